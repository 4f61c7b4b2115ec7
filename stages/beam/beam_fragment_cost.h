// What beam_fragment is charged.
#pragma once

#include "simd/position_mask.h"
#include "stages/beam/beam_fragment.h"

namespace beampipe {

struct BeamFragmentWork {
  std::uint64_t pairs = 0;
  std::uint64_t partial = 0;    // pairs that the triangle does not cover completely, whose area is tested
  std::uint64_t computed = 0;   // pairs whose area, mask and depth range are computed
  std::uint64_t triangles = 0;  // whose edges are prepared for masks
  EdgesTested edges;            // for MaskSource::grid
  std::uint64_t fragments = 0;
  std::uint64_t whole = 0;            // of these, fragments with all positions and the area of a pixel
  std::uint64_t centroid_depths = 0;  // fragments whose depth at the centroid is computed
  // Specks that are given positions: specks, comparisons of their area with positions given so far, positions given.
  std::uint64_t specks = 0, speck_comparisons = 0, given = 0;
};

void charge(const BeamFragmentWork& work, const BeamFragmentOptions& options, StageCounters& counters);

}  // namespace beampipe
