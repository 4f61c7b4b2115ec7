#include <algorithm>
#include <cmath>
#include <numbers>

#include "traces/scenes/interior_textures.h"
#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3, glm::dvec4;

// Metres. The stairs rise along the wall x = -1, towards -z.
constexpr int kSteps = 14;
constexpr double kRise = 0.175, kTread = 0.28, kTop = kSteps * kRise, kBack = -kSteps * kTread - 1.6;
constexpr double kWallAt = -1, kFarWallAt = 2.6, kFront = 3, kCeiling = kTop + 2.6, kRailAt = 0.42;

struct StairsLook {
  Finish wallpaper, boards, carpet, picture, paint;
};

// Along the middle of the treads and down the risers; t: 0..1 from the bottom to the top.
dvec3 on_runner(double x, double t) {
  const double at = 2 * kSteps * t;
  const int edge = std::min(static_cast<int>(at), 2 * kSteps - 1);
  const double rest = at - edge;
  const int step = edge / 2;
  constexpr double kAbove = 0.008;
  const double z = -step * kTread + kAbove;
  if (edge % 2 == 0) return {x, step * kRise + kAbove + rest * kRise, z};
  return {x, (step + 1) * kRise + kAbove, z - rest * kTread};
}

// A turned baluster between two points, with rings and bellies.
void add_baluster(MeshBuilder& rail, const dvec3& foot, double height, int sides, int rows) {
  rail.surface(
      sides, rows,
      [&](double u, double v) {
        const double wave = 1 - std::abs(2 * (5 * v - std::floor(5 * v)) - 1);
        const double radius = v == 0 || v == 1 ? 0 : 0.012 + 0.012 * wave * wave * (1.5 - v);
        const double angle = 2 * std::numbers::pi * u;
        return foot + dvec3(radius * std::sin(angle), height * v, radius * std::cos(angle));
      },
      true);
}

std::vector<Mesh> build(const StairsLook& look, double budget, Random& random) {
  MeshBuilder walls("walls"), floor("floor"), ceiling("ceiling"), steps("steps"), carpet("carpet"), frames("frames"),
      pictures("pictures"), rail("rail");
  const int n = divisions(0.1 * budget, 24, 1);
  const auto wall = [&](MeshBuilder& mesh, const dvec3& corner, const dvec3& right, const dvec3& up) {
    mesh.surface(n, n, [=](double u, double v) { return corner + u * right + v * up; });
  };
  walls.finish = look.wallpaper;
  walls.color = glm::vec3(0.95f);
  const double depth = kFront - kBack;
  wall(walls, {kWallAt, 0, kFront}, {0, 0, -depth}, {0, kCeiling, 0});
  wall(walls, {kWallAt, 0, kBack}, {kFarWallAt - kWallAt, 0, 0}, {0, kCeiling, 0});
  wall(walls, {kFarWallAt, 0, kBack}, {0, 0, depth}, {0, kCeiling, 0});
  floor.finish = look.boards;
  floor.color = {0.72f, 0.50f, 0.32f};
  wall(floor, {kWallAt, 0, kFront}, {kFarWallAt - kWallAt, 0, 0}, {0, 0, -depth});
  ceiling.finish = look.paint;
  ceiling.color = {0.86f, 0.84f, 0.80f};
  wall(ceiling, {kWallAt, kCeiling, kBack}, {kFarWallAt - kWallAt, 0, 0}, {0, 0, depth});

  steps.finish = look.boards;
  steps.color = {0.58f, 0.36f, 0.22f};
  for (int i = 0; i < kSteps; ++i)
    steps.box({kWallAt, i * kRise, i + 1 < kSteps ? -(i + 1) * kTread - 0.02 : kBack},
              {kRailAt + 0.06, (i + 1) * kRise, -i * kTread});
  carpet.finish = look.carpet;
  carpet.color = glm::vec3(1.0f);
  carpet.texture_place = [](const dvec3& p) { return glm::dvec2(p.x + 0.72, p.z - p.y) / 0.84; };
  carpet.surface(2, 2 * kSteps, [](double u, double v) { return on_runner(-0.72 + 0.84 * u, v); });

  for (int i = 0; i < 5; ++i) {  // a picture every third step
    const double z = -(3 * i + 0.5) * kTread, y = 3 * i * kRise + random.uniform(1.45, 1.55),
                 half = 0.2 + 0.04 * (i % 3);
    frames.finish = look.boards;
    frames.color = {0.45f, 0.30f, 0.12f};
    frames.box({kWallAt, y - half - 0.03, z - half - 0.03}, {kWallAt + 0.025, y + half + 0.03, z + half + 0.03});
    pictures.finish = look.picture;
    pictures.color = glm::vec3(1.0f);
    const double x = kWallAt + 0.028;
    pictures.quad({x, y - half, z + half}, {x, y - half, z - half}, {x, y + half, z - half}, {x, y + half, z + half});
  }

  rail.finish = look.paint;
  const int sides = std::clamp(divisions(0.9 * budget / (2 * kSteps), 3, 3), 3, 80),
            rows = std::max(5, static_cast<int>(0.9 * budget / (2 * kSteps) / (2 * sides)));
  for (int i = 0; i < 2 * kSteps; ++i) {
    rail.color = i % 2 ? glm::vec3(0.92f, 0.90f, 0.86f) : glm::vec3(0.88f, 0.86f, 0.80f);
    const double z = -(0.5 * i + 0.25) * kTread, bottom = (i / 2 + 1) * kRise;
    add_baluster(rail, {kRailAt, bottom, z}, (0.5 * i + 0.75) * kRise + 0.9 - bottom, sides, rows);
  }
  rail.color = {0.30f, 0.16f, 0.08f};
  const double bottom = 0.25 * kRise + 0.92, run = kSteps * kTread;
  rail.tube(line({kRailAt, bottom, 0.1}, {kRailAt, bottom + kTop * (run + 0.1) / run, -run}), 0.035, 8);
  return {walls.take(),  floor.take(),  ceiling.take(),  steps.take(),
          carpet.take(), frames.take(), pictures.take(), rail.take()};
}

