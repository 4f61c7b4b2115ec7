#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "traces/scenes/scene.h"
#include "traces/scenes/textures.h"

namespace beampipe {
namespace {

using glm::dvec3, glm::dvec4;

// A square sheet; turned about its upright axis and then about the one to the right, in radians.
struct Sheet {
  dvec3 center;
  double size, turn, tilt, wave;
  glm::vec4 color;  // linear RGB and opacity
};
constexpr std::size_t kSheets = 9;
const std::array<Sheet, kSheets> kFromBackToFront = {{
    {{-2.5, 0.4, -1.6}, 2.8, 0.1, 0.0, 0.0, {0.85f, 0.10f, 0.08f, 0.5f}},
    {{2.6, -0.3, -1.3}, 2.9, -0.1, 0.1, 0.0, {0.08f, 0.20f, 0.80f, 0.5f}},
    {{0.0, 0.3, -1.0}, 3.0, 0.0, 0.0, 0.0, {0.95f, 0.75f, 0.05f, 0.40f}},
    {{-1.5, -0.5, 0.0}, 2.8, 0.55, 0.0, 0.0, {0.05f, 0.60f, 0.15f, 0.5f}},  // these two cut through each other
    {{-1.5, -0.3, 0.0}, 2.8, -0.55, 0.0, 0.0, {0.55f, 0.10f, 0.60f, 0.5f}},
    {{1.5, 0.3, 0.2}, 2.6, 0.1, 0.5, 0.0, {0.90f, 0.40f, 0.05f, 0.5f}},  // and these
    {{1.5, 0.1, 0.2}, 2.6, -0.1, -0.5, 0.0, {0.05f, 0.55f, 0.60f, 0.5f}},
    {{0.1, 0.2, 0.6}, 2.4, 0.0, 0.2, 0.25, {0.90f, 0.90f, 0.95f, 0.35f}},  // and this one through several
    {{0.3, -0.95, 1.2}, 1.6, 0.2, -0.2, 0.0, {0.75f, 0.10f, 0.30f, 0.55f}},
}};
constexpr std::array<std::size_t, kSheets> kDrawOrder = {4, 0, 8, 2, 6, 1, 7, 3, 5};

constexpr int kCourses = 8;  // of bricks in a texture

// 0 in the mortar, 1 on a brick.
double brick_height(double x, double y) {
  const double course = std::floor(y * kCourses), across = y * kCourses - course;
  const double along = 4 * x + 0.5 * (course - 2 * std::floor(course / 2)), part = along - std::floor(along);
  return smooth_step(0.04, 0.09, std::min({across, 1 - across, 2 * part, 2 * (1 - part)}));
}

dvec4 brick_color(double x, double y) {
  const double course = std::floor(y * kCourses);
  const double along = std::floor(4 * x + 0.5 * (course - 2 * std::floor(course / 2)));
  const double shade = 0.75 + 0.25 * lattice_noise((along + 0.5) / 4, (course + 0.5) / kCourses, 4, kCourses, 81);
  const double grain = 0.85 + 0.15 * fractal_noise(x, y, 32, 32, 2, 82);
  const dvec4 mortar(0.72, 0.70, 0.66, 1), brick(0.72 * shade, 0.42 * shade, 0.32 * shade, 1);
  return dvec4(grain, grain, grain, 1) * (mortar + brick_height(x, y) * (brick - mortar));
}

// White, more opaque in a printed grid of lines.
dvec4 print_color(double x, double y) {
  const double line =
      std::max(smooth_step(0.88, 0.94, triangle_wave(6 * x)), smooth_step(0.88, 0.94, triangle_wave(6 * y)));
  return {1, 1, 1, 0.8 + 0.2 * line};
}

Mesh make_sheet(const Sheet& sheet, std::size_t number, const Finish& finish, double budget, Random& random) {
  MeshBuilder mesh("sheet " + std::to_string(number));
  mesh.finish = finish;
  mesh.color = glm::vec3(1.0f);
  const double turn = sheet.turn + random.uniform(-0.05, 0.05), tilt = sheet.tilt + random.uniform(-0.05, 0.05);
  const int n = divisions(budget, 2, sheet.wave > 0 ? 6 : 1);
  mesh.surface(n, n, [&](double u, double v) {
    const double x = sheet.size * (u - 0.5), y = sheet.size * (v - 0.5), z = sheet.wave * std::sin(7 * u + 3 * v);
    const dvec3 turned(x * std::cos(turn) + z * std::sin(turn), y, z * std::cos(turn) - x * std::sin(turn));
    return sheet.center + dvec3(turned.x, turned.y * std::cos(tilt) - turned.z * std::sin(tilt),
                                turned.y * std::sin(tilt) + turned.z * std::cos(tilt));
  });
  return mesh.take();
}

}  // namespace

Trace make_sheets(const SceneOptions& options) {
  Surfaces surfaces;
  const Texture bricks = surfaces.add(paint_image("bricks", {512, 512}, brick_color));
  const Texture joints =
      surfaces.add(paint_normals("joints", {256, 256}, [](double x, double y) { return 0.01 * brick_height(x, y); }));
  const Texture print = surfaces.add(paint_image("print", {256, 256}, print_color));
  const Finish wall{
      surfaces.add(Material{.name = "bricks", .base_texture = bricks, .roughness = 0.9f, .normal_texture = joints}),
      2.4};
  std::array<Finish, kSheets> sheets;
  for (std::size_t i = 0; i < kSheets; ++i) {
    sheets[i].material = surfaces.add(Material{.name = "sheet " + std::to_string(i + 1),
                                               .base_color = kFromBackToFront[i].color,
                                               .base_texture = print,
                                               .roughness = 0.3f,
                                               .alpha_mode = AlphaMode::blend,
                                               .double_sided = true});
  }
  const auto build = [&](double budget, Random& random) {
    MeshBuilder back("wall");
    back.finish = wall;
    back.color = glm::vec3(1.0f);
    const int n = divisions(0.1 * budget, 2, 1);
    back.surface(n, n, [](double u, double v) { return dvec3(24 * u - 12, 9 * v - 4.5, -3); });
    std::vector<Mesh> meshes{back.take()};
    for (const std::size_t i : kDrawOrder)
      meshes.push_back(make_sheet(kFromBackToFront[i], i + 1, sheets[i], 0.9 * budget / kSheets, random));
    return meshes;
  };
  const Camera camera{
      .eye = {0.4, 0.5, 7.6}, .target = {0, -0.05, 0}, .up = {0, 1, 0}, .fovy_deg = 36, .near = 1, .far = 40};
  Trace trace = one_frame(options, camera, build_to_budget(options, 2000, build));
  add_surfaces(trace, std::move(surfaces), {0.8f, 0.78f, 0.72f},
               {.sky = {0.50f, 0.52f, 0.55f}, .ground = {0.30f, 0.28f, 0.26f}});
  return trace;
}

}  // namespace beampipe
