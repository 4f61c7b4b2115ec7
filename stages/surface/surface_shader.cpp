#include "stages/surface/surface_shader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <new>
#include <optional>

#include "stages/cost/counting.h"
#include "stages/data/half_bits.h"
#include "stages/surface/alpha_range.h"
#include "stages/surface/footprint_filter.h"
#include "stages/surface/lit_colors.h"
#include "stages/surface/texture_filter.h"
#include "stages/surface/texture_taps.h"
#include "traces/srgb.h"

namespace beampipe {
namespace {

glm::vec2 vector_of(const std::array<float, 2>& v) { return {v[0], v[1]}; }

// Along the sides of the footprint.
TextureSlopes slopes_of(const TexturePlace<float>& place) { return {vector_of(place.dx), vector_of(place.dy)}; }
// Of point i.
TextureSlopes slopes_of(const TexturePoints& points, std::size_t i) {
  return {{points.dx[0][i], points.dx[1][i]}, {points.dy[0][i], points.dy[1][i]}};
}
glm::vec2 uv_of(const TexturePoints& points, std::size_t i) { return {points.uv[0][i], points.uv[1][i]}; }

// What is known of point i.
PointInputs<float> row(const PointInputs<PointColumn>& points, std::size_t i) {
  PointInputs<float> found;
  for (std::size_t member = 0; member < sizeof found / sizeof(float); ++member)
    std::memcpy(reinterpret_cast<float*>(&found) + member,
                reinterpret_cast<const float*>(&points) + member * kMostPoints + i, sizeof(float));
  return found;
}

// Sets the member at point i.
template <std::size_t kCount>
void set_row(std::array<PointColumn, kCount>& column, std::size_t i, const std::array<float, kCount>& row) {
  for (std::size_t c = 0; c < kCount; ++c) column[c][i] = row[c];
}

// The middles of an area's right and lower side, from its own.
Invocation right_of(Invocation middle) {
  middle.place.u += 0.5f * middle.footprint.xx, middle.place.v += 0.5f * middle.footprint.xy;
  return middle;
}
Invocation below(Invocation middle) {
  middle.place.v += 0.5f * middle.footprint.yy;
  return middle;
}

// A shader that needs nothing but the normal and the direction to the eye, from the same triangles.
ShaderInputs directions_alone(const ShaderInputs& shader) {
  static const Material lit{};
  return {lit, false, shader.has_own_normal, false};
}

// Textures that matter to light_range().
bool is_of_area(TextureRole role) { return role == TextureRole::normal || role == TextureRole::metallic_roughness; }
bool is_any(TextureRole) { return true; }

// Is one of the material's textures, of those that are wanted, read at this set of texture coordinates?
bool reads(const Material& material, std::size_t set, bool (*is_wanted)(TextureRole)) {
  bool found = false;
  for_each_texture<float>(material, [&](TextureRole role, const Texture& texture, auto) {
    found = found || (is_wanted(role) && texture.uv_set == set);
  });
  return found;
}

ColorSpace space_of(TextureRole role) {
  return role == TextureRole::base || role == TextureRole::emissive ? ColorSpace::srgb : ColorSpace::linear;
}

// Adds the texels that are read to `texels`, unless it is null.
auto noting(TexelRequests* texels, std::uint32_t image, ColorSpace space, std::uint32_t test = kNoAlphaTest) {
  return [=](std::size_t level, std::uint32_t column, std::uint32_t row) {
    if (texels)
      texels->read({.image = image,
                    .space = space,
                    .level = static_cast<std::uint32_t>(level),
                    .x = column,
                    .y = row,
                    .alpha_test = test});
  };
}

// The filter of a texture for means over areas, whatever it is for colours.
Texture for_areas(Texture texture) {
  texture.minify = texture.magnify = Filter::linear, texture.mip = MipFilter::linear;
  return texture;
}

// What the rules make of a texture's sampler. `taps`: ShadingRules::texture_taps.
Texture filtered_by(Texture texture, int taps) {
  if (taps == kAnisotropic) texture.minify = Filter::linear, texture.mip = MipFilter::linear, texture.anisotropy = 16;
  return texture;
}

// Light that a flat triangle reflects, by Lambert's law.
glm::vec3 flat_color(const FlatAttributes& flat, const Lighting& lighting) {
  if (!flat.lit) return flat.kd;
  glm::vec3 color(0.0f);
  for (const Light& light : lighting.lights) {
    glm::vec3 reflected;
    lambert(&flat.kd.x, &flat.normal.x, &light.direction.x, &reflected.x);
    color += light.color * reflected;
  }
  if (!lighting.ambient) return color;
  const Triple<float> normal = triple<float>(flat.normal);
  for (std::size_t c = 0; c < 3; ++c)
    color[static_cast<int>(c)] += flat.kd[static_cast<int>(c)] * ambient_light(*lighting.ambient, normal, c);
  return color;
}

// Texture coordinates and how they change, from the planes of a triangle, or as differences between the invocations of
// a quad.
template <class Real>
TexturePlace<Real> counted_place(const SurfaceVertexOf<Real>& vertex, std::uint32_t set,
                                 const BarycentricPlanes<Real>& planes, const Barycentrics<Real>& weights,
                                 Derivatives derivatives) {
  const Real one = vertex.color[0];
  const std::array<std::array<Real, 2>, 3> uvs{vertex.uvs[set], vertex.uvs[set], vertex.uvs[set]};
  if (derivatives != Derivatives::quad) return place_on_triangle(uvs, planes, one, one, weights);
  TexturePlace<Real> found;
  for (std::size_t c = 0; c < 2; ++c) {
    found.uv[c] = interpolated(uvs[0][c], uvs[1][c], uvs[2][c], weights);
    found.dx[c] = found.uv[c] - one, found.dy[c] = found.uv[c] - one;
  }
  return found;
}

// The operations up to what the surface is made of, with the weights and texture coordinates that it needs. A fetch is
// one operation; filtering is done by the texture unit.
OperationCounts material_cost(const ShaderInputs& shader, Derivatives derivatives) {
  return count_operations([&](OperationCounts& counts) {
    using Real = Counted<float>;
    const Real one(1.0f, counts);
    const Triple<Real> vector{one, one, one};
    SurfaceVertexOf<Real> vertex{
        .to_eye = vector, .normal = vector, .tangent = vector, .tangent_sign = one, .color = {one, one, one, one}};
    for (auto& uv : vertex.uvs) uv = {one, one};
    const ScreenPlane<Real> plane{one, one, one};
    const BarycentricPlanes<Real> planes{plane, plane, plane};
    const Barycentrics<Real> weights = weights_at(planes, one, one);
    std::array<std::optional<TexturePlace<Real>>, 2> places;
    const auto place = [&](std::uint32_t set) {
      if (!places[set]) places[set] = counted_place(vertex, set, planes, weights, derivatives);
    };
    const auto attribute = [&](const auto& member_of) {
      auto result = member_of(vertex);
      for (Real& number : result) number = interpolated(number, number, number, weights);
      return result;
    };
    PointInputs<Real> inputs;
    for_each_texture<Real>(shader.material, [&](TextureRole, const Texture& texture, auto texel) {
      place(texture.uv_set);
      ++counts.fetch;
      inputs.*texel = {one, one, one, one};
    });
    set_attributes(shader, TriangleInputs<Real>{vector, one, vector, one}, attribute, inputs);
    material_of(shader, inputs);
  });
}

// Of alpha alone. Its slopes come from the planes in every technique.
OperationCounts alpha_cost(const ShaderInputs& shader) {
  if (!shader.material.base_texture && !shader.has_vertex_colors) return {};
  return count_operations([&](OperationCounts& counts) {
    using Real = Counted<float>;
    const Real one(1.0f, counts);
    SurfaceVertexOf<Real> vertex{};
    vertex.color.fill(one);
    for (auto& uv : vertex.uvs) uv = {one, one};
    const ScreenPlane<Real> plane{one, one, one};
    const BarycentricPlanes<Real> planes{plane, plane, plane};
    const Barycentrics<Real> weights = weights_at(planes, one, one);
    const auto place = [&](std::uint32_t set) {
      return counted_place(vertex, set, planes, weights, Derivatives::analytic);
    };
    const auto fetch = [&](TextureRole, const TexturePlace<Real>&) -> std::array<Real, 4> {
      ++counts.fetch;
      return {one, one, one, one};
    };
    alpha_at(shader, {one, one, one}, weights, place, fetch);
  });
}

// Of light_range(): material_of() without colours, normals and directions to the eye at three points, and a look-up of
// each texture that matters, whose four texels are compared.
OperationCounts range_cost(const ShaderInputs& shader, const Lighting& lighting) {
  if (shader.material.unlit) return {};
  return count_operations([&](OperationCounts& counts) {
    using Real = Counted<float>;
    const Real one(1.0f, counts);
    const Triple<Real> vector{one, one, one};
    const ScreenPlane<Real> plane{one, one, one};
    const BarycentricPlanes<Real> planes{plane, plane, plane};
    SurfaceVertexOf<Real> vertex{
        .to_eye = vector, .normal = vector, .tangent = vector, .tangent_sign = one, .color = {one, one, one, one}};
    for (auto& uv : vertex.uvs) uv = {one, one};
    PointInputs<Real> inputs;
    inputs.color = {one, one, one, one};
    for (int point = 0; point < 3; ++point) {
      const Barycentrics<Real> weights = weights_at(planes, one, one);
      const auto attribute = [&](const auto& member_of) {
        auto result = member_of(vertex);
        for (Real& number : result) number = interpolated(number, number, number, weights);
        return result;
      };
      set_attributes(shader, TriangleInputs<Real>{vector, one, vector, one}, attribute, inputs);
      if (point > 0) continue;
      for_each_texture<Real>(shader.material, [&](TextureRole role, const Texture& texture, auto texel) {
        inputs.*texel = {one, one, one, one};
        if (role != TextureRole::normal && role != TextureRole::metallic_roughness) return;
        counted_place(vertex, texture.uv_set, planes, weights, Derivatives::analytic);
        ++counts.fetch;
        for (int i = 0; i < 12; ++i) static_cast<void>(greater(one, lesser(one, one)) + one);
      });
    }
    const auto turns = [&] { return Turn<Real>{turned(vector, vector), turned(vector, vector), one}; };
    if (!shader.has_own_normal) turns();
    const Turn<Real> of_eye = turns();
    const Real around = one * (length(of_eye.right) + length(of_eye.down)) + one;
    light_range(material_of(shader, inputs).reflector, Turn<Real>{vector, vector, around}, lighting);
  });
}

OperationCounts light_cost(const Material& material, const Lighting& lighting) {
  return count_operations([&](OperationCounts& counts) {
    using Real = Counted<float>;
    const Real one(1.0f, counts);
    const Triple<Real> vector{one, one, one};
    lit_color(material, SurfaceMaterial<Real>{{vector, one, one, vector, vector}, vector, one}, lighting);
  });
}

// Lambert's law for each light. White lights are not multiplied by their colour.
OperationCounts flat_light_cost(const Lighting& lighting) {
  return count_operations([&](OperationCounts& counts) {
    using Real = Counted<float>;
    const Real one(1.0f, counts), kd[3] = {one, one, one};
    Real color[3];
    if (lighting.lights.empty()) lambert(kd, kd, kd, color);
    for (const Light& light : lighting.lights) {
      lambert(kd, kd, kd, color);
      if (light.color == glm::vec3(1.0f)) continue;
      for (int c = 0; c < 3; ++c) static_cast<void>(one * one);
    }
    const std::size_t sums = lighting.lights.empty() ? 0 : lighting.lights.size() - 1 + lighting.ambient.has_value();
    for (std::size_t i = 0; i < 3 * sums; ++i) static_cast<void>(one + one);
    if (!lighting.ambient) return;
    const Triple<Real> normal{one, one, one};
    for (std::size_t c = 0; c < 3; ++c) static_cast<void>(one * ambient_light(*lighting.ambient, normal, c));
  });
}

std::uint64_t shader_input_bytes(const ShaderInputs& shader) {
  const Material& material = shader.material;
  std::uint64_t floats = shader.has_vertex_colors ? 4 : 0;
  if (!material.unlit) floats += 3 + (shader.has_own_normal ? 0 : 3);
  if (material.normal_texture) floats += 4;
  bool sets[2] = {false, false};
  for (const auto* texture : {&material.base_texture, &material.metallic_roughness_texture, &material.normal_texture,
                              &material.emissive_texture})
    if (*texture) sets[(*texture)->uv_set] = true;
  floats += 2u * (sets[0] + sets[1]);
  return kSurfaceBytes + 3 * floats * sizeof(float);
}

// Where works_ has that of a material's shader.
std::size_t work_index(std::uint32_t material, const ShaderInputs& shader) {
  return std::size_t{material} * 8 + shader.has_vertex_colors * 4u + shader.has_own_normal * 2u +
         shader.has_tangents * 1u;
}

float stored(float value, float largest_code) {
  return std::floor(std::clamp(value, 0.0f, 1.0f) * largest_code + 0.5f) / largest_code;
}

// What is left of a surface after it was written to a G-buffer and read back: base colour as sRGB and roughness in
// RGBA8, normal and metallic in RGB10A2. (Emission is written into the colour that light is added to.)
Reflector<float> through_gbuffer(Reflector<float> surface) {
  for (float& component : surface.base) component = srgb_values()[srgb_code(component)];
  surface.roughness = stored(surface.roughness, 255);
  surface.metallic = stored(surface.metallic, 3);
  for (float& component : surface.normal) component = stored(0.5f + 0.5f * component, 1023) * 2 - 1;
  surface.normal = unit(surface.normal);
  return surface;
}

// Alpha that is extrapolated beyond the triangle may leave 0..1. What is not a number becomes 1.
float limited_alpha(float alpha) { return greater(lesser(alpha, 1.0f), 0.0f); }

void round_to(AccumulatorFormat format, glm::vec3& color) {
  for (int c = 0; c < 3; ++c) color[c] = rounded_to(format, color[c]);
}

// 0 where a program has discarded.
glm::vec4 with_limited_alpha(const glm::vec4& color) { return {glm::vec3(color), greater(color.a, 0.0f)}; }

}  // namespace

std::vector<glm::vec3> shade_triangles(const SetupTriangles& triangles, const Lighting& lighting) {
  std::vector<glm::vec3> colors;
  colors.reserve(triangles.attributes.size());
  for (const FlatAttributes& flat : triangles.attributes) colors.push_back(flat_color(flat, lighting));
  return colors;
}

SurfaceShader::SurfaceShader(const SetupTriangles& triangles, const Trace& trace, const Frame& frame,
                             const TextureSet* textures, const ShadingRules& rules)
    : triangles_(triangles),
      trace_(trace),
      frame_(frame),
      textures_(textures),
      rules_(rules),
      programs_(triangles, trace, frame, textures ? &textures->programs() : nullptr),
      flat_(shade_triangles(triangles, frame.lighting)) {
  if (rules.colors == SurfaceColors::by_pixel) rules_.stored_as = AccumulatorFormat::fp32;
  for (glm::vec3& color : flat_) {
    color = stored_color(color);
    round_to(rules_.stored_as, color);
  }
  flat_unlit_.input_bytes = flat_lit_.input_bytes = sizeof(FlatAttributes);
  flat_lit_.light = flat_light_cost(frame.lighting);
  if (is_flat()) return;
  works_.resize(trace.materials.size() * 8);
  program_works_.resize(frame.draws.size());
  for (std::uint32_t i = 0; i < triangles.surfaces.size(); ++i) {
    if (is_flat(i)) continue;
    if (is_program(i)) {
      Work& work = program_works_[triangles.draws[i]];
      if (work.input_bytes > 0) continue;
      const ProgramShader::Cost& cost = programs_.cost(triangles.draws[i]);
      const bool in_quads = rules.derivatives == Derivatives::quad;
      work.input_bytes = cost.input_bytes;
      work.helpers = in_quads ? 0 : cost.helpers;
      // Where samples decide, the run that says whether there is a surface gives its colour as well.
      if (!triangles.is_opaque(i)) work.alpha = cost.ops * (1 + work.helpers);
      if (!in_quads || !is_cutout(i)) work.material = cost.ops;
      continue;
    }
    const ShaderInputs shader = inputs_of(i);
    Work& work = works_[work_index(triangles.surfaces[i].material, shader)];
    if (work.input_bytes == 0)
      work = {material_cost(shader, rules.derivatives), light_cost(shader.material, frame.lighting),
              triangles.is_opaque(i) ? OperationCounts{} : alpha_cost(shader), range_cost(shader, frame.lighting),
              shader_input_bytes(shader)};
  }
}

ShaderInputs SurfaceShader::inputs_of(std::uint32_t triangle) const {
  const SetupSurface& surface = triangles_.surfaces[triangle];
  const Mesh& mesh = trace_.meshes[frame_.draws[triangles_.draws[triangle]].mesh];
  return {trace_.materials[surface.material], !mesh.vertex_colors.empty(), surface.has_own_normal,
          !mesh.tangents.empty()};
}

const SurfaceShader::Work& TileShader::lit_flat() const {
  static const SurfaceShader::Work one_light{{}, flat_light_cost({{{}}, {}}), {}, sizeof(FlatAttributes)};
  return shader_ ? shader_->lit_flat() : one_light;
}

const SurfaceShader::Work& SurfaceShader::material_work(std::uint32_t triangle) const {
  if (is_program(triangle)) return program_works_[triangles_.draws[triangle]];
  return works_[work_index(triangles_.surfaces[triangle].material, inputs_of(triangle))];
}

glm::vec3 SurfaceShader::stored_color(const glm::vec3& linear) const {
  if (frame_.target != ColorTarget::unorm) return linear;
  glm::vec3 stored;
  for (int c = 0; c < 3; ++c) stored[c] = static_cast<float>(encoded_as_srgb(linear[c]));
  return stored;
}

ProgramPlace SurfaceShader::program_place(const Invocation& invocation, bool is_color) const {
  const auto& [triangle, place, footprint] = invocation;
  if (is_color && rules_.colors == SurfaceColors::by_pixel)
    return {.triangle = triangle, .x = place.x, .y = place.y, .stays_in_triangle = true, .is_there = true};
  const bool in_cells = rules_.derivatives != Derivatives::analytic;
  const float column = place.u / footprint.yy, row = place.v / footprint.yy;
  const bool is_centre = column - std::floor(column) == 0.5f && row - std::floor(row) == 0.5f;
  return {.triangle = triangle,
          .x = place.x,
          .y = place.y,
          .u = place.u,
          .v = place.v,
          .side = in_cells ? footprint.yy : 1.0f,
          .in_quad = in_cells && (footprint.yy == 1 || is_centre),
          .is_there = is_color};
}

void SurfaceShader::run_programs(std::span<const ProgramPlace> places, glm::vec4* colors, TexelRequests* texels) const {
  // Where a pixel has one colour of a triangle, its cells ask for the same again and again.
  std::vector<ProgramPlace> others;
  std::vector<std::size_t> number_of;  // of each place in `others`
  const bool repeats = !texels && rules_.colors == SurfaceColors::by_pixel;
  for (std::size_t i = 0; repeats && i < places.size(); ++i) {
    if (i == 0 || places[i] != places[i - 1]) others.push_back(places[i]);
    number_of.push_back(others.size() - 1);
  }
  const std::size_t count = repeats ? others.size() : places.size();
  programs_.shade(repeats ? others : places, colors, texels);
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec3 color(colors[i]);
    round_to(rules_.stored_as, color);
    colors[i] = glm::vec4(color, colors[i].a);
  }
  for (std::size_t i = places.size(); repeats && i-- > 0;) colors[i] = colors[number_of[i]];
}

