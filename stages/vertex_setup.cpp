#include "stages/vertex_setup.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "simd/sample_pattern.h"
#include "simd/scalar.h"
#include "simd/vertex_transform.h"
#include "stages/counting.h"

namespace beampipe {
namespace {

// Depth plane through three snapped vertices; `area2` is twice their signed area.
template <class Real>
struct Slopes {
  Real dzdx, dzdy;
};

template <class Real>
Slopes<Real> depth_slopes(const ScreenVertex<Real>& p, const ScreenVertex<Real>& q, const ScreenVertex<Real>& r) {
  const Real qx = q.x - p.x, qy = q.y - p.y, qz = q.z - p.z;
  const Real rx = r.x - p.x, ry = r.y - p.y, rz = r.z - p.z;
  const Real inverse = Real(1.0) / (qx * ry - rx * qy);
  return {(qz * ry - rz * qy) * inverse, (rz * qx - qz * rx) * inverse};
}

// Clip planes as inner products that are >= 0 inside: near, far, then the guard band's four sides.
constexpr int kPlanes = 6;
using ClipPlanes = std::array<std::array<double, 4>, kPlanes>;

ClipPlanes clip_planes(const Frame& frame) {
  // Pixel x lies in [-G, G]: (x / w + 1) W / 2 >= -G, and so on.
  const double right = 2 * kGuardBand / frame.width - 1, left = 2 * kGuardBand / frame.width + 1;
  const double low = 2 * kGuardBand / frame.height - 1, high = 2 * kGuardBand / frame.height + 1;
  return {{{0, 0, 1, 1}, {0, 0, -1, 1}, {1, 0, 0, left}, {-1, 0, 0, right}, {0, 1, 0, low}, {0, -1, 0, high}}};
}

template <class Real>
Real plane_distance(const std::array<Real, 4>& plane, const ClipVertex<Real>& v) {
  return plane[0] * v.x + plane[1] * v.y + plane[2] * v.z + plane[3] * v.w;
}

// Where an edge that leaves the inside meets the plane.
template <class Real>
ClipVertex<Real> crossing(const ClipVertex<Real>& in, const ClipVertex<Real>& out, Real in_distance,
                          Real out_distance) {
  const Real t = in_distance / (in_distance - out_distance);
  return {in.x + t * (out.x - in.x), in.y + t * (out.y - in.y), in.z + t * (out.z - in.z), in.w + t * (out.w - in.w)};
}

using Polygon = std::vector<ClipVertex<double>>;

// Sutherland-Hodgman against one plane. A crossing is always computed from its inner to its outer vertex, so that two
// triangles that share the edge get the same point. Adds the crossings to `crossings`.
Polygon clip_to_plane(const Polygon& polygon, const std::array<double, 4>& plane, std::uint64_t& crossings) {
  std::vector<double> distances;
  for (const ClipVertex<double>& vertex : polygon) distances.push_back(plane_distance(plane, vertex));
  Polygon clipped;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::size_t next = (i + 1) % polygon.size();
    const ClipVertex<double>&from = polygon[i], &to = polygon[next];
    const double from_distance = distances[i], to_distance = distances[next];
    if (from_distance >= 0) clipped.push_back(from);
    if ((from_distance >= 0) == (to_distance >= 0)) continue;
    const bool leaving = from_distance >= 0;
    const ClipVertex<double>&in = leaving ? from : to, &out = leaving ? to : from;
    clipped.push_back(crossing(in, out, leaving ? from_distance : to_distance, leaving ? to_distance : from_distance));
    ++crossings;
  }
  return clipped;
}

// Outside one side of the view volume with all three vertices?
template <class Real>
bool outside_view(const std::array<ClipVertex<Real>, 3>& v) {
  bool left = true, right = true, below = true, above = true, before = true, behind = true;
  for (const ClipVertex<Real>& p : v) {
    const Real minus_w = Real(0.0) - p.w;
    left &= p.x<minus_w, right &= p.x> p.w;
    below &= p.y<minus_w, above &= p.y> p.w;
    before &= p.z<minus_w, behind &= p.z> p.w;
  }
  return left | right | below | above | before | behind;
}

// Twice the signed area; positive: clockwise with y down.
template <class Int>
Int doubled_area(const std::array<Int, 3>& x, const std::array<Int, 3>& y) {
  return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
}

template <class Real>
struct Vector {
  Real x, y, z;
};

// `m`: column-major. The sums are paired as glm does.
template <class Real>
Vector<Real> world_point(const std::array<Real, 16>& m, const Vector<Real>& p) {
  const auto row = [&](std::size_t r) { return (m[r] * p.x + m[4 + r] * p.y) + (m[8 + r] * p.z + m[12 + r]); };
  return {row(0), row(1), row(2)};
}

// The normal of a triangle, whose length is not one, and that length.
template <class Real>
Vector<Real> face_normal(const Vector<Real>& p, const Vector<Real>& q, const Vector<Real>& r, Real& length) {
  const Real ax = q.x - p.x, ay = q.y - p.y, az = q.z - p.z;
  const Real bx = r.x - p.x, by = r.y - p.y, bz = r.z - p.z;
  const Vector<Real> normal{ay * bz - by * az, az * bx - bz * ax, ax * by - bx * ay};
  length = square_root(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
  return normal;
}

std::array<double, 16> elements_of(const glm::dmat4& matrix) {  // column-major
  std::array<double, 16> elements{};
  for (int i = 0; i < 16; ++i) elements[static_cast<std::size_t>(i)] = matrix[i / 4][i % 4];
  return elements;
}

// How often each twin ran.
struct Work {
  std::uint64_t transformed = 0, outside_tests = 0, plane_tests = 0, crossings = 0, fans = 0, projected = 0, areas = 0;
  std::uint64_t normals = 0;

  Work& operator+=(const Work& other) {
    transformed += other.transformed, outside_tests += other.outside_tests, plane_tests += other.plane_tests;
    crossings += other.crossings, fans += other.fans, projected += other.projected, areas += other.areas;
    normals += other.normals;
    return *this;
  }
};

// What the draws of a frame have in common.
struct View {
  double width, height;
  glm::dmat4 to_clip;  // from the world
  ClipPlanes planes;
  bool mirrored;

  explicit View(const Frame& frame)
      : width(frame.width),
        height(frame.height),
        to_clip(frame.projection * frame.view),
        planes(clip_planes(frame)),
        // Front faces are counter-clockwise on screen; a mirroring view or projection turns that around in the world.
        // Clip space is left-handed, so that what does not mirror has a negative determinant.
        mirrored(glm::determinant(to_clip) > 0) {}
};

// Triangles of one draw, one after the other, into `out`.
class TriangleSetup {
 public:
  TriangleSetup(const View& view, const Mesh& mesh, const Draw& draw, std::uint32_t draw_index,
                const VertexTransform& transform, const std::vector<ProjectedVertex>& vertices)
      : view_(view),
        mesh_(mesh),
        draw_(draw),
        to_world_(elements_of(draw.transform)),
        draw_index_(draw_index),
        transform_(transform),
        vertices_(vertices) {}

  void add(std::size_t t) {
    const glm::uvec3& index = mesh_.triangles[t];
    const std::array<const ProjectedVertex*, 3> v = {&vertices_[index.x], &vertices_[index.y], &vertices_[index.z]};
    if (v[0]->in_view && v[1]->in_view && v[2]->in_view) {
      add_on_screen(t, *v[0], *v[1], *v[2]);
    } else if (v[0]->finite && v[1]->finite && v[2]->finite) {
      ++work.outside_tests;
      const std::array<ClipVertex<double>, 3> clip = {v[0]->clip, v[1]->clip, v[2]->clip};
      if (!outside_view(clip)) add_clipped(t, clip);
    }
  }

  SetupTriangles out;
  Work work;

 private:
  void add_clipped(std::size_t t, const std::array<ClipVertex<double>, 3>& v) {
    Polygon polygon(v.begin(), v.end());
    bool clipped = false;
    for (const auto& plane : view_.planes)
      for (const ClipVertex<double>& p : v) clipped |= plane_distance(plane, p) < 0;
    work.plane_tests += view_.planes.size() * v.size();
    for (std::size_t i = 0; clipped && i < view_.planes.size(); ++i) {
      work.plane_tests += polygon.size();
      polygon = clip_to_plane(polygon, view_.planes[i], work.crossings);
    }
    const auto on_screen = [&](const ClipVertex<double>& p) {
      ProjectedVertex vertex{};
      vertex.clip = p;
      place_on_screen(transform_, vertex);
      ++work.projected;
      return vertex;
    };
    work.fans += polygon.size() < 3 ? 0 : polygon.size() - 2;
    for (std::size_t i = 2; i < polygon.size(); ++i)
      if (polygon[0].w > 0 && polygon[i - 1].w > 0 && polygon[i].w > 0)
        add_on_screen(t, on_screen(polygon[0]), on_screen(polygon[i - 1]), on_screen(polygon[i]));
  }

  void add_on_screen(std::size_t t, const ProjectedVertex& a, const ProjectedVertex& b, const ProjectedVertex& c) {
    ++work.areas;
    const std::int64_t area2 = doubled_area<std::int64_t>({a.x, b.x, c.x}, {a.y, b.y, c.y});
    if (area2 == 0) return;
    const bool front = area2 < 0;  // counter-clockwise with y up
    if (draw_.cull == (front ? Cull::front : Cull::back)) return;
    SetupTriangle triangle;
    const std::array<const ProjectedVertex*, 3> turned = {&a, front ? &c : &b, front ? &b : &c};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.x[k] = turned[k]->x, triangle.y[k] = turned[k]->y;
      triangle.vertex_z[k] = static_cast<float>(turned[k]->screen.z);
    }
    // Sorted, so that equal triangles have equal depth whatever vertex they start with and whichever way they turn.
    std::array<ScreenVertex<double>, 3> p = {a.screen, b.screen, c.screen};
    const auto put_in_order = [&p](std::size_t i) {
      const auto key = [](const ScreenVertex<double>& v) { return std::array{v.x, v.y, v.z}; };
      if (key(p[i + 1]) < key(p[i])) std::swap(p[i], p[i + 1]);
    };
    put_in_order(0), put_in_order(1), put_in_order(0);
    const Slopes<double> slopes = depth_slopes(p[0], p[1], p[2]);
    triangle.depth = {p[0].z, slopes.dzdx, slopes.dzdy, p[0].x, p[0].y};
    triangle.front = front;
    out.triangles.push_back(triangle);
    out.attributes.push_back(attributes(t, front));
    out.draws.push_back(draw_index_);
  }

  FlatAttributes attributes(std::size_t t, bool front) {
    FlatAttributes flat{draw_.kd.value_or(mesh_.colors[t]), glm::vec3(0), draw_.shading == Shading::lambert};
    if (!flat.lit) return flat;
    ++work.normals;
    const auto world = [&](std::uint32_t i) {
      const glm::vec3& p = mesh_.positions[i];
      return world_point<double>(to_world_, {p.x, p.y, p.z});
    };
    const glm::uvec3& index = mesh_.triangles[t];
    double length = 0;
    const Vector<double> normal = face_normal(world(index.x), world(index.y), world(index.z), length);
    const double scale = (front != view_.mirrored ? 1.0 : -1.0) / length;
    if (length > 0) flat.normal = glm::vec3(glm::dvec3(normal.x, normal.y, normal.z) * scale);
    return flat;
  }

  const View& view_;
  const Mesh& mesh_;
  const Draw& draw_;
  std::array<double, 16> to_world_;
  std::uint32_t draw_index_;
  const VertexTransform& transform_;
  const std::vector<ProjectedVertex>& vertices_;
};

void append(const SetupTriangles& part, SetupTriangles& whole) {
  whole.triangles.insert(whole.triangles.end(), part.triangles.begin(), part.triangles.end());
  whole.attributes.insert(whole.attributes.end(), part.attributes.begin(), part.attributes.end());
  whole.draws.insert(whole.draws.end(), part.draws.begin(), part.draws.end());
}

constexpr std::size_t kChunk = 4096;  // vertices or triangles that one thread takes at once

// Calls work(first, end) for chunks of [0, count), side by side.
template <class ChunkWork>
void for_each_chunk(std::size_t count, ChunkWork&& work) {
  tbb::parallel_for(std::size_t{0}, (count + kChunk - 1) / kChunk,
                    [&](std::size_t chunk) { work(chunk * kChunk, std::min(count, (chunk + 1) * kChunk)); });
}

// The draw's triangles, chunk by chunk, behind those of `out`.
Work add_draw(const View& view, const Mesh& mesh, const Draw& draw, std::uint32_t draw_index, SetupTriangles& out) {
  const VertexTransform transform{elements_of(view.to_clip * draw.transform), view.width, view.height};
  std::vector<ProjectedVertex> vertices(mesh.positions.size());
  std::vector<std::size_t> in_view((vertices.size() + kChunk - 1) / kChunk);
  for_each_chunk(vertices.size(), [&](std::size_t first, std::size_t end) {
    in_view[first / kChunk] =
        transform_vertices(&mesh.positions[first].x, end - first, transform, vertices.data() + first);
  });
  std::vector<TriangleSetup> chunks((mesh.triangles.size() + kChunk - 1) / kChunk,
                                    TriangleSetup(view, mesh, draw, draw_index, transform, vertices));
  for_each_chunk(mesh.triangles.size(), [&](std::size_t first, std::size_t end) {
    chunks[first / kChunk].out.reserve(end - first);
    for (std::size_t t = first; t < end; ++t) chunks[first / kChunk].add(t);
  });
  std::size_t count = out.triangles.size();
  for (const TriangleSetup& chunk : chunks) count += chunk.out.triangles.size();
  out.reserve(count);
  Work work;
  work.transformed = vertices.size();
  for (const std::size_t of_chunk : in_view) work.projected += of_chunk;
  for (const TriangleSetup& chunk : chunks) {
    append(chunk.out, out);
    work += chunk.work;
  }
  return work;
}

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

// Once per triangle: of each edge a, b and c, of each corner the depth (stages/setup_triangle.h).
OperationCounts edges_cost() {
  return count_operations([](OperationCounts& counts) {
    using Int = Counted<std::int64_t>;
    const Int x(1, counts), zero(0);
    for (int k = 0; k < 3; ++k) {
      const Int a = x - x, b = x - x;
      static_cast<void>(zero - (a * x + b * x));
      to_float(x);
    }
  });
}

OperationCounts slopes_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal zero(0.0, counts), one(1.0, counts);
    counts.add += 3;  // comparisons that put the corners in order
    depth_slopes<CountedReal>({zero, zero, zero}, {one, zero, one}, {zero, one, one});
  });
}

}  // namespace

