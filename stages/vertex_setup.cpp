#include "stages/vertex_setup.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simd/sample_pattern.h"
#include "simd/scalar.h"
#include "stages/counting.h"

namespace beampipe {
namespace {

template <class Real>
struct ClipVertex {
  Real x, y, z, w;
};

template <class Real>
ClipVertex<Real> transform_vertex(const std::array<Real, 16>& m, Real x, Real y, Real z) {
  const auto row = [&](std::size_t r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
  return {row(0), row(1), row(2), row(3)};
}

// Viewport transform. Depth goes from [-1, 1] to [-1, 0] (stages/setup_triangle.h).
template <class Real>
struct ScreenVertex {
  Real x, y, z;  // pixels, pixels, depth
};

template <class Real>
ScreenVertex<Real> project(const ClipVertex<Real>& v, Real width, Real height) {
  const Real half(0.5), one(1.0);
  const Real inverse_w = one / v.w;
  return {(v.x * inverse_w + one) * half * width, (one - v.y * inverse_w) * half * height,
          (v.z * inverse_w - one) * half};
}

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

// Before it is rounded down to an integer: pixels in 1/256 px.
template <class Real>
Real to_grid(Real pixels) {
  return pixels * Real(double{kSubpixelUnits}) + Real(0.5);
}

std::int32_t snap(double pixels) { return static_cast<std::int32_t>(std::floor(to_grid(pixels))); }

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

class Setup {
 public:
  Setup(const Frame& frame, SetupTriangles& out) : frame_(frame), planes_(clip_planes(frame)), out_(out) {
    // Front faces are counter-clockwise on screen; a mirroring view or projection turns that around in the world. Clip
    // space is left-handed, so that what does not mirror has a negative determinant.
    mirrored_ = glm::determinant(frame.projection * frame.view) > 0;
  }

  void add_draw(const Mesh& mesh, const Draw& draw) {
    const std::array<double, 16> elements = elements_of(frame_.projection * frame_.view * draw.transform);
    vertices_.clear();
    vertices_.reserve(mesh.positions.size());
    for (const glm::vec3& p : mesh.positions) vertices_.push_back(transform_vertex<double>(elements, p.x, p.y, p.z));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) add_triangle(mesh, draw, t);
    work_.transformed += mesh.positions.size();
    ++draws_;
  }

  // How often each twin ran.
  struct Work {
    std::uint64_t transformed = 0, outside_tests = 0, plane_tests = 0, crossings = 0, projected = 0, areas = 0;
    std::uint64_t normals = 0;
  };
  const Work& work() const { return work_; }

 private:
  void add_triangle(const Mesh& mesh, const Draw& draw, std::size_t t) {
    const glm::uvec3& index = mesh.triangles[t];
    const std::array<ClipVertex<double>, 3> v = {vertices_[index.x], vertices_[index.y], vertices_[index.z]};
    for (const ClipVertex<double>& p : v)
      if (!std::isfinite(p.x + p.y + p.z + p.w)) return;
    ++work_.outside_tests;
    if (outside_view(v)) return;
    const std::size_t first = out_.triangles.size();
    bool clipped = false;
    for (const auto& plane : planes_)
      for (const ClipVertex<double>& p : v) clipped |= plane_distance(plane, p) < 0;
    work_.plane_tests += planes_.size() * v.size();
    if (!clipped) {
      add_screen_triangle(v[0], v[1], v[2], draw.cull);
    } else {
      Polygon polygon(v.begin(), v.end());
      for (const auto& plane : planes_) {
        work_.plane_tests += polygon.size();
        polygon = clip_to_plane(polygon, plane, work_.crossings);
      }
      for (std::size_t i = 2; i < polygon.size(); ++i)
        add_screen_triangle(polygon[0], polygon[i - 1], polygon[i], draw.cull);
    }
    for (std::size_t i = first; i < out_.triangles.size(); ++i)
      out_.attributes.push_back(attributes(mesh, draw, t, fronts_[i - first]));
    out_.draws.resize(out_.triangles.size(), draws_);
    fronts_.clear();
  }

  void add_screen_triangle(const ClipVertex<double>& a, const ClipVertex<double>& b, const ClipVertex<double>& c,
                           Cull cull) {
    SetupTriangle triangle;
    std::array<ScreenVertex<double>, 3> p;
    int k = 0;
    for (const ClipVertex<double>* v : {&a, &b, &c}) {
      if (!(v->w > 0)) return;
      const auto i = static_cast<std::size_t>(k);
      ++work_.projected;
      p[i] = project<double>(*v, frame_.width, frame_.height);
      triangle.x[k] = snap(p[i].x), triangle.y[k] = snap(p[i].y);
      triangle.vertex_z[k] = static_cast<float>(p[i].z);
      p[i].x = triangle.x[k] / double(kSubpixelUnits), p[i].y = triangle.y[k] / double(kSubpixelUnits);
      ++k;
    }
    ++work_.areas;
    const std::int64_t area2 = doubled_area<std::int64_t>({triangle.x[0], triangle.x[1], triangle.x[2]},
                                                          {triangle.y[0], triangle.y[1], triangle.y[2]});
    if (area2 == 0) return;
    const bool front = area2 < 0;  // counter-clockwise with y up
    if (cull == (front ? Cull::front : Cull::back)) return;
    if (front) {
      std::swap(triangle.x[1], triangle.x[2]);
      std::swap(triangle.y[1], triangle.y[2]);
      std::swap(triangle.vertex_z[1], triangle.vertex_z[2]);
    }
    // Sorted, so that equal triangles have equal depth whatever vertex they start with and whichever way they turn.
    std::sort(p.begin(), p.end(), [](const auto& l, const auto& r) {
      return std::array{l.x, l.y, l.z} < std::array{r.x, r.y, r.z};
    });
    const Slopes<double> slopes = depth_slopes(p[0], p[1], p[2]);
    triangle.depth = {p[0].z, slopes.dzdx, slopes.dzdy, p[0].x, p[0].y};
    triangle.front = front;
    out_.triangles.push_back(triangle);
    fronts_.push_back(front);
  }

  FlatAttributes attributes(const Mesh& mesh, const Draw& draw, std::size_t t, bool front) {
    FlatAttributes flat{draw.kd.value_or(mesh.colors[t]), glm::vec3(0), draw.shading == Shading::lambert};
    if (!flat.lit) return flat;
    ++work_.normals;
    const auto world = [&](std::uint32_t i) {
      const glm::vec3& p = mesh.positions[i];
      return world_point<double>(elements_of(draw.transform), {p.x, p.y, p.z});
    };
    const glm::uvec3& index = mesh.triangles[t];
    double length = 0;
    const Vector<double> normal = face_normal(world(index.x), world(index.y), world(index.z), length);
    const double scale = (front != mirrored_ ? 1.0 : -1.0) / length;
    if (length > 0) flat.normal = glm::vec3(glm::dvec3(normal.x, normal.y, normal.z) * scale);
    return flat;
  }

  const Frame& frame_;
  ClipPlanes planes_;
  SetupTriangles& out_;
  bool mirrored_ = false;
  std::vector<ClipVertex<double>> vertices_;  // of the draw at hand
  std::vector<bool> fronts_;                  // of the triangle at hand, per piece
  std::uint32_t draws_ = 0;                   // before the one at hand
  Work work_;
};

using CountedReal = Counted<double>;

OperationCounts transform_cost() {
  return count_operations([](OperationCounts& counts) {
    std::array<CountedReal, 16> matrix;
    matrix.fill(CountedReal(1.0, counts));
    const CountedReal x(1.0, counts);
    transform_vertex(matrix, x, x, x);
  });
}

OperationCounts project_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal x(1.0, counts);
    const ScreenVertex<CountedReal> screen = project<CountedReal>({x, x, x, x}, x, x);
    converted(to_grid(screen.x)), converted(to_grid(screen.y));
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
    const CountedReal scale = x / x;
    for (const CountedReal& component : {normal.x, normal.y, normal.z}) converted(component * scale);
  });
}

