// What a triangle looks like at a point of a pixel: flat triangles everywhere the same, others by their material's
// fragment shader (stages/surface/surface_formulas.h) or by that which the program brought
// (stages/surface/program_shader.h). Every technique asks here; techniques differ in where they ask.
//
// Colours are linear, unless the frame's target stores the numbers of programs' shaders as they are: then all colours
// are encoded as sRGB, so that blending and means do what such a target does. Technique::render() decodes pictures.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/accumulator.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"
#include "stages/surface/fragment_verdict.h"
#include "stages/surface/invocation.h"
#include "stages/surface/opacity.h"
#include "stages/surface/program_shader.h"
#include "stages/surface/surface_formulas.h"
#include "stages/surface/surface_points.h"
#include "stages/surface/texel_requests.h"
#include "stages/surface/texture_filter.h"
#include "stages/surface/texture_set.h"
#include "traces/trace.h"

namespace beampipe {

// How a shader knows what part of a texture a pixel covers: from the planes of its own triangle, or as the difference
// between the pixels of its 2x2 quad, which helper invocations shade. Textures of materials are filtered for the
// footprint in any case; the differences that programs take are those of the pixel, or of cells from the planes.
enum class Derivatives { analytic, quad, analytic_of_cells };

// Between a material and its lighting: nothing is stored, or a G-buffer with few bits.
enum class MaterialStorage { none, gbuffer };

// Where surfaces are shaded that vary. by_pixel: at the pixel's centre, or at a point of the triangle near it, for an
// area of one pixel and without rounding, whatever is asked for. All techniques then agree on a triangle's colour in a
// pixel, and what is left of their errors is visibility.
enum class SurfaceColors { by_place, by_pixel };

inline constexpr int kAnisotropic = -1;

// How a technique shades.
struct ShadingRules {
  Derivatives derivatives = Derivatives::analytic;
  MaterialStorage storage = MaterialStorage::none;
  AccumulatorFormat stored_as = AccumulatorFormat::fp32;  // colours are rounded to it
  SurfaceColors colors = SurfaceColors::by_place;
  // Textures are means over footprints of at most so many taps: 1, 4 or 16 (stages/surface/footprint_filter.h). 0: as
  // samplers ask for; kAnisotropic: by trilinear samplers with an anisotropy of 16, whatever they ask for.
  int texture_taps = 0;
  bool takes_positions = false;  // alpha takes mask positions away (stages/beam/alpha_mask.h)
};

// What the alpha test says about the points of an area: all or none of them pass, or it may be some. `unknown`: nobody
// has asked.
enum class CutoutCover : std::uint8_t { unknown, none, mixed, all };

class SurfaceShader {
 public:
  // All but the rules must outlive it. `textures`: of the trace; may be null if all triangles are flat.
  SurfaceShader(const SetupTriangles& triangles, const Trace& trace, const Frame& frame, const TextureSet* textures,
                const ShadingRules& rules);

  // Are all triangles flat?
  bool is_flat() const { return triangles_.surfaces.empty(); }
  bool is_flat(std::uint32_t triangle) const {
    return is_flat() || triangles_.surfaces[triangle].material == kFlatSurface;
  }

  // RGB. `footprint`: as in Invocation. Adds the texels that are read to the open request of `texels`, unless it
  // is null.
  glm::vec3 color(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint = {},
                  TexelRequests* texels = nullptr) const {
    if (is_flat(triangle)) return flat_[triangle];
    return glm::vec3(shaded({triangle, place, footprint}, texels));
  }

  // The same for several invocations, side by side, which takes less time; with alpha, which is 1 for flat triangles.
  // Each is a request of its own.
  std::vector<glm::vec4> colors_and_alphas(const std::vector<Invocation>& invocations,
                                           TexelRequests* texels = nullptr) const;
  // The same, as if each were asked for alone: programs do not see each other's invocations, and requests that are kept
  // stay in order.
  std::vector<glm::vec4> colors_alone(const std::vector<Invocation>& invocations,
                                      TexelRequests* texels = nullptr) const;
  glm::vec4 color_and_alpha(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint = {}) const {
    if (is_flat(triangle)) return glm::vec4(flat_[triangle], 1.0f);
    return shaded({triangle, place, footprint}, nullptr);
  }

