#include "simd/depth_span.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/depth_span.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::uint64_t depth_span_kernel(const DepthSpan& span, std::size_t count, std::uint64_t owner_id, double* depth,
                                std::uint64_t* owner) {
  const hn::ScalableTag<double> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN double lane_index[hn::MaxLanes(d)];
  for (std::size_t lane = 0; lane < lanes; ++lane) lane_index[lane] = static_cast<double>(lane);
  const auto z = hn::Set(d, span.z), dzdx = hn::Set(d, span.dzdx), row = hn::Set(d, span.row);
  const auto first = hn::Load(d, lane_index);
  const auto id = hn::Set(du, owner_id);
  std::uint64_t passed = 0;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto index = hn::Add(hn::Set(d, static_cast<double>(i)), first);
    const auto x = hn::Add(hn::Set(d, span.x), hn::Mul(hn::Set(d, span.step), index));
    const auto at = hn::Add(hn::Add(z, hn::Mul(dzdx, x)), row);
    const auto pass = hn::Lt(at, hn::LoadU(d, depth + i));
    hn::BlendedStore(at, pass, d, depth + i);
    hn::BlendedStore(id, hn::RebindMask(du, pass), du, owner + i);
    passed += hn::CountTrue(d, pass);
  }
  return passed + depth_span_scalar(span, i, count, owner_id, depth, owner);
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(depth_span_kernel);
std::uint64_t depth_span(const DepthSpan& span, std::size_t count, std::uint64_t owner_id, double* depth,
                         std::uint64_t* owner) {
  return HWY_DYNAMIC_DISPATCH(depth_span_kernel)(span, count, owner_id, depth, owner);
}
}  // namespace beampipe
#endif
