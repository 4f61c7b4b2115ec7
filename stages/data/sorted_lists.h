// The A-buffer's lists: for each pixel of a tile, what waits to be composed, from near to far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace beampipe {

// What is sorted: a fragment, or a pair that will become one.
struct SortRecord {
  std::uint32_t pixel;     // index within the tile, row by row
  std::uint32_t triangle;  // index into SetupTriangles
  float depth;
};

// Working memory per record while the lists are made, the record included.
inline constexpr std::size_t kSortBytes = sizeof(SortRecord) + 3 * sizeof(std::uint64_t);

struct ABuffer {
  std::vector<std::uint32_t> first;    // per pixel, where its list starts in `records`; one more marks the end
  std::vector<std::uint32_t> records;  // indices of the records that were sorted

  // How many records the pixel has.
  std::uint32_t record_count(std::size_t pixel) const { return first[pixel + 1] - first[pixel]; }
};

// Size in the modelled machine of the link from a stored record to the next one, and of a pixel's link to its first.
inline constexpr std::uint32_t kLinkBytes = 4;

}  // namespace beampipe