template <class Visit>
void SurfaceShader::for_each_draw(const std::vector<Invocation>& invocations, const std::vector<std::size_t>& numbers,
                                  Visit&& visit) const {
  std::map<std::uint32_t, std::vector<std::size_t>> of_draws;
  for (const std::size_t i : numbers) of_draws[triangles_.draws[invocations[i].triangle]].push_back(i);
  for (const auto& [draw, of_draw] : of_draws) {
    std::vector<ProgramPlace> places;
    for (const std::size_t i : of_draw) places.push_back(program_place(invocations[i], true));
    visit(places, of_draw);
  }
}

void SurfaceShader::add_program_texels(const std::vector<Invocation>& invocations, TexelRequests& texels) const {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < invocations.size(); ++i)
    if (programs_.reads_images(triangles_.draws[invocations[i].triangle])) numbers.push_back(i);
  std::vector<glm::vec4> ignored;
  for_each_draw(invocations, numbers, [&](const std::vector<ProgramPlace>& places, const std::vector<std::size_t>&) {
    ignored.resize(places.size());
    programs_.shade(places, ignored.data(), &texels);
  });
}

glm::vec4 SurfaceShader::run_program(const ProgramPlace& place, TexelRequests* texels) const {
  glm::vec4 color;
  run_programs({&place, 1}, &color, texels);
  return color;
}