  // Adds the texels that color() reads, for invocations whose colours are computed elsewhere, or not at all.
  void add_texels(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                  TexelRequests& texels) const;
  // The same for several invocations, none of them of a program, if requests are not kept.
  void count_texels(const std::vector<Invocation>& invocations, TexelRequests& texels) const;

  // Does a program shade the triangle, which is not flat?
  bool is_program(std::uint32_t triangle) const { return triangles_.surfaces[triangle].material == kProgramSurface; }
  // As in ProgramShader.
  std::uint64_t stopped(std::uint32_t draw) const { return programs_.stopped(draw); }
  // As add_texels, for invocations of programs, whose requests have no order.
  void add_program_texels(const std::vector<Invocation>& invocations, TexelRequests& texels) const;

  // Alpha at a place, whatever SurfaceColors says. `footprint`, `texels`: as above. 1 for opaque triangles.
  float alpha(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
              TexelRequests* texels = nullptr) const;

  // Where alpha's texture is read, and how that changes over the footprint; 0 without one.
  struct AlphaPlace {
    std::array<float, 2> uv{}, right{}, down{};
  };
  AlphaPlace alpha_place(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint) const;

  // The part of an area that a cutout covers, 0..1: of a point, 0 or 1, if its texels are larger than the area, and
  // else the part that passes the alpha test (stages/surface/tested_alpha.h), which the textures must have.
  // `footprint`, `texels`: as above.
  struct CutoutPart {
    float part = 0;
    bool is_share = false;  // from tested alpha
  };
  CutoutPart cutout_part(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                         TexelRequests* texels = nullptr) const;

  // How far light may vary in a footprint around a place, about, in linear RGB (light_range in
  // stages/surface/surface_formulas.h): by the highlights of normals that differ there. Textures of normals and
  // roughness are read once, where four texels cover the footprint. 0 for flat and unlit triangles. `texels`: as above.
  float light_range(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                    TexelRequests* texels = nullptr) const;
  // The same for several invocations, side by side, whose requests are not kept.
  std::vector<float> light_ranges(const std::vector<Invocation>& invocations, TexelRequests* texels = nullptr) const;

  // A cutout seen from one place: its four texels there tell alpha around it, or which part of the footprint passes.
  struct CutoutPatch {
    bool is_share = false;
    float part = 0;  // of is_share
    // Else alpha at (x, y) pixels from the place lies between those of four texels, or is that of the nearest one.
    std::array<float, 4> alphas{};  // upper left, upper right, lower left, lower right
    bool is_nearest = false;
    glm::vec2 share{0.0f}, right{0.0f}, down{0.0f};  // between the texels, and how it changes per pixel
    float factor = 1;                                // of alpha

    float alpha(float x, float y) const {
      glm::vec2 at = share + x * right + y * down;
      if (is_nearest) at = {at.x < 0.5f ? 0.0f : 1.0f, at.y < 0.5f ? 0.0f : 1.0f};
      const float upper = alphas[0] + at.x * (alphas[1] - alphas[0]),
                  lower = alphas[2] + at.x * (alphas[3] - alphas[2]);
      return factor * (upper + at.y * (lower - upper));
    }
  };
  CutoutPatch cutout_patch(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                           TexelRequests* texels = nullptr) const;

  // What tested alpha, in a level where four texels cover a footprint, says for all of it. `texels`: as above.
  CutoutCover tested_cover(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                           TexelRequests* texels = nullptr) const;

