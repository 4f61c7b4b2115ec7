// Perspective: the weights of a triangle's vertices on the screen, against exact rational arithmetic, and their slopes.
#include <boost/multiprecision/cpp_int.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "stages/geometry/vertex_setup.h"
#include "tests/simd/clipped_polygon.h"
#include "tests/simd/random.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::surface_planes_test {

using Rational = boost::multiprecision::cpp_rational;

struct ExactVertex {
  std::array<Rational, 4> clip;
  Rational second, third;
};
using ExactPolygon = std::vector<ExactVertex>;

constexpr std::int64_t kGuard = 32768;  // pixels on all sides of the viewport's origin

ExactVertex transformed(const glm::dmat4& matrix, const glm::vec3& p, int corner) {
  ExactVertex vertex{{}, corner == 1, corner == 2};
  for (int row = 0; row < 4; ++row) {
    vertex.clip[row] = Rational(matrix[3][row]);
    for (int k = 0; k < 3; ++k) vertex.clip[row] += Rational(matrix[k][row]) * Rational(p[k]);
  }
  return vertex;
}

ExactPolygon clipped(const ExactPolygon& polygon, const std::array<Rational, 4>& plane) {
  return clipped_polygon(
      polygon,
      [&](const ExactVertex& v) {
        return Rational(std::inner_product(plane.begin(), plane.end(), v.clip.begin(), Rational(0)));
      },
      [](const ExactVertex& from, const ExactVertex& to, const Rational& t) {
        ExactVertex crossing{{}, from.second + t * (to.second - from.second), from.third + t * (to.third - from.third)};
        for (std::size_t k = 0; k < 4; ++k) crossing.clip[k] = from.clip[k] + t * (to.clip[k] - from.clip[k]);
        return crossing;
      });
}

struct Screen {
  Rational x, y;
};

Screen on_screen(const ExactVertex& v, std::uint32_t width, std::uint32_t height) {
  return {(v.clip[0] / v.clip[3] + 1) * width / 2, (1 - v.clip[1] / v.clip[3]) * height / 2};
}

// What a plane of the surface should be: at the snapped corners it has these values.
struct ExactPlane {
  Rational value, dx, dy;
  double slope_scale = 0;  // bounds the terms that the slopes are differences of
};

double as_double(const Rational& r) { return static_cast<double>(r); }

struct SnappedCorner {
  Rational x, y;  // pixels
};

ExactPlane exact_plane(const std::array<SnappedCorner, 3>& p, const std::array<Rational, 3>& values) {
  const Rational qx = p[1].x - p[0].x, qy = p[1].y - p[0].y, rx = p[2].x - p[0].x, ry = p[2].y - p[0].y;
  const Rational qv = values[1] - values[0], rv = values[2] - values[0], area = qx * ry - rx * qy;
  const auto size = [](const Rational& r) { return std::abs(as_double(r)); };
  double largest = 0;
  for (const Rational& v : values) largest = std::max(largest, size(v));
  const double reach = std::max({size(qx), size(qy), size(rx), size(ry)});
  return {values[0], (qv * ry - rv * qy) / area, (rv * qx - qv * rx) / area, 2 * largest * reach / size(area)};
}

struct Statistics {
  int triangles = 0, points = 0, sharp = 0;
  double worst = 0;  // largest error of the points whose bound is sharp
};

constexpr double kUnit = 0x1p-24;     // a rounding of float
constexpr double kDoubles = 0x1p-50;  // several roundings of double

// A plane's error at (x, y): its three numbers are rounded, and so are two products and two sums. Before that, slopes
// were computed in double precision as differences of products.
double plane_error(const ExactPlane& plane, double x, double y) {
  return 5 * kUnit *
             (std::abs(as_double(plane.value)) + std::abs(as_double(plane.dx) * x) +
              std::abs(as_double(plane.dy) * y)) +
         kDoubles * plane.slope_scale * (std::abs(x) + std::abs(y)) + kDoubles * std::abs(as_double(plane.value));
}

