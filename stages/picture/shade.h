// shade: fragments -> fragments with colour.
//
// A flat triangle's colour is the same everywhere, and is computed once, but charged once per invocation: one per
// fragment, and helper invocations that fill up the 2x2 quads (lanes_used, lanes_issued). Others are shaded by their
// material (stages/surface/surface_shader.h).
//
// The texels that invocations read are added to `texels`, which is null if all triangles are flat. A request is a 2x2
// quad or, where fragments are shaded one by one, an invocation. The caller charges them.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/fragment.h"
#include "stages/data/pair.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/sample_fragment.h"
#include "stages/data/sample_quad.h"
#include "stages/data/shaded_triangle.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

// Shades at the centroid of what a fragment covers, in 2x2 quads: sets the fragments' colours (times alpha). Helper
// invocations read no texels, because derivatives do not come from them.
void shade(const TileShader& shader, std::vector<Fragment>& fragments, StageCounters& counters,
           TexelRequests* texels = nullptr);

// The same for fragments that are known to be visible. They are shaded one by one, not in quads.
void shade_visible(const TileShader& shader, std::vector<Fragment>& fragments, StageCounters& counters,
                   TexelRequests* texels = nullptr);

// Only charges the shading of pairs that cover their whole pixel; compose_whole asks for their colours.
void shade_visible(const TileShader& shader, const std::vector<Pair>& whole, StageCounters& counters);

// Only charges the shading of triangles that compose_pooled shades where it needs their colours.
void shade_visible(const TileShader& shader, const std::vector<ShadedTriangle>& shaded, StageCounters& counters);

// Only charges the shading of sample fragments, in 2x2 quads. Samples keep their triangle's index instead of a colour,
// because it and the pixel say where the triangle is shaded. `color_bytes`: of the colour that goes on.
void shade(const TileShader& shader, const std::vector<SampleFragment>& fragments, std::uint32_t color_bytes,
           StageCounters& counters);

// Sets the colours of shading samples of quads, which are the tile's, row by row, in the given order: 4 q + p is sample
// p of quad q, and extra samples follow those of all quads. Charges nothing. `pattern`: of the visibility samples.
void color_samples(const TileShader& shader, const Tile& tile, const SamplePattern& pattern,
                   const std::vector<std::uint32_t>& order, std::vector<SampleQuad>& quads,
                   TexelRequests* texels = nullptr);

// Shading in two steps: writing the material to a G-buffer, and lighting. The functions only charge the work.
// `triangles`: of each sample.
void write_gbuffer(const TileShader& shader, const std::vector<SampleFragment>& fragments,
                   StageCounters& counters);  // in 2x2 quads
void write_gbuffer(const TileShader& shader, const std::vector<std::uint32_t>& triangles,
                   StageCounters& counters);  // one by one, from visibility ids
void light(const TileShader& shader, const std::vector<std::uint32_t>& triangles, StageCounters& counters);

}  // namespace beampipe
