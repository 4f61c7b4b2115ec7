// The exact picture of a frame, computed in rational arithmetic from the trace's own numbers. Nothing is rounded except
// what the pipeline must round: vertices, to 1/256 px. This is slow, and it shares no code with the stages.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

// Places in a pixel, in units of 1/256 px from its upper left corner.
using SamplePlaces = std::vector<glm::ivec2>;

// The RGBA of every pixel of a frame, row 0 on top: individual values in a rectangle around the triangles, and one
// value for all other pixels.
struct ExactPicture {
  glm::ivec2 low{0}, high{0};         // pixels [low, high)
  std::vector<glm::dvec4> rgba = {};  // of these pixels, row by row
  glm::dvec4 elsewhere{0};

  const glm::dvec4& at(int x, int y) const {
    if (x < low.x || y < low.y || x >= high.x || y >= high.y) return elsewhere;
    return rgba[static_cast<std::size_t>(y - low.y) * static_cast<std::size_t>(high.x - low.x) +
                static_cast<std::size_t>(x - low.x)];
  }
};

// Each colour counts by its visible area; A is the covered area. Of two triangles the nearer one is visible, at equal
// depth the earlier one. Draws must be unlit and without culling. The time grows with the cube of the number of
// triangles that overlap in a pixel.
ExactPicture exact_areas(const Trace& trace, const Frame& frame);

// The same, but instead of areas the mean of samples at these places counts, with the top-left rule.
ExactPicture exact_samples(const Trace& trace, const Frame& frame, const SamplePlaces& places);

}  // namespace beampipe
