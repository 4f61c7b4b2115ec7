// claim: fragments in primitive order -> owners of mask positions. It is the ROP of the beam in streaming order.
//
// A fragment claims the positions where it is nearer than their owners; at equal depth the earlier triangle keeps the
// position. A pixel has room for a fixed number of owners. If there is one more, the farthest is dropped and its
// positions are deferred: another pass over the geometry decides them, so that the settled positions are exact. In the
// same pass, a deferred position may still be claimed by a fragment that is nearer than everything that was dropped.
#pragma once

#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/fragment.h"
#include "stages/data/owner_pixel.h"
#include "stages/data/position_set.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// `pixels`: one per pixel of the tile, kept from batch to batch and from pass to pass; cleared_pixel() at first. The
// depth plane of an owner is computed again from its setup triangle each time a fragment is compared with it. If
// `remade` is not null, the indices of those triangles are appended to it. Counts as items out the fragments that take
// a position.
template <std::size_t Words, std::size_t Layers>
void claim(const SetupTriangles& triangles, const std::vector<Fragment>& fragments, const Tile& tile,
           const PositionSet& positions, StageCounters& counters, std::vector<OwnerPixel<Words, Layers>>& pixels,
           std::vector<std::uint32_t>* remade = nullptr);

}  // namespace beampipe
