#include "simd/plane_order.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/plane_order.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kMaxMaskSamples>;
using V = hn::Vec<D>;

// From the pixel's centre: units to pixels is exact, so is the half.
HWY_INLINE V offsets(const std::int32_t* units) {
  const D d;
  const hn::RebindToSigned<D> di;
  const V pixels = hn::Mul(hn::ConvertTo(d, hn::Load(di, units)), hn::Set(d, 1.0f / kSubpixelUnits));
  return hn::Sub(pixels, hn::Set(d, 0.5f));
}

HWY_INLINE V depths(const DepthPlane<float>& plane, V u, V v) {
  const D d;
  const V along_u = hn::Add(hn::Set(d, plane.z), hn::Mul(hn::Set(d, plane.dzdu), u));
  return hn::Add(along_u, hn::Mul(hn::Set(d, plane.dzdv), v));
}

void nearer_positions_kernel(const DepthPlane<float>& plane, const DepthPlane<float>& other,
                             const SamplePattern* patterns, std::size_t words, std::uint32_t* masks) {
  const D d;
  for (std::size_t w = 0; w < words; ++w) {
    std::uint32_t mask = 0;
    for (std::size_t s = 0; s < kMaxMaskSamples; s += hn::Lanes(d)) {
      const V u = offsets(patterns[w].x.data() + s), v = offsets(patterns[w].y.data() + s);
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, hn::Lt(depths(plane, u, v), depths(other, u, v)), bytes);
      mask |= (bytes[0] | std::uint32_t{bytes[1]} << 8) << s;
    }
    masks[w] = mask;
  }
}

float nearest_depth_kernel(const DepthPlane<float>& plane, const SamplePattern* patterns, std::size_t words,
                           const std::uint32_t* masks) {
  const D d;
  V nearest = hn::Set(d, kNoDepth);
  for (std::size_t w = 0; w < words; ++w) {
    for (std::size_t s = 0; s < kMaxMaskSamples; s += hn::Lanes(d)) {
      const std::uint8_t bits[8] = {static_cast<std::uint8_t>(masks[w] >> s),
                                    static_cast<std::uint8_t>(masks[w] >> s >> 8)};
      const V u = offsets(patterns[w].x.data() + s), v = offsets(patterns[w].y.data() + s);
      nearest = hn::IfThenElse(hn::LoadMaskBits(d, bits), hn::Min(nearest, depths(plane, u, v)), nearest);
    }
  }
  return hn::GetLane(hn::MinOfLanes(d, nearest));
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(nearer_positions_kernel);
void nearer_positions(const DepthPlane<float>& plane, const DepthPlane<float>& other, const SamplePattern* patterns,
                      std::size_t words, std::uint32_t* masks) {
  HWY_DYNAMIC_DISPATCH(nearer_positions_kernel)(plane, other, patterns, words, masks);
}
HWY_EXPORT(nearest_depth_kernel);
float nearest_depth(const DepthPlane<float>& plane, const SamplePattern* patterns, std::size_t words,
                    const std::uint32_t* masks) {
  return HWY_DYNAMIC_DISPATCH(nearest_depth_kernel)(plane, patterns, words, masks);
}
}  // namespace beampipe
#endif
