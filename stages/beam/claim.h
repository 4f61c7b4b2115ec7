// claim: fragments in primitive order -> owners of mask positions. The ROP of the beam in streaming order.
//
// A fragment claims the positions where it is nearer than their owners. A pixel has room for so many owners; when there
// is one more, the farthest is dropped and its positions are deferred: another pass over the geometry decides about
// them, so that what is settled is exact. A deferred position may still be claimed by what is nearer than all that was
// dropped. At equal depth the earlier triangle keeps a position.
#pragma once

#include <vector>

#include "stages/beam/beam_fragment.h"
#include "stages/data/owner_pixel.h"
#include "stages/data/position_set.h"

namespace beampipe {

// Bytes of a fragment on its way from beam_fragment: pixel, triangle, mask, depth plane and nearest depth as float32.
constexpr std::uint32_t streaming_fragment_bytes(std::size_t words) {
  return 4 + 4 + static_cast<std::uint32_t>(words) * 4 + 12 + 4;
}

// `pixels`: one per pixel of the tile, kept from batch to batch and from pass to pass; empty (cleared_pixel) before
// the first. Owners' depth planes are made again from their setup triangles, as often as fragments are compared with
// them: `remade`, if it is not null, gets those triangles' indices added. items_out: claims that took a position.
template <std::size_t Words, std::size_t Layers>
void claim(const SetupTriangles& triangles, const std::vector<Fragment>& fragments, const Tile& tile,
           const PositionSet& positions, StageCounters& counters, std::vector<OwnerPixel<Words, Layers>>& pixels,
           std::vector<std::uint32_t>* remade = nullptr);

}  // namespace beampipe