template <class TextureAlpha>
float SurfaceShader::alpha_there(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                                 TextureAlpha&& texture_alpha) const {
  if (is_opaque(triangle)) return 1.0f;
  const SetupSurface& surface = triangles_.surfaces[triangle];
  const ShaderInputs shader = inputs_of(triangle);
  const auto vertex = [&](std::size_t k) -> const SurfaceVertex& { return triangles_.vertices[surface.vertices[k]]; };
  Barycentrics<float> weights;
  const float x = static_cast<float>(place.x) + place.u - surface.anchor_x,
              y = static_cast<float>(place.y) + place.v - surface.anchor_y;
  if (shader.has_vertex_colors || shader.material.base_texture) weights = weights_at(surface.planes, x, y);
  const auto texture_place = [&](std::uint32_t set) {
    return place_on_triangle<float>({vertex(0).uvs[set], vertex(1).uvs[set], vertex(2).uvs[set]}, surface.planes, x, y,
                                    weights);
  };
  const auto fetch = [&](TextureRole, const TexturePlace<float>& at) {
    return glm::vec4(texture_alpha(*shader.material.base_texture, vector_of(at.uv),
                                   slopes_of(along_sides(at, footprint.xx, footprint.xy, footprint.yy))));
  };
  const float alpha =
      alpha_at(shader, {vertex(0).color[3], vertex(1).color[3], vertex(2).color[3]}, weights, texture_place, fetch);
  return limited_alpha(alpha);
}

