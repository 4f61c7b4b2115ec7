// dilate: shading samples with their masks -> pixels of the current frame.
//
// A pixel's colour is the mean of the colours of its quad's shading samples, weighted by the number of the pixel's
// visibility samples that each was given. The box that the history is clamped to is the same mean of their boxes.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/frame_history.h"
#include "stages/data/sample_quad.h"

namespace beampipe {

struct ShadedQuads {
  const QuadFrame& quads;
  const std::vector<std::uint32_t>& draws;  // one per triangle
  const glm::vec3& background;
  std::uint32_t room = 0;  // for extra samples in a quad
};

// Sets color, low, high and known of the tile's pixels. The box of a shading sample spans those of the 3x3 shading
// samples around it that belong to the same draw; around the pixel of an extra sample, these are the nine that pixels
// store. If none of a pixel's visibility samples was given to a shading sample, the pixel takes the colour of its own
// shading sample, and `known` is 0.
void dilate(const ShadedQuads& in, const Tile& tile, StageCounters& counters, CurrentFrame& frame);

// Per pixel, the part of it whose material has no shading sample in the quad, 0..1.
std::vector<float> unknown_part(const CurrentFrame& frame);

}  // namespace beampipe
