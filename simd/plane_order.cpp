#include "simd/plane_order.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/plane_order.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// This order: a formula finds only those above it.
#include "simd/depth_plane-inl.h"
//
#include "simd/plane_order-inl.h"

using D = hn::CappedTag<float, kMaxMaskSamples>;
using Reals = Lanes<D>;

HWY_INLINE DepthPlane<Reals> in_every_lane(const DepthPlane<float>& plane) {
  return {Reals(plane.z), Reals(plane.dzdu), Reals(plane.dzdv)};
}

void nearer_positions_kernel(const DepthPlane<float>& plane, const DepthPlane<float>& other,
                             const PositionOffsets* offsets, std::size_t words, std::uint32_t* masks,
                             const std::uint32_t* where) {
  const DepthPlane<Reals> of_plane = in_every_lane(plane), of_other = in_every_lane(other);
  for (std::size_t w = 0; w < words; ++w) {
    std::uint32_t mask = 0;
    masks[w] = 0;
    if (where && where[w] == 0) continue;
    for (std::size_t s = 0; s < kMaxMaskSamples; s += hn::Lanes(D())) {
      const Reals u(hn::Load(D(), offsets[w].u.data() + s)), v(hn::Load(D(), offsets[w].v.data() + s));
      mask |= mask_bits(nearer_formula(of_plane, of_other, u, v)) << s;
    }
    masks[w] = where ? mask & where[w] : mask;
  }
}

float farthest_depth_kernel(const DepthPlane<float>& plane, const PositionOffsets* offsets, std::size_t words,
                            const std::uint32_t* masks) {
  const DepthPlane<Reals> of_plane = in_every_lane(plane);
  Reals farthest(kInFront);
  for (std::size_t w = 0; w < words; ++w) {
    if (masks[w] == 0) continue;
    for (std::size_t s = 0; s < kMaxMaskSamples; s += hn::Lanes(D())) {
      const Reals u(hn::Load(D(), offsets[w].u.data() + s)), v(hn::Load(D(), offsets[w].v.data() + s));
      farthest = farthest_formula(of_plane, u, v, mask_of_bits<D>(masks[w], s), farthest);
    }
  }
  return hn::GetLane(hn::MaxOfLanes(D(), farthest.raw));
}

PositionSums position_sums_kernel(const SamplePattern* patterns, std::size_t words, const std::uint32_t* masks) {
  using DI = hn::RebindToSigned<D>;
  auto x = hn::Zero(DI()), y = hn::Zero(DI());
  for (std::size_t w = 0; w < words; ++w) {
    if (masks[w] == 0) continue;
    for (std::size_t s = 0; s < kMaxMaskSamples; s += hn::Lanes(D())) {
      const auto in_mask = hn::RebindMask(DI(), mask_of_bits<D>(masks[w], s).raw);
      x = hn::Add(x, hn::IfThenElseZero(in_mask, hn::Load(DI(), patterns[w].x.data() + s)));
      y = hn::Add(y, hn::IfThenElseZero(in_mask, hn::Load(DI(), patterns[w].y.data() + s)));
    }
  }
  return {hn::GetLane(hn::SumOfLanes(DI(), x)), hn::GetLane(hn::SumOfLanes(DI(), y))};
}

PositionSquares position_squares_kernel(const SamplePattern* patterns, std::size_t words, const std::uint32_t* masks) {
  using DI = hn::RebindToSigned<D>;
  auto xx = hn::Zero(DI()), xy = hn::Zero(DI()), yy = hn::Zero(DI());
  for (std::size_t w = 0; w < words; ++w) {
    if (masks[w] == 0) continue;
    for (std::size_t s = 0; s < kMaxMaskSamples; s += hn::Lanes(D())) {
      const auto in_mask = hn::RebindMask(DI(), mask_of_bits<D>(masks[w], s).raw);
      const auto x = hn::IfThenElseZero(in_mask, hn::Load(DI(), patterns[w].x.data() + s));
      const auto y = hn::IfThenElseZero(in_mask, hn::Load(DI(), patterns[w].y.data() + s));
      xx = hn::Add(xx, hn::Mul(x, x)), xy = hn::Add(xy, hn::Mul(x, y)), yy = hn::Add(yy, hn::Mul(y, y));
    }
  }
  return {hn::GetLane(hn::SumOfLanes(DI(), xx)), hn::GetLane(hn::SumOfLanes(DI(), xy)),
          hn::GetLane(hn::SumOfLanes(DI(), yy))};
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
std::vector<PositionOffsets> offsets_of(const std::vector<SamplePattern>& patterns) {
  std::vector<PositionOffsets> offsets(patterns.size());
  for (std::size_t w = 0; w < patterns.size(); ++w)
    for (std::size_t s = 0; s < kMaxMaskSamples; ++s)
      offsets[w].u[s] = position_u(patterns[w], s), offsets[w].v[s] = position_v(patterns[w], s);
  return offsets;
}
HWY_EXPORT(nearer_positions_kernel);
void nearer_positions(const DepthPlane<float>& plane, const DepthPlane<float>& other, const PositionOffsets* offsets,
                      std::size_t words, std::uint32_t* masks, const std::uint32_t* where) {
  HWY_DYNAMIC_DISPATCH(nearer_positions_kernel)(plane, other, offsets, words, masks, where);
}
HWY_EXPORT(farthest_depth_kernel);
float farthest_depth(const DepthPlane<float>& plane, const PositionOffsets* offsets, std::size_t words,
                     const std::uint32_t* masks) {
  return HWY_DYNAMIC_DISPATCH(farthest_depth_kernel)(plane, offsets, words, masks);
}
HWY_EXPORT(position_sums_kernel);
PositionSums position_sums(const SamplePattern* patterns, std::size_t words, const std::uint32_t* masks) {
  return HWY_DYNAMIC_DISPATCH(position_sums_kernel)(patterns, words, masks);
}
HWY_EXPORT(position_squares_kernel);
PositionSquares position_squares(const SamplePattern* patterns, std::size_t words, const std::uint32_t* masks) {
  return HWY_DYNAMIC_DISPATCH(position_squares_kernel)(patterns, words, masks);
}
}  // namespace beampipe
#endif
