// accumulate: fragments with visible samples -> one colour accumulator per pixel (ACAA, Enderton et al. 2015).
//
// A depth-only pass has found the visible samples. A fragment adds its colour times its share of the pixel's samples.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/accumulator.h"
#include "stages/data/sample_tile.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

// Adds the background for the samples that the depth-only pass left clear. DoubleCounting::saturate needs this to be
// done first, so that alpha saturates at what geometry covers. It costs another read of all depths.
void accumulate_background(const SampleTile& depth, const glm::vec3& background, StageCounters& counters,
                           Accumulator& accumulator);

// Keeps of each fragment the samples at which no earlier fragment has passed, and drops fragments without such samples.
void stencil_test(const Tile& tile, StageCounters& counters, Accumulator& accumulator,
                  std::vector<SampleFragment>& fragments);

// `places`: where each fragment is shaded, in its pixel; may be empty if all triangles are flat.
void accumulate(const std::vector<SampleFragment>& fragments, const TileShader& shader,
                const std::vector<glm::vec2>& places, const Tile& tile, StageCounters& counters,
                Accumulator& accumulator);

// Blends the accumulated colours over the background, which is weighted by 1 - alpha. Returns RGBA per pixel of the
// tile.
std::vector<glm::vec4> resolve(const Accumulator& accumulator, const glm::vec3& background, StageCounters& counters);

}  // namespace beampipe
