// Which of the 32 samples of a quad of 2 x 2 pixels have the same material as a given one.
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

inline constexpr int kQuadSamples = 32;  // 4 pixels of 8 samples

// `ids` has 32 entries per quad, `locations` four, each 0..31. Bit s of masks[4 q + i]: ids[32 q + s] equals
// ids[32 q + locations[4 q + i]]. Lanes are across samples.
void match_masks(const std::uint32_t* ids, const std::uint8_t* locations, std::size_t quads, std::uint32_t* masks);

// The scalar twin: the samples that have this id. Id is std::uint32_t or a counting number.
template <class Id>
std::uint32_t match_mask_scalar(const Id ids[kQuadSamples], Id id) {
  std::uint32_t mask = 0;
  for (int s = 0; s < kQuadSamples; ++s) mask |= static_cast<std::uint32_t>(ids[s] == id) << s;
  return mask;
}

}  // namespace beampipe
