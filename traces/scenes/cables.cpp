#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

// Metres. A street between two rows of houses; cables hang across it and along it.
constexpr double kStreet = 8, kEnd = -50;

void add_houses(MeshBuilder& houses, bool has_windows, Random& random) {
  for (const double side : {-1.0, 1.0}) {
    for (double z = 4; z > kEnd;) {
      const double front = random.uniform(5, 9), height = random.uniform(5, 9);
      houses.color = random.vary({0.62f, 0.50f, 0.40f}, 0.35);
      const double wall = side * kStreet / 2, back = side * (kStreet / 2 + 6);
      houses.box({std::min(wall, back), 0, z - front}, {std::max(wall, back), height, z});
      houses.color = random.vary({0.15f, 0.17f, 0.20f}, 0.3);
      for (double y = 1; has_windows && y < height - 1.5; y += 2.4)
        for (double at = 0.8; at < front - 1; at += 1.8) {
          const double low = wall - 0.03, high = wall + 0.03;
          houses.box({low, y, z - at - 0.9}, {high, y + 1.3, z - at});
        }
      z -= front;
    }
  }
}

// Poles with crossbars, and what they bear at each end of the crossbars.
std::vector<std::vector<dvec3>> add_poles(MeshBuilder& poles, double distance, Random& random) {
  std::vector<std::vector<dvec3>> ends;
  for (double z = 0; z > kEnd; z -= distance) {
    const double x = 2.9 + random.uniform(-0.1, 0.1);
    poles.color = random.vary({0.32f, 0.25f, 0.18f}, 0.15);
    poles.tube(line({x, 0, z}, {x, 6.6, z}), 0.12, 0.08, 8);
    std::vector<dvec3>& of_pole = ends.emplace_back();
    for (const double y : {5.6, 6.2}) {
      poles.box({x - 0.9, y - 0.05, z - 0.05}, {x + 0.9, y + 0.05, z + 0.05});
      for (const double at : {-0.8, -0.4, 0.4, 0.8}) of_pole.push_back({x + at, y + 0.12, z});
    }
  }
  return ends;
}

std::vector<Mesh> cable_meshes(double budget, Random& random) {
  MeshBuilder ground("ground"), houses("houses"), poles("poles"), cables("cables");
  ground.color = {0.30f, 0.30f, 0.31f};
  ground.quad({-40, 0, 12}, {40, 0, 12}, {40, 0, kEnd}, {-40, 0, kEnd});
  const bool is_small = budget < 12000;
  add_houses(houses, !is_small, random);
  const std::vector<std::vector<dvec3>> ends = add_poles(poles, is_small ? 18 : 9, random);
  const double left =
      std::max(0.4 * budget, budget - static_cast<double>(houses.triangle_count() + poles.triangle_count()));
  const int across = std::clamp(static_cast<int>(left / 400), 6, 120), sides = 3;
  const auto along = static_cast<int>((ends.size() - 1) * ends[0].size());
  const int segments = std::max(3, static_cast<int>(left / (across * 1.5 + along) / (2 * sides)));
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    for (std::size_t k = 0; k < ends[i].size(); ++k) {
      cables.color = random.vary({0.08f, 0.08f, 0.09f}, 0.2);
      cables.tube(line(ends[i][k], ends[i + 1][k], segments, random.uniform(0.3, 0.7)), 0.012, sides);
    }
  for (int i = 0; i < across; ++i) {
    const double z = 2 - 42 * random.uniform() * random.uniform(), y = random.uniform(2.8, 6.5);
    const dvec3 from(-kStreet / 2, y, z);
    const double rise = random.uniform(-1, 1), slant = random.uniform(-4, 4);
    const dvec3 to(kStreet / 2, y + rise, z + slant);
    cables.color = random.uniform({0.05, 0.05, 0.05}, {0.45, 0.25, 0.25});
    const Path path = line(from, to, segments, random.uniform(0.2, 1.4));
    if (i % 4 == 0) cables.braid(path, 0.012, 0.5 * segments, sides);
    if (i % 4 != 0) cables.tube(path, random.uniform(0.006, 0.02), sides);
  }
  return {ground.take(), houses.take(), poles.take(), cables.take()};
}

}  // namespace

Trace make_cables(const SceneOptions& options) {
  const Camera camera{
      .eye = {-0.8, 1.7, 9}, .target = {0, 3.6, -6}, .up = {0, 1, 0}, .fovy_deg = 42, .near = 0.5, .far = 90};
  Trace trace = one_frame(options, camera, build_to_budget(options, 40000, cable_meshes));
  trace.frames[0].draws[1].shading = Shading::unlit;  // the light reaches one side of the street only
  return trace;
}

}  // namespace beampipe