// Once per triangle and edge: a, b and c (stages/setup_triangle.h).
OperationCounts edges_cost() {
  return count_operations([](OperationCounts& counts) {
    using Int = Counted<std::int64_t>;
    const Int x(1, counts), zero(0);
    for (int k = 0; k < 3; ++k) {
      const Int a = x - x, b = x - x;
      static_cast<void>(zero - (a * x + b * x));
    }
  });
}

OperationCounts slopes_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal zero(0.0, counts), one(1.0, counts);
    depth_slopes<CountedReal>({zero, zero, zero}, {one, zero, one}, {zero, one, one});
  });
}

}  // namespace

SetupTriangles vertex_setup(const Trace& trace, const Frame& frame, StageCounters& counters) {
  SetupTriangles out;
  Setup setup(frame, out);
  counters.stage = "vertex_setup";
  for (const Draw& draw : frame.draws) {
    const Mesh& mesh = trace.meshes[draw.mesh];
    setup.add_draw(mesh, draw);
    counters.items_in += mesh.triangles.size();
    counters.bytes_read += mesh.triangles.size() * sizeof(glm::uvec3) + mesh.positions.size() * sizeof(glm::vec3);
  }
  counters.items_out = out.triangles.size();
  const Setup::Work& work = setup.work();
  counters.ops += transform_cost() * work.transformed;
  counters.ops += outside_cost() * work.outside_tests;
  counters.ops += plane_test_cost() * work.plane_tests;
  counters.ops += crossing_cost() * work.crossings;
  counters.ops += project_cost() * work.projected;
  counters.ops += area_cost() * work.areas;
  counters.ops += slopes_cost() * out.triangles.size();
  counters.ops += edges_cost() * out.triangles.size();
  counters.ops += normal_cost() * work.normals;
  counters.bytes_written += out.triangles.size() * (sizeof(SetupTriangle) + sizeof(FlatAttributes));
  return out;
}

}  // namespace beampipe
