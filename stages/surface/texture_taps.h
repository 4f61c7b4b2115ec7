// Textures filtered at several places side by side, with a bilinear look-up in each lane.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "stages/surface/texture_filter.h"

namespace beampipe {

// Sets values[i] to filtered() at uvs[i] by plans[i], to the last bit. All three are as long. Plans have at most 64
// probes.
void filter_side_by_side(const MipChain& chain, const Texture& texture, std::span<const glm::vec2> uvs,
                         std::span<const FilterPlan> plans, glm::vec4* values);

}  // namespace beampipe
