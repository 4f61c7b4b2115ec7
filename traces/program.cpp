#include "traces/program.h"

#include <algorithm>

namespace beampipe {

std::uint64_t texel_bytes(TexelFormat format) {
  switch (format) {
    case TexelFormat::R8_UNORM:
      return 1;
    case TexelFormat::R8G8_UNORM:
    case TexelFormat::R16_SFLOAT:
      return 2;
    case TexelFormat::R8G8B8A8_UNORM:
    case TexelFormat::R8G8B8A8_SRGB:
    case TexelFormat::B8G8R8A8_UNORM:
    case TexelFormat::B8G8R8A8_SRGB:
    case TexelFormat::R16G16_SFLOAT:
    case TexelFormat::R32_SFLOAT:
    case TexelFormat::D32_SFLOAT:
      return 4;
    case TexelFormat::R16G16B16A16_SFLOAT:
    case TexelFormat::R16G16B16A16_UNORM:
      return 8;
    case TexelFormat::R32G32B32A32_SFLOAT:
    case TexelFormat::R32G32B32A32_UINT:
    case TexelFormat::R32G32B32A32_SINT:
      return 16;
  }
  return 0;
}

std::uint64_t level_start(const ProgramImage& image, std::uint32_t level) {
  std::uint64_t texels = 0;
  for (std::uint32_t i = 0; i < level; ++i) {
    const auto side = [i](std::uint32_t of_first) { return std::uint64_t{std::max(of_first >> i, 1u)}; };
    texels += side(image.width) * side(image.height) * side(image.depth) * image.layers;
  }
  return texels * texel_bytes(image.format);
}

std::uint64_t varyings_of(const ShaderProgram& program) {
  std::uint64_t count = 0;
  for (const ProgramInput& input : program.inputs) count += input.count;
  return count;
}

}  // namespace beampipe
