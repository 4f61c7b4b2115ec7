// a_buffer: pairs or fragments in primitive order -> per pixel, a list of them from near to far (Carpenter 1984).
//
// Among equal depths the earlier record comes first.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/fragment.h"
#include "stages/data/pair.h"
#include "stages/data/sorted_lists.h"
#include "stages/data/tile.h"

namespace beampipe {

// The depth that a fragment is sorted by: at the centroid of the clipped triangle, or its nearest depth in the pixel.
enum class SortKey { centroid, nearest };

std::vector<SortRecord> sort_records(const std::vector<Fragment>& fragments, SortKey key);
// Pairs are sorted by their nearest depth.
std::vector<SortRecord> sort_records(const std::vector<Pair>& pairs, const Tile& tile);

// The modelled machine inserts a record by exchanging the pixel's head link and writing the record with the old link.
// Then it reads every pixel's head and records to sort them; nothing is written back. `item_bytes`: size of an item
// that comes in. `record_bytes`: size of a stored record without its link.
ABuffer a_buffer(const std::vector<SortRecord>& records, std::size_t pixels, std::uint32_t item_bytes,
                 std::uint32_t record_bytes, StageCounters& counters);

// Per pixel, the number of its records.
std::vector<float> record_counts(const ABuffer& buffer);

// Size of the whole buffer, which stays in memory until it is composed.
std::uint64_t a_buffer_bytes(std::uint64_t records, std::uint64_t pixels, std::uint32_t record_bytes);

}  // namespace beampipe
