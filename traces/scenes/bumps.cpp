#include <array>
#include <cmath>
#include <numbers>

#include "traces/scenes/scene.h"
#include "traces/scenes/textures.h"

namespace beampipe {
namespace {

using glm::dvec3;

struct Ball {
  dvec3 center;
  double radius;
  glm::vec3 color;
};
const Ball kBalls[] = {{{0, 1, 0}, 1, {0.95f, 0.62f, 0.25f}},
                       {{-1.5, 0.5, 0.5}, 0.5, {0.60f, 0.05f, 0.04f}},
                       {{1.5, 0.42, 0.6}, 0.42, {0.06f, 0.20f, 0.45f}}};
constexpr int kCells = 24;  // of a texture, in a row; each has a bump

// Round bumps that touch each other, each of its own height.
double bump_height(double x, double y, std::uint64_t seed) {
  const double row = std::floor(y * kCells), along = x * kCells + 0.5 * (row - 2 * std::floor(row / 2));
  const double column = std::floor(along), dx = along - column - 0.5, dy = y * kCells - row - 0.5;
  const double tall = 0.6 + 0.4 * lattice_noise((column + 0.5) / kCells, (row + 0.5) / kCells, kCells, kCells, seed);
  const double inside = std::max(0.0, 1 - 4 * (dx * dx + dy * dy));
  return tall * inside * inside * 0.35 / kCells;
}

// A cube that is blown up, so that its texture is nearly as large everywhere and has no poles.
void add_ball(MeshBuilder& mesh, const Ball& ball, int divisions) {
  mesh.color = ball.color;
  mesh.place = [&](const dvec3& p) {
    dvec3 even;
    for (int axis = 0; axis < 3; ++axis) even[axis] = std::tan(std::numbers::pi / 4 * p[axis]);
    return ball.center + ball.radius * glm::normalize(even);
  };
  mesh.box(dvec3(-1), dvec3(1), divisions);
  mesh.place = nullptr;
}

// The normals of the faces' edges, which the faces must share.
void make_round(Mesh& mesh, const Ball& ball) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.normals[i] = glm::normalize(dvec3(mesh.positions[i]) - ball.center);
}

std::vector<Mesh> bumps_meshes(const std::array<Finish, 3>& finishes, const Finish& ground, double budget, Random&) {
  MeshBuilder floor("floor");
  floor.finish = ground;
  floor.color = {0.42f, 0.40f, 0.38f};
  floor.quad({-30, 0, 6}, {30, 0, 6}, {30, 0, -40}, {-30, 0, -40});
  std::vector<Mesh> meshes{floor.take()};
  constexpr double kShares[] = {0.6, 0.2, 0.2};
  constexpr const char* kNames[] = {"ball", "left ball", "right ball"};
  for (std::size_t i = 0; i < 3; ++i) {
    MeshBuilder ball(kNames[i]);
    ball.finish = finishes[i];
    add_ball(ball, kBalls[i], divisions(kShares[i] * budget, 12, 4));
    make_round(meshes.emplace_back(ball.take()), kBalls[i]);
  }
  return meshes;
}

}  // namespace

Trace make_bumps(const SceneOptions& options) {
  Surfaces surfaces;
  const Texture bumps = surfaces.add(paint_normals(
      "bumps", {384, 384}, [&](double x, double y) { return bump_height(x, y, mix_bits(options.seed)); }));
  const Texture concrete = surfaces.add(paint_image("concrete", {256, 256}, [](double x, double y) {
    const double light = 0.75 + 0.25 * fractal_noise(x, y, 8, 8, 5, 71);
    return glm::dvec4(light, light, light, 1);
  }));
  const auto material = [&](const char* name, float metallic, float roughness) {
    return surfaces.add(Material{.name = name, .metallic = metallic, .roughness = roughness, .normal_texture = bumps});
  };
  const std::array<Finish, 3> finishes{
      Finish{material("brass", 1, 0.3f)}, {material("red glaze", 0, 0.2f)}, {material("blue glaze", 0, 0.25f)}};
  const Finish ground{surfaces.add(Material{.name = "concrete", .base_texture = concrete, .roughness = 0.9f}), 0.8};
  const Camera camera{
      .eye = {0, 1.5, 5.2}, .target = {0, 0.85, 0}, .up = {0, 1, 0}, .fovy_deg = 30, .near = 0.5, .far = 80};
  const auto build_balls = [&](double budget, Random& random) {
    return bumps_meshes(finishes, ground, budget, random);
  };
  Trace trace = one_frame(options, camera, build_to_budget(options, 10000, build_balls));
  add_surfaces(trace, std::move(surfaces), {1.0f, 0.95f, 0.85f},
               {.sky = {0.45f, 0.50f, 0.58f}, .ground = {0.20f, 0.18f, 0.16f}});
  return trace;
}

}  // namespace beampipe
