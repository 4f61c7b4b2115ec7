// blend: translucent sample fragments -> the colours of samples, in the order of the draws.
//
// Translucent fragments are tested against depth but do not write it.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/accumulator.h"
#include "stages/data/sample_tile.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

struct PlacedFragments {
  const std::vector<SampleFragment>& list;
  const std::vector<glm::vec2>& places;  // where each fragment is shaded, in its pixel
};

// surface.over must have a value for each sample. Replaces `accesses` by one access per fragment.
void blend(const SampledTriangles& in, const TileShader& shader, const PlacedFragments& fragments,
           StageCounters& counters, SampleTile& surface, std::vector<SampleAccess>& accesses);

// Depths, of which one sample of each pixel is read.
struct DepthsOfOneSample {
  const SampleTile& depth;
  std::size_t sample;
  std::vector<SampleAccess>& accesses;  // replaced
};

// The same for an accumulator that has all that is opaque: fragments are tested at one sample of the pixel and, if that
// passes, go over the whole of it. in.sampling: this sample alone.
void blend(const SampledTriangles& in, const TileShader& shader, const PlacedFragments& fragments,
           const DepthsOfOneSample& tested, StageCounters& counters, Accumulator& accumulator);

}  // namespace beampipe