float SurfaceShader::alpha(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                           TexelRequests* texels) const {
  if (!is_opaque(triangle) && is_program(triangle)) {
    const float found = run_program(program_place({triangle, place, footprint}, false), texels).a;
    if (found == ProgramShader::kDiscarded) return 0.0f;
    return alpha_mode(triangle) == AlphaMode::mask ? 1.0f : found;
  }
  return alpha_there(
      triangle, place, footprint, [&](const Texture& given, const glm::vec2& uv, const TextureSlopes& slopes) {
        const Texture texture = filtered_by(given, rules_.texture_taps);
        const MipChain& chain = textures_->chain(texture.image, ColorSpace::srgb);
        const FilterPlan plan = rules_.texture_taps > 0 ? footprint_plan(chain, texture, slopes, rules_.texture_taps)
                                                        : filter_plan(chain, texture, slopes);
        return filtered(chain, texture, uv, plan, noting(texels, texture.image, ColorSpace::srgb)).a;
      });
}

std::vector<FragmentVerdict> SurfaceShader::verdicts(std::uint32_t triangle, const std::vector<Invocation>& invocations,
                                                     bool place_is_there, TexelRequests* texels) const {
  std::vector<FragmentVerdict> found(invocations.size());
  std::vector<glm::vec4> colors;
  if (is_program(triangle)) {
    std::vector<ProgramPlace> places;
    for (const Invocation& invocation : invocations) {
      places.push_back(program_place(invocation, false));
      places.back().is_there = place_is_there;
    }
    colors.resize(places.size());
    programs_.shade(places, colors.data(), texels, found.data());
  } else {
    for (const Invocation& invocation : invocations) colors.push_back(shaded(invocation, texels));
  }
  const float least = is_program(triangle) || !is_cutout(triangle) ? 0 : alpha_cutoff(triangle);
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].is_kept = colors[i].a >= least;
    if (has_alpha_to_coverage(triangle)) found[i].coverage = limited_alpha(colors[i].a);
  }
  return found;
}

SurfaceShader::AlphaPlace SurfaceShader::alpha_place(std::uint32_t triangle, const ShadingPlace& place,
                                                     const Footprint& footprint) const {
  AlphaPlace found;
  if (is_program(triangle)) return found;
  alpha_there(triangle, place, footprint, [&](const Texture&, const glm::vec2& uv, const TextureSlopes& slopes) {
    found = {{uv.x, uv.y}, {slopes.dx.x, slopes.dx.y}, {slopes.dy.x, slopes.dy.y}};
    return 1.0f;
  });
  return found;
}

