#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"
#include "traces/scenes/textures.h"

namespace beampipe {
namespace {

using glm::dvec2, glm::dvec3, glm::dvec4;

// A leaf in the image of a twig, from its stalk to its tip.
struct Leaf {
  dvec2 stalk, tip;
  double width;
};
constexpr dvec2 kTwigRoot(0.5, 1.0), kTwigTip(0.5, 0.3);
constexpr Leaf kLeaves[] = {{{0.5, 0.34}, {0.50, 0.02}, 0.10}, {{0.5, 0.50}, {0.16, 0.22}, 0.10},
                            {{0.5, 0.46}, {0.84, 0.18}, 0.10}, {{0.5, 0.68}, {0.10, 0.48}, 0.10},
                            {{0.5, 0.64}, {0.90, 0.46}, 0.10}, {{0.5, 0.86}, {0.14, 0.76}, 0.09},
                            {{0.5, 0.82}, {0.87, 0.74}, 0.09}};

// How far a point is inside a leaf, in units of the image's width (negative outside), and how light the leaf is there.
struct LeafPoint {
  double inside, light;
};

LeafPoint leaf_point(const Leaf& leaf, const dvec2& at) {
  const dvec2 along = leaf.tip - leaf.stalk, to = at - leaf.stalk;
  const double length = std::sqrt(along.x * along.x + along.y * along.y);
  const double s = (to.x * along.x + to.y * along.y) / (length * length);
  const double across = std::abs(to.x * along.y - to.y * along.x) / length;
  const double half_width = leaf.width * 4 * s * (1 - s) * (1.3 - 0.6 * s);
  const double veins = triangle_wave(7 * (s - 1.5 * across));
  const double light = across < 0.006 ? 1.0 : 0.55 + 0.25 * smooth_step(0.8, 1, veins) - 0.1 * s;
  return {s < 0 || s > 1 ? -1.0 : half_width - across, light};
}

// The colour goes on outside the leaves, so that filtering mixes nothing dark into their edges.
TextureImage paint_twig() {
  constexpr ImageSize kSize{512, 512};
  return paint_image("twig", kSize, [](double x, double y) {
    LeafPoint top{-1, 0.6};
    for (const Leaf& leaf : kLeaves) {
      const LeafPoint point = leaf_point(leaf, {x, y});
      if (point.inside > top.inside) top = point;
    }
    const double stem = y > kTwigTip.y ? 0.004 + 0.008 * (y - kTwigTip.y) - std::abs(x - kTwigRoot.x) : -1;
    const double alpha = 0.5 + 0.25 * kSize.width * std::max(top.inside, stem);  // an edge is four texels wide
    const double spots = 0.9 + 0.1 * lattice_noise(x, y, 32, 32, 61);
    if (stem > top.inside) return dvec4(0.55, 0.48, 0.30, std::clamp(alpha, 0.0, 1.0));
    return dvec4(0.78 * top.light * spots, top.light * spots, 0.45 * top.light, std::clamp(alpha, 0.0, 1.0));
  });
}

TextureImage paint_grass() {
  return paint_image("grass", {256, 256}, [](double x, double y) {
    const double light = 0.35 + 0.65 * fractal_noise(x, y, 16, 16, 4, 62);
    return dvec4(light, light, 0.8 * light, 1);
  });
}

struct Plants {
  Finish ground, stem, card;
};

// A card is a square that stands with the middle of its lower edge on the stem.
void add_card(MeshBuilder& cards, const dvec3& root, const dvec3& outward, double size, Random& random) {
  const dvec3 along = glm::normalize(outward + dvec3(0, 0.5, 0) + 0.6 * random.direction());
  const dvec3 across = 0.5 * size * glm::normalize(glm::cross(along, random.direction()));
  const dvec3 tip = root + size * along;
  cards.quad(root - across, root + across, tip + across, tip - across);
}

std::vector<Mesh> build(const Plants& plants, double budget, Random& random) {
  MeshBuilder ground("ground"), stems("stems"), cards("leaves");
  ground.finish = plants.ground;
  ground.color = {0.30f, 0.38f, 0.12f};
  ground.quad({-30, 0, 8}, {30, 0, 8}, {30, 0, -40}, {-30, 0, -40});

  const int count = std::clamp(static_cast<int>(budget / 300), 3, 32);
  const int segments = budget < 5000 ? 4 : 8, sides = budget < 5000 ? 3 : 5;
  const int per_stem = std::max(1, static_cast<int>((budget / count - 2 * segments * sides) / 2));
  const double size = std::clamp(0.42 * std::sqrt(170.0 / per_stem * 32 / count), 0.12, 0.9);
  stems.finish = plants.stem;
  cards.finish = plants.card;
  for (int i = 0; i < count; ++i) {
    const double depth = random.uniform(-1.6, 1.0);
    const dvec3 foot(3.3 * (2 * (i + random.uniform()) / count - 1), 0, depth);
    const dvec3 lean = random.uniform({-0.5, 1.7, -0.3}, {0.5, 2.7, 0.5});
    Path path;  // bends over towards its end
    for (int k = 0; k <= segments; ++k) {
      const double t = static_cast<double>(k) / segments;
      path.push_back(foot + dvec3(lean.x * t * t, lean.y * (t - 0.25 * t * t), lean.z * t * t));
    }
    stems.color = random.vary({0.24f, 0.17f, 0.09f}, 0.2);
    stems.tube(path, 0.035, 0.008, sides);
    const glm::vec3 green = random.vary({0.55f, 0.62f, 0.25f}, 0.3);
    for (int k = 0; k < per_stem; ++k) {
      const double part = 0.95 * random.uniform();
      const double t = 1 - part * random.uniform();
      const auto at = static_cast<std::size_t>(std::min(t * segments, segments - 1.0));
      const dvec3 root = path[at] + (t * segments - static_cast<double>(at)) * (path[at + 1] - path[at]);
      const dvec3 outward = random.direction() * dvec3(1, 0.5, 1);
      cards.color = random.vary(green, 0.2);
      const double card_size = size * random.uniform(0.7, 1.1);
      const dvec3 middle = root + 0.15 * random.direction();
      add_card(cards, middle, outward, card_size, random);
    }
  }
  return {ground.take(), stems.take(), cards.take()};
}

}  // namespace

Trace make_leaves(const SceneOptions& options) {
  Surfaces surfaces;
  const Texture twig = surfaces.add(paint_twig()), grass = surfaces.add(paint_grass());
  const Plants plants{
      .ground = {surfaces.add(Material{.name = "grass", .base_texture = grass}), 1},
      .stem = {surfaces.add(Material{.name = "bark", .roughness = 0.8f})},
      .card = {surfaces.add(Material{.name = "twig",
                                     .base_texture = twig,
                                     .roughness = 0.6f,
                                     .alpha_mode = AlphaMode::mask,
                                     .double_sided = true})},
  };
  const auto build_plants = [&](double budget, Random& random) { return build(plants, budget, random); };
  const Camera camera{
      .eye = {0, 1.5, 7.2}, .target = {0, 1.25, 0}, .up = {0, 1, 0}, .fovy_deg = 30, .near = 0.5, .far = 80};
  Trace trace = one_frame(options, camera, build_to_budget(options, 12000, build_plants));
  add_surfaces(trace, std::move(surfaces), {1.1f, 1.0f, 0.85f},
               {.sky = {0.45f, 0.50f, 0.55f}, .ground = {0.16f, 0.18f, 0.10f}});
  return trace;
}

}  // namespace beampipe
