// compose_regions (stage `compose` of beam where draws keep the API's order): shaded fragments -> regions of pixels ->
// colours of pixels.
//
// A fragment cuts the regions that it meets in two: it changes what lies inside, and what lies outside stays. Inside,
// stencil is tested for each region at once, and depth too, except where planes cross: there it is tested at each
// position. What passes is blended with the region's colour, once for all of it. Regions become one again where they
// have the same depth and stencil value, and nearly the same colour. So a mesh has no seams, and a pixel in it that it
// is blended with is one region, or few.
//
// Areas are exact where one edge cuts the pixel. The fragment's analytic area is shared by the regions that it meets:
// what it covers completely goes first, and the others share the rest, as their positions are inside. The areas of a
// pixel always add up to 1. Specks are tested where the region of the nearest position is. Those of one draw that pass
// wait until the draw has left the pixel. Then they are blended, once, with the largest region that the draw has not
// changed, by their share of its area. If it has changed all of them, the specks' areas are theirs already.
//
// When a pixel has more than kMostRegions, the two are merged that lose least. They get a mean colour, and the depth
// and the stencil value of the larger one.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stages/beam/owners_bin.h"
#include "stages/cost/counters.h"
#include "stages/data/fragment.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/position_set.h"
#include "stages/data/region_pixels.h"
#include "stages/data/setup_triangle.h"
#include "stages/rop/rop_rules.h"

namespace beampipe {

// What a bin has in common for all its fragments.
struct RegionsBin {
  const SetupTriangles& triangles;
  const RopRules& rules;
  const PositionSet& positions;
  bool lists_requests = false;                // fill RegionsResult::fetched and ::visits
  const PixelObservers* observers = nullptr;  // who looks at the pixels; null: nobody
};

// In the API's order.
struct ColoredBeamFragments {
  const std::vector<Fragment>& list;
  const std::vector<glm::vec4>& colors;  // RGBA, of each. The modelled machine shades those that RegionsResult says.
};

// Counts per pixel of the tile.
struct RegionsMaps {
  std::vector<float>& merges;         // how often two regions became one because there were too many
  std::vector<float>& memory_chunks;  // as in PooledMaps
  std::vector<float>& record_bytes;
};

// What was done, beside what is charged.
struct RegionsResult {
  std::vector<std::size_t> shaded;  // the fragments whose colour was needed
  std::vector<DepthFetch> fetched;
  std::vector<RecordVisit> visits;
  ChunkRequests spills;  // to records beyond the pool on chip
};

// Counts as items out the fragments that change a pixel.
void compose_regions(const RegionsBin& bin, const ColoredBeamFragments& fragments, StageCounters& counters,
                     RegionPixels& pixels, const RegionsMaps& maps, RegionsResult& result);

// After the last fragment: the pixels' colours, linear RGB and the part that draws have covered.
std::vector<glm::vec4> finish_regions(const RegionsBin& bin, const glm::vec3& background, StageCounters& counters,
                                      RegionPixels& pixels, const RegionsMaps& maps, RegionsResult& result);

}  // namespace beampipe
