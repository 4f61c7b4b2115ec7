#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

constexpr glm::vec3 kShrubGreens[] = {{0.16f, 0.40f, 0.10f}, {0.30f, 0.46f, 0.08f}, {0.45f, 0.42f, 0.12f}};

// A pointed leaf of four triangles: both halves rise from the middle, and its tip hangs down.
void add_leaf(MeshBuilder& leaves, const dvec3& stalk, double size, Random& random) {
  const dvec3 along = glm::normalize(random.direction() + dvec3(0, 0.4, 0));
  const dvec3 across = glm::normalize(glm::cross(along, random.direction()));
  const dvec3 up = glm::cross(across, along);
  const dvec3 tip = stalk + size * along - dvec3(0, 0.25 * size, 0), middle = stalk + 0.5 * size * along;
  for (const double side : {-1.0, 1.0}) {
    const dvec3 edge = middle + 0.22 * size * side * across + 0.08 * size * up;
    leaves.triangle(stalk, middle, edge);
    leaves.triangle(middle, tip, edge);
  }
}

// Three triangles that bend over.
void add_blade(MeshBuilder& grass, const dvec3& foot, double height, Random& random) {
  const double angle = random.uniform(0, 6.28), lean = random.uniform(0.1, 0.7);
  const dvec3 across = 0.02 * height * dvec3(std::cos(angle), 0, std::sin(angle));
  const dvec3 outward(lean * height * std::sin(angle), 0, -lean * height * std::cos(angle));
  const dvec3 middle = foot + 0.3 * outward + dvec3(0, 0.6 * height, 0);
  const dvec3 tip = foot + outward + dvec3(0, 0.95 * height, 0);
  grass.quad(foot - across, foot + across, middle + 0.7 * across, middle - 0.7 * across);
  grass.triangle(middle - 0.7 * across, middle + 0.7 * across, tip);
}

// A stem's middle and end.
Path grow_stem(const dvec3& foot, double height, Random& random) {
  const dvec3 lean = random.uniform({-0.7, 0.7, -0.7}, {0.7, 1.1, 0.7});
  Path path;
  for (int k = 0; k <= 3; ++k) {
    const double t = k / 3.0;
    path.push_back(foot + height * dvec3(lean.x * t * t, lean.y * t, lean.z * t * t));
  }
  return path;
}

std::vector<Mesh> shrub_meshes(double budget, Random& random) {
  MeshBuilder ground("ground"), stems("stems"), leaves("leaves"), grass("grass");
  ground.color = {0.28f, 0.24f, 0.14f};
  ground.quad({-40, 0, 10}, {40, 0, 10}, {40, 0, -60}, {-40, 0, -60});
  const int count = std::clamp(static_cast<int>(budget / 1500), 3, 30), per_shrub = budget < 5000 ? 4 : 12;
  const int leaf_count = std::max(1, static_cast<int>(0.6 * budget / 4 / count / per_shrub));
  const double leaf_size = std::clamp(0.9 / std::sqrt(leaf_count), 0.05, 0.35);
  for (int i = 0; i < count; ++i) {
    const double far = static_cast<double>(i) / count, z = 0.5 - 14 * far;
    const dvec3 foot((2.4 + 5.5 * far) * random.uniform(-1, 1), 0, z);
    const double height = random.uniform(0.8, 1.9);
    const glm::vec3 green = random.vary(kShrubGreens[i % 3], 0.25);
    stems.color = random.vary({0.30f, 0.20f, 0.12f}, 0.2);
    for (int k = 0; k < per_shrub; ++k) {
      const Path path = grow_stem(foot, height, random);
      stems.tube(path, 0.012 * height, 0.004 * height, 3);
      for (int n = 0; n < leaf_count; ++n) {
        const double t = 3 * (1 - 0.8 * random.uniform() * random.uniform());
        const auto at = static_cast<std::size_t>(std::min(t, 2.0));
        const dvec3 stalk = path[at] + (t - static_cast<double>(at)) * (path[at + 1] - path[at]);
        leaves.color = random.vary(green, 0.3);
        const double size = leaf_size * random.uniform(0.7, 1.2);
        const dvec3 away = 0.12 * height * random.direction();
        add_leaf(leaves, stalk + away, size, random);
      }
    }
  }
  const int blades = static_cast<int>(0.3 * budget / 3);
  for (int i = 0; i < blades; ++i) {
    const double far = random.uniform() * random.uniform();
    const double x = (2.5 + 6 * far) * random.uniform(-1, 1);
    grass.color = random.vary({0.35f, 0.42f, 0.10f}, 0.3);
    add_blade(grass, {x, 0, 2.5 - 16 * far}, random.uniform(0.15, 0.45), random);
  }
  return {ground.take(), stems.take(), leaves.take(), grass.take()};
}

}  // namespace

Trace make_shrubs(const SceneOptions& options) {
  const Camera camera{
      .eye = {0.4, 1.3, 5.5}, .target = {0, 0.75, 0}, .up = {0, 1, 0}, .fovy_deg = 36, .near = 0.5, .far = 90};
  return one_frame(options, camera, build_to_budget(options, 60000, shrub_meshes));
}

}  // namespace beampipe