SurfaceShader::CutoutPart SurfaceShader::cutout_part(std::uint32_t triangle, const ShadingPlace& place,
                                                     const Footprint& footprint, TexelRequests* texels) const {
  const float cutoff = alpha_cutoff(triangle);
  if (cutoff <= 0.0f) return {1.0f};
  if (is_program(triangle)) return {alpha(triangle, place, footprint, texels)};
  const TestedAlpha* tested = nullptr;
  glm::vec4 shares;
  // Of a point; or what the texture's alpha is multiplied by.
  const float alpha = alpha_there(
      triangle, place, footprint, [&](const Texture& texture, const glm::vec2& uv, const TextureSlopes& slopes) {
        const MipChain& chain = textures_->chain(texture.image, ColorSpace::srgb);
        const FilterPlan plan = filter_plan(chain, texture, slopes);
        if (!plan.is_minified)
          return filtered(chain, texture, uv, plan, noting(texels, texture.image, ColorSpace::srgb)).a;
        const std::uint32_t material = triangles_.surfaces[triangle].material;
        tested = &textures_->tested_alpha(material);
        shares = filtered(tested->shares, for_areas(texture), uv, slopes,
                          noting(texels, texture.image, ColorSpace::linear, textures_->alpha_test(material)));
        return 1.0f;
      });
  if (!tested) return {alpha >= cutoff ? 1.0f : 0.0f};
  return {tested->share(shares, cutoff / alpha), true};
}

SurfaceShader::CutoutPatch SurfaceShader::cutout_patch(std::uint32_t triangle, const ShadingPlace& place,
                                                       const Footprint& footprint, TexelRequests* texels) const {
  const float cutoff = alpha_cutoff(triangle);
  CutoutPatch patch{.is_share = true, .part = 1.0f};
  if (cutoff <= 0.0f) return patch;
  if (is_program(triangle)) {
    patch.part = alpha(triangle, place, footprint, texels);
    return patch;
  }
  const TestedAlpha* tested = nullptr;
  glm::vec4 shares;
  const float factor = alpha_there(
      triangle, place, footprint, [&](const Texture& texture, const glm::vec2& uv, const TextureSlopes& slopes) {
        const MipChain& chain = textures_->chain(texture.image, ColorSpace::srgb);
        if (filter_plan(chain, texture, slopes).is_minified) {
          const std::uint32_t material = triangles_.surfaces[triangle].material;
          tested = &textures_->tested_alpha(material);
          shares = filtered(tested->shares, texture, uv, footprint_plan(tested->shares, texture, slopes, 1),
                            noting(texels, texture.image, ColorSpace::linear, textures_->alpha_test(material)));
          return 1.0f;
        }
        patch.is_share = false, patch.is_nearest = texture.magnify == Filter::nearest;
        const TexelQuad quad = texels_around(chain, texture, 0, uv, noting(texels, texture.image, ColorSpace::srgb));
        for (std::size_t i = 0; i < 4; ++i) patch.alphas[i] = quad.texels[i].a;
        const glm::vec2 size(chain.levels[0].width, chain.levels[0].height);
        patch.share = {quad.columns.share, quad.rows.share};
        patch.right = slopes.dx * size / footprint.xx, patch.down = slopes.dy * size / footprint.yy;
        return 1.0f;
      });
  if (tested) {
    patch.part = tested->share(shares, cutoff / factor);
  } else if (patch.is_share) {  // without a texture
    patch.part = factor >= cutoff ? 1.0f : 0.0f;
  }
  patch.factor = factor;
  return patch;
}

CutoutCover SurfaceShader::tested_cover(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                                        TexelRequests* texels) const {
  if (is_program(triangle)) return CutoutCover::mixed;
  const std::uint32_t material = triangles_.surfaces[triangle].material;
  if (textures_ == nullptr || textures_->alpha_test(material) == kNoAlphaTest || inputs_of(triangle).has_vertex_colors)
    return CutoutCover::mixed;
  CutoutCover cover = CutoutCover::mixed;
  alpha_there(triangle, place, footprint,
              [&](const Texture& texture, const glm::vec2& uv, const TextureSlopes& slopes) {
                const TestedAlpha& tested = textures_->tested_alpha(material);
                const CoveringLevel covering = covering_level(tested.shares, slopes);
                if (!(covering.side <= 1)) return 1.0f;
                const TexelQuad quad =
                    texels_around(tested.shares, texture, covering.level, uv,
                                  noting(texels, texture.image, ColorSpace::linear, textures_->alpha_test(material)));
                const auto are_all = [&](float share) {
                  return std::ranges::all_of(quad.texels, [&](const glm::vec4& shares) { return shares[0] == share; });
                };
                cover = are_all(1.0f) ? CutoutCover::all : are_all(0.0f) ? CutoutCover::none : CutoutCover::mixed;
                return 1.0f;
              });
  return cover;
}

// Invocations of one shader, which wait until there are enough of them.
struct SurfaceShader::Batch {
  std::size_t work;  // index into works_
  std::vector<Invocation> invocations;
  std::vector<std::size_t> places;  // of what is found
};

// Sorts invocations into batches. run(batch): of at most kMostPoints.
template <class Run>
class SurfaceShader::Batches {
 public:
  Batches(const SurfaceShader& shader, Run run) : shader_(shader), run_(std::move(run)) {}

  void add(const Invocation& invocation, std::size_t place) {
    if (invocation.triangle != last_triangle_) find_batch(invocation.triangle);
    Batch& batch = batches_[current_];
    batch.invocations.push_back(invocation);
    batch.places.push_back(place);
    if (batch.places.size() == kMostPoints) finish(batch);
  }

  // Those that still wait.
  void finish() {
    for (Batch& batch : batches_)
      if (!batch.places.empty()) finish(batch);
  }

 private:
  void find_batch(std::uint32_t triangle) {
    last_triangle_ = triangle;
    const std::size_t work = work_index(shader_.triangles_.surfaces[triangle].material, shader_.inputs_of(triangle));
    if (current_ < batches_.size() && batches_[current_].work == work) return;
    current_ = 0;
    while (current_ < batches_.size() && batches_[current_].work != work) ++current_;
    if (current_ == batches_.size()) batches_.push_back({work, {}, {}});
  }

