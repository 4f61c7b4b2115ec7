#include "stages/geometry/setup_cost.h"

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

OperationCounts project_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    const ScreenVertex<CountedReal> screen = project<CountedReal>({x, x, x, x}, x, x);
    converted(to_grid(screen.x)), converted(to_grid(screen.y));
    for (int axis = 0; axis < 2; ++axis) converted(x) * CountedReal(1.0 / kSubpixelUnits);  // what was snapped
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
    crossing<CountedReal>({x, x, x, x}, {x, x, x, x}, x, CountedReal(0.0, counts));
  });
}

OperationCounts area_cost() {  // and which way the triangle turns
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

// Is every corner of a clipped polygon's triangle before the eye?
OperationCounts fan_cost() { return {.add = 3}; }

// The corners' depths as they are stored.
OperationCounts depths_cost() { return {.convert = 3}; }

OperationCounts slopes_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal zero(0.0, counts), one(1.0, counts);
    counts.add += 3;  // comparisons that put the corners in order
    depth_slopes<CountedReal>({zero, zero, zero}, {one, zero, one}, {zero, one, one});
  });
}

}  // namespace

OperationCounts setup_cost(const SetupWork& work) {
  OperationCounts ops = transform_cost() * work.transformed;
  ops += outside_cost() * work.outside_tests;
  ops += plane_test_cost() * work.plane_tests;
  ops += crossing_cost() * work.crossings;
  ops += fan_cost() * work.fans;
  ops += project_cost() * work.projected;
  ops += area_cost() * work.areas;
  ops += slopes_cost() * work.triangles;
  ops += depths_cost() * work.triangles;
  ops += normal_cost() * work.normals;
  return ops;
}

}  // namespace beampipe
