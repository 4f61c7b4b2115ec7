// compose_pooled (stage `compose` of beam in near-first and streaming order): fragments -> owners of mask positions ->
// colours of pixels.
//
// A fragment takes the positions where it is nearer than their owners; at equal depth the triangle that comes first in
// the trace keeps them. A triangle that covers a pixel in front of everything needs no mask. Owners in front of the
// watermark are final. When the pool runs low, a collection looks for them in all pixels, and when a pixel has as many
// owners as it may have, in that pixel: their area (simd/conserve.h) and colour are added to the pixel's sums, and
// their bytes are free again. If nothing is final, the two owners of the pixel are merged whose depth planes are
// closest at the means of the positions that they own. From then on they share a mean colour and one depth plane.
//
// Specks own no position. They are added at once, if the owners of the positions next to them do not hide them. Where
// nothing is final before the end, they are forgotten once surfaces close the pixel in front of all of them.
//
// Two estimates of a pixel are kept. The analytic one is far more accurate where visibility is simple, but where
// hundreds of triangles meet in a pixel, it may be wrong about which specks are seen. Counting positions is never worse
// than multisampling. So the result is the analytic estimate, limited to what the error of counted positions explains.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/beam/owners_bin.h"
#include "stages/cost/counters.h"
#include "stages/data/closed_depth.h"
#include "stages/data/fragment.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/pooled_pixels.h"

namespace beampipe {

// Counts per pixel of the tile.
struct PooledMaps {
  std::vector<float>& memory_chunks;  // chunks of the record that were read or written in memory
  std::vector<float>& record_bytes;   // the most that the record has had
  // Of a frame's pool; of others they may be null.
  std::vector<float>* refusals = nullptr;     // fragments for which a closed pool had no room
  std::vector<float>* lost_specks = nullptr;  // how often it lost specks: a new one, or all before
};

// What was done, beside what is charged.
struct PooledResult : OwnersResult {
  ChunkRequests spills;  // to records beyond a pool on chip
  PooledMaps maps;
  // Each has read the words of all pixels, and written those of these pixels.
  std::vector<std::vector<std::uint32_t>> collections;
  bool lists_visits = false;        // fill the list that follows
  std::vector<RecordVisit> visits;  // to all records, wherever they lie
  bool lists_claims = false;        // fill the list that follows
  std::vector<PoolClaim> claims;    // to a frame's pool

  explicit PooledResult(const PooledMaps& of_pixels) : maps(of_pixels) {}
};

// What fragments are composed into.
template <std::size_t Words>
struct PooledTile {
  PooledPixels<Words>& pixels;
  ClosedDepth& closed;  // pixels whose positions all have owners are closed here
  OwnersMaps maps;
  PooledResult& result;
};

// Counts as items out the fragments that take a position.
template <std::size_t Words>
void compose_pooled(const OwnersBin& bin, const OwnersBatch& batch, StageCounters& counters,
                    const PooledTile<Words>& tile);

// After the last fragment: all owners are final. Returns the pixels' colours.
template <std::size_t Words>
std::vector<PixelColor> finish_pooled(const OwnersBin& bin, StageCounters& counters, PooledPixels<Words>& pixels,
                                      PooledResult& result);

}  // namespace beampipe