  void finish(Batch& batch) {
    run_(batch);
    batch.invocations.clear();
    batch.places.clear();
  }

  const SurfaceShader& shader_;
  Run run_;
  std::vector<Batch> batches_;
  std::size_t current_ = 0;  // most invocations have the triangle or the shader of the one before
  std::uint32_t last_triangle_ = ~0u;
};

SurfaceShader::AreaTexel SurfaceShader::area_texel(TextureRole role, const Texture& texture, const Material& material,
                                                   const glm::vec2& uv, const TextureSlopes& slopes,
                                                   TexelRequests* texels) const {
  const ColorSpace space = space_of(role);
  const MipChain& chain = textures_->chain(texture.image, space);
  const CoveringLevel covering = covering_level(chain, slopes);
  const TexelQuad quad = texels_around(chain, texture, covering.level, uv, noting(texels, texture.image, space));
  const auto& all = quad.texels;
  const glm::vec4 least = glm::min(glm::min(all[0], all[1]), glm::min(all[2], all[3])),
                  most = glm::max(glm::max(all[0], all[1]), glm::max(all[2], all[3]));
  const glm::vec4 mean = (all[0] + all[1] + all[2] + all[3]) * 0.25f;
  if (role == TextureRole::metallic_roughness) return {{mean.r, least.g, most.b, 1.0f}};
  // What four texels span, they span over a length of one texel. A texel of several is the shorter the more they
  // differ.
  const glm::vec2 span = (glm::vec2(most) - glm::vec2(least)) * std::min(covering.side, 1.0f);
  AreaTexel found{{mean.r, mean.g, mean.b, 0.0f}, std::abs(material.normal_scale) * glm::length(span)};
  if (covering.level > 0) {
    const float mean_length = std::min(glm::length(glm::vec3(mean) * 2.0f - 1.0f), 1.0f);
    found.around_within_texels = std::sqrt(2.0f * (1.0f - mean_length));
  }
  return found;
}

AreaInputs<float> SurfaceShader::find_area(const Invocation& invocation, TexelRequests* texels) const {
  const ShaderInputs shader = inputs_of(invocation.triangle);
  AreaInputs<float> area{};
  std::array<TexturePlace<float>, 2> places;
  with_point(triangles_, point_rules(), invocation, [&](const auto& point) {
    point.set_inputs(shader, area.middle);
    for (std::size_t set = 0; set < 2; ++set)
      if (reads(shader.material, set, is_of_area)) places[set] = point.place(set);
  });
  const auto beside = [&](const Invocation& there, Triple<float>& to_eye, Triple<float>& normal) {
    PointInputs<float> inputs{};
    with_point(triangles_, point_rules(), there,
               [&](const auto& point) { point.set_inputs(directions_alone(shader), inputs); });
    to_eye = inputs.to_eye, normal = inputs.normal;
  };
  beside(right_of(invocation), area.right_to_eye, area.right_normal);
  beside(below(invocation), area.below_to_eye, area.below_normal);
  for_each_texture<float>(shader.material, [&](TextureRole role, const Texture& texture, auto texel) {
    const TexturePlace<float>& at = places[texture.uv_set];
    const AreaTexel found = is_of_area(role)
                                ? area_texel(role, texture, shader.material, vector_of(at.uv), slopes_of(at), texels)
                                : AreaTexel{};
    area.middle.*texel = found.texel;
    if (role == TextureRole::normal)
      area.around_of_texels = found.around_of_texels, area.around_within_texels = found.around_within_texels;
  });
  return area;
}

void SurfaceShader::find_areas(std::span<const Invocation> invocations, TexelRequests* texels,
                               AreaInputs<PointColumn>& areas) const {
  const ShaderInputs shader = inputs_of(invocations[0].triangle);
  std::array<TexturePoints, 2> points;
  find_points(triangles_, shader, point_rules(), invocations, &areas.middle,
              {reads(shader.material, 0, is_of_area) ? &points[0] : nullptr,
               reads(shader.material, 1, is_of_area) ? &points[1] : nullptr});
  PointInputs<PointColumn> inputs;
  const auto beside = [&](auto there, std::array<PointColumn, 3>& to_eye, std::array<PointColumn, 3>& normal) {
    std::array<Invocation, kMostPoints> moved;
    for (std::size_t i = 0; i < invocations.size(); ++i) moved[i] = there(invocations[i]);
    find_points(triangles_, directions_alone(shader), point_rules(), std::span(moved).first(invocations.size()),
                &inputs, {});
    to_eye = inputs.to_eye, normal = inputs.normal;
  };
  beside(right_of, areas.right_to_eye, areas.right_normal);
  beside(below, areas.below_to_eye, areas.below_normal);
  areas.around_of_texels.fill(0.0f), areas.around_within_texels.fill(0.0f);
  for_each_texture<PointColumn>(shader.material, [&](TextureRole role, const Texture& texture, auto texel) {
    const TexturePoints& at = points[texture.uv_set];
    if (!is_of_area(role)) {
      for (PointColumn& column : areas.middle.*texel) column.fill(1.0f);
      return;
    }
    for (std::size_t i = 0; i < invocations.size(); ++i) {
      const AreaTexel found = area_texel(role, texture, shader.material, uv_of(at, i), slopes_of(at, i), texels);
      set_row(areas.middle.*texel, i, found.texel);
      if (role != TextureRole::normal) continue;
      areas.around_of_texels[i] = found.around_of_texels, areas.around_within_texels[i] = found.around_within_texels;
    }
  });
}

float SurfaceShader::light_range(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                                 TexelRequests* texels) const {
  if (!may_vary(triangle)) return 0.0f;
  return beampipe::light_range(inputs_of(triangle), find_area({triangle, place, footprint}, texels), frame_.lighting);
}

std::vector<float> SurfaceShader::light_ranges(const std::vector<Invocation>& invocations,
                                               TexelRequests* texels) const {
  std::vector<float> ranges(invocations.size());
  AreaInputs<PointColumn> areas;
  PointColumn found;
  Batches batches(*this, [&](const Batch& batch) {
    const std::size_t count = batch.invocations.size();
    find_areas(batch.invocations, texels, areas);
    beampipe::light_ranges(inputs_of(batch.invocations[0].triangle), frame_.lighting, areas, count, found.data());
    for (std::size_t i = 0; i < count; ++i) ranges[batch.places[i]] = found[i];
  });
  for (std::size_t i = 0; i < invocations.size(); ++i)
    if (may_vary(invocations[i].triangle)) batches.add(invocations[i], i);
  batches.finish();
  return ranges;
}

