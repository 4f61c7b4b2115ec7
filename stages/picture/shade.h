// shade: fragments -> fragments with colour.
//
// A triangle has one colour (flat shading), so the shader's result is computed once per triangle and charged once per
// invocation: one per fragment, and helpers to fill its 2x2 quads (lanes_used and lanes_issued).
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "stages/beam/beam_fragment.h"
#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/raster/sample_raster.h"

namespace beampipe {

// What the shader returns per triangle: kd, times max(0, -normal . light) when lit. `light` is the way the light
// travels.
std::vector<glm::vec3> shade_triangles(const SetupTriangles& triangles, const std::optional<glm::vec3>& light);

// The colours as a framebuffer of fp16 RGB takes them.
std::vector<glm::vec3> round_to_half(std::vector<glm::vec3> colors);

// At the centroid: sets the fragments' colours (times alpha). `attributes`: of the triangles, to know which are lit;
// null: all are.
void shade(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters,
           const std::vector<FlatAttributes>* attributes = nullptr);

// The same for fragments that are known to be visible: one by one, not in quads.
void shade_visible(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes = nullptr);

// The counts alone, where the triangle's colour is taken as it is.
void shade_visible(const std::vector<PixelTriangle>& whole, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes = nullptr);

// At the pixel's centre or centroid, which is the same for flat colours: counts, for fragments that keep their
// triangle's index in place of its colour.
void shade(const std::vector<SampleFragment>& fragments, StageCounters& counters,
           const std::vector<FlatAttributes>* attributes = nullptr);

// Shading in two steps: materials into a G-buffer, which is here what light needs, Kd and normal; then light.
inline constexpr std::uint32_t kGBufferBytes = 8;     // RGBA8 and RGB10A2 per pixel
inline constexpr std::uint32_t kVisibilityBytes = 4;  // a triangle's and a draw's number in 32 bits

void write_gbuffer(const std::vector<SampleFragment>& fragments, StageCounters& counters);  // in 2x2 quads
void write_gbuffer(std::uint64_t samples, StageCounters& counters);  // one by one, from visibility ids
void light(std::uint64_t samples, StageCounters& counters);          // one by one

}  // namespace beampipe
