#include "stages/motion.h"

#include <half.h>

#include <algorithm>
#include <limits>

#include "simd/scalar.h"
#include "stages/counting.h"
#include "stages/shade.h"

namespace beampipe {
namespace {

// A position in pixels, in the last frame, of a point at (x, y) in normalized device coordinates and depth z. `m`:
// to_last_frame's, column-major.
template <class Real>
void reproject(const Real m[16], Real x, Real y, Real z, Real width, Real height, Real& last_x, Real& last_y, Real& w) {
  const auto row = [&](int r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
  const Real one(1.0f), half(0.5f);
  w = row(3);
  const Real inverse = one / w;
  last_x = (row(0) * inverse + one) * half * width;
  last_y = (one - row(1) * inverse) * half * height;
}

OperationCounts pixel_cost(std::size_t samples) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> m[16], x, y, w;
    for (Counted<float>& element : m) element = one;
    reproject(m, one, one, one, one, one, x, y, w);
    counts += OperationCounts{0, 2, 0, 2, 0, 2};  // less the pixel's centre; draw and matrix; to fp16
    counts.add += 2 * (samples - 1);              // the nearest sample
  });
}

glm::vec2 pixel_motion(const glm::dmat4& to_last, double center_x, double center_y, float depth, const Frame& frame) {
  double m[16];
  for (int i = 0; i < 16; ++i) m[i] = to_last[i / 4][i % 4];
  const double width = frame.width, height = frame.height;
  double x = 0, y = 0, w = 0;
  reproject<double>(m, 2 * center_x / width - 1, 1 - 2 * center_y / height, 2 * std::min(double{depth}, 0.0) + 1, width,
                    height, x, y, w);
  if (!(w > 0)) return glm::vec2(std::numeric_limits<float>::infinity());
  return {half(static_cast<float>(x - center_x)), half(static_cast<float>(y - center_y))};
}

}  // namespace

Poses poses_of(const Frame& frame) {
  Poses poses{frame.projection * frame.view, {}};
  for (const Draw& draw : frame.draws) poses.draws.push_back({draw.mesh, draw.transform});
  return poses;
}

std::vector<glm::dmat4> to_last_frame(const Poses& now, const Poses& before) {
  const glm::dmat4 to_world = glm::inverse(now.view_projection), still = before.view_projection * to_world;
  std::vector<glm::dmat4> matrices;
  for (std::size_t i = 0; i < now.draws.size(); ++i) {
    const Poses::Pose& pose = now.draws[i];
    const bool moved =
        i < before.draws.size() && before.draws[i].mesh == pose.mesh && before.draws[i].transform != pose.transform;
    matrices.push_back(
        moved ? before.view_projection * before.draws[i].transform * glm::inverse(pose.transform) * to_world : still);
  }
  matrices.push_back(still);
  return matrices;
}

std::vector<glm::vec2> motion(const SampleTile& surface, const Tile& tile, const Frame& frame,
                              const std::vector<std::uint32_t>& draws, const std::vector<glm::dmat4>& to_last,
                              StageCounters& counters) {
  const std::size_t samples = surface.samples_per_pixel;
  std::vector<glm::vec2> vectors;
  vectors.reserve(tile.pixels());
  for (std::int32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::int32_t x = tile.x0; x < tile.x1; ++x) {
      const auto first = surface.depth.begin() + static_cast<std::ptrdiff_t>(vectors.size() * samples);
      const auto nearest = std::min_element(first, first + static_cast<std::ptrdiff_t>(samples));
      const std::uint32_t triangle = surface.triangle[static_cast<std::size_t>(nearest - surface.depth.begin())];
      const glm::dmat4& matrix = triangle == kNoTriangle ? to_last.back() : to_last[draws[triangle]];
      vectors.push_back(pixel_motion(matrix, x + 0.5, y + 0.5, *nearest, frame));
    }
  }
  const std::size_t pixels = vectors.size();
  counters.items_in += pixels * samples;
  counters.items_out += pixels;
  counters.ops += pixel_cost(samples) * pixels;
  counters.bytes_read += pixels * (samples * kSampleDepthBytes + kVisibilityBytes);
  counters.bytes_written += pixels * kMotionBytes;
  counters.lanes_used += pixels;
  counters.lanes_issued += pixels;
  return vectors;
}

}  // namespace beampipe