SetupTriangles vertex_setup(const Trace& trace, const Frame& frame, StageCounters& counters) {
  SetupTriangles out;
  const View view(frame);
  Work work;
  counters.stage = "vertex_setup";
  for (std::uint32_t i = 0; i < frame.draws.size(); ++i) {
    const Draw& draw = frame.draws[i];
    const Mesh& mesh = trace.meshes[draw.mesh];
    work += add_draw(view, mesh, draw, i, out);
    counters.items_in += mesh.triangles.size();
    counters.bytes_read += mesh.triangles.size() * sizeof(glm::uvec3) + mesh.positions.size() * sizeof(glm::vec3);
  }
  counters.items_out = out.triangles.size();
  counters.ops += transform_cost() * work.transformed;
  counters.ops += outside_cost() * work.outside_tests;
  counters.ops += plane_test_cost() * work.plane_tests;
  counters.ops += crossing_cost() * work.crossings;
  counters.ops += fan_cost() * work.fans;
  counters.ops += project_cost() * work.projected;
  counters.ops += area_cost() * work.areas;
  counters.ops += slopes_cost() * out.triangles.size();
  counters.ops += edges_cost() * out.triangles.size();
  counters.ops += normal_cost() * work.normals;
  counters.bytes_written += out.triangles.size() * (sizeof(SetupTriangle) + sizeof(FlatAttributes));
  return out;
}

}  // namespace beampipe