// Texture coordinates and vertex alphas are quotients of linear functions. As long as the divisor is positive, they are
// largest and smallest at corners.
CutoutCover SurfaceShader::cutout_cover(std::uint32_t triangle, const ShadingPlace& corner, float side) const {
  constexpr float kRounding = 1e-5f;  // of the filter and of products, generously
  if (is_program(triangle)) {
    // Nothing is known of a square but its middle, which stands for small ones.
    constexpr float kSmall = 1.0f / 16;
    if (side > kSmall) return CutoutCover::mixed;
    const ShadingPlace middle{corner.x, corner.y, corner.u + 0.5f * side, corner.v + 0.5f * side};
    return alpha(triangle, middle, side) > 0.0f ? CutoutCover::all : CutoutCover::none;
  }
  const SetupSurface& surface = triangles_.surfaces[triangle];
  for (const std::uint32_t vertex : surface.vertices)
    if (!(triangles_.vertices[vertex].color[3] <= 1.0f)) return CutoutCover::mixed;
  if (!(material(triangle).base_color.a <= 1.0f)) return CutoutCover::mixed;
  const Texture* texture = nullptr;
  glm::vec2 low(0.0f), high(0.0f);
  AlphaRange factor{1, 0};  // of all but the texture
  for (int i = 0; i < 4; ++i) {
    const ShadingPlace place{corner.x, corner.y, corner.u + (i % 2 == 0 ? 0 : side), corner.v + (i < 2 ? 0 : side)};
    const float x = static_cast<float>(place.x) + place.u - surface.anchor_x,
                y = static_cast<float>(place.y) + place.v - surface.anchor_y;
    const Barycentrics<float> weights = weights_at(surface.planes, x, y);
    const auto is_limited = [](float weight) { return !(weight > -kMostWeight && weight < 1 + kMostWeight); };
    if (!(value_at(surface.planes.inverse_w, x, y) > 0) || is_limited(weights.second) || is_limited(weights.third))
      return CutoutCover::mixed;
    const float alpha =
        alpha_there(triangle, place, 0.0f, [&](const Texture& of, const glm::vec2& uv, const TextureSlopes&) {
          low = texture ? glm::min(low, uv) : uv;
          high = texture ? glm::max(high, uv) : uv;
          texture = &of;
          return 1.0f;
        });
    factor = {std::min(factor.least, alpha), std::max(factor.most, alpha)};
  }
  AlphaRange of_texture;
  if (texture) {
    const std::optional<AlphaRange> found =
        alpha_range(textures_->chain(texture->image, ColorSpace::srgb), *texture, low, high);
    if (!found) return CutoutCover::mixed;
    of_texture = *found;
  }
  const float cutoff = alpha_cutoff(triangle);
  if (factor.least * of_texture.least * (1 - kRounding) >= cutoff) return CutoutCover::all;
  return factor.most * of_texture.most * (1 + kRounding) < cutoff ? CutoutCover::none : CutoutCover::mixed;
}

SurfaceShader::FilteredTexture SurfaceShader::filtered_texture(TextureRole role, const Texture& texture) const {
  const int taps = rules_.colors == SurfaceColors::by_pixel ? 0 : rules_.texture_taps;
  const ColorSpace space = space_of(role);
  return {role, filtered_by(texture, taps), space, textures_->chain(texture.image, space), taps};
}

FilterPlan SurfaceShader::FilteredTexture::plan(const TextureSlopes& slopes, float lod) const {
  return taps > 0 ? footprint_plan(chain, texture, slopes, taps) : filter_plan(chain, texture, slopes, lod);
}

std::array<float, 4> SurfaceShader::FilteredTexture::texel(const glm::vec4& value, const FilterPlan& plan) const {
  return {value.r, value.g, value.b, role != TextureRole::normal ? value.a : plan.is_minified ? 1.0f : 0.0f};
}

void SurfaceShader::find_input(const Invocation& invocation, TexelRequests* texels, PointInputs<float>* inputs) const {
  const ShaderInputs shader = inputs_of(invocation.triangle);
  std::array<TexturePlace<float>, 2> places;
  with_point(triangles_, point_rules(), invocation, [&](const auto& point) {
    if (inputs) point.set_inputs(shader, *inputs);
    for (std::size_t set = 0; set < 2; ++set)
      if (reads(shader.material, set, is_any)) places[set] = point.place(set);
  });
  const bool is_kept = texels && texels->are_kept();
  for_each_texture<float>(shader.material, [&](TextureRole role, const Texture& given, auto texel) {
    const FilteredTexture texture = filtered_texture(role, given);
    const TexturePlace<float>& at = places[given.uv_set];
    const FilterPlan plan = texture.plan(slopes_of(at), level_of_detail(slopes_of(at), texture.chain.levels[0]));
    if (texels && !is_kept) texels->count(plan.texels());
    if (!inputs && !is_kept) return;
    const glm::vec4 value = filtered(texture.chain, texture.texture, vector_of(at.uv), plan,
                                     noting(is_kept ? texels : nullptr, given.image, texture.space));
    if (inputs) inputs->*texel = texture.texel(value, plan);
  });
}

