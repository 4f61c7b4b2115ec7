#include "stages/vertex_setup.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simd/sample_pattern.h"
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

double plane_distance(const std::array<double, 4>& plane, const ClipVertex<double>& v) {
  return plane[0] * v.x + plane[1] * v.y + plane[2] * v.z + plane[3] * v.w;
}

using Polygon = std::vector<ClipVertex<double>>;

// Sutherland-Hodgman against one plane. A crossing is always computed from its inner to its outer vertex, so that two
// triangles that share the edge get the same point.
Polygon clip_to_plane(const Polygon& polygon, const std::array<double, 4>& plane) {
  Polygon clipped;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const ClipVertex<double>&from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double from_distance = plane_distance(plane, from), to_distance = plane_distance(plane, to);
    if (from_distance >= 0) clipped.push_back(from);
    if ((from_distance >= 0) == (to_distance >= 0)) continue;
    const bool leaving = from_distance >= 0;
    const ClipVertex<double>&in = leaving ? from : to, &out = leaving ? to : from;
    const double in_distance = leaving ? from_distance : to_distance;
    const double out_distance = leaving ? to_distance : from_distance;
    const double t = in_distance / (in_distance - out_distance);
    clipped.push_back(
        {in.x + t * (out.x - in.x), in.y + t * (out.y - in.y), in.z + t * (out.z - in.z), in.w + t * (out.w - in.w)});
  }
  return clipped;
}

// Outside one side of the view volume with all three vertices?
bool outside_view(const std::array<ClipVertex<double>, 3>& v) {
  const auto all = [&](auto&& beyond) { return beyond(v[0]) && beyond(v[1]) && beyond(v[2]); };
  using Vertex = ClipVertex<double>;
  return all([](const Vertex& p) { return p.x < -p.w; }) || all([](const Vertex& p) { return p.x > p.w; }) ||
         all([](const Vertex& p) { return p.y < -p.w; }) || all([](const Vertex& p) { return p.y > p.w; }) ||
         all([](const Vertex& p) { return p.z < -p.w; }) || all([](const Vertex& p) { return p.z > p.w; });
}

std::int32_t snap(double pixels) { return static_cast<std::int32_t>(std::floor(pixels * kSubpixelUnits + 0.5)); }

class Setup {
 public:
  Setup(const Frame& frame, SetupTriangles& out) : frame_(frame), planes_(clip_planes(frame)), out_(out) {
    // Front faces are counter-clockwise on screen; a mirroring view or projection turns that around in the world. Clip
    // space is left-handed, so that what does not mirror has a negative determinant.
    mirrored_ = glm::determinant(frame.projection * frame.view) > 0;
  }

  void add_draw(const Mesh& mesh, const Draw& draw) {
    const glm::dmat4 matrix = frame_.projection * frame_.view * draw.transform;
    std::array<double, 16> elements{};
    for (std::size_t column = 0; column < 4; ++column)
      for (std::size_t row = 0; row < 4; ++row)
        elements[4 * column + row] = matrix[static_cast<int>(column)][static_cast<int>(row)];
    vertices_.clear();
    vertices_.reserve(mesh.positions.size());
    for (const glm::vec3& p : mesh.positions) vertices_.push_back(transform_vertex<double>(elements, p.x, p.y, p.z));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) add_triangle(mesh, draw, t);
    transformed_ += mesh.positions.size();
    ++draws_;
  }

  std::uint64_t transformed() const { return transformed_; }
  std::uint64_t projected() const { return projected_; }
  std::uint64_t plane_tests() const { return plane_tests_; }

 private:
  void add_triangle(const Mesh& mesh, const Draw& draw, std::size_t t) {
    const glm::uvec3& index = mesh.triangles[t];
    const std::array<ClipVertex<double>, 3> v = {vertices_[index.x], vertices_[index.y], vertices_[index.z]};
    for (const ClipVertex<double>& p : v)
      if (!std::isfinite(p.x + p.y + p.z + p.w)) return;
    if (outside_view(v)) return;
    const std::size_t first = out_.triangles.size();
    bool clipped = false;
    for (const auto& plane : planes_)
      for (const ClipVertex<double>& p : v) clipped |= plane_distance(plane, p) < 0;
    if (!clipped) {
      add_screen_triangle(v[0], v[1], v[2], draw.cull);
    } else {
      Polygon polygon(v.begin(), v.end());
      for (const auto& plane : planes_) {
        plane_tests_ += polygon.size();
        polygon = clip_to_plane(polygon, plane);
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
    projected_ += 3;
    SetupTriangle triangle;
    std::array<ScreenVertex<double>, 3> p;
    int k = 0;
    for (const ClipVertex<double>* v : {&a, &b, &c}) {
      if (!(v->w > 0)) return;
      const auto i = static_cast<std::size_t>(k);
      p[i] = project<double>(*v, frame_.width, frame_.height);
      triangle.x[k] = snap(p[i].x), triangle.y[k] = snap(p[i].y);
      triangle.vertex_z[k] = static_cast<float>(p[i].z);
      p[i].x = triangle.x[k] / double(kSubpixelUnits), p[i].y = triangle.y[k] / double(kSubpixelUnits);
      ++k;
    }
    const auto area2 = std::int64_t{triangle.x[1] - triangle.x[0]} * (triangle.y[2] - triangle.y[0]) -
                       std::int64_t{triangle.x[2] - triangle.x[0]} * (triangle.y[1] - triangle.y[0]);
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

  FlatAttributes attributes(const Mesh& mesh, const Draw& draw, std::size_t t, bool front) const {
    FlatAttributes flat{draw.kd.value_or(mesh.colors[t]), glm::vec3(0), draw.shading == Shading::lambert};
    if (!flat.lit) return flat;
    const auto world = [&](std::uint32_t i) { return glm::dvec3(draw.transform * glm::dvec4(mesh.positions[i], 1.0)); };
    const glm::dvec3 p = world(mesh.triangles[t].x);
    const glm::dvec3 normal = glm::cross(world(mesh.triangles[t].y) - p, world(mesh.triangles[t].z) - p);
    const double length = glm::length(normal);
    if (length > 0) flat.normal = glm::vec3(normal * ((front != mirrored_ ? 1.0 : -1.0) / length));
    return flat;
  }

  const Frame& frame_;
  ClipPlanes planes_;
  SetupTriangles& out_;
  bool mirrored_ = false;
  std::vector<ClipVertex<double>> vertices_;  // of the draw at hand
  std::vector<bool> fronts_;                  // of the triangle at hand, per piece
  std::uint32_t draws_ = 0;                   // before the one at hand
  std::uint64_t transformed_ = 0, projected_ = 0, plane_tests_ = 0;
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
    project<CountedReal>({x, x, x, x}, x, x);
    counts.convert += 2;  // snapping x and y
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
  constexpr OperationCounts kPlaneTest{4, 4, 0, 0, 0, 0};  // an inner product and its comparison with 0
  counters.ops += transform_cost() * setup.transformed();
  counters.ops += project_cost() * setup.projected();
  counters.ops += slopes_cost() * out.triangles.size();
  counters.ops += kPlaneTest * setup.plane_tests();
  counters.bytes_written += out.triangles.size() * (sizeof(SetupTriangle) + sizeof(FlatAttributes));
  return out;
}

}  // namespace beampipe
