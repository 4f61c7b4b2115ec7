#include <cmath>

#include "traces/scenes/boat.h"
#include "traces/scenes/textures.h"

namespace beampipe {
namespace {

using glm::dvec4;

constexpr int kPlanks = 8;  // one above the other in a texture

// 0 in the seams between planks and at their ends, 1 elsewhere.
double plank_height(double x, double y) {
  const double plank = std::floor(y * kPlanks), across = y * kPlanks - plank;
  const double along = x + 0.375 * plank - std::floor(x + 0.375 * plank);  // ends are not one above the other
  const double to_seam = std::min(across, 1 - across), to_end = std::min(along, 1 - along) * kPlanks;
  return smooth_step(0.02, 0.10, std::min(to_seam, to_end));
}

dvec4 plank_tint(double x, double y) {
  const double plank = std::floor(y * kPlanks);
  const double shade = 0.82 + 0.18 * lattice_noise(0, (plank + 0.5) / kPlanks, 1, 2 * kPlanks, 51);
  const double light = (0.35 + 0.65 * plank_height(x, y)) * shade;
  return dvec4(light, light, light, 1) * wood_tint(wood_grain(x, y));
}

// Cloth in panels that are sewn together.
dvec4 sail_tint(double x, double y) {
  const double panel = 8 * x - std::floor(8 * x), seam = smooth_step(0.06, 0.03, std::min(panel, 1 - panel));
  const double light = 0.92 + 0.08 * fractal_noise(x, y, 8, 8, 3, 52) - 0.22 * seam;
  return {light, light, light, 1};
}

}  // namespace

Trace make_rigging(const SceneOptions& options) {
  Surfaces surfaces;
  BoatLook look;
  const Texture planks = surfaces.add(paint_image("planks", {512, 512}, plank_tint));
  const Texture seams =
      surfaces.add(paint_normals("seams", {256, 256}, [](double x, double y) { return 0.012 * plank_height(x, y); }));
  const Texture wood =
      surfaces.add(paint_image("wood", {256, 256}, [](double x, double y) { return wood_tint(wood_grain(x, y)); }));
  const Texture cloth = surfaces.add(paint_image("cloth", {256, 256}, sail_tint));
  const Texture waves = surfaces.add(
      paint_normals("waves", {256, 256}, [](double x, double y) { return 0.10 * fractal_noise(x, y, 4, 6, 4, 53); }));

  look.hull = {
      surfaces.add(Material{
          .name = "hull", .base_texture = planks, .roughness = 0.4f, .normal_texture = seams, .double_sided = true}),
      1.6};
  look.deck = {surfaces.add(Material{.name = "deck", .base_texture = planks, .roughness = 0.7f, .double_sided = true}),
               1.2};
  look.house = {surfaces.add(Material{.name = "deckhouse", .base_texture = planks, .roughness = 0.5f}), 1.6};
  look.spar = {surfaces.add(Material{.name = "spars", .base_texture = wood, .roughness = 0.35f}), 1.2};
  look.sail = {
      surfaces.add(Material{.name = "sailcloth", .base_texture = cloth, .roughness = 0.9f, .double_sided = true}), 6};
  look.line = {surfaces.add(Material{.name = "tarred lines", .roughness = 0.25f})};
  look.rope = {surfaces.add(Material{.name = "ropes", .roughness = 0.3f})};
  look.sea = {surfaces.add(Material{.name = "water", .roughness = 0.2f, .normal_texture = waves, .double_sided = true}),
              6};

  Trace trace = boat_trace(options, 40000, look);
  add_surfaces(trace, std::move(surfaces), {0.95f, 0.90f, 0.80f},
               {.sky = {0.40f, 0.48f, 0.60f}, .ground = {0.12f, 0.16f, 0.18f}});
  return trace;
}

}  // namespace beampipe
