#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

constexpr int kBars = 24;

// Long square rods across the picture at different slopes, from two pixels thick (at the default size) to a quarter of
// one.
std::vector<Mesh> build(double budget, Random& random) {
  MeshBuilder bars("bars");
  const int pieces = std::max(1, static_cast<int>(budget / (8 * kBars)));
  for (int i = 0; i < kBars; ++i) {
    const double share = static_cast<double>(i) / (kBars - 1);
    const double thickness = 0.045 * std::pow(0.125, share);
    const double y = 1.55 - 3.1 * share, slope = random.uniform(0.01, 0.09);
    bars.color = i % 2 == 0 ? glm::vec3(0.90f, 0.86f, 0.70f) : glm::vec3(0.75f, 0.16f, 0.08f);
    const Path path = line({-2.75, y - slope, 0}, {2.75, y + slope, 0}, pieces);
    bars.tube(path, thickness / 2, 4);
  }
  return {bars.take()};
}

}  // namespace

Trace make_bars(const SceneOptions& options) {
  const Camera camera{.eye = {0, 0, 8}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 25, .near = 1, .far = 40};
  return one_frame(options, camera, build_to_budget(options, 4000, build));
}

}  // namespace beampipe
