// resolve: framebuffer -> image. Linear RGB over the background, and A, the part of the pixel that geometry covers.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "simd/merge.h"
#include "stages/counters.h"
#include "stages/depth_test.h"

namespace beampipe {

// Aggregates as stored (colour rounded to fp16), each over the background. One RGBA per pixel of the tile.
std::vector<glm::vec4> resolve(const std::vector<Aggregate>& aggregates, const glm::vec3& background,
                               StageCounters& counters);

// The mean of each pixel's samples (a box filter of one pixel).
std::vector<glm::vec4> resolve(const SampleTile& surface, std::size_t pixels, const std::vector<glm::vec3>& colors,
                               const glm::vec3& background, StageCounters& counters);

}  // namespace beampipe
