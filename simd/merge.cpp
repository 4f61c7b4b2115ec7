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
HWY_INLINE Surface merge_lanes(const Surface& in, U tiny_bits, const Surface& old, const SamplePattern& pattern,
                               const MergeRules& rules) {
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
  const bool cut_by_range = rules.extents == MergeRules::Extents::range;
  const auto slab_front = [&](V base) {
    const V front = hn::Sub(base, half_thickness);
    return cut_by_range ? clamp(front, old.z_min, old.z_max) : front;
  };
  const auto slab_back = [&](V base, V front) {
    const V back = hn::Add(base, half_thickness);
    return cut_by_range ? hn::Max(hn::Min(back, old.z_max), front) : back;
  };
  const bool transition = rules.overlap == MergeRules::Overlap::transition;
  U front_mask = none, back_mask = none;
  V fuzzy_u = zero, fuzzy_v = zero, apart = zero;
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
    if (transition) {
      const V distance = hn::Abs(hn::Sub(depth, clamp(base, old.z_min, old.z_max)));
      apart = hn::Add(apart, hn::IfThenElseZero(present, distance));
    }
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
  const bool keep = rules.local == MergeRules::Local::keep;
  const V cover_i = keep ? local_i : hn::Min(local_i, one), cover_a = keep ? local_a : hn::Min(local_a, one);
  const V open_i = hn::Max(hn::Sub(one, cover_i), zero), open_a = hn::Max(hn::Sub(one, cover_a), zero);
  V fuzziness = zero;
  if (transition) {
    const V span = hn::Sub(hn::Max(in.z_max, old.z_max), hn::Min(in.z_min, old.z_min));
    const V distance =
        hn::Div(hn::Div(apart, hn::Max(count_bits(overlap), one)), hn::IfThenElse(hn::Gt(span, zero), span, one));
    const V left_open = hn::Abs(hn::Sub(hn::Div(count_bits(old.mask), bits), old.alpha));
    fuzziness = hn::Min(hn::Mul(left_open, distance), one);
  }
  const M tiny = hn::RebindMask(d, hn::Ne(tiny_bits, none));
  const auto what_is_left = [&](V cover, V open) {
    const V added = hn::Min(cover, open), independent = hn::Mul(cover, open);
    switch (rules.overlap) {
      case MergeRules::Overlap::over:
        return independent;
      case MergeRules::Overlap::add:
        return added;
      case MergeRules::Overlap::transition:
        return hn::Add(added, hn::Mul(hn::Sub(independent, added), fuzziness));
      case MergeRules::Overlap::tiny:
        break;
    }
    return hn::IfThenElse(tiny, added, independent);
  };
  const V over_a = what_is_left(cover_a, open_i), under_i = what_is_left(cover_i, open_a);
  V fuzzy_i = hn::Mul(cover_i, hn::Sub(one, delta)), fuzzy_a = hn::Mul(cover_a, delta);
  if (rules.fuzzy == MergeRules::Fuzzy::mix) {
    fuzzy_i = hn::Add(cover_i, hn::Mul(hn::Sub(under_i, cover_i), delta));
    fuzzy_a = hn::Add(over_a, hn::Mul(hn::Sub(cover_a, over_a), delta));
  } else if (rules.overlap != MergeRules::Overlap::over) {
    fuzzy_i = hn::IfThenElse(tiny, cover_i, fuzzy_i);
    fuzzy_a = hn::IfThenElse(tiny, over_a, fuzzy_a);
  }

  const auto combine = [&](V only, V local, V over, V under, V fuzzy) {
    const V sum = hn::Add(hn::Add(hn::Add(hn::Mul(only, local), hn::Mul(in_front, over)), hn::Mul(behind, under)),
                          hn::Mul(within, fuzzy));
    return hn::Div(sum, bits);
  };
  const V weight_i = combine(only_i, local_i, cover_i, under_i, fuzzy_i);
  const V weight_a = combine(only_a, local_a, over_a, cover_a, fuzzy_a);
  const V total = hn::Add(weight_i, weight_a);
  const V scale = hn::Div(one, hn::Max(total, one));
  const V least = hn::Set(d, 1e-30f);
  const V scale_i = hn::Div(hn::Mul(weight_i, scale), hn::Max(in.alpha, least));
  const V scale_a = hn::Div(hn::Mul(weight_a, scale), hn::Max(old.alpha, least));

  Surface merged;
  merged.alpha = hn::Mul(total, scale);
  merged.mask = hn::Or(in.mask, old.mask);
  for (int c = 0; c < 3; ++c) merged.color[c] = hn::Add(hn::Mul(in.color[c], scale_i), hn::Mul(old.color[c], scale_a));

  const bool by_area = rules.plane == MergeRules::Plane::area;
  const V part_i = by_area ? in.alpha : weight_i, part_a = by_area ? old.alpha : weight_a;
  const V share_i = hn::Div(part_i, hn::Add(part_i, part_a)), share_a = hn::Sub(one, share_i);
  const M first = hn::RebindMask(d, hn::Eq(old.mask, none));
  const auto blend = [&](V p_i, V p_a) {
    return hn::IfThenElse(first, p_i, hn::Add(hn::Mul(p_i, share_i), hn::Mul(p_a, share_a)));
  };
  merged.z = blend(in.z, old.z);
  merged.dzdu = blend(in.dzdu, old.dzdu);
  merged.dzdv = blend(in.dzdv, old.dzdv);
  const bool visible_only = rules.slab == MergeRules::Slab::visible;
  const bool containing = rules.thickness == MergeRules::Thickness::containing;
  const U reached = visible_only ? hn::AndNot(back_mask, in.mask) : in.mask;
  V farthest = zero, moved = zero;
  for (std::size_t s = 0; s < 32; ++s) {
    const V at_u = position(pattern.x, s), at_v = position(pattern.y, s);
    const auto has_position = [&](U mask) {
      return hn::RebindMask(d, hn::Ne(hn::And(mask, hn::Set(du, 1u << s)), none));
    };
    const V at = clamp(depth_at(in.z, in.dzdu, in.dzdv, at_u, at_v), in.z_min, in.z_max);
    const V middle = depth_at(merged.z, merged.dzdu, merged.dzdv, at_u, at_v);
    farthest = hn::IfThenElse(has_position(reached), hn::Max(farthest, hn::Abs(hn::Sub(at, middle))), farthest);
    if (containing) {
      const V shift = hn::Abs(hn::Sub(depth_at(old.z, old.dzdu, old.dzdv, at_u, at_v), middle));
      moved = hn::IfThenElse(has_position(old.mask), hn::Max(moved, shift), moved);
    }
  }
  const V kept = containing ? hn::Add(old.thickness, hn::Add(moved, moved)) : old.thickness;
  merged.thickness = hn::IfThenElse(first, zero, hn::Max(kept, hn::Add(farthest, farthest)));
  merged.z_min = hn::Min(in.z_min, old.z_min);
  merged.z_max = hn::Max(in.z_max, old.z_max);
  if (visible_only) {
    const M hidden = hn::RebindMask(d, hn::Eq(reached, none));
    const auto unless_hidden = [&](V now, V before) { return hn::IfThenElse(hidden, before, now); };
    merged.z = unless_hidden(merged.z, old.z);
    merged.dzdu = unless_hidden(merged.dzdu, old.dzdu);
    merged.dzdv = unless_hidden(merged.dzdv, old.dzdv);
    merged.thickness = unless_hidden(merged.thickness, old.thickness);
    merged.z_min = unless_hidden(merged.z_min, old.z_min);
    merged.z_max = unless_hidden(merged.z_max, old.z_max);
  }
  return merged;
}

void merge_kernel(const MergeFragment* fragments, std::size_t count, const SamplePattern& pattern,
                  const MergeRules& rules, Aggregate* aggregates) {
  const D d;
  const DU du;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN float in[kFragmentColumns * hn::MaxLanes(d)], out[kSurfaceColumns * hn::MaxLanes(d)];
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t n = HWY_MIN(lanes, count - first);
    rows_to_columns(fragments + first, n, lanes, in);
    rows_to_columns(aggregates + first, n, lanes, out);
    const U tiny = hn::BitCast(du, hn::Load(d, in + kSurfaceColumns * lanes));
    const Surface merged = merge_lanes(load_surface(in, lanes), tiny, load_surface(out, lanes), pattern, rules);
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
void merge(const MergeFragment* fragments, std::size_t count, const SamplePattern& pattern, const MergeRules& rules,
           Aggregate* aggregates) {
  HWY_DYNAMIC_DISPATCH(merge_kernel)(fragments, count, pattern, rules, aggregates);
}
}  // namespace beampipe
#endif