  // What the test of alpha(), of points without an area, says for all points of a square that lie in the triangle.
  // `corner`: the upper left one; `side`: in pixels.
  CutoutCover cutout_cover(std::uint32_t triangle, const ShadingPlace& corner, float side) const;

  bool is_opaque(std::uint32_t triangle) const { return triangles_.is_opaque(triangle); }
  bool is_cutout(std::uint32_t triangle) const {
    return !is_opaque(triangle) && alpha_mode(triangle) == AlphaMode::mask;
  }
  bool is_translucent(std::uint32_t triangle) const { return !is_opaque(triangle) && !is_cutout(triangle); }
  // Does its shader take positions away? In the API's order, what is translucent is blended instead.
  bool is_masked(std::uint32_t triangle) const {
    return triangles_.order == DrawOrder::of_api ? is_cutout(triangle) || has_verdict(triangle) : !is_opaque(triangle);
  }

  // Does its shader say more of a fragment, in the API's order, than its colour and whether it is discarded?
  bool has_verdict(std::uint32_t triangle) const {
    return has_alpha_to_coverage(triangle) || (is_program_in_order(triangle) && programs_.has_verdicts(draw(triangle)));
  }
  // What it says. `place_is_there`: who asks knows that the surface is there, or near it in the pixel.
  std::vector<FragmentVerdict> verdicts(std::uint32_t triangle, const std::vector<Invocation>& invocations,
                                        bool place_is_there, TexelRequests* texels = nullptr) const;
  // Are its fragments tested before they are shaded, whatever the shader says of them then?
  bool tests_early(std::uint32_t triangle) const {
    return is_program_in_order(triangle) && programs_.tests_early(draw(triangle));
  }
  float alpha_cutoff(std::uint32_t triangle) const {
    return is_program(triangle) ? Material{}.alpha_cutoff : material(triangle).alpha_cutoff;
  }

  // One for each triangle (stages/surface/sheets.h). Only shaders whose fragments have mask positions need them.
  void set_sheets(std::vector<std::uint32_t> sheets) { sheets_ = std::move(sheets); }
  std::uint32_t sheet(std::uint32_t triangle) const { return sheets_[triangle]; }

  // Do the triangles have the same colour everywhere?
  bool same_color(std::uint32_t a, std::uint32_t b) const {
    return a == b || (is_flat(a) && is_flat(b) && flat_[a] == flat_[b]);
  }

  // What an invocation costs: its operations, for the material, for light and for alpha alone, what others cost, and
  // bytes of what it reads of the triangle and its vertices.
  struct Work {
    OperationCounts material, light, alpha, range;  // range: of light_range()
    std::uint64_t input_bytes = 0;
    std::uint32_t helpers = 0;  // invocations that the material needs besides, where it is not shaded in quads
  };
  const Work& work(std::uint32_t triangle) const {
    return is_flat(triangle) ? triangles_.attributes[triangle].lit ? flat_lit_ : flat_unlit_ : material_work(triangle);
  }

  const Work& lit_flat() const { return flat_lit_; }  // of a flat triangle that is lit

  const std::vector<glm::vec3>& flat_colors() const { return flat_; }  // one per triangle; others have any value

  // Of a triangle that is not flat.
  const std::array<std::uint32_t, 3>& vertices(std::uint32_t triangle) const {
    return triangles_.surfaces[triangle].vertices;
  }

 private:
  struct Batch;
  template <class Run>
  class Batches;

  // Color and alpha of one invocation; of its inputs, whose material is no program; and of the light that it reflects,
  // with the material's alpha.
  glm::vec4 shaded(const Invocation& invocation, TexelRequests* texels) const;
  glm::vec4 lit(const Invocation& invocation, const PointInputs<float>& inputs) const;
  glm::vec4 as_stored(const Invocation& invocation, const glm::vec4& lit) const;

