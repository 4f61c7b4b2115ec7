#include "simd/depth_test.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/depth_test.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::uint64_t depth_test_kernel(const CellDepth* items, std::size_t count, const SamplePattern& pattern,
                                const SampleSurface& surface) {
  const hn::CappedTag<float, kMaxMaskSamples> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const std::size_t lanes = hn::Lanes(d);
  const auto samples = static_cast<std::size_t>(pattern.count);
  std::uint64_t passed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const CellDepth& item = items[i];
    const auto z = hn::Set(d, item.z), dzdx = hn::Set(d, item.dzdx), dzdy = hn::Set(d, item.dzdy);
    for (std::size_t s = 0; s < samples; s += lanes) {
      const std::uint8_t bits[8] = {static_cast<std::uint8_t>(item.mask >> s),
                                    static_cast<std::uint8_t>(item.mask >> s >> 8)};
      const auto x = hn::ConvertTo(d, hn::Load(di, pattern.x.data() + s));
      const auto y = hn::ConvertTo(d, hn::Load(di, pattern.y.data() + s));
      const auto depth = hn::Add(hn::Add(z, hn::Mul(dzdx, x)), hn::Mul(dzdy, y));
      float* stored_depth = surface.depth + item.cell * samples + s;
      const auto pass = hn::And(hn::Lt(depth, hn::LoadU(d, stored_depth)), hn::LoadMaskBits(d, bits));
      hn::BlendedStore(depth, pass, d, stored_depth);
      hn::BlendedStore(hn::Set(du, item.triangle), hn::RebindMask(du, pass), du,
                       surface.triangle + item.cell * samples + s);
      passed += hn::CountTrue(d, pass);
    }
  }
  return passed;
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(depth_test_kernel);
std::uint64_t depth_test(const CellDepth* items, std::size_t count, const SamplePattern& pattern,
                         const SampleSurface& surface) {
  return HWY_DYNAMIC_DISPATCH(depth_test_kernel)(items, count, pattern, surface);
}
}  // namespace beampipe
#endif
