#include <cmath>

#include "traces/scenes/scene.h"
#include "traces/scenes/textures.h"

namespace beampipe {
namespace {

using glm::dvec3, glm::dvec4;

struct Boxes {
  Finish stripes, rings, squares;
};

dvec4 light_or_dark(double light, const dvec4& color) { return color + light * (dvec4(0.96, 0.95, 0.92, 1) - color); }

// Sharp steps, two texels wide: `at` is 0 on an edge, and `slope` is how fast it changes over the image.
double sharp_step(double at, double slope, double texels) { return smooth_step(-slope / texels, slope / texels, at); }

// Diagonal stripes; 256 texels are a whole number of them.
dvec4 stripe_color(double x, double y) {
  const double wave = triangle_wave(10 * (x + y)) - 0.5;
  return light_or_dark(sharp_step(wave, 28, 256), {0.70, 0.08, 0.06, 1});
}

// Rings that get narrower outwards.
dvec4 ring_color(double x, double y) {
  const double radius2 = (x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5);
  const double wave = triangle_wave(28 * radius2) - 0.5;
  return light_or_dark(sharp_step(wave, 112 * std::sqrt(radius2) + 1, 256), {0.05, 0.15, 0.55, 1});
}

dvec4 square_color(double x, double y, int count) {
  const double wave = (triangle_wave(count / 2.0 * x) - 0.5) * (triangle_wave(count / 2.0 * y) - 0.5);
  return light_or_dark(sharp_step(wave, 0.5 * count, 256), {0.10, 0.11, 0.12, 1});
}

std::vector<Mesh> build(const Finish& floor, const Boxes& finishes, double budget, Random& random) {
  MeshBuilder ground("floor"), boxes("boxes");
  ground.finish = floor;
  ground.color = glm::vec3(0.9f);
  const int n = divisions(0.5 * budget, 2, 1);
  ground.surface(n, n, [](double u, double v) { return dvec3(1600 * u - 800, 0, 10 - 1000 * v); });

  struct Box {
    dvec3 middle, half;
    const Finish& finish;
    double turn;
  };
  const Box places[] = {{{-1.9, 0.6, 0.4}, {0.6, 0.6, 0.6}, finishes.stripes, 0.5},
                        {{0.1, 0.8, -1.2}, {0.7, 0.8, 0.5}, finishes.rings, 0.3},
                        {{2.1, 0.5, 0.2}, {0.5, 0.5, 0.5}, finishes.squares, -0.6},
                        {{5.5, 1.2, -7}, {1.2, 1.2, 1.2}, finishes.stripes, -0.2},
                        {{-6.5, 1.5, -9}, {1.2, 1.5, 1.2}, finishes.rings, 0.7},
                        {{0.5, 1.6, -22}, {1.6, 1.6, 1.6}, finishes.squares, 0.4}};
  for (const Box& box : places) {
    const double turn = box.turn + random.uniform(-0.1, 0.1), c = std::cos(turn), s = std::sin(turn);
    boxes.finish = box.finish;
    boxes.color = glm::vec3(1.0f);
    boxes.place = [&](const dvec3& p) { return box.middle + dvec3(c * p.x + s * p.z, p.y, c * p.z - s * p.x); };
    boxes.box(-box.half, box.half, divisions(0.5 * budget / std::size(places), 12, 1));
  }
  return {ground.take(), boxes.take()};
}

}  // namespace

Trace make_tiles(const SceneOptions& options) {
  Surfaces surfaces;
  const auto material = [&](const char* name, float roughness, const ColorPattern& color) {
    const Texture texture = surfaces.add(paint_image(name, {256, 256}, color));
    return surfaces.add(Material{.name = name, .base_texture = texture, .roughness = roughness});
  };
  const Finish floor{material("checker", 0.8f, [](double x, double y) { return square_color(x, y, 2); }), 1.2};
  const Boxes boxes{.stripes = {material("stripes", 0.6f, stripe_color)},
                    .rings = {material("rings", 0.6f, ring_color)},
                    .squares = {material("squares", 0.6f, [](double x, double y) { return square_color(x, y, 12); })}};
  const auto build_tiles = [&](double budget, Random& random) { return build(floor, boxes, budget, random); };
  const Camera camera{
      .eye = {0, 1.7, 6}, .target = {0, 0.85, 0}, .up = {0, 1, 0}, .fovy_deg = 40, .near = 0.2, .far = 1500};
  Trace trace = one_frame(options, camera, build_to_budget(options, 74, build_tiles));
  add_surfaces(trace, std::move(surfaces), {0.75f, 0.72f, 0.66f},
               {.sky = {0.42f, 0.45f, 0.50f}, .ground = {0.28f, 0.27f, 0.26f}});
  return trace;
}

}  // namespace beampipe
