// resolve: framebuffer -> image. Linear RGB over the background, and A, the part of the pixel that geometry covers.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "simd/merge.h"
#include "stages/cost/counters.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

// What resolve needs of an aggregate.
struct PixelColor {
  float alpha;
  glm::vec3 color;  // times alpha
};
std::vector<PixelColor> pixel_colors(const std::vector<Aggregate>& aggregates);

// Aggregates as stored, `stored_bytes` each, over the background. One RGBA per pixel of the
// tile.
std::vector<glm::vec4> resolve(const std::vector<PixelColor>& aggregates, const glm::vec3& background,
                               std::uint32_t stored_bytes, StageCounters& counters);

// The mean of each pixel's samples (a box filter of one pixel).
std::vector<glm::vec4> resolve(const SampleTile& surface, std::size_t pixels, const std::vector<glm::vec3>& colors,
                               const glm::vec3& background, StageCounters& counters);

}  // namespace beampipe
