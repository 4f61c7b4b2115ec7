// Cases that are hard on shading: texture coordinates, textures, alpha and light at the ends of their ranges. No exact
// picture is known for most of them, but what their pictures may hold follows from the textures and lights.
#include <cmath>
#include <limits>

#include "tools/stress/case_parts.h"
#include "traces/size_text.h"

namespace beampipe {
namespace {

constexpr std::uint8_t kDark = 40, kBright = 220;  // codes of the textures' channels

// Random codes from kDark to kBright, without a pattern that a filter could meet; alpha is 255.
TextureImage noise(std::uint32_t width, std::uint32_t height) {
  TextureImage image{.name = "noise", .width = width, .height = height, .texels = {}};
  std::uint32_t state = 1;
  const auto code = [&] {
    state = state * 1664525u + 1013904223u;
    return static_cast<std::uint8_t>(kDark + (state >> 16) % (kBright - kDark + 1u));
  };
  for (std::size_t i = 0; i < std::size_t{width} * height; ++i) {
    const std::uint8_t r = code(), g = code(), b = code();
    image.texels.emplace_back(r, g, b, 255);
  }
  return image;
}

double linear(std::uint8_t code) { return std::pow((code / 255.0 + 0.055) / 1.055, 2.4); }

// A surface that is unlit shows the colours of its texture and nothing else.
ColorBounds bounds_of_noise() { return {glm::dvec3(linear(kDark)), glm::dvec3(linear(kBright))}; }

Material unlit_material() {
  Material material;
  material.name = "surface";
  material.unlit = material.double_sided = true;
  return material;
}

// Gives all triangles of the trace a material.
Trace with_material(Trace trace, const Material& material) {
  trace.materials = {material};
  trace.meshes[0].materials.assign(trace.meshes[0].triangles.size(), 0);
  return trace;
}

// Gives all triangles an unlit texture. uv(position): of a vertex.
template <class Uv>
Trace with_texture(Trace trace, TextureImage image, Texture texture, Uv&& uv) {
  Material material = unlit_material();
  material.base_texture = texture;
  trace = with_material(std::move(trace), material);
  trace.images = {std::move(image)};
  for (const glm::vec3& position : trace.meshes[0].positions) trace.meshes[0].uvs[0].push_back(uv(position));
  return trace;
}

HardCase within_noise(const std::string& name, const std::string& what, Trace trace) {
  HardCase result{name, what, std::move(trace), {}, full_masks()};
  result.between = bounds_of_noise();
  result.limits[ErrorSource::published_merges] = {0.04, kOver};
  result.limits[ErrorSource::independent_fragments] = {0.25, kOver};
  return result;
}

HardCase uv_near_plane() {
  const auto steep = [](const glm::vec3& p) { return glm::vec2(1000 * p.x + 500 * p.z, 1000 * p.y - 700 * p.z); };
  return within_noise("uv_near_plane", "steep texture coordinates where w is nearly 0",
                      with_texture(perspective(0.0001, 100,
                                               {{{{-0.5f, -0.5f, -2.0f}, {0.6f, -0.4f, -2.0f}, {0.1f, 0.8f, 1.5f}}},
                                                {{{-3.0f, 1.0f, -4.0f}, {3.0f, 1.0f, -4.0f}, {0.0f, 1.0f, 0.0f}}},
                                                {{{-1.0f, -1.0f, 1.0f}, {1.0f, -1.0f, 1.0f}, {0.0f, -1e-5f, -0.3f}}}}),
                                   noise(64, 64), {}, steep));
}

// A normal map on such a triangle has no direction of u.
HardCase uv_degenerate() {
  Screen screen(16, 16);
  screen.triangle({0.3, 0.2}, {15.8, 0.4}, {7.9, 5.1}, 0.5, kRed);   // all equal
  screen.triangle({0.3, 5.2}, {15.8, 5.4}, {7.9, 10.1}, 0.5, kRed);  // on a line
  screen.triangle({0.3, 10.2}, {15.8, 10.4}, {7.9, 15.9}, 0.5, kRed);
  HardCase result = within_noise("uv_degenerate", "texture coordinates without an area, under a normal map", {});
  result.trace = with_texture(screen.trace(), noise(64, 64), {}, [](const glm::vec3& p) {
    return p.y < 5.15f ? glm::vec2(0.3f, 0.6f) : p.y < 10.15f ? glm::vec2(p.x, 2 * p.x) : glm::vec2(1e-20f * p.x, p.y);
  });
  Material& material = result.trace.materials[0];
  material.normal_texture = material.base_texture;
  material.unlit = false;
  material.roughness = 1;
  result.trace.frames[0].lighting.ambient = Ambient{glm::vec3(1.0f), glm::vec3(1.0f)};
  // All around, there is a light of 1. A dielectric mirrors the part 0.04 of it, and reflects the base colour's part of
  // the rest.
  result.between = ColorBounds{glm::dvec3(0.04 + 0.96 * linear(kDark)), glm::dvec3(0.04 + 0.96 * linear(kBright))};
  return result;
}

// A floor to the horizon, on which a pixel covers millions of texels.
Trace floor_trace(float below) {
  return perspective(0.01 * below, 1e6, {{{{-1e6f, -below, 1.0f}, {1e6f, -below, 1.0f}, {0.0f, -below, -1e6f}}}});
}

HardCase minification() {
  return within_noise("minification", "a texture of 1 x 4096 texels, repeated a million times per unit",
                      with_texture(floor_trace(1.0f), noise(1, 4096), {},
                                   [](const glm::vec3& p) { return glm::vec2(1e6f * p.x, 1e6f * p.z); }));
}

HardCase grazing_texture() {
  return within_noise("grazing_texture", "an anisotropic texture on a plane that passes the eye at 10^-4 units",
                      with_texture(floor_trace(1e-4f), noise(256, 256), {.anisotropy = 16},
                                   [](const glm::vec3& p) { return glm::vec2(p.x, p.z); }));
}

HardCase widest_texture(std::uint32_t width, std::uint32_t height, const std::string& name) {
  Screen screen(16, 16);
  screen.triangle({-3.3, 0.2}, {25.8, 2.4}, {7.9, 25.1}, 0.5, kRed);
  return within_noise(name, "a texture of " + size_text(width, height) + " texels",
                      with_texture(screen.trace(), noise(width, height), {.wrap_u = Wrap::mirror},
                                   [](const glm::vec3& p) { return glm::vec2(p.x / 16, p.y / 16); }));
}

// A triangle in front of another one. `front`: whether it is there.
Screen two_triangles(bool front) {
  Screen screen(16, 16);
  screen.triangle({-3.3, 1.2}, {25.8, -2.4}, {7.9, 25.1}, 0.75, kBlue);
  if (front) screen.triangle({1.3, 3.2}, {14.8, 0.4}, {6.9, 15.1}, 0.25, kRed);
  return screen;
}

// Gives the front triangle of two_triangles() a material in a draw of its own. Without one, it is left out.
Trace front_with(const std::optional<Material>& material) {
  Trace trace = two_triangles(material.has_value()).trace();
  if (!material) return trace;
  trace.materials = {*material};
  trace.meshes[0].materials = {kNoMaterial, 0};
  return trace;
}

Material front_material(AlphaMode mode, float alpha) {
  Material material = unlit_material();
  material.base_color = glm::vec4(kRed, alpha);
  material.alpha_mode = mode;
  return material;
}

HardCase equal(const std::string& name, const std::string& what, Trace trace, Trace same) {
  HardCase result{name, what, std::move(trace), {}, {}};
  result.equals = std::move(same);
  return result;
}

// Half of the largest step between two codes of sRGB, which is that to white.
constexpr double kHalfCode = 2.4 / 1.055 / 255 / 2;

HardCase with_opacity(float alpha, const std::string& name, const std::string& what) {
  const bool is_there = alpha > 0;
  HardCase result = equal(name, what, front_with(front_material(AlphaMode::blend, alpha)),
                          front_with(is_there ? std::optional(front_material(AlphaMode::opaque, 1)) : std::nullopt));
  // Two roundings where the triangle is opaque and counts as a share, and one below it where it is translucent.
  if (is_there) {
    result.limits[ErrorSource::sums_in_unorm8] = {3 * kUnorm8Error, "sums are rounded to 8 bits"};
    result.limits[ErrorSource::one_translucent_sample] = {[](int samples) { return 1 - 1.0 / samples; },
                                                          "one sample stands for all others at edges"};
  }
  return result;
}

HardCase cutoff(float alpha, float least, const std::string& name, const std::string& what) {
  const bool is_there = alpha >= least;
  Material material = front_material(AlphaMode::mask, alpha);
  material.alpha_cutoff = least;
  HardCase result = equal(name, what, front_with(material),
                          front_with(is_there ? std::optional(front_material(AlphaMode::opaque, 1)) : std::nullopt));
  if (is_there)
    result.limits[ErrorSource::gbuffer_of_8_bits] = {kHalfCode,
                                                     "a G-buffer keeps the colours of cutouts in 8 bits as sRGB"};
  return result;
}

// Texels of 4 x 4 pixels whose alpha is exactly the cutoff, or one code below it.
HardCase texture_at_cutoff(bool below) {
  constexpr std::uint8_t kCode = 128;
  const auto trace = [&](AlphaMode mode) {
    Screen screen(16, 16);
    screen.triangle({1.3, 3.2}, {14.8, 0.4}, {6.9, 15.1}, 0.25, kRed);
    TextureImage image = noise(4, 4);
    for (glm::u8vec4& texel : image.texels) texel.a = below ? kCode - 1 : kCode;
    const Texture texture{.magnify = Filter::nearest, .minify = Filter::nearest, .mip = MipFilter::none};
    Trace result =
        with_texture(screen.trace(), image, texture, [](const glm::vec3& p) { return glm::vec2(p.x, p.y) / 16.0f; });
    result.materials[0].alpha_mode = mode;
    result.materials[0].alpha_cutoff = static_cast<float>(kCode) / 255.0f;
    return result;
  };
  Trace same = trace(AlphaMode::opaque);
  if (below) same.frames[0].draws.clear();
  return equal(below ? "texture_below_cutoff" : "texture_at_cutoff",
               below ? "a texture whose alpha is one code below the cutoff" : "a texture whose alpha is the cutoff",
               trace(AlphaMode::mask), std::move(same));
}

constexpr const char* kPositions = "opacity is rounded to mask positions, of which deep layers have few left";

glm::vec3 color_of_layer(int i) { return i % 2 ? kRed : kGreen; }

HardCase layers() {
  constexpr int kLayers = 64;
  Screen screen(kLayers, 2);
  for (int i = 0; i < kLayers; ++i)  // each covers everything to the right of x = i
    screen.triangle({i, -kLayers}, {i, kLayers + 2}, {3 * kLayers, 1}, 0.9 - 0.8 * i / kLayers, color_of_layer(i));
  HardCase result{"layers", "1 to 64 translucent layers in a pixel, from far to near", {}, {}, {}};
  result.trace = screen.trace();
  for (int i = 0; i < 2; ++i) {
    Material& material = result.trace.materials.emplace_back(front_material(AlphaMode::blend, 0.5f));
    material.name = i ? "red" : "green";
    material.base_color = glm::vec4(color_of_layer(i), 0.5f);
  }
  for (std::uint32_t i = 0; i < kLayers; ++i) result.trace.meshes[0].materials.push_back(i % 2);
  // Measured: with 32 positions up to 0.104, and with four times as many a quarter of that.
  constexpr double kFew = 0.105;
  result.limits = mask_limits(kFew / 4, kPositions);
  for (const ErrorSource source : {ErrorSource::merges_of_layers, ErrorSource::published_merges})
    result.limits[source] = {kFew, kPositions};
  // Eight layers in a row leave one of 256 positions, which may show any of the other colours.
  const auto last_position = [](int positions) { return positions < 256 ? kFew : 0.875 / 256 + kFp16Error; };
  result.limits[ErrorSource::estimated_areas] = {last_position, kPositions};
  ExactPicture& picture = result.picture.emplace();
  picture.high = {kLayers, 2};
  picture.rgba.resize(2 * kLayers);
  glm::dvec4 over(glm::dvec3(kBackground), 0);
  for (std::size_t i = 0; i < kLayers; ++i) {
    over = 0.5 * glm::dvec4(glm::dvec3(color_of_layer(static_cast<int>(i))), 1) + 0.5 * over;
    picture.rgba[i] = picture.rgba[kLayers + i] = over;
  }
  return result;
}

// Colours must be finite. They may be negative, as a base colour above 1 reflects more light than there is.
HardCase largest_numbers() {
  HardCase result{"largest_numbers", "light, colours and normals at the ends of their ranges", {}, {}, {}};
  result.trace =
      with_texture(floor_trace(1.0f), noise(16, 16), {}, [](const glm::vec3& p) { return glm::vec2(p.x, p.z); });
  Mesh& mesh = result.trace.meshes[0];
  mesh.vertex_colors.assign(mesh.positions.size(), glm::vec4(glm::vec3(kMostColor), 1));
  mesh.vertex_colors[0] = glm::vec4(0, 0, 0, 1);
  Material& material = result.trace.materials[0];
  material.unlit = false;
  material.normal_texture = material.base_texture;
  material.normal_scale = kMostNormalScale;
  material.base_color = glm::vec4(glm::vec3(kMostColor), 1);
  material.emissive = glm::vec3(kMostColor);
  material.roughness = 0, material.metallic = 0.5f;
  Lighting& lighting = result.trace.frames[0].lighting;
  lighting.lights.assign(kMostLights, {glm::normalize(glm::vec3(0.1f, -1, -0.2f)), glm::vec3(kMostColor)});
  lighting.ambient = Ambient{glm::vec3(kMostColor), glm::vec3(0)};
  for (const ErrorSource source : {ErrorSource::published_merges, ErrorSource::independent_fragments})
    result.limits[source] = {0.04, kOver};
  const double infinity = std::numeric_limits<double>::infinity();
  result.between = ColorBounds{glm::dvec3(-infinity), glm::dvec3(infinity)};
  return result;
}

}  // namespace

std::vector<HardCase> surface_cases() {
  const float half = 0.5f;
  return {uv_near_plane(),
          uv_degenerate(),
          minification(),
          grazing_texture(),
          widest_texture(16384, 1, "widest_texture"),
          widest_texture(1, 16384, "highest_texture"),
          cutoff(half, half, "alpha_at_cutoff", "alpha that is exactly the cutoff, which is there"),
          cutoff(std::nextafter(half, 0.0f), half, "alpha_below_cutoff", "alpha just below the cutoff, which is not"),
          texture_at_cutoff(false),
          texture_at_cutoff(true),
          with_opacity(0, "opacity_0", "a translucent triangle of opacity 0, which changes nothing"),
          with_opacity(1, "opacity_1", "a translucent triangle of opacity 1, which is opaque"),
          layers(),
          largest_numbers()};
}

}  // namespace beampipe