  std::uint32_t draw(std::uint32_t triangle) const { return triangles_.draws[triangle]; }
  // Where shaders say that there is a surface everywhere, nobody asks them.
  bool is_program_in_order(std::uint32_t triangle) const {
    return triangles_.order == DrawOrder::of_api && !is_opaque(triangle) && is_program(triangle);
  }
  bool has_alpha_to_coverage(std::uint32_t triangle) const {
    return triangles_.order == DrawOrder::of_api && !is_opaque(triangle) &&
           frame_.draws[draw(triangle)].state.alpha_to_coverage;
  }

  AlphaMode alpha_mode(std::uint32_t triangle) const {
    return is_program(triangle) ? programs_.alpha_mode(triangles_.draws[triangle]) : material(triangle).alpha_mode;
  }
  // Where a program runs. `is_color`: rules say where; else it is at the place itself.
  ProgramPlace program_place(const Invocation& invocation, bool is_color) const;
  // Color and alpha.
  glm::vec4 run_program(const ProgramPlace& place, TexelRequests* texels) const;
  // Of programs of one draw. Colours are rounded.
  void run_programs(std::span<const ProgramPlace> places, glm::vec4* colors, TexelRequests* texels) const;
  // Invocations of programs, draw by draw.
  template <class Visit>
  void for_each_draw(const std::vector<Invocation>& invocations, const std::vector<std::size_t>& numbers,
                     Visit&& visit) const;
  // As the frame's target has it.
  glm::vec3 stored_color(const glm::vec3& linear) const;

  PointRules point_rules() const {
    return {.at_centres = rules_.colors == SurfaceColors::by_pixel,
            .in_quads = rules_.derivatives == Derivatives::quad};
  }
  // What the shader knows of a point, with textures. `inputs`: may be null: only texels are noted.
  void find_input(const Invocation& invocation, TexelRequests* texels, PointInputs<float>* inputs) const;
  // The same for several points, side by side. `invocations`: of one shader, at least one and at most kMostPoints.
  // `texels`: of requests that are not kept.
  void find_inputs(std::span<const Invocation> invocations, TexelRequests* texels,
                   PointInputs<PointColumn>* inputs) const;
  // What light_range() depends on; as above.
  AreaInputs<float> find_area(const Invocation& invocation, TexelRequests* texels) const;
  void find_areas(std::span<const Invocation> invocations, TexelRequests* texels, AreaInputs<PointColumn>& areas) const;
  // A texture of a material, with the filter that the rules say.
  struct FilteredTexture {
    TextureRole role;
    Texture texture;
    ColorSpace space;
    const MipChain& chain;
    int taps;  // ShadingRules::texture_taps

    FilterPlan plan(const TextureSlopes& slopes, float lod) const;
    std::array<float, 4> texel(const glm::vec4& value, const FilterPlan& plan) const;  // as in PointInputs
  };
  FilteredTexture filtered_texture(TextureRole role, const Texture& texture) const;
  // What a texture says of an area.
  struct AreaTexel {
    std::array<float, 4> texel{1.0f, 1.0f, 1.0f, 1.0f};
    float around_of_texels = 0, around_within_texels = 0;  // of normals
  };
  AreaTexel area_texel(TextureRole role, const Texture& texture, const Material& material, const glm::vec2& uv,
                       const TextureSlopes& slopes, TexelRequests* texels) const;
  // May its light vary within an area?
  bool may_vary(std::uint32_t triangle) const {
    return !is_flat(triangle) && !is_program(triangle) && !material(triangle).unlit;
  }
  // Alpha, where texture_alpha(texture, uv, slopes) says that of the texture.
  template <class TextureAlpha>
  float alpha_there(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                    TextureAlpha&& texture_alpha) const;
  ShaderInputs inputs_of(std::uint32_t triangle) const;
  // Does the material pass through a G-buffer?
  bool is_stored(const Material& material) const {
    return rules_.storage == MaterialStorage::gbuffer && rules_.colors == SurfaceColors::by_place &&
           material.alpha_mode != AlphaMode::blend;
  }
  const Material& material(std::uint32_t triangle) const {
    return trace_.materials[triangles_.surfaces[triangle].material];
  }
  const Work& material_work(std::uint32_t triangle) const;

