// sample_select: the 8x visibility buffer -> four shading samples per 2x2 quad (decoupled visibility multisampling).
//
// Each pixel brings the sample at the frame's jitter position. Where a material of the quad has none, a sample of a
// material that has several is switched to it, both chosen at random, so that no sample is starved. Then each of the
// quad's 32 visibility samples is given to a shading sample of its material: one at the same pixel if there is one.
// With more than four materials some visibility samples stay without.
#pragma once

#include <cstdint>
#include <vector>

#include "simd/match.h"
#include "stages/cost/counters.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

// Bit 8 p + s of a mask is sample s of pixel p; pixel p = 0..3 is (p % 2, p / 2) of the quad. Shading sample p is
// stored at pixel p. Those of pixels outside the frame (odd sizes) have no mask.
struct SampleQuad {
  std::uint32_t triangle[4];  // what is shaded; kNoTriangle: background
  std::uint32_t mask[4];      // the visibility samples that take this colour
  std::uint8_t location[4];   // where it is shaded: a bit number
};

struct SelectOptions {
  std::uint32_t jitter = 0;  // 0..7: the sample that each pixel brings
  std::uint32_t seed = 1;    // of the random choices: another one for each frame
};

// The quads of the tile, row by row. `surface` has 8 samples per pixel; `materials`: one per triangle, below
// kNoTriangle, which is the background's.
std::vector<SampleQuad> sample_select(const SampleTile& surface, const Tile& tile,
                                      const std::vector<std::uint32_t>& materials, const SelectOptions& options,
                                      StageCounters& counters);

// How many of the quads' shading samples show a triangle.
std::uint64_t shaded_samples(const std::vector<SampleQuad>& quads);

inline constexpr std::uint64_t kShadingSampleBytes = 4 + 4 + 1;  // visibility id, mask, location

}  // namespace beampipe