void check_triangle(const SetupTriangle& triangle, const SetupSurface& surface, const ExactPolygon& polygon,
                    const Frame& frame, Random& random, Statistics& statistics) {
  // The corners in the trace's order: vertex_setup swaps the last two of front faces.
  std::array<std::int32_t, 3> xs = {triangle.x[0], triangle.x[1], triangle.x[2]},
                              ys = {triangle.y[0], triangle.y[1], triangle.y[2]};
  if (triangle.front) std::swap(xs[1], xs[2]), std::swap(ys[1], ys[2]);
  // Which corners of the polygon they are: those that are snapped there.
  std::array<const ExactVertex*, 3> corners{};
  std::size_t fan = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const std::array<const ExactVertex*, 3> candidate = {&polygon[0], &polygon[i - 1], &polygon[i]};
    bool fits = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Screen at = on_screen(*candidate[k], frame.width, frame.height);
      fits &= abs(at.x * 256 - xs[k]) <= Rational(5001, 10000) && abs(at.y * 256 - ys[k]) <= Rational(5001, 10000);
    }
    if (fits) corners = candidate, ++fan;
  }
  ASSERT_GE(fan, 1u) << "no part of the exact polygon has these corners";
  if (fan > 1) return;  // corners so close together that several parts have the same
  std::array<SnappedCorner, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = {Rational(xs[k], 256), Rational(ys[k], 256)};
  const Rational w = std::min({corners[0]->clip[3], corners[1]->clip[3], corners[2]->clip[3]});
  const auto plane_of = [&](auto&& value) {
    return exact_plane(p, {value(*corners[0]) * w / corners[0]->clip[3], value(*corners[1]) * w / corners[1]->clip[3],
                           value(*corners[2]) * w / corners[2]->clip[3]});
  };
  const ExactPlane inverse = plane_of([](const ExactVertex&) { return Rational(1); });
  const ExactPlane second = plane_of([](const ExactVertex& v) { return v.second; });
  const ExactPlane third = plane_of([](const ExactVertex& v) { return v.third; });
  ++statistics.triangles;
  for (int i = 0; i < 12; ++i) {
    // A point of the triangle, on the grid of 1/256 px, so that its distance from the anchor is exact.
    const double s = random.real(0, 1), t = random.real(0, 1 - s);
    const auto at = [&](const std::array<std::int32_t, 3>& c) {
      return static_cast<std::int64_t>(std::llround(c[0] + s * (c[1] - c[0]) + t * (c[2] - c[0])));
    };
    const Rational x(at(xs) - xs[0], 256), y(at(ys) - ys[0], 256);
    const double dx = as_double(x), dy = as_double(y);
    ASSERT_EQ(surface.anchor_x, static_cast<float>(xs[0]) / 256);
    const auto exact_at = [&](const ExactPlane& plane) { return Rational(plane.value + plane.dx * x + plane.dy * y); };
    const Rational inverse_w = exact_at(inverse);
    if (inverse_w <= 0) continue;  // the grid point lies outside
    const double size = as_double(inverse_w), error = plane_error(inverse, dx, dy);
    if (error > size / 2) continue;  // nothing can be said
    const Barycentrics<float> found = weights_at(surface.planes, static_cast<float>(dx), static_cast<float>(dy));
    const auto check = [&](const ExactPlane& plane, float weight) {
      const double exact =
          std::clamp(as_double(exact_at(plane) / inverse_w), -double{kMostWeight}, 1 + double{kMostWeight});
      const double bound =
          (plane_error(plane, dx, dy) + std::abs(exact) * error) / (size - error) + 4 * kUnit * std::abs(exact);
      ASSERT_LE(std::abs(weight - exact), bound) << weight << " instead of " << exact;
      ++statistics.points;
      if (bound < 1e-3) ++statistics.sharp, statistics.worst = std::max(statistics.worst, std::abs(weight - exact));
    };
    check(second, found.second), check(third, found.third);
  }
}

SetupTriangles set_up(const Trace& trace) {
  StageCounters counters;
  return vertex_setup(trace, trace.frames[0], counters);
}

