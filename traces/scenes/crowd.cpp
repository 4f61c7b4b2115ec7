#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

constexpr glm::vec3 kSkins[] = {{0.75f, 0.55f, 0.42f}, {0.50f, 0.33f, 0.22f}, {0.28f, 0.18f, 0.12f}};

// How finely a figure is made.
struct Detail {
  int sides, rings;
};

// A figure of 1.75 m that looks towards +z: limbs are tubes, and it is in the middle of a step.
void add_figure(MeshBuilder& people, const dvec3& foot, double turn, const Detail& detail, Random& random) {
  const double size = random.uniform(0.85, 1.1), step = random.uniform(-0.3, 0.3), reach = random.uniform(-0.3, 0.5);
  people.place = [=](const dvec3& p) {
    return foot +
           size * dvec3(std::cos(turn) * p.x + std::sin(turn) * p.z, p.y, std::cos(turn) * p.z - std::sin(turn) * p.x);
  };
  const auto limb = [&](const dvec3& a, const dvec3& b, const dvec3& c, double thick) {
    people.tube({a, b, c}, thick, 0.6 * thick, detail.sides);
  };
  const glm::vec3 skin = random.vary(kSkins[random.bits() % 3], 0.1);
  people.color = random.uniform({0.05, 0.05, 0.08}, {0.35, 0.30, 0.40});  // trousers
  limb({-0.1, 0.9, 0}, {-0.11, 0.48, 0.5 * step + 0.03}, {-0.11, 0.03, step}, 0.085);
  limb({0.1, 0.9, 0}, {0.11, 0.48, -0.5 * step + 0.03}, {0.11, 0.03, -step}, 0.085);
  people.color = random.uniform({0.1, 0.1, 0.1}, {0.85, 0.75, 0.75});  // jacket
  people.tube({{0, 0.85, 0}, {0, 1.15, 0}, {0, 1.45, 0}}, 0.15, 0.19, 2 * detail.sides);
  limb({-0.2, 1.42, 0}, {-0.27, 1.15, -0.3 * step}, {-0.26, 0.92, 0.1 - step}, 0.055);
  limb({0.2, 1.42, 0}, {0.28, 1.16, 0.1 + 0.3 * reach}, {0.25, 0.95 + 0.5 * reach, 0.15 + 0.6 * reach}, 0.055);
  people.color = skin;
  people.tube(line({0, 1.44, 0}, {0, 1.55, 0.01}), 0.05, detail.sides);
  people.sphere({0, 1.64, 0.02}, 0.11, 2 * detail.rings, detail.rings);
  people.place = nullptr;
}

// Posts with flags, which stand among the figures.
void add_flag(MeshBuilder& flags, const dvec3& foot, int folds, Random& random) {
  flags.color = {0.70f, 0.70f, 0.72f};
  flags.tube(line(foot, foot + dvec3(0, 5, 0)), 0.03, 6);
  flags.color = random.uniform({0.2, 0.1, 0.1}, {0.8, 0.6, 0.6});
  const double phase = random.uniform(0, 6.28);
  flags.surface(folds, folds, [&](double u, double v) {
    const double wave = 0.12 * u * std::sin(9 * u + phase);
    return foot + dvec3(0.03 + 1.4 * u, 4.9 - 0.9 * v - 0.1 * u * u, wave);
  });
}

std::vector<Mesh> crowd_meshes(double budget, Random& random) {
  MeshBuilder ground("ground"), houses("houses"), flags("flags"), people("people");
  ground.color = {0.46f, 0.43f, 0.39f};
  ground.quad({-80, 0, 12}, {80, 0, 12}, {80, 0, -90}, {-80, 0, -90});
  for (int i = 0; i < 9; ++i) {
    houses.color = random.vary({0.58f, 0.48f, 0.42f}, 0.3);
    houses.box({-54.0 + 12 * i, 0, -85}, {-42.5 + 12 * i, random.uniform(9, 16), -75});
  }
  const int folds = divisions(0.03 * budget, 10, 2);
  for (int i = 0; i < 5; ++i) add_flag(flags, {-7.0 + 3.5 * i, 0, -8.0 - 3 * (i % 2)}, folds, random);
  const Detail detail = budget < 20000 ? Detail{3, 3} : budget < 120000 ? Detail{4, 4} : Detail{6, 6};
  const int of_figure = 4 * (4 * detail.sides + 2 * (detail.sides - 2)) + 2 * (2 * detail.sides) +
                        2 * (2 * detail.sides + 2 * (detail.sides - 2)) + 4 * detail.rings * (detail.rings - 1);
  const int count = std::max(4, static_cast<int>(budget / of_figure));
  for (int i = 0; i < count; ++i) {
    const double far = (i + random.uniform()) / count, z = -2 - 60 * far * far;
    const double x = (1.5 - 0.55 * z) * random.uniform(-1, 1), turn = random.uniform(-3.1, 3.1);
    add_figure(people, {x, 0, z}, turn, detail, random);
  }
  return {ground.take(), houses.take(), flags.take(), people.take()};
}

}  // namespace

Trace make_crowd(const SceneOptions& options) {
  const Camera camera{
      .eye = {0, 3.2, 5}, .target = {0, 1.5, -8}, .up = {0, 1, 0}, .fovy_deg = 36, .near = 0.5, .far = 150};
  return one_frame(options, camera, build_to_budget(options, 80000, crowd_meshes), Shoulder::right);
}

}  // namespace beampipe