void SurfaceShader::find_inputs(std::span<const Invocation> invocations, TexelRequests* texels,
                                PointInputs<PointColumn>* inputs) const {
  const ShaderInputs shader = inputs_of(invocations[0].triangle);
  std::array<TexturePoints, 2> points;  // by set of texture coordinates
  find_points(triangles_, shader, point_rules(), invocations, inputs,
              {reads(shader.material, 0, is_any) ? &points[0] : nullptr,
               reads(shader.material, 1, is_any) ? &points[1] : nullptr});
  for_each_texture<PointColumn>(shader.material, [&](TextureRole role, const Texture& given, auto texel) {
    const FilteredTexture texture = filtered_texture(role, given);
    const TexturePoints& at = points[given.uv_set];
    PointColumn lods;
    for (std::size_t i = 0; i < invocations.size(); ++i)
      lods[i] = squared_footprint(slopes_of(at, i), texture.chain.levels[0]);
    for (std::size_t i = 0; i < invocations.size(); ++i) lods[i] = level_of_detail(lods[i]);
    if (!inputs) {
      for (std::size_t i = 0; i < invocations.size(); ++i)
        texels->count(texture.plan(slopes_of(at, i), lods[i]).texels());
      return;
    }
    std::array<FilterPlan, kMostPoints> plans;
    for (std::size_t i = 0; i < invocations.size(); ++i) {
      // Made where it stays: a copy of what was just written in parts would wait for them, 6 % of a frame of msaa:8.
      ::new (&plans[i]) FilterPlan(texture.plan(slopes_of(at, i), lods[i]));
      if (texels) texels->count(plans[i].texels());
    }
    std::array<glm::vec2, kMostPoints> uvs;
    std::array<glm::vec4, kMostPoints> values;
    for (std::size_t i = 0; i < invocations.size(); ++i) uvs[i] = uv_of(at, i);
    filter_side_by_side(texture.chain, texture.texture, std::span(uvs).first(invocations.size()), plans, values.data());
    for (std::size_t i = 0; i < invocations.size(); ++i) set_row(inputs->*texel, i, texture.texel(values[i], plans[i]));
  });
}

glm::vec4 SurfaceShader::shaded(const Invocation& invocation, TexelRequests* texels) const {
  const std::uint32_t triangle = invocation.triangle;
  if (is_program(triangle)) return with_limited_alpha(run_program(program_place(invocation, true), texels));
  PointInputs<float> inputs;
  find_input(invocation, texels, &inputs);
  return lit(invocation, inputs);
}

glm::vec4 SurfaceShader::lit(const Invocation& invocation, const PointInputs<float>& inputs) const {
  const Material& material = this->material(invocation.triangle);
  SurfaceMaterial<float> found = material_of(inputs_of(invocation.triangle), inputs);
  if (is_stored(material)) found.reflector = through_gbuffer(found.reflector);
  const Triple<float> color = lit_color(material, found, frame_.lighting);
  return as_stored(invocation, {color[0], color[1], color[2], found.alpha});
}

glm::vec4 SurfaceShader::as_stored(const Invocation& invocation, const glm::vec4& lit) const {
  const std::uint32_t triangle = invocation.triangle;
  glm::vec3 color = stored_color(glm::vec3(lit));
  round_to(rules_.stored_as, color);
  if (material(triangle).alpha_mode == AlphaMode::opaque) return {color, 1.0f};
  return {color, rules_.colors == SurfaceColors::by_pixel ? alpha(triangle, invocation.place, invocation.footprint)
                                                          : limited_alpha(lit.a)};
}

std::vector<glm::vec4> SurfaceShader::colors_and_alphas(const std::vector<Invocation>& invocations,
                                                        TexelRequests* texels) const {
  std::vector<glm::vec4> colors(invocations.size());
  PointInputs<PointColumn> inputs;
  std::array<glm::vec4, kMostPoints> found;
  Batches batches(*this, [&](const Batch& batch) {
    const std::size_t count = batch.invocations.size();
    const std::uint32_t first = batch.invocations[0].triangle;
    find_inputs(batch.invocations, texels, &inputs);
    if (is_stored(material(first))) {
      for (std::size_t i = 0; i < count; ++i) colors[batch.places[i]] = lit(batch.invocations[i], row(inputs, i));
      return;
    }
    lit_colors(inputs_of(first), frame_.lighting, inputs, count, found.data());
    for (std::size_t i = 0; i < count; ++i) colors[batch.places[i]] = as_stored(batch.invocations[i], found[i]);
  });
  const bool is_kept = texels && texels->are_kept();  // requests are kept in order
  std::vector<std::size_t> of_programs;               // numbers of invocations
  for (std::size_t i = 0; i < invocations.size(); ++i) {
    const Invocation& invocation = invocations[i];
    if (is_flat(invocation.triangle)) {
      colors[i] = glm::vec4(flat_[invocation.triangle], 1.0f);
    } else if (is_program(invocation.triangle)) {
      of_programs.push_back(i);
    } else if (is_kept) {
      colors[i] = shaded(invocation, texels);
      end_request(texels);
    } else {
      batches.add(invocation, i);
    }
  }
  batches.finish();
  for_each_draw(invocations, of_programs,
                [&](const std::vector<ProgramPlace>& places, const std::vector<std::size_t>& numbers) {
                  std::vector<glm::vec4> of_draw(places.size());
                  run_programs(places, of_draw.data(), texels);
                  for (std::size_t k = 0; k < numbers.size(); ++k) colors[numbers[k]] = with_limited_alpha(of_draw[k]);
                });
  return colors;
}

std::vector<glm::vec4> SurfaceShader::colors_alone(const std::vector<Invocation>& invocations,
                                                   TexelRequests* texels) const {
  const auto runs_program = [&](const Invocation& invocation) {
    return !is_flat(invocation.triangle) && is_program(invocation.triangle);
  };
  if (!(texels && texels->are_kept()) && std::ranges::none_of(invocations, runs_program))
    return colors_and_alphas(invocations, texels);
  std::vector<glm::vec4> colors;
  colors.reserve(invocations.size());
  for (const Invocation& invocation : invocations) {
    colors.push_back(is_flat(invocation.triangle) ? glm::vec4(flat_[invocation.triangle], 1.0f)
                                                  : shaded(invocation, texels));
    end_request(texels);
  }
  return colors;
}

void SurfaceShader::add_texels(std::uint32_t triangle, const ShadingPlace& place, const Footprint& footprint,
                               TexelRequests& texels) const {
  if (is_flat(triangle)) return;
  if (is_program(triangle)) {
    add_program_texels({{triangle, place, footprint}}, texels);
    return;
  }
  find_input({triangle, place, footprint}, &texels, nullptr);
}

void SurfaceShader::count_texels(const std::vector<Invocation>& invocations, TexelRequests& texels) const {
  Batches batches(*this, [&](const Batch& batch) { find_inputs(batch.invocations, &texels, nullptr); });
  for (const Invocation& invocation : invocations)
    if (!is_flat(invocation.triangle)) batches.add(invocation, 0);
  batches.finish();
}

}  // namespace beampipe