// Sets the trace up and compares all its triangles' planes.
void check_scene(const Trace& trace, Random& random, Statistics& statistics) {
  const Frame& frame = trace.frames[0];
  const SetupTriangles triangles = set_up(trace);
  ASSERT_EQ(triangles.surfaces.size(), triangles.triangles.size());
  const Mesh& mesh = trace.meshes[0];
  const glm::dmat4 matrix = frame.projection * frame.view * frame.draws[0].transform;
  const Rational width(frame.width), height(frame.height);
  const std::array<std::array<Rational, 4>, 6> planes = {{{0, 0, 1, 1},
                                                          {0, 0, -1, 1},
                                                          {1, 0, 0, 2 * kGuard / width + 1},
                                                          {-1, 0, 0, 2 * kGuard / width - 1},
                                                          {0, 1, 0, 2 * kGuard / height - 1},
                                                          {0, -1, 0, 2 * kGuard / height + 1}}};
  for (std::size_t i = 0; i < triangles.triangles.size(); ++i) {
    const SetupSurface& surface = triangles.surfaces[i];
    const std::uint32_t t = surface.vertices[0] / 3;  // vertices are not shared
    ExactPolygon polygon;
    for (int k = 0; k < 3; ++k) polygon.push_back(transformed(matrix, mesh.positions[mesh.triangles[t][k]], k));
    for (const auto& plane : planes) polygon = clipped(polygon, plane);
    check_triangle(triangles.triangles[i], surface, polygon, frame, random, statistics);
    if (testing::Test::HasFatalFailure()) return;
  }
}

// Separate triangles with a material, seen by a camera at the origin that looks along -z, or by the transform's mirror.
Trace scene_of(const std::vector<glm::vec3>& positions, double near, double far, const glm::dmat4& transform) {
  Trace trace;
  Mesh mesh;
  mesh.positions = positions;
  mesh.uvs[0].resize(positions.size());
  for (std::uint32_t i = 0; i + 2 < positions.size(); i += 3) mesh.triangles.emplace_back(i, i + 1, i + 2);
  mesh.colors.resize(mesh.triangles.size());
  mesh.materials.resize(mesh.triangles.size());
  trace.meshes.push_back(mesh);
  trace.materials.resize(1);
  trace.materials[0].double_sided = true;
  Frame frame;
  frame.width = 640, frame.height = 480;
  set_camera(frame,
             {.eye = {0, 0, 0}, .target = {0, 0, -1}, .up = {0, 1, 0}, .fovy_deg = 60, .near = near, .far = far});
  frame.draws.emplace_back().transform = transform;
  trace.frames.push_back(frame);
  return trace;
}

const glm::dmat4 kPlain(1.0), kMirror = glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1));

// `make` fills 60 triangles, each of them plain and mirrored.
Statistics check_random(std::uint64_t seed, double near, double far,
                        const std::function<void(Random&, std::array<glm::vec3, 3>&)>& make) {
  Random random(seed);
  Statistics statistics;
  for (const glm::dmat4& transform : {kPlain, kMirror}) {
    std::vector<glm::vec3> positions;
    for (int i = 0; i < 60; ++i) {
      std::array<glm::vec3, 3> triangle;
      make(random, triangle);
      if (random.one_in(2)) std::swap(triangle[1], triangle[2]);
      positions.insert(positions.end(), triangle.begin(), triangle.end());
    }
    check_scene(scene_of(positions, near, far, transform), random, statistics);
  }
  return statistics;
}

Trace one_triangle(const glm::dmat4& transform = kPlain) {
  return scene_of({{-1, -1, -3}, {1, -1, -3}, {0, 1, -3}}, 1, 10, transform);
}

glm::vec3 in_view(Random& random, double z) {
  return {static_cast<float>(random.real(-0.7, 0.7) * z), static_cast<float>(random.real(-0.5, 0.5) * z),
          static_cast<float>(-z)};
}

TEST(SurfacePlanes, OrdinaryTrianglesAreAccurate) {
  const Statistics found = check_random(1, 0.5, 100, [](Random& random, auto& triangle) {
    for (glm::vec3& p : triangle) p = in_view(random, random.real(1, 20));
  });
  EXPECT_GT(found.sharp, 1500);
  EXPECT_LT(found.worst, 1e-4);
}

TEST(SurfacePlanes, DepthsThatDifferByAMillion) {
  const Statistics found = check_random(2, 0.01, 1e5, [](Random& random, auto& triangle) {
    for (glm::vec3& p : triangle) p = in_view(random, std::pow(10.0, random.real(-1.9, 4.9)));
  });
  EXPECT_GT(found.points, 1000);
}

TEST(SurfacePlanes, CutByTheNearPlane) {
  const Statistics found = check_random(3, 1, 100, [](Random& random, auto& triangle) {
    for (glm::vec3& p : triangle) p = in_view(random, random.real(1, 30));
    triangle[static_cast<std::size_t>(random.integer(0, 2))].z = random.real32(-0.5, 5);  // behind the near plane
  });
  EXPECT_GT(found.sharp, 500);
}

