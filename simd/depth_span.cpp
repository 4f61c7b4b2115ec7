#include "simd/depth_span.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/depth_span.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

#include "simd/depth_span-inl.h"

std::uint64_t depth_span_kernel(const DepthSpan& span, std::size_t count, std::uint64_t owner_id, double* depth,
                                std::uint64_t* owner) {
  using D = hn::ScalableTag<double>;
  using Reals = Lanes<D>;
  const D d;
  const hn::RebindToUnsigned<D> du;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN double lane_index[hn::MaxLanes(d)];
  for (std::size_t lane = 0; lane < lanes; ++lane) lane_index[lane] = static_cast<double>(lane);
  const DepthSpanOf<Reals> all{Reals(span.z), Reals(span.dzdx), Reals(span.row), Reals(span.x), Reals(span.step)};
  const Reals first(hn::Load(d, lane_index));
  const auto id = hn::Set(du, owner_id);
  std::uint64_t passed = 0;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const Reals index = Reals(static_cast<double>(i)) + first, stored(hn::LoadU(d, depth + i));
    Reals at;
    const auto pass = depth_span_sample(all, index, stored, at).raw;
    hn::BlendedStore(at.raw, pass, d, depth + i);
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
