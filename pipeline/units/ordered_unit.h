// Multisampling in the API's order: tests, shading and blending in a bin, with the surface that they change.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/memory/sample_memory.h"
#include "stages/data/ordered_tile.h"
#include "stages/picture/resolve.h"
#include "stages/samples/alpha_test.h"
#include "stages/samples/shading_point.h"

namespace beampipe {

class OrderedUnit {
 public:
  // The frame must need the API's order. `sampling` must outlive it.
  OrderedUnit(Bin& bin, const Sampling& sampling, AccumulatorFormat format, std::uint32_t color_bytes);

  // Draws the bin's triangles. Fragments are tested before they are shaded, as hardware does, and no hierarchy of
  // depths hides any. Clears cost nothing. Stages: sample_raster, depth_test, shade, blend.
  void draw(ShadeAt at, AlphaCoverage alpha);

  // The picture. Stage: resolve, if the bin has it.
  std::vector<glm::vec4> resolve_samples(ResolveSpace space);

 private:
  Bin& bin_;
  const Sampling& sampling_;
  OrderedTile surface_;
  SampleMemory memory_;
};

}  // namespace beampipe