TEST(SurfacePlanes, SeenNearlyEdgeOn) {
  const Statistics found = check_random(4, 0.5, 100, [](Random& random, auto& triangle) {
    const double height = std::pow(10.0, random.real(-3, -1));
    for (glm::vec3& p : triangle) {
      p = in_view(random, random.real(1, 60));
      p.y = static_cast<float>(height);  // the eye is at 0
    }
  });
  EXPECT_GT(found.points, 500);
}

TEST(SurfacePlanes, ReachingThroughTheGuardBand) {
  const Statistics found = check_random(5, 0.1, 1000, [](Random& random, auto& triangle) {
    for (glm::vec3& p : triangle) p = {random.real32(-900, 900), random.real32(-900, 900), random.real32(-200, 20)};
  });
  EXPECT_GT(found.points, 200);
}

TEST(SurfacePlanes, AFloorToTheHorizon) {
  Random random(6);
  Statistics found;
  const std::vector<glm::vec3> floor = {{-1000, -1, 0}, {1000, -1, 0},     {1000, -1, -1000},
                                        {-1000, -1, 0}, {1000, -1, -1000}, {-1000, -1, -1000}};
  check_scene(scene_of(floor, 0.1, 2000, kPlain), random, found);
  EXPECT_GE(found.triangles, 4);
}

// ---- Slopes

TEST(SurfacePlanes, SlopesAreThoseOfTheWeights) {
  Random random(7);
  for (int i = 0; i < 20'000; ++i) {
    BarycentricPlanes<double> planes;
    const auto fill = [&](ScreenPlane<double>& plane, double base, double slope) {
      plane = {base, random.real(-slope, slope), random.real(-slope, slope)};
    };
    fill(planes.inverse_w, random.real(0.5, 1), 0.01), fill(planes.second, random.real(0, 1), 0.1);
    fill(planes.third, random.real(0, 1), 0.1);
    const double x = random.real(-10, 10), y = random.real(-10, 10), h = 1e-4;
    const Barycentrics<double> weights = weights_at(planes, x, y);
    const auto [right, down] = weight_slopes(planes, x, y, weights);
    const auto difference = [&](double a, double b) { return (a - b) / (2 * h); };
    const auto right_of = weights_at(planes, x + h, y), left_of = weights_at(planes, x - h, y);
    const auto below = weights_at(planes, x, y + h), above = weights_at(planes, x, y - h);
    ASSERT_NEAR(right.second, difference(right_of.second, left_of.second), 1e-7);
    ASSERT_NEAR(right.third, difference(right_of.third, left_of.third), 1e-7);
    ASSERT_NEAR(down.second, difference(below.second, above.second), 1e-7);
    ASSERT_NEAR(down.third, difference(below.third, above.third), 1e-7);
  }
}

TEST(SurfacePlanes, WeightsAreLimitedWhereThePlaneMeetsTheEye) {
  const BarycentricPlanes<float> planes{{1, 0, -0.1f}, {0.5f, 0.25f, 0}, {0.25f, 0, 0.25f}};
  for (int y = -200; y <= 200; ++y)
    for (int x = -20; x <= 20; ++x) {
      const Barycentrics<float> found = weights_at(planes, static_cast<float>(x), static_cast<float>(y) / 10);
      for (const float weight : {found.second, found.third})
        ASSERT_TRUE(weight >= -kMostWeight && weight <= 1 + kMostWeight) << x << ", " << y;
    }
}

// ---- What is set up

TEST(SurfacePlanes, FlatFramesHaveNone) {
  Trace trace = scene_of({{0, 0, -2}, {1, 0, -2}, {0, 1, -2}}, 1, 10, kPlain);
  trace.frames[0].draws[0].kd = glm::vec3(1);
  StageCounters counters;
  const SetupTriangles flat = vertex_setup(trace, trace.frames[0], counters);
  EXPECT_TRUE(flat.surfaces.empty());
  EXPECT_TRUE(flat.vertices.empty());
  trace.frames[0].draws.push_back(trace.frames[0].draws[0]);
  trace.frames[0].draws[1].kd.reset();
  StageCounters more;
  const SetupTriangles both = vertex_setup(trace, trace.frames[0], more);
  ASSERT_EQ(both.surfaces.size(), 2u);
  EXPECT_EQ(both.surfaces[0].material, kFlatSurface);
  EXPECT_EQ(both.surfaces[1].material, 0u);
  EXPECT_EQ(both.vertices.size(), 3u);
  EXPECT_EQ(more.bytes_written - 2 * counters.bytes_written, kSurfaceBytes + 3 * (12 + 8));  // to_eye and uv
}

