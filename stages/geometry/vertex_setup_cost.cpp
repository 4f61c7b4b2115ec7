#include "stages/geometry/vertex_setup_cost.h"

#include <array>

#include "simd/sample_pattern.h"
#include "stages/cost/counting.h"
#include "stages/geometry/clip.h"
#include "stages/geometry/setup_formulas.h"

namespace beampipe {
namespace {

using CountedReal = Counted<double>;

OperationCounts transform_cost() {
  return count_operations([](OperationCounts& counts) {
    std::array<CountedReal, 16> matrix;
    matrix.fill(CountedReal(1.0, counts));
    const CountedReal x(1.0, counts);
    static_cast<void>(in_view(transform_vertex(matrix, x, x, x)));
  });
}

OperationCounts transform_homogeneous_cost() {
  return count_operations([](OperationCounts& counts) {
    std::array<CountedReal, 16> matrix;
    matrix.fill(CountedReal(1.0, counts));
    const CountedReal x(1.0, counts);
    static_cast<void>(in_view(transform_vertex(matrix, x, x, x, x)));
  });
}

// The depths of three corners, and where a painted triangle's layer lies.
OperationCounts placed_cost() { return {.mul_add = 3 + 1, .add = 3 + 1}; }

OperationCounts bias_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    counts.add += 2 * 2;  // the nearest and the farthest corner
    const CountedReal bias = limited_bias(depth_bias<CountedReal>({x, x, x, x}, x, x), x, x, x, x);
    for (int corner = 0; corner < 3 + 1; ++corner) static_cast<void>(x + bias);
  });
}

OperationCounts project_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    const ScreenVertex<CountedReal> screen = project<CountedReal>({x, x, x, x}, x, x);
    converted(to_grid(screen.x)), converted(to_grid(screen.y));
    for (int axis = 0; axis < 2; ++axis) converted(x) * CountedReal(1.0 / kSubpixelUnits);  // snapped, back to pixels
  });
}

OperationCounts outside_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    outside_view<CountedReal>({{{x, x, x, x}, {x, x, x, x}, {x, x, x, x}}});
  });
}

OperationCounts plane_test_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    static_cast<void>(plane_distance<CountedReal>({x, x, x, x}, {x, x, x, x}) < x);
  });
}

OperationCounts crossing_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    crossing<CountedReal>({x, x, x, x}, {x, x, x, x}, crossing_place(x, CountedReal(0.0, counts)));
  });
}

// The area, and which way the triangle turns.
OperationCounts area_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::int64_t> x(1, counts);
    static_cast<void>(doubled_area<Counted<std::int64_t>>({x, x, x}, {x, x, x}) < x);
  });
}

OperationCounts normal_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    std::array<CountedReal, 16> matrix;
    matrix.fill(x);
    const auto world = [&] { return world_point<CountedReal>(matrix, {x, x, x}); };
    CountedReal length;
    const Vector<CountedReal> normal = face_normal(world(), world(), world(), length);
    static_cast<void>(length > CountedReal(0.0));
    const CountedReal scale = x / x;
    for (const CountedReal& component : {normal.x, normal.y, normal.z}) converted(component * scale);
  });
}

// The test whether all three corners of a clipped polygon's triangle are in front of the eye.
OperationCounts fan_cost() { return {.add = 3}; }

// Conversion of the corners' depths to the stored format.
OperationCounts depths_cost() { return {.convert = 3}; }

OperationCounts slopes_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal zero(0.0, counts), one(1.0, counts);
    counts.add += 3;  // comparisons to sort the corners
    depth_slopes<CountedReal>({zero, zero, zero}, {one, zero, one}, {zero, one, one});
  });
}

// World position, and the direction to the eye.
OperationCounts to_eye_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    std::array<CountedReal, 16> matrix;
    matrix.fill(x);
    const Vector<CountedReal> world = world_point<CountedReal>(matrix, {x, x, x});
    for (const CountedReal& component : {world.x, world.y, world.z}) converted(x - component);
  });
}

// A normal or a tangent: a 3 x 3 matrix, and its length.
OperationCounts vertex_vector_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    const auto row = [&] { return x * x + x * x + x * x; };
    const CountedReal length = square_root(row());
    for (int component = 0; component < 3; ++component) converted(row() / length);
  });
}

// Three planes from 1 / w and two weights.
OperationCounts surface_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal zero(0.0, counts), one(1.0, counts);
    const CountedReal smallest = lesser(lesser(one, one), one);
    for (int corner = 0; corner < 3; ++corner) {
      const CountedReal w = smallest / one;
      for (int weight = 0; weight < 2; ++weight) static_cast<void>(one * w);
    }
    for (int plane = 0; plane < 3; ++plane) {
      const Slopes<CountedReal> slopes =
          depth_slopes<CountedReal>({zero, zero, zero}, {one, zero, one}, {zero, one, one});
      converted(one), converted(slopes.dzdx), converted(slopes.dzdy);
    }
  });
}

// The area of corners that are not snapped, and three planes' values at the snapped corner.
OperationCounts unsnapped_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    static_cast<void>(magnitude(doubled_area<CountedReal>({x, x, x}, {x, x, x})) < x);
    for (int plane = 0; plane < 3; ++plane) static_cast<void>(value_beside<CountedReal>({x, x, x}, {x, x}, x, x));
  });
}

// Edges of the triangle in space and in texture coordinates, and a unit vector.
OperationCounts tangent_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    for (int edge = 0; edge < 2 * (3 + 2); ++edge) static_cast<void>(x - x);
    static_cast<void>(x * x - x * x < x);
    const auto component = [&] { return (x * x - x * x) * x; };
    const CountedReal length = square_root(component() * x + component() * x + component() * x);
    for (int axis = 0; axis < 3; ++axis) converted(x / length);
  });
}

}  // namespace

void charge(const SetupWork& work, StageCounters& counters) {
  counters.ops += transform_cost() * work.transformed;
  counters.ops += transform_homogeneous_cost() * work.transformed_homogeneous;
  counters.ops += placed_cost() * work.placed;
  counters.ops += bias_cost() * work.biased;
  counters.ops += outside_cost() * work.outside_tests;
  counters.ops += plane_test_cost() * work.plane_tests;
  counters.ops += crossing_cost() * work.crossings;
  counters.ops += fan_cost() * work.fans;
  counters.ops += project_cost() * work.projected;
  counters.ops += area_cost() * work.areas;
  counters.ops += slopes_cost() * work.triangles;
  counters.ops += depths_cost() * work.triangles;
  counters.ops += normal_cost() * work.normals;
  counters.ops += to_eye_cost() * work.shaded_vertices;
  counters.ops += vertex_vector_cost() * work.vertex_vectors;
  counters.ops += surface_cost() * work.surfaces;
  counters.ops += tangent_cost() * work.tangents;
  counters.ops += unsnapped_cost() * work.unsnapped;
}

}  // namespace beampipe
