// resolve: framebuffer -> picture: linear RGB over the background, and A, the part of the pixel that geometry covers.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "simd/merge.h"
#include "stages/cost/counters.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/sample_tile.h"

namespace beampipe {

std::vector<PixelColor> pixel_colors(const std::vector<Aggregate>& aggregates);

// Blends the aggregates over the background. `stored_bytes`: size of a stored aggregate. Returns RGBA per pixel of the
// tile.
std::vector<glm::vec4> resolve(const std::vector<PixelColor>& aggregates, const glm::vec3& background,
                               std::uint32_t stored_bytes, StageCounters& counters);

// Returns the mean of each pixel's samples (a box filter of one pixel). `colors`: one per triangle.
std::vector<glm::vec4> resolve(const SampleTile& surface, std::size_t pixels, const std::vector<glm::vec3>& colors,
                               const glm::vec3& background, StageCounters& counters);

}  // namespace beampipe
