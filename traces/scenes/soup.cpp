#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

// Sizes from a fraction of a pixel to a third of the picture. The larger a triangle is, the rarer.
std::vector<Mesh> soup_meshes(double budget, Random& random) {
  MeshBuilder soup("soup");
  const int count = std::max(1, static_cast<int>(budget));
  for (int i = 0; i < count; ++i) {
    const double octave = 9 * (1 - std::sqrt(1 - random.uniform()));  // most often near 0, which is the smallest size
    const double size = 0.004 * std::exp2(octave);
    const dvec3 center = random.uniform({-3.6, -2.1, -3}, {3.6, 2.1, 1});
    dvec3 corners[3];
    for (dvec3& corner : corners) {
      const dvec3 direction = random.direction();
      corner = center + size * random.uniform(0.3, 1) * direction;
    }
    soup.color = random.uniform(dvec3(0.05), dvec3(0.95));
    soup.triangle(corners[0], corners[1], corners[2]);
  }
  return {soup.take()};
}

}  // namespace

Trace make_soup(const SceneOptions& options) {
  const Camera camera{.eye = {0, 0, 6}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 36, .near = 1, .far = 20};
  return one_frame(options, camera, build_to_budget(options, 20000, soup_meshes));
}

}  // namespace beampipe
