// Which of the 32 samples of a 2x2 quad are of the same material as a given one.
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

inline constexpr int kQuadSamples = 32;  // 4 pixels of 8 samples

// `ids`: 32 per quad; `locations`: four per quad, each 0..31. masks[4 q + i] has bit s set when ids[32 q + s] is the
// same as ids[32 q + locations[4 q + i]]. Lanes are across samples.
void match_masks(const std::uint32_t* ids, const std::uint8_t* locations, std::size_t quads, std::uint32_t* masks);

// Scalar twin: the samples with this id. Id is std::uint32_t or a counting number.
template <class Id>
std::uint32_t match_mask_scalar(const Id ids[kQuadSamples], Id id) {
  std::uint32_t mask = 0;
  for (int s = 0; s < kQuadSamples; ++s) mask |= static_cast<std::uint32_t>(ids[s] == id) << s;
  return mask;
}

}  // namespace beampipe
