// Textures as the texture units read them: each image at full size and at ever smaller ones, 8 bits per channel.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

enum class ColorSpace { linear, srgb };  // of RGB; alpha is always linear

// Linear values 0..1 of the 256 codes of sRGB (IEC 61966-2-1), and the code nearest to a linear value.
const std::array<float, 256>& srgb_values();
std::uint8_t srgb_code(float linear);

// Linear values of the codes in a texel's channels.
struct TexelValues {
  std::array<float, 256> color, alpha;

  glm::vec4 operator()(const glm::u8vec4& codes) const {
    return {color[codes.r], color[codes.g], color[codes.b], alpha[codes.a]};
  }
};
const TexelValues& texel_values(ColorSpace space);

struct MipLevel {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::u8vec4> texels;  // row by row

  const glm::u8vec4& texel(std::uint32_t x, std::uint32_t y) const { return texels[std::size_t{y} * width + x]; }
};

// Level 0 is the image; each further level has half the width and height, rounded down but at least 1, until both are
// 1. A texel is the mean of what it covers, in linear light, rounded to 8 bits.
struct MipChain {
  ColorSpace space = ColorSpace::linear;
  std::vector<MipLevel> levels;
};

MipChain make_mip_chain(const TextureImage& image, ColorSpace space);

}  // namespace beampipe
