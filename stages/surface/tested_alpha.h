// Where a cutout is there, as a texture: which part of each texel passes the alpha test, at every mip level.
//
// Mean alpha does not say how much of an area passes the test. So alpha is tested first, as the magnification filter
// shows it, and the results are averaged. The modelled machine keeps them in a texture of their own.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "stages/surface/mip_chain.h"
#include "traces/material.h"

namespace beampipe {

// The shares of four values of alpha that texture must reach, one in each channel. The first is what the material asks
// for where vertices have alpha 1; smaller alphas of vertices ask for more, and the others go in equal steps up to 1.
// Between them, the share is interpolated.
struct TestedAlpha {
  float first = 0, step = 0;
  MipChain shares;

  // `shares`: at a place. `needed`: the texture's alpha that just passes.
  float share(const glm::vec4& shares_there, float needed) const;
};

// The alpha of its texture at which a material with opaque vertices just passes the test.
float least_texture_alpha(const Material& material);

// What the results take, with all levels.
inline std::uint64_t tested_alpha_bytes(const TextureImage& image) {
  return image.texels.size() * sizeof(glm::u8vec4) * 4 / 3;
}

// Of a material with a base texture. `image`: the texture's.
TestedAlpha test_alpha(const Material& material, const TextureImage& image);

}  // namespace beampipe
