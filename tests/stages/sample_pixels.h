// Runs the stages of techniques that test samples, as far as a test needs them.
#pragma once

#include "stages/raster/sample_raster.h"
#include "stages/samples/test_depth.h"
#include "tests/stages/screen_triangles.h"

namespace beampipe {

inline std::vector<SampleFragment> sample_fragments(const SetupTriangles& triangles, const Tile& tile,
                                                    const Sampling& sampling, ClosedDepth* closed = nullptr) {
  std::vector<SampleFragment> fragments;
  StageCounters ignored;
  sample_raster({triangles, tile, sampling}, all_of(triangles), ignored, fragments, closed);
  return fragments;
}

// What is nearest at each sample.
inline SampleTile tested_samples(const SetupTriangles& triangles, const Tile& tile, const Sampling& sampling) {
  std::vector<SampleAccess> accesses;
  StageCounters ignored;
  SampleTile surface(tile, sampling);
  depth_test({triangles, tile, sampling}, sample_fragments(triangles, tile, sampling), ignored, surface, accesses);
  return surface;
}

}  // namespace beampipe
