#include "simd/depth_compare.h"

#include "simd/population_count.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/depth_compare.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The depth of samples s, s + 1, ... of an item.
template <class D>
HWY_INLINE hn::Vec<D> depths_at(D d, const CellDepth& item, const SamplePattern& pattern, std::size_t s) {
  const hn::RebindToSigned<D> di;
  const auto x = hn::ConvertTo(d, hn::Load(di, pattern.x.data() + s));
  const auto y = hn::ConvertTo(d, hn::Load(di, pattern.y.data() + s));
  const CellPlane<float>& plane = item.plane;
  return hn::Add(hn::Add(hn::Set(d, plane.z), hn::Mul(hn::Set(d, plane.dzdx), x)), hn::Mul(hn::Set(d, plane.dzdy), y));
}

template <class D>
HWY_INLINE hn::Mask<D> samples_at(D d, std::uint32_t mask, std::size_t s) {
  const std::uint8_t bits[8] = {static_cast<std::uint8_t>(mask >> s), static_cast<std::uint8_t>(mask >> s >> 8)};
  return hn::LoadMaskBits(d, bits);
}

template <class D>
HWY_INLINE std::uint32_t mask_bits(D d, hn::Mask<D> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | std::uint32_t{bytes[1]} << 8;
}

SampleCounts depth_test_kernel(const CellDepth* items, std::size_t count, const SamplePattern& pattern,
                               const SampleSurface& surface, std::uint32_t* passed_masks) {
  const hn::CappedTag<float, kMaxMaskSamples> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const std::size_t lanes = hn::Lanes(d);
  const auto samples = static_cast<std::size_t>(pattern.count);
  SampleCounts counts{0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    const CellDepth& item = items[i];
    std::uint32_t mask = 0;
    for (std::size_t s = 0; s < samples; s += lanes) {
      const auto depth = depths_at(d, item, pattern, s);
      float* stored_depth = surface.depth + item.cell * samples + s;
      const auto pass = hn::And(hn::Lt(depth, hn::LoadU(d, stored_depth)), samples_at(d, item.mask, s));
      hn::BlendedStore(depth, pass, d, stored_depth);
      hn::BlendedStore(hn::Set(du, item.triangle), hn::RebindMask(du, pass), du,
                       surface.triangle + item.cell * samples + s);
      mask |= mask_bits(d, pass) << s;
    }
    counts.tested += population_count(item.mask);
    counts.passed += population_count(mask);
    if (passed_masks) passed_masks[i] = mask;
  }
  return counts;
}

SampleCounts depth_equal_kernel(const CellDepth* items, std::size_t count, const SamplePattern& pattern,
                                const float* depth, std::uint32_t* masks) {
  const hn::CappedTag<float, kMaxMaskSamples> d;
  const auto samples = static_cast<std::size_t>(pattern.count);
  SampleCounts counts{0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    const CellDepth& item = items[i];
    std::uint32_t mask = 0;
    for (std::size_t s = 0; s < samples; s += hn::Lanes(d)) {
      const auto equal = hn::Eq(depths_at(d, item, pattern, s), hn::LoadU(d, depth + item.cell * samples + s));
      mask |= mask_bits(d, equal) << s;
    }
    masks[i] = mask & item.mask;
    counts.tested += population_count(item.mask);
    counts.passed += population_count(masks[i]);
  }
  return counts;
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(depth_test_kernel);
SampleCounts depth_test(const CellDepth* items, std::size_t count, const SamplePattern& pattern,
                        const SampleSurface& surface, std::uint32_t* passed) {
  return HWY_DYNAMIC_DISPATCH(depth_test_kernel)(items, count, pattern, surface, passed);
}
HWY_EXPORT(depth_equal_kernel);
SampleCounts depth_equal(const CellDepth* items, std::size_t count, const SamplePattern& pattern, const float* depth,
                         std::uint32_t* masks) {
  return HWY_DYNAMIC_DISPATCH(depth_equal_kernel)(items, count, pattern, depth, masks);
}
}  // namespace beampipe
#endif
