// sample_select: the visibility buffer with 8 samples per pixel -> four shading samples per 2x2 quad (decoupled
// visibility multisampling).
//
// Each pixel starts with the sample at the frame's jitter position. If a material of the quad has no shading sample,
// one of a material that has several is switched to it. Both are chosen at random, so that no sample is starved. Then
// each of the quad's 32 visibility samples is given to a shading sample of its material, to one at the same pixel if
// there is one. If a quad has more than four materials, some visibility samples are not given to any shading sample.
//
// With room for extra samples, materials that have no shading sample get one of these first, and only then those of
// others. The article has samples added in place of switched as the most accurate variant, and a few of them beside the
// four as future work.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/sample_quad.h"

namespace beampipe {

struct SelectOptions {
  std::uint32_t jitter = 0;  // the sample that each pixel starts with, 0..7
  std::uint32_t seed = 1;    // for the random choices; a different one for each frame
  std::uint32_t room = 0;    // for extra samples in a quad; 28 are enough for 32 materials
};

// Returns the quads of the tile, row by row. `surface` has 8 samples per pixel. `materials`: one per triangle, below
// kNoTriangle, which stands for the background's material.
std::vector<SampleQuad> sample_select(const SampleTile& surface, const Tile& tile,
                                      const std::vector<std::uint32_t>& materials, const SelectOptions& options,
                                      StageCounters& counters);

// The triangles of these quads' shading samples: four for each quad, and then all extra ones.
std::vector<std::uint32_t> triangles_of(const std::vector<SampleQuad>& quads);

// The number of shading samples in these quads that show a triangle.
std::uint64_t shaded_samples(const std::vector<SampleQuad>& quads);

}  // namespace beampipe