// Hills and water under a sky.
dvec4 landscape(double x, double y) {
  const double hill = 0.45 + 0.25 * fractal_noise(x, 0.5, 4, 1, 4, 61), shore = 0.78;
  if (y < hill) return dvec4(0.45, 0.60, 0.80, 1) + fractal_noise(x, y, 4, 8, 4, 62) * dvec4(0.4, 0.3, 0.2, 0);
  if (y < shore) return dvec4(0.25, 0.35, 0.15, 1) + fractal_noise(x, y, 32, 32, 3, 63) * dvec4(0.3, 0.3, 0.1, 0);
  return dvec4(0.20, 0.30, 0.45, 1) + lattice_noise(x, y, 8, 96, 64) * dvec4(0.3, 0.3, 0.3, 0);
}

}  // namespace

Trace make_stairs(const SceneOptions& options) {
  Surfaces surfaces;
  const auto material = [&](const char* name, float roughness, TextureImage image) {
    const Texture texture = surfaces.add(std::move(image));
    return surfaces.add(Material{.name = name, .base_texture = texture, .roughness = roughness});
  };
  const StairsLook look{
      .wallpaper = {material("wallpaper", 0.9f, paint_wallpaper({0.80, 0.74, 0.60, 1}, {0.42, 0.14, 0.12, 1})), 0.7},
      .boards = {material("boards", 0.45f, paint_boards()), 0.6},
      .carpet = {material("carpet", 1.0f, paint_carpet({0.45, 0.06, 0.08, 1}, {0.85, 0.70, 0.40, 1}))},
      .picture = {material("picture", 0.6f, paint_image("landscape", {256, 256}, landscape))},
      .paint = {surfaces.add(Material{.name = "paint", .roughness = 0.5f}), 1.0}};
  const Camera camera{
      .eye = {0.1, 1.55, 2.1}, .target = {-0.35, 1.85, -3}, .up = {0, 1, 0}, .fovy_deg = 55, .near = 0.1, .far = 30};
  const auto build_stairs = [&](double budget, Random& random) { return build(look, budget, random); };
  Trace trace = one_frame(options, camera, build_to_budget(options, 20000, build_stairs));
  add_surfaces(trace, std::move(surfaces), {0.75f, 0.70f, 0.60f},
               {.sky = {0.48f, 0.47f, 0.45f}, .ground = {0.36f, 0.32f, 0.28f}});
  return trace;
}

}  // namespace beampipe