// A material without double_sided hides the side from which its vertices are clockwise, also if a transform mirrors it.
TEST(SurfacePlanes, BackFacesAreCulledAsTheMeshHasThem) {
  for (const bool clockwise : {false, true})
    for (const glm::dmat4& transform : {kPlain, kMirror}) {
      Trace trace = one_triangle(transform);
      if (clockwise) std::swap(trace.meshes[0].positions[1], trace.meshes[0].positions[2]);
      trace.materials[0].double_sided = false;
      // glTF: if a transform's determinant is negative, the winding order of faces is reversed.
      EXPECT_EQ(set_up(trace).triangles.size(), clockwise ? 0u : 1u);
      trace.materials[0].double_sided = true;
      const SetupTriangles both = set_up(trace);
      ASSERT_EQ(both.triangles.size(), 1u);
      EXPECT_EQ(both.surfaces[0].turned, clockwise);
    }
}

TEST(SurfacePlanes, VerticesKnowTheWayToTheEye) {
  Trace trace = one_triangle();
  const SetupTriangles found = set_up(trace);
  for (std::size_t i = 0; i < 3; ++i)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.vertices[i].to_eye[c], -trace.meshes[0].positions[i][c], 1e-5);
}

// A projection without depth has no inverse, but it has an eye.
TEST(SurfacePlanes, TheEyeOfAProjectionThatHasNoInverse) {
  Trace trace = one_triangle();
  trace.frames[0].view[3] = glm::dvec4(0.5, -0.25, 2, 1);
  for (const double depth : {0.0, 0.5}) {  // everywhere, in parts of w
    for (int column = 0; column < 4; ++column)
      trace.frames[0].projection[column][2] = depth * trace.frames[0].projection[column][3];
    const SetupTriangles found = set_up(trace);
    ASSERT_EQ(found.triangles.size(), 1u);
    const glm::dvec3 eye(-0.5, 0.25, -2);
    for (std::size_t i = 0; i < 3; ++i)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found.vertices[i].to_eye[c], eye[c] - trace.meshes[0].positions[i][c], 1e-5);
  }
}

// Its square must be finite, because shading normalises it.
TEST(SurfacePlanes, TheWayToTheEyeIsAsLongAsFloatsCanSquare) {
  Trace trace = one_triangle();
  for (const double scale : {1e-30, 1e30, 1e60, 1e150}) {
    Trace scaled = trace;
    for (int i = 0; i < 3; ++i) scaled.frames[0].view[i] /= scale;
    for (int i = 0; i < 3; ++i) scaled.frames[0].draws[0].transform[i] *= scale;
    const SetupTriangles found = set_up(scaled);
    ASSERT_EQ(found.triangles.size(), 1u) << scale;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto to_eye = std::bit_cast<glm::vec3>(found.vertices[i].to_eye);
      EXPECT_TRUE(std::isfinite(glm::dot(to_eye, to_eye))) << scale;
      const glm::vec3 straight = -trace.meshes[0].positions[i];
      EXPECT_NEAR(glm::dot(glm::normalize(glm::dvec3(to_eye)), glm::normalize(glm::dvec3(straight))), 1, 1e-6) << scale;
    }
  }
}

// A planar shadow: the draw's transform is singular.
TEST(SurfacePlanes, AFlattenedMeshHasFiniteNormals) {
  SurfaceTrace scene(8, 8);
  Material material;
  material.double_sided = true;
  scene.add_rectangle(0, 0, 8, 8, 0.5, material);
  scene.mesh().normals.assign(scene.mesh().positions.size(), glm::normalize(glm::vec3(1, 2, 3)));
  scene.frame().draws[0].transform =
      glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 0, 0), glm::dvec4(0, 0, 0.5, 1));
  for (const SurfaceVertex& vertex : set_up(scene.trace).vertices)
    for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(std::isfinite(vertex.normal[axis]));
}

}  // namespace beampipe::surface_planes_test
