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

// One RGBA per pixel, row 0 on top: colours weighted by visible area, A the covered area. Depth LESS, at equal depth
// the earlier triangle. Unlit draws without culling only; time grows with the cube of the triangles that overlap in a
// pixel.
std::vector<glm::dvec4> exact_areas(const Trace& trace, const Frame& frame);

// The same with the mean of the samples at these places (top-left rule) in place of the area.
std::vector<glm::dvec4> exact_samples(const Trace& trace, const Frame& frame, const SamplePlaces& places);

}  // namespace beampipe
