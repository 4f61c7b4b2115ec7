#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

constexpr dvec3 kTrees[] = {{-0.6, 0, 0.5}, {3.4, 0, -1.5}, {-4.4, 0, -2}, {1.2, 0, -5}, {-2.6, 0, -7}};
constexpr glm::vec3 kGreens[] = {
    {0.22f, 0.48f, 0.07f}, {0.12f, 0.36f, 0.10f}, {0.50f, 0.45f, 0.06f}, {0.60f, 0.25f, 0.05f}, {0.16f, 0.42f, 0.16f}};

struct Twig {
  dvec3 start, end;
};

// Grows a limb and the limbs that sprout from it. The last of these are the twigs that bear leaves.
class Tree {
 public:
  Tree(MeshBuilder& wood, Random& random, int segments) : wood_(wood), random_(random), segments_(segments) {}

  std::vector<Twig> grow(const dvec3& root, double height) {
    add_limb(root, root + dvec3(random_.uniform(-0.3, 0.3), 0.75 * height, 0), 0.035 * height, 0);
    return std::move(twigs_);
  }

 private:
  void add_limb(const dvec3& start, const dvec3& end, double radius, int level) {
    const double length = glm::distance(start, end);
    wood_.tube(line(start, end, segments_, level == 0 ? 0.0 : 0.04 * length), radius, 0.45 * radius,
               level == 0 ? 2 * segments_ : segments_ + 1);
    if (level == 2) {
      twigs_.push_back({start, end});
      return;
    }
    const dvec3 along = (end - start) / length;
    const dvec3 across = glm::normalize(glm::cross(along, random_.direction()));
    const int sprouts = level == 0 ? 9 : 5;
    for (int i = 0; i < sprouts; ++i) {  // each turned by the golden angle from the last
      const double t = 0.4 + 0.6 * (i + 1) / sprouts, angle = 2.39996 * i;
      const dvec3 outward = std::cos(angle) * across + std::sin(angle) * glm::cross(along, across);
      const dvec3 from = start + t * (end - start);
      const dvec3 direction = glm::normalize(outward + random_.uniform(0.3, 0.9) * along + dvec3(0, 0.1, 0));
      const double part = (level == 0 ? 0.62 : 0.6) * (1.25 - 0.6 * t) * random_.uniform(0.8, 1.2);
      add_limb(from, from + part * length * direction, 0.45 * radius, level + 1);
    }
  }

  MeshBuilder& wood_;
  Random& random_;
  int segments_;
  std::vector<Twig> twigs_;
};

// A leaf is two triangles, folded along the middle.
void add_leaf(MeshBuilder& leaves, const dvec3& stem, double size, Random& random) {
  const dvec3 along = glm::normalize(random.direction() + dvec3(0, -0.3, 0));
  const dvec3 across = glm::normalize(glm::cross(along, random.direction()));
  const dvec3 up = glm::cross(across, along);
  const dvec3 middle = stem + 0.5 * size * along + 0.12 * size * up;
  leaves.quad(stem, middle + 0.3 * size * across, stem + size * along, middle - 0.3 * size * across);
}

std::vector<Mesh> foliage_meshes(double budget, Random& random) {
  MeshBuilder ground("ground"), wood("wood"), leaves("leaves");
  ground.color = {0.25f, 0.33f, 0.12f};
  ground.quad({-30, 0, 8}, {30, 0, 8}, {30, 0, -40}, {-30, 0, -40});

  const std::size_t count = std::clamp<std::size_t>(static_cast<std::size_t>(budget / 4000), 1, std::size(kTrees));
  std::vector<std::vector<Twig>> trees;
  for (std::size_t i = 0; i < count; ++i) {
    wood.color = random.vary({0.26f, 0.17f, 0.10f}, 0.2);
    Tree tree(wood, random, budget < 20000 ? 2 : 4);
    trees.push_back(tree.grow(kTrees[i], random.uniform(4.6, 5.6)));
  }
  const double left = std::max(0.2 * budget, budget - static_cast<double>(wood.triangle_count()));
  const int per_tree = static_cast<int>(left / 2 / static_cast<double>(count));
  const double size = std::min(0.7, 0.19 * std::sqrt(6000.0 / per_tree));
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < per_tree; ++k) {
      const Twig& twig = trees[i][random.bits() % trees[i].size()];
      const dvec3 stem = twig.start + random.uniform(-0.2, 1.15) * (twig.end - twig.start);
      leaves.color = random.vary(kGreens[i], 0.35);
      const double leaf_size = size * random.uniform(0.6, 1.2);
      const dvec3 direction = random.direction();
      add_leaf(leaves, stem + 0.25 * random.uniform() * direction, leaf_size, random);
    }
  }
  return {ground.take(), wood.take(), leaves.take()};
}

}  // namespace

Trace make_foliage(const SceneOptions& options) {
  const Camera camera{
      .eye = {0, 2.4, 9.5}, .target = {-0.2, 2.9, 0}, .up = {0, 1, 0}, .fovy_deg = 36, .near = 1, .far = 80};
  return one_frame(options, camera, build_to_budget(options, 80000, foliage_meshes));
}

}  // namespace beampipe
