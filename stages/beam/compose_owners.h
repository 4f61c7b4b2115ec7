// compose_owners (stage `compose` of beam in near-first and streaming order): fragments -> owners of mask positions ->
// colours of pixels.
//
// A fragment takes the positions where it is nearer than their owners; at equal depth the triangle that comes first in
// the trace keeps them. What lies in front of the watermark is final: its area (simd/conserve.h) and colour are added
// to the pixel, and its slot is free again. If all slots are in use and nothing is final, two owners become one: those
// whose depth planes are closest at the positions that they own. From then on they share a mean colour and one depth
// plane.
//
// Specks own no position. They are added at once, if the owners of the positions next to them do not hide them.
//
// Two estimates of a pixel are kept. The analytic one is far more accurate where visibility is simple, but where
// hundreds of triangles meet in a pixel, it may be wrong about which specks are seen. Counting positions is never worse
// than multisampling. So the result is the analytic estimate, limited to what the error of counted positions explains.
#pragma once

#include <vector>

#include "stages/beam/owners_bin.h"
#include "stages/cost/counters.h"
#include "stages/data/closed_depth.h"
#include "stages/data/open_pixel.h"
#include "stages/data/pixel_formats.h"

namespace beampipe {

// What fragments are composed into.
template <std::size_t Words, std::size_t Slots>
struct OwnersTile {
  OpenPixels<Words, Slots>& pixels;
  ClosedDepth& closed;  // pixels whose positions all have owners are closed here
  OwnersMaps maps;
  OwnersResult& result;
};

// Counts as items out the fragments that take a position.
template <std::size_t Words, std::size_t Slots>
void compose_owners(const OwnersBin& bin, const OwnersBatch& batch, StageCounters& counters,
                    const OwnersTile<Words, Slots>& tile);

// After the last fragment: all owners are final. Returns the pixels' colours.
template <std::size_t Words, std::size_t Slots>
std::vector<PixelColor> finish_owners(const OwnersBin& bin, StageCounters& counters, OpenPixels<Words, Slots>& pixels,
                                      OwnersResult& result);

}  // namespace beampipe
