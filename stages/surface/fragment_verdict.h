// What the shader of a fragment says to coverage and to tests, where draws keep the API's order.
//
// Positions of a pixel are the samples of multisampling, the mask positions of `beam`, and the cells of the reference.
// A sample mask has a bit for each sample of the captured picture, or 32 if there is none. Position p has the bit p,
// modulo their number: so each bit stands for the same share of a pixel.
//
// Sources: OpenGL 4.6 core, sections 14.9 and 17.3.1; Vulkan 1.3, section 26 (sample mask, alpha to coverage).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

#include "stages/surface/opacity.h"

namespace beampipe {

struct FragmentVerdict {
  bool is_kept = true;           // not discarded
  std::uint32_t samples = ~0u;   // SampleMask, as 32 bits
  float coverage = 1;            // alpha to coverage: the part of the positions that it takes, 0..1
  std::optional<float> depth{};  // in place of its triangle's, of the frame: -1..0

  // The mask of a target with so many samples, a power of two up to 32, repeated in all bits.
  static std::uint32_t repeated(std::uint32_t mask, std::uint32_t samples) {
    if (samples >= 32) return mask;
    mask &= (1u << samples) - 1;
    for (; samples < 32; samples *= 2) mask |= mask << samples;
    return mask;
  }
};

// Which positions of a pixel verdicts take: by alpha, all surfaces the same ones in an order that is the pixel's own.
class TakenPositions {
 public:
  // (x, y): the pixel. `positions`: in it. Those beyond 256 have the ranks of the first ones again.
  TakenPositions(const FragmentVerdict& verdict, std::int32_t x, std::int32_t y, std::uint32_t positions)
      : verdict_(verdict), ranks_(0, x, y, std::min(std::bit_ceil(positions), kRanked)) {}

  bool takes(std::uint32_t position) const {
    return verdict_.is_kept && (verdict_.samples >> position % 32 & 1) != 0 &&
           (verdict_.coverage >= 1 || ranks_.takes(position % kRanked, verdict_.coverage));
  }

 private:
  static constexpr std::uint32_t kRanked = 256;

  const FragmentVerdict& verdict_;
  OpacityRanks ranks_;
};

}  // namespace beampipe
