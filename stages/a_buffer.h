// a_buffer: fragments in primitive order -> per pixel, the list of its fragments from near to far (Carpenter 1984).
//
// Equal depth: the earlier fragment first.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/beam_fragment.h"
#include "stages/counters.h"

namespace beampipe {

struct ABuffer {
  std::vector<std::uint32_t> first;      // per pixel of the tile, and one more: where its list starts in `fragments`
  std::vector<std::uint32_t> fragments;  // indices of fragments

  std::uint32_t depth_of(std::size_t pixel) const { return first[pixel + 1] - first[pixel]; }
};

// A stored fragment is an aggregate and a link to the next one; a pixel has one head link.
inline constexpr std::uint32_t kLinkBytes = 4;

// What near and far mean: the depth at the clipped triangle's centroid, or its nearest depth in the pixel.
enum class SortKey { centroid, nearest };

// `record_bytes`: of a fragment as it is stored, without its link.
ABuffer a_buffer(const std::vector<Fragment>& fragments, std::size_t pixels, SortKey key, std::uint32_t record_bytes,
                 StageCounters& counters);

// Bytes of the whole buffer, which stands in memory until it is composed.
std::uint64_t a_buffer_bytes(std::uint64_t fragments, std::uint64_t pixels, std::uint32_t record_bytes);

}  // namespace beampipe
