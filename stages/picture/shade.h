// shade: fragments -> fragments with colour.
//
// Shading is flat: a triangle has one colour. The shader's result is therefore computed once per triangle, but charged
// once per invocation: one per fragment, and helper invocations that fill up the 2x2 quads (lanes_used, lanes_issued).
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/fragment.h"
#include "stages/data/pair.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/sample_fragment.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/shaded_triangle.h"
#include "traces/trace.h"

namespace beampipe {

// Returns the colour of each triangle: kd, times the light that it receives if it is lit.
std::vector<glm::vec3> shade_triangles(const SetupTriangles& triangles, const Lighting& lighting);

// Rounds the colours as a framebuffer of fp16 RGB does.
std::vector<glm::vec3> round_to_half(std::vector<glm::vec3> colors);

// The following functions take the attributes of the triangles to know which are lit; null: all are lit.

// Shades at the centroid, in 2x2 quads: sets the fragments' colours (times alpha).
void shade(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters,
           const std::vector<FlatAttributes>* attributes = nullptr);

// The same for fragments that are known to be visible. They are shaded one by one, not in quads.
void shade_visible(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes = nullptr);

// Only charges the shading of pairs that cover their whole pixel; they take their triangle's colour as it is.
void shade_visible(const std::vector<Pair>& whole, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes = nullptr);

// Only charges the shading of triangles that a later stage shades where it needs their colours.
void shade_visible(const std::vector<ShadedTriangle>& shaded, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes = nullptr);

// Only charges the shading of sample fragments, in 2x2 quads; they keep their triangle's index instead of a colour.
// With flat colours it makes no difference whether they are shaded at the centre or the centroid.
void shade(const std::vector<SampleFragment>& fragments, StageCounters& counters,
           const std::vector<FlatAttributes>* attributes = nullptr);

// Shading in two steps: writing the material to a G-buffer, and lighting. The functions only charge the work.
void write_gbuffer(const std::vector<SampleFragment>& fragments, StageCounters& counters);  // in 2x2 quads
void write_gbuffer(std::uint64_t samples, StageCounters& counters);  // one by one, from visibility ids
void light(std::uint64_t samples, StageCounters& counters);          // one by one

}  // namespace beampipe
