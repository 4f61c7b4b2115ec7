#include "simd/merge.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/merge.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using DU = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;
using U = hn::Vec<DU>;
using M = hn::Mask<D>;

struct Surface {
  V alpha;
  U mask;
  V z, dzdu, dzdv, thickness, z_min, z_max, color[3];
};
constexpr std::size_t kSurfaceColumns = sizeof(Aggregate) / sizeof(float);
constexpr std::size_t kFragmentColumns = sizeof(MergeFragment) / sizeof(float);

// Columns in the order of AggregateOf's members.
HWY_INLINE Surface load_surface(const float* columns, std::size_t lanes) {
  const D d;
  const DU du;
  const auto column = [&](std::size_t i) { return hn::Load(d, columns + i * lanes); };
  return {column(0), hn::BitCast(du, column(1)),        column(2), column(3), column(4), column(5), column(6),
          column(7), {column(8), column(9), column(10)}};
}

HWY_INLINE V count_bits(U mask) {
  const D d;
  return hn::ConvertTo(d, hn::BitCast(hn::RebindToSigned<D>(), hn::PopulationCount(mask)));
}

HWY_INLINE V depth_at(V z, V dzdu, V dzdv, V u, V v) { return hn::Add(hn::Add(z, hn::Mul(dzdu, u)), hn::Mul(dzdv, v)); }

// The same steps as merge_scalar, a vector at a time.
HWY_INLINE Surface merge_lanes(const Surface& in, U tiny_bits, const Surface& old, const SamplePattern& pattern) {
  const D d;
  const DU du;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f), bits = hn::Set(d, 32.0f);
  const U none = hn::Zero(du);
  const auto clamp = [](V value, V low, V high) { return hn::Min(hn::Max(value, low), high); };
  const auto position = [&](const auto& values, std::size_t s) {
    return hn::Set(d, static_cast<float>(values[s]) / kSubpixelUnits - 0.5f);
  };

  const U overlap = hn::And(in.mask, old.mask);
  const V only_i = count_bits(hn::AndNot(old.mask, in.mask)), only_a = count_bits(hn::AndNot(in.mask, old.mask));

  const V half_thickness = hn::Mul(half, old.thickness);
  const auto slab_front = [&](V base) { return clamp(hn::Sub(base, half_thickness), old.z_min, old.z_max); };
  const auto slab_back = [&](V base, V front) {
    return hn::Max(hn::Min(hn::Add(base, half_thickness), old.z_max), front);
  };
  U front_mask = none, back_mask = none;
  V fuzzy_u = zero, fuzzy_v = zero;
  for (std::size_t s = 0; s < 32; ++s) {
    const V u = position(pattern.x, s), v = position(pattern.y, s);
    const V depth = clamp(depth_at(in.z, in.dzdu, in.dzdv, u, v), in.z_min, in.z_max);
    const V base = depth_at(old.z, old.dzdu, old.dzdv, u, v);
    const V front = slab_front(base), back = slab_back(base, front);
    const M is_front = hn::Lt(depth, front), is_back = hn::Ge(depth, back);
    const U here = hn::And(overlap, hn::Set(du, 1u << s));
    front_mask = hn::Or(front_mask, hn::IfThenElseZero(hn::RebindMask(du, is_front), here));
    back_mask = hn::Or(back_mask, hn::IfThenElseZero(hn::RebindMask(du, is_back), here));
    const M present = hn::RebindMask(d, hn::Ne(here, none));
    const M fuzzy = hn::AndNot(hn::Or(is_front, is_back), present);
    fuzzy_u = hn::Add(fuzzy_u, hn::IfThenElseZero(fuzzy, u));
    fuzzy_v = hn::Add(fuzzy_v, hn::IfThenElseZero(fuzzy, v));
  }
  const V in_front = count_bits(front_mask), behind = count_bits(back_mask);
  const V within = count_bits(hn::AndNot(back_mask, hn::AndNot(front_mask, overlap)));

  const V safe_within = hn::Max(within, one);
  const V u = hn::Div(fuzzy_u, safe_within), v = hn::Div(fuzzy_v, safe_within);
  const V base = depth_at(old.z, old.dzdu, old.dzdv, u, v);
  const V front = slab_front(base), back = slab_back(base, front);
  const V extent = hn::Sub(back, front);
  const V depth = clamp(depth_at(in.z, in.dzdu, in.dzdv, u, v), in.z_min, in.z_max);
  const V delta = clamp(hn::Div(hn::Sub(depth, front), hn::IfThenElse(hn::Gt(extent, zero), extent, one)), zero, one);

  const V local_i = hn::Div(hn::Mul(in.alpha, bits), hn::Max(count_bits(in.mask), one));
  const V local_a = hn::Div(hn::Mul(old.alpha, bits), hn::Max(count_bits(old.mask), one));
  const V cover_i = hn::Min(local_i, one), cover_a = hn::Min(local_a, one);
  const M tiny = hn::RebindMask(d, hn::Ne(tiny_bits, none));
  const V open_i = hn::Sub(one, cover_i), open_a = hn::Sub(one, cover_a);
  const V a_beside_i = hn::IfThenElse(tiny, hn::Min(cover_a, open_i), hn::Mul(cover_a, open_i));
  const V i_beside_a = hn::IfThenElse(tiny, hn::Min(cover_i, open_a), hn::Mul(cover_i, open_a));
  const V fuzzy_i = hn::IfThenElse(tiny, cover_i, hn::Mul(cover_i, hn::Sub(one, delta)));
  const V fuzzy_a = hn::IfThenElse(tiny, a_beside_i, hn::Mul(cover_a, delta));

  const auto combine = [&](V only, V local, V over, V under, V fuzzy) {
    const V sum = hn::Add(hn::Add(hn::Add(hn::Mul(only, local), hn::Mul(in_front, over)), hn::Mul(behind, under)),
                          hn::Mul(within, fuzzy));
    return hn::Div(sum, bits);
  };
  const V weight_i = combine(only_i, local_i, cover_i, i_beside_a, fuzzy_i);
  const V weight_a = combine(only_a, local_a, a_beside_i, cover_a, fuzzy_a);
  const V total = hn::Add(weight_i, weight_a);
  const V scale = hn::Div(one, hn::Max(total, one));
  const V least = hn::Set(d, 1e-30f);
  const V scale_i = hn::Div(hn::Mul(weight_i, scale), hn::Max(in.alpha, least));
  const V scale_a = hn::Div(hn::Mul(weight_a, scale), hn::Max(old.alpha, least));

  Surface merged;
  merged.alpha = hn::Mul(total, scale);
  merged.mask = hn::Or(in.mask, old.mask);
  for (int c = 0; c < 3; ++c) merged.color[c] = hn::Add(hn::Mul(in.color[c], scale_i), hn::Mul(old.color[c], scale_a));

  const V share_i = hn::Div(in.alpha, hn::Add(in.alpha, old.alpha)), share_a = hn::Sub(one, share_i);
  const M first = hn::RebindMask(d, hn::Eq(old.mask, none));
  const auto blend = [&](V p_i, V p_a) {
    return hn::IfThenElse(first, p_i, hn::Add(hn::Mul(p_i, share_i), hn::Mul(p_a, share_a)));
  };
  merged.z = blend(in.z, old.z);
  merged.dzdu = blend(in.dzdu, old.dzdu);
  merged.dzdv = blend(in.dzdv, old.dzdv);
  V farthest = zero;
  for (std::size_t s = 0; s < 32; ++s) {
    const V at_u = position(pattern.x, s), at_v = position(pattern.y, s);
    const V at = clamp(depth_at(in.z, in.dzdu, in.dzdv, at_u, at_v), in.z_min, in.z_max);
    const V distance = hn::Abs(hn::Sub(at, depth_at(merged.z, merged.dzdu, merged.dzdv, at_u, at_v)));
    const M covered = hn::RebindMask(d, hn::Ne(hn::And(in.mask, hn::Set(du, 1u << s)), none));
    farthest = hn::IfThenElse(covered, hn::Max(farthest, distance), farthest);
  }
  merged.thickness = hn::IfThenElse(first, zero, hn::Max(old.thickness, hn::Add(farthest, farthest)));
  merged.z_min = hn::Min(in.z_min, old.z_min);
  merged.z_max = hn::Max(in.z_max, old.z_max);
  return merged;
}

