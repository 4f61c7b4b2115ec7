// a_buffer: what waits for composition, in primitive order -> per pixel, the list of it from near to far (Carpenter
// 1984).
//
// Equal depth: the earlier record first.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/beam/beam_fragment.h"
#include "stages/cost/counters.h"

namespace beampipe {

// What is sorted of a fragment, or of a pixel and triangle that will be one.
struct SortRecord {
  std::uint32_t pixel;     // within the tile
  std::uint32_t triangle;  // index into SetupTriangles
  float depth;
};

// What sorting takes per record, itself included.
inline constexpr std::size_t kSortBytes = sizeof(SortRecord) + 3 * sizeof(std::uint64_t);

struct ABuffer {
  std::vector<std::uint32_t> first;    // per pixel of the tile, and one more: where its list starts in `records`
  std::vector<std::uint32_t> records;  // indices of records

  std::uint32_t depth_of(std::size_t pixel) const { return first[pixel + 1] - first[pixel]; }
};

// A stored record has a link to the next one; a pixel has one head link.
inline constexpr std::uint32_t kLinkBytes = 4;

// What near and far mean for a fragment: the depth at the clipped triangle's centroid, or its nearest depth in the
// pixel.
enum class SortKey { centroid, nearest };

std::vector<SortRecord> sort_records(const std::vector<Fragment>& fragments, SortKey key);
std::vector<SortRecord> sort_records(const std::vector<PixelTriangle>& pairs, const Tile& tile);  // nearest depth

// Insertion exchanges a pixel's head link and writes a record with the old one; then every pixel's head and records are
// read, and sorted. `item_bytes`: of what comes in; `record_bytes`: of a record as it is stored, without its link.
ABuffer a_buffer(const std::vector<SortRecord>& records, std::size_t pixels, std::uint32_t item_bytes,
                 std::uint32_t record_bytes, StageCounters& counters);

// Records per pixel.
std::vector<float> depths_of(const ABuffer& buffer);

// Bytes of the whole buffer, which stands in memory until it is composed.
std::uint64_t a_buffer_bytes(std::uint64_t records, std::uint64_t pixels, std::uint32_t record_bytes);

}  // namespace beampipe
