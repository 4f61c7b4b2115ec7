#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

// Metres. The wall is z = 0; the scaffold stands in front of it, in two rows of posts.
constexpr double kWallWidth = 26, kStorey = 2.0, kNearRow = 1.5, kFarRow = 0.4;

// A bar as an upright prism, in short pieces if there are triangles for them.
void add_bar(MeshBuilder& bars, const dvec3& a, const dvec3& b, double radius, int sides, int pieces) {
  bars.tube(line(a, b, pieces), radius, sides);
}

void add_wall(MeshBuilder& wall, double budget, int columns, int rows, Random& random) {
  wall.color = {0.62f, 0.50f, 0.40f};
  wall.quad({-20, 0, 0}, {20, 0, 0}, {20, 20, 0}, {-20, 20, 0});
  for (int i = 0; i < columns; ++i)
    for (int k = 0; k < rows; ++k) {
      const double x = -kWallWidth / 2 + kWallWidth * (i + 0.5) / columns, y = 0.6 + kStorey * k;
      wall.color = random.vary({0.16f, 0.20f, 0.26f}, 0.3);
      wall.quad({x - 0.4, y, 0.02}, {x + 0.4, y, 0.02}, {x + 0.4, y + 1.2, 0.02}, {x - 0.4, y + 1.2, 0.02});
      if (budget < 6000) continue;
      wall.color = {0.80f, 0.78f, 0.72f};
      for (const double bar : {-0.4, 0.0, 0.4}) wall.box({x + bar - 0.02, y, 0.02}, {x + bar + 0.02, y + 1.2, 0.06});
    }
}

// A net of thin threads hangs before a part of the scaffold.
void add_net(MeshBuilder& net, double budget) {
  constexpr double kLeft = 2, kRight = 9, kLow = 4, kHigh = 10;
  const int count = std::clamp(static_cast<int>(budget / 10 / 2), 2, 160);
  net.color = {0.12f, 0.38f, 0.20f};
  for (int i = 0; i <= count; ++i) {
    const double x = kLeft + (kRight - kLeft) * i / count, y = kLow + (kHigh - kLow) * i / count;
    net.tube(line({x, kLow, kNearRow + 0.1}, {x, kHigh, kNearRow + 0.1}), 0.006, 3);
    net.tube(line({kLeft, y, kNearRow + 0.11}, {kRight, y, kNearRow + 0.11}), 0.006, 3);
  }
}

std::vector<Mesh> scaffold_meshes(double budget, Random& random) {
  MeshBuilder ground("ground"), wall("wall"), bars("bars"), planks("planks"), net("net");
  ground.color = {0.34f, 0.33f, 0.31f};
  ground.quad({-40, 0, 30}, {40, 0, 30}, {40, 0, 0}, {-40, 0, 0});
  const double scale = std::min(1.0, std::sqrt(budget / 14000));
  const int bays = std::max(3, static_cast<int>(13 * scale)), storeys = std::max(2, static_cast<int>(7 * scale));
  const int sides = budget < 20000 ? 4 : 8;
  add_wall(wall, budget, bays + 1, storeys + 1, random);
  add_net(net, 0.15 * budget);
  // Bars of a bay and storey: two posts, four ledgers, one that joins the rows, and a brace.
  const int pieces = std::max(1, static_cast<int>(0.8 * budget / (bays * storeys * 8.0) / (2 * sides)));
  const double bay = kWallWidth / bays;
  for (int i = 0; i <= bays; ++i) {
    const double x = -kWallWidth / 2 + bay * i;
    for (int k = 0; k < storeys; ++k) {
      const double y = kStorey * k, top = y + kStorey;
      bars.color = random.vary({0.62f, 0.64f, 0.67f}, 0.15);
      for (const double z : {kNearRow, kFarRow}) {
        add_bar(bars, {x, y, z}, {x, top, z}, 0.035, sides, pieces);
        if (i == bays) continue;
        for (const double rail : {top, top + 1.0})
          add_bar(bars, {x, rail, z}, {x + bay, rail, z}, 0.025, sides, pieces);
      }
      add_bar(bars, {x, top, kFarRow}, {x, top, kNearRow}, 0.025, sides, 1);
      if (i == bays) continue;
      if ((i + k) % 3 == 0) {
        bars.color = random.vary({0.75f, 0.45f, 0.10f}, 0.1);
        add_bar(bars, {x, y, kNearRow + 0.06}, {x + bay, top, kNearRow + 0.06}, 0.022, sides, pieces);
      }
      planks.color = random.vary({0.52f, 0.36f, 0.18f}, 0.25);
      for (int board = 0; board < 3; ++board) {
        const double z = kFarRow + 0.1 + 0.32 * board, shift = random.uniform(-0.2, 0.2);
        planks.box({x + shift, top + 0.03, z}, {x + bay + shift, top + 0.07, z + 0.28});
      }
    }
  }
  return {ground.take(), wall.take(), bars.take(), planks.take(), net.take()};
}

}  // namespace

Trace make_scaffold(const SceneOptions& options) {
  const Camera camera{
      .eye = {-6, 1.7, 19}, .target = {-0.5, 6.2, 0}, .up = {0, 1, 0}, .fovy_deg = 40, .near = 1, .far = 80};
  return one_frame(options, camera, build_to_budget(options, 50000, scaffold_meshes), Shoulder::right);
}

}  // namespace beampipe