  const SetupTriangles& triangles_;
  const Trace& trace_;
  const Frame& frame_;
  const TextureSet* textures_;
  ShadingRules rules_;
  ProgramShader programs_;
  std::vector<Work> program_works_;  // by draw
  std::vector<glm::vec3> flat_;
  std::vector<std::uint32_t> sheets_;  // of triangles
  Work flat_lit_, flat_unlit_;
  std::vector<Work> works_;  // of materials, by what their meshes have
};

// The same for the pixels of a tile, which are numbered row by row.
class TileShader {
 public:
  // Both must outlive it.
  TileShader(const SurfaceShader& shader, const Tile& tile)
      : flat_(shader.flat_colors()), shader_(&shader), tile_(tile) {}

  // Of flat triangles, which are all lit by one light. The colours must outlive it.
  TileShader(const std::vector<glm::vec3>& flat_colors) : flat_(flat_colors) {}

  bool is_flat(std::uint32_t triangle) const { return !shader_ || shader_->is_flat(triangle); }
  bool is_flat() const { return !shader_ || shader_->is_flat(); }

  // (u, v): in the pixel, from its upper left corner, 0..1.
  glm::vec3 color(std::uint32_t triangle, std::uint32_t pixel, float u, float v, const Footprint& footprint = {},
                  TexelRequests* texels = nullptr) const {
    if (is_flat(triangle)) return flat_[triangle];
    return shader_->color(triangle, place(pixel, u, v), footprint, texels);
  }
  std::vector<glm::vec4> colors_and_alphas(const std::vector<Invocation>& invocations,
                                           TexelRequests* texels = nullptr) const {
    if (shader_) return shader_->colors_and_alphas(invocations, texels);
    std::vector<glm::vec4> colors;
    for (const Invocation& invocation : invocations) colors.emplace_back(flat_[invocation.triangle], 1.0f);
    return colors;
  }
  std::vector<glm::vec4> colors_alone(const std::vector<Invocation>& invocations,
                                      TexelRequests* texels = nullptr) const {
    return shader_ ? shader_->colors_alone(invocations, texels) : colors_and_alphas(invocations);
  }
  std::vector<glm::vec3> colors(const std::vector<Invocation>& invocations, TexelRequests* texels = nullptr) const {
    std::vector<glm::vec3> colors;
    colors.reserve(invocations.size());
    for (const glm::vec4& color : colors_and_alphas(invocations, texels)) colors.emplace_back(color);
    return colors;
  }
  glm::vec4 color_and_alpha(std::uint32_t triangle, std::uint32_t pixel, float u, float v,
                            const Footprint& footprint = {}) const {
    if (is_flat(triangle)) return glm::vec4(flat_[triangle], 1.0f);
    return shader_->color_and_alpha(triangle, place(pixel, u, v), footprint);
  }

  void add_texels(std::uint32_t triangle, std::uint32_t pixel, float u, float v, const Footprint& footprint,
                  TexelRequests& texels) const {
    if (!is_flat(triangle)) shader_->add_texels(triangle, place(pixel, u, v), footprint, texels);
  }

