#include "tests/llvmpipe/snapped.h"

#include <cmath>

#include "tests/simd/clipped_polygon.h"
#include "tests/stages/screen_triangles.h"

namespace beampipe {
namespace {

constexpr int kUnits = 256;  // per pixel

// At 64 px, positions in float have errors of about 1/500 of a unit, and clipping adds to them.
constexpr double kUndecided = 0.02;  // distance from the middle between two grid points, in units

// Planes whose inner product with a point is >= 0 inside the volume.
constexpr std::array<std::array<double, 4>, 6> kViewVolume = {
    {{1, 0, 0, 1}, {-1, 0, 0, 1}, {0, 1, 0, 1}, {0, -1, 0, 1}, {0, 0, 1, 1}, {0, 0, -1, 1}}};

using Polygon = std::vector<glm::dvec4>;

Polygon clip_to_view(const ClipTriangle& clip) {
  Polygon polygon(clip.begin(), clip.end());
  for (const auto& plane : kViewVolume)
    polygon = clipped_polygon(
        polygon, [&](const glm::dvec4& p) { return plane[0] * p.x + plane[1] * p.y + plane[2] * p.z + plane[3] * p.w; },
        [](const glm::dvec4& from, const glm::dvec4& to, double t) { return glm::mix(from, to, t); });
  return polygon;
}

// The one or two grid points that a coordinate may be snapped to.
std::vector<std::int32_t> snaps(double units) {
  const double down = std::floor(units), past = units - down;
  const auto low = static_cast<std::int32_t>(down);
  if (std::abs(past - 0.5) < kUndecided) return {low, low + 1};
  return {past < 0.5 ? low : low + 1};
}

}  // namespace

bool needs_clipping(const ClipTriangle& clip) {
  for (const glm::vec4& p : clip)
    if (!(p.w > 0 && std::abs(p.x) <= p.w && std::abs(p.y) <= p.w && std::abs(p.z) <= p.w)) return true;
  return false;
}

std::vector<SetupTriangles> snapped_alternatives(const ClipTriangle& clip, int size) {
  std::vector<std::vector<ScreenPoint>> outlines(1);
  for (const glm::dvec4& p : clip_to_view(clip)) {
    std::vector<std::vector<ScreenPoint>> longer;
    for (const std::int32_t x : snaps((p.x / p.w + 1) * size / 2 * kUnits))
      for (const std::int32_t y : snaps((1 - p.y / p.w) * size / 2 * kUnits))
        for (std::vector<ScreenPoint> outline : outlines) {
          outline.push_back({x, y});
          longer.push_back(std::move(outline));
        }
    outlines = std::move(longer);
  }
  std::vector<SetupTriangles> alternatives;
  for (const std::vector<ScreenPoint>& outline : outlines) {
    const std::size_t corners = outline.size();
    for (std::size_t first = 0; first < (corners > 3 ? corners : 1); ++first) {
      SetupTriangles& fan = alternatives.emplace_back();
      for (std::size_t i = 2; i < corners; ++i)
        add_triangle(fan, outline[first], outline[(first + i - 1) % corners], outline[(first + i) % corners]);
    }
  }
  return alternatives;
}

}  // namespace beampipe
