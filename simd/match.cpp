#include "simd/match.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/match.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void match_masks_kernel(const std::uint32_t* ids, const std::uint8_t* locations, std::size_t quads,
                        std::uint32_t* masks) {
  const hn::CappedTag<std::uint32_t, 16> d;
  for (std::size_t i = 0; i < 4 * quads; ++i) {
    const std::uint32_t* quad = ids + i / 4 * kQuadSamples;
    const auto id = hn::Set(d, quad[locations[i]]);
    std::uint32_t mask = 0;
    for (std::size_t s = 0; s < kQuadSamples; s += hn::Lanes(d)) {
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, hn::Eq(hn::LoadU(d, quad + s), id), bytes);
      mask |= (bytes[0] | std::uint32_t{bytes[1]} << 8) << s;
    }
    masks[i] = mask;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(match_masks_kernel);
void match_masks(const std::uint32_t* ids, const std::uint8_t* locations, std::size_t quads, std::uint32_t* masks) {
  HWY_DYNAMIC_DISPATCH(match_masks_kernel)(ids, locations, quads, masks);
}
}  // namespace beampipe
#endif