  float alpha(std::uint32_t triangle, std::uint32_t pixel, float u, float v, const Footprint& footprint,
              TexelRequests* texels = nullptr) const {
    return shader_->alpha(triangle, place(pixel, u, v), footprint, texels);
  }
  SurfaceShader::AlphaPlace alpha_place(std::uint32_t triangle, std::uint32_t pixel, float u, float v,
                                        const Footprint& footprint) const {
    return shader_->alpha_place(triangle, place(pixel, u, v), footprint);
  }
  SurfaceShader::CutoutPart cutout_part(std::uint32_t triangle, std::uint32_t pixel, float u, float v,
                                        const Footprint& footprint, TexelRequests* texels = nullptr) const {
    return shader_->cutout_part(triangle, place(pixel, u, v), footprint, texels);
  }
  CutoutCover cutout_cover(std::uint32_t triangle, std::uint32_t pixel, float u, float v, float side) const {
    return shader_->cutout_cover(triangle, place(pixel, u, v), side);
  }
  SurfaceShader::CutoutPatch cutout_patch(std::uint32_t triangle, std::uint32_t pixel, float u, float v,
                                          const Footprint& footprint, TexelRequests* texels = nullptr) const {
    return shader_->cutout_patch(triangle, place(pixel, u, v), footprint, texels);
  }
  // Of the whole pixel.
  CutoutCover tested_cover(std::uint32_t triangle, std::uint32_t pixel, TexelRequests* texels = nullptr) const {
    constexpr float kWidth = 1.125f;  // in pixels: with perspective, a pixel shows more than its slopes say
    return shader_->tested_cover(triangle, place(pixel, 0.5f, 0.5f), kWidth, texels);
  }
  // Of triangles that are not flat.
  float light_range(std::uint32_t triangle, std::uint32_t pixel, float u, float v, const Footprint& footprint,
                    TexelRequests* texels = nullptr) const {
    return shader_->light_range(triangle, place(pixel, u, v), footprint, texels);
  }
  std::vector<float> light_ranges(const std::vector<Invocation>& invocations, TexelRequests* texels = nullptr) const {
    return shader_->light_ranges(invocations, texels);
  }
  bool has_verdict(std::uint32_t triangle) const { return shader_ && shader_->has_verdict(triangle); }
  bool tests_early(std::uint32_t triangle) const { return shader_ && shader_->tests_early(triangle); }
  FragmentVerdict verdict(const Invocation& invocation, bool place_is_there, TexelRequests* texels) const {
    return shader_->verdicts(invocation.triangle, {invocation}, place_is_there, texels)[0];
  }
  std::vector<FragmentVerdict> verdicts(std::uint32_t triangle, const std::vector<Invocation>& invocations) const {
    return shader_->verdicts(triangle, invocations, false);
  }
  bool is_opaque(std::uint32_t triangle) const { return !shader_ || shader_->is_opaque(triangle); }
  bool is_masked(std::uint32_t triangle) const { return shader_ && shader_->is_masked(triangle); }
  bool is_cutout(std::uint32_t triangle) const { return shader_ && shader_->is_cutout(triangle); }
  float alpha_cutoff(std::uint32_t triangle) const { return shader_->alpha_cutoff(triangle); }
  // Of `positions` in the pixel.
  OpacityRanks opacity_ranks(std::uint32_t triangle, std::uint32_t pixel, std::size_t positions) const {
    const ShadingPlace at = place(pixel, 0, 0);
    return {shader_->sheet(triangle), at.x, at.y, static_cast<std::uint32_t>(positions)};
  }

  // Flat triangles that belong to no tile look the same everywhere.
  ShadingPlace place(std::uint32_t pixel, float u, float v) const {
    if (!shader_) return {};
    const std::uint32_t row = pixel / static_cast<std::uint32_t>(tile_.width());
    return {tile_.x0 + static_cast<std::int32_t>(pixel - row * static_cast<std::uint32_t>(tile_.width())),
            tile_.y0 + static_cast<std::int32_t>(row), u, v};
  }

  const SurfaceShader::Work& work(std::uint32_t triangle) const {
    return shader_ ? shader_->work(triangle) : lit_flat();
  }
  const SurfaceShader::Work& lit_flat() const;  // of a flat triangle that is lit

 private:
  const std::vector<glm::vec3>& flat_;
  const SurfaceShader* shader_ = nullptr;
  Tile tile_{};
};

// Colours of flat triangles: kd, times the light that is received if they are lit.
std::vector<glm::vec3> shade_triangles(const SetupTriangles& triangles, const Lighting& lighting);

}  // namespace beampipe
