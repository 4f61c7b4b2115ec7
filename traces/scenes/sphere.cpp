#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

void add_sphere(MeshBuilder& mesh, const dvec3& center, double radius, double budget) {
  const int rings = divisions(budget, 4, 4);
  mesh.sphere(center, radius, 2 * rings, rings);
}

std::vector<Mesh> sphere_meshes(double budget, Random& random) {
  MeshBuilder backdrop("backdrop"), large("sphere"), small("small spheres");
  backdrop.color = {0.10f, 0.85f, 0.15f};
  const int n = divisions(0.02 * budget, 2, 1);
  backdrop.surface(n, n, [](double u, double v) { return dvec3(12 * u - 6, 6.8 * v - 3.4, -2.5); });

  large.color = {0.85f, 0.12f, 0.08f};
  add_sphere(large, dvec3(0.0), 1.25, 0.7 * budget);

  // On a ring around the large sphere, partly in front of it and partly behind it.
  const int count = budget < 5000 ? 4 : 16;
  for (int i = 0; i < count; ++i) {
    const double angle = 6.283185307179586 * (i + 0.3) / count, radius = random.uniform(0.06, 0.22);
    small.color = random.uniform({0.3, 0.05, 0.4}, {0.9, 0.3, 0.95});
    add_sphere(small, {2.1 * std::cos(angle), 0.9 * std::sin(angle), 1.3 * std::sin(angle)}, radius,
               0.28 * budget / count);
  }
  return {backdrop.take(), large.take(), small.take()};
}

}  // namespace

Trace make_sphere(const SceneOptions& options) {
  const Camera camera{.eye = {0, 0.8, 5.2}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 34, .near = 1, .far = 20};
  return one_frame(options, camera, build_to_budget(options, 100000, sphere_meshes));
}

}  // namespace beampipe
