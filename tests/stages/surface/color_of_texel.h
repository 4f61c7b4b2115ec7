// A texel as shaders see it.
#pragma once

#include "stages/surface/mip_chain.h"

namespace beampipe {

// Linear RGBA.
inline glm::vec4 color_of_texel(const MipChain& chain, std::size_t level, std::uint32_t x, std::uint32_t y) {
  return texel_values(chain.space)(chain.levels[level].texel(x, y));
}

}  // namespace beampipe
