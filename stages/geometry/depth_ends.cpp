#include "stages/geometry/depth_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace beampipe {
namespace {

using Corners = std::array<glm::dvec4, 3>;  // in clip space

constexpr double kNear = 1e-6;  // depths no further apart than this count as equal

template <class Holds>
bool all(const Corners& corners, const Holds& holds) {
  return std::ranges::all_of(corners, holds);
}

class WindowDepths {
 public:
  WindowDepths(const DrawState& state, const Frame& frame)
      : depth_(state.depth),
        scale_(0.5 * (double{state.depth.far} - double{state.depth.near})),
        offset_(0.5 * (double{state.depth.far} + double{state.depth.near})),
        half_width_(0.5 * (state.viewport ? double{state.viewport->width} : frame.width)),
        half_height_(0.5 * std::abs(state.viewport ? double{state.viewport->height} : frame.height)) {}

  bool reach_ends(const Corners& corners) const {
    const bool is_beyond = all(corners, [](const glm::dvec4& v) { return v.z < -v.w; }) ||
                           all(corners, [](const glm::dvec4& v) { return v.z > v.w; });
    if (depth_.clip && is_beyond) return false;
    if (!depth_.clip && !all(corners, [](const glm::dvec4& v) { return v.z > -v.w && v.z < v.w; })) return true;
    const auto at = [&](double end) {
      return all(corners, [&](const glm::dvec4& v) {
        return std::abs(scale_ * v.z + (offset_ - end) * v.w) <= kNear * std::abs(v.w);
      });
    };
    return at(0) || at(1) || (depth_.bias != DepthBias{} && biased_reach_ends(corners));
  }

 private:
  bool biased_reach_ends(const Corners& corners) const {
    if (!all(corners, [](const glm::dvec4& v) { return v.w > 0; })) return true;
    std::array<glm::dvec3, 3> p;  // pixels, pixels, window depth
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec4& v = corners[k];
      p[k] = {half_width_ * v.x / v.w, half_height_ * v.y / v.w, offset_ + scale_ * v.z / v.w};
    }
    const glm::dvec3 a = p[1] - p[0], b = p[2] - p[0];
    const double area = a.x * b.y - a.y * b.x;
    if (area == 0) return false;
    const double slope = std::max(std::abs(a.z * b.y - a.y * b.z), std::abs(a.x * b.z - a.z * b.x)) / std::abs(area);
    const double bias = double{depth_.bias.constant} + double{depth_.bias.slope} * slope;
    const auto [least, most] = std::minmax({p[0].z, p[1].z, p[2].z});
    const double first = depth_.clip ? 0.0 : double{std::min(depth_.near, depth_.far)};
    const double last = depth_.clip ? 1.0 : double{std::max(depth_.near, depth_.far)};
    return least + bias <= first + kNear || most + bias >= last - kNear;
  }

  const DepthState& depth_;
  double scale_, offset_;            // from z / w
  double half_width_, half_height_;  // pixels
};

}  // namespace

bool reaches_ends(const Trace& trace, const Frame& frame, const Draw& draw) {
  const Mesh& mesh = trace.meshes[draw.mesh];
  const glm::dmat4 to_clip = frame.projection * frame.view * draw.transform;
  std::vector<glm::dvec4> clip(mesh.positions.size());
  for (std::size_t i = 0; i < clip.size(); ++i)
    clip[i] = to_clip * glm::dvec4(mesh.positions[i], mesh.ws.empty() ? 1.0f : mesh.ws[i]);
  const WindowDepths depths(draw.state, frame);
  return std::ranges::any_of(mesh.triangles, [&](const glm::uvec3& triangle) {
    return depths.reach_ends({clip[triangle.x], clip[triangle.y], clip[triangle.z]});
  });
}

}  // namespace beampipe
