// What a frame looks like, by exact rational arithmetic from the trace's own numbers: nothing in it is rounded but what
// the pipeline is specified to round, vertices to 1/256 px. Slow, and shares no code with the stages.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

// Places in a pixel, in 1/256 px from its upper left corner.
using SamplePlaces = std::vector<glm::ivec2>;

// RGBA of every pixel of a frame, row 0 on top: one by one in a rectangle around the triangles, alike elsewhere.
struct ExactPicture {
  glm::ivec2 low{0}, high{0};    // pixels [low, high)
  std::vector<glm::dvec4> rgba;  // of those, row by row
  glm::dvec4 elsewhere{0};

  const glm::dvec4& at(int x, int y) const {
    if (x < low.x || y < low.y || x >= high.x || y >= high.y) return elsewhere;
    return rgba[static_cast<std::size_t>(y - low.y) * static_cast<std::size_t>(high.x - low.x) +
                static_cast<std::size_t>(x - low.x)];
  }
};

// Colours weighted by visible area, A the covered area. Depth LESS, at equal depth the earlier triangle. Unlit draws
// without culling only; time grows with the cube of the triangles that overlap in a pixel.
ExactPicture exact_areas(const Trace& trace, const Frame& frame);

// The same with the mean of the samples at these places (top-left rule) in place of the area.
ExactPicture exact_samples(const Trace& trace, const Frame& frame, const SamplePlaces& places);

}  // namespace beampipe
