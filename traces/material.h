// What surfaces are made of: glTF 2.0's metallic-roughness model, with its textures.
//
// Source: Khronos Group, glTF 2.0 Specification, sections 3.8 (textures), 3.9 (materials) and appendix B (BRDF).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace beampipe {

// The most that a colour or a light has in each channel: the largest fp16 number. Products of such numbers, which are
// what shading adds up, stay far below the largest float.
inline constexpr float kMostColor = 65504.0f;

// Of the magnitude of Material::normal_scale. At this scale a normal that leans by one code of 8 bits lies flat.
inline constexpr float kMostNormalScale = 1000.0f;

// 8 bits per channel as stored: base colours and emission are encoded as sRGB, everything else is linear, and alpha is
// always linear. Row 0 is on top. The texture coordinate (0, 0) is the upper left corner of the upper left texel.
struct TextureImage {
  std::string name;
  std::uint32_t width = 0, height = 0;  // texels, each 1..16384
  std::vector<glm::u8vec4> texels;      // RGBA, row by row
};

enum class Wrap { repeat, clamp, mirror };
enum class Filter { nearest, linear };
enum class MipFilter { none, nearest, linear };  // none: always the image itself; linear: trilinear filtering

struct Texture {
  std::uint32_t image = 0;   // index into Trace::images
  std::uint32_t uv_set = 0;  // 0 or 1
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  Filter magnify = Filter::linear, minify = Filter::linear;
  MipFilter mip = MipFilter::linear;
  // At most so many probes along the longer side of a pixel's footprint; 1..16. Only with MipFilter::linear.
  std::uint32_t anisotropy = 1;

  bool operator==(const Texture&) const = default;
};

// opaque: alpha is ignored. mask: the surface is there where alpha is at least the cutoff. blend: alpha is opacity.
enum class AlphaMode { opaque, mask, blend };

struct Material {
  std::string name;
  glm::vec4 base_color{1.0f};  // linear RGB 0..kMostColor and alpha 0..1; times the texture and the vertices'
  std::optional<Texture> base_texture{};                // sRGB, with alpha
  float metallic = 0, roughness = 1;                    // 0..1
  std::optional<Texture> metallic_roughness_texture{};  // linear: roughness in G, metallic in B
  std::optional<Texture> normal_texture{};              // linear: tangent space, 0..255 for -1..1
  float normal_scale = 1;                               // -kMostNormalScale..kMostNormalScale
  glm::vec3 emissive{0.0f};                             // linear RGB, 0..kMostColor
  std::optional<Texture> emissive_texture{};            // sRGB
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;  // 0..1
  bool double_sided = false;  // false: back faces are culled
  bool unlit = false;         // the colour is the base colour, whatever the lights
};

// A material's textures, by their names in traces.
struct TextureSlot {
  const char* name;
  std::optional<Texture> Material::*texture;
};
inline constexpr TextureSlot kTextureSlots[] = {
    {"base_texture", &Material::base_texture},
    {"metallic_roughness_texture", &Material::metallic_roughness_texture},
    {"normal_texture", &Material::normal_texture},
    {"emissive_texture", &Material::emissive_texture},
};

}  // namespace beampipe