void merge_kernel(const MergeFragment* fragments, std::size_t count, const SamplePattern& pattern,
                  Aggregate* aggregates) {
  const D d;
  const DU du;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN float in[kFragmentColumns * hn::MaxLanes(d)], out[kSurfaceColumns * hn::MaxLanes(d)];
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t n = HWY_MIN(lanes, count - first);
    rows_to_columns(fragments + first, n, lanes, in);
    rows_to_columns(aggregates + first, n, lanes, out);
    const U tiny = hn::BitCast(du, hn::Load(d, in + kSurfaceColumns * lanes));
    const Surface merged = merge_lanes(load_surface(in, lanes), tiny, load_surface(out, lanes), pattern);
    const V columns[kSurfaceColumns] = {merged.alpha,    hn::BitCast(d, merged.mask),
                                        merged.z,        merged.dzdu,
                                        merged.dzdv,     merged.thickness,
                                        merged.z_min,    merged.z_max,
                                        merged.color[0], merged.color[1],
                                        merged.color[2]};
    for (std::size_t i = 0; i < kSurfaceColumns; ++i) hn::Store(columns[i], d, out + i * lanes);
    columns_to_rows(out, n, lanes, aggregates + first);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(merge_kernel);
void merge(const MergeFragment* fragments, std::size_t count, const SamplePattern& pattern, Aggregate* aggregates) {
  HWY_DYNAMIC_DISPATCH(merge_kernel)(fragments, count, pattern, aggregates);
}
}  // namespace beampipe
#endif
