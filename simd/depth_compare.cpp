#include "simd/depth_compare.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/depth_compare.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The pattern's positions as floats.
struct PatternPositions {
  explicit PatternPositions(const SamplePattern& pattern) {
    for (std::size_t s = 0; s < kMaxMaskSamples; ++s)
      x[s] = static_cast<float>(pattern.x[s]), y[s] = static_cast<float>(pattern.y[s]);
  }
  alignas(64) float x[kMaxMaskSamples], y[kMaxMaskSamples];
};

// The depth of samples s, s + 1, ... of a cell.
template <class D>
HWY_INLINE hn::Vec<D> depths_at(D d, const CellPlane<float>& plane, const PatternPositions& positions, std::size_t s) {
  const auto x = hn::Load(d, positions.x + s), y = hn::Load(d, positions.y + s);
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

// test(d, item, plane, s): the mask of samples s, s + 1, ... that pass.
template <class D, class Test>
HWY_INLINE SampleCounts each_cell(D d, SampleAccess* items, const CellPlane<float>* planes, std::size_t count,
                                  std::size_t samples, Test&& test) {
  SampleCounts counts{0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    SampleAccess& item = items[i];
    std::uint32_t passed = 0;
    for (std::size_t s = 0; s < samples; s += hn::Lanes(d)) passed |= mask_bits(d, test(d, item, planes[i], s)) << s;
    item.passed = passed;
    counts.tested += static_cast<std::uint64_t>(std::popcount(item.tested));
    counts.passed += static_cast<std::uint64_t>(std::popcount(passed));
  }
  return counts;
}

// With as many lanes as the pattern has samples, if there are so many. Wider vectors would reach into cells that
// earlier items have just stored, and wait for them.
template <class Test>
HWY_INLINE SampleCounts each_cell(SampleAccess* items, const CellPlane<float>* planes, std::size_t count,
                                  std::size_t samples, Test&& test) {
  if (samples <= 4) return each_cell(hn::CappedTag<float, 4>(), items, planes, count, samples, test);
  if (samples <= 8) return each_cell(hn::CappedTag<float, 8>(), items, planes, count, samples, test);
  return each_cell(hn::CappedTag<float, kMaxMaskSamples>(), items, planes, count, samples, test);
}

SampleCounts depth_test_kernel(SampleAccess* items, const CellPlane<float>* planes, std::size_t count,
                               const SamplePattern& pattern, const SampleSurface& surface) {
  const auto samples = static_cast<std::size_t>(pattern.count);
  const PatternPositions positions(pattern);
  float* const depths = surface.depth;
  std::uint32_t* const triangles = surface.triangle;
  // A masked store would be slower, because later loads would have to wait for it.
  const auto test = [=, &positions](auto d, const SampleAccess& item, const CellPlane<float>& plane, std::size_t s) {
    const hn::RebindToUnsigned<decltype(d)> du;
    const std::size_t at = item.cell * samples + s;
    const auto depth = depths_at(d, plane, positions, s), stored = hn::LoadU(d, depths + at);
    const auto pass = hn::And(hn::Lt(depth, stored), samples_at(d, item.tested, s));
    const auto owner = hn::LoadU(du, triangles + at);
    hn::StoreU(hn::IfThenElse(pass, depth, stored), d, depths + at);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(du, pass), hn::Set(du, item.triangle), owner), du, triangles + at);
    return pass;
  };
  return each_cell(items, planes, count, samples, test);
}

SampleCounts depth_equal_kernel(SampleAccess* items, const CellPlane<float>* planes, std::size_t count,
                                const SamplePattern& pattern, const float* depths) {
  const auto samples = static_cast<std::size_t>(pattern.count);
  const PatternPositions positions(pattern);
  const auto test = [=, &positions](auto d, const SampleAccess& item, const CellPlane<float>& plane, std::size_t s) {
    const auto stored = hn::LoadU(d, depths + item.cell * samples + s);
    return hn::And(hn::Eq(depths_at(d, plane, positions, s), stored), samples_at(d, item.tested, s));
  };
  return each_cell(items, planes, count, samples, test);
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(depth_test_kernel);
SampleCounts depth_test(SampleAccess* items, const CellPlane<float>* planes, std::size_t count,
                        const SamplePattern& pattern, const SampleSurface& surface) {
  return HWY_DYNAMIC_DISPATCH(depth_test_kernel)(items, planes, count, pattern, surface);
}
HWY_EXPORT(depth_equal_kernel);
SampleCounts depth_equal(SampleAccess* items, const CellPlane<float>* planes, std::size_t count,
                         const SamplePattern& pattern, const float* depth) {
  return HWY_DYNAMIC_DISPATCH(depth_equal_kernel)(items, planes, count, pattern, depth);
}
}  // namespace beampipe
#endif
