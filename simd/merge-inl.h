// The formulas of simd/merge.h. No include guard: see simd/scalar.h.

// How much of the fragment (i, for incoming) and of the aggregate (a) is visible in one region of mask positions.
template <class Float>
struct BlendFactors {
  Float i, a;
};

template <class Float, class Mask>
AggregateOf<Float, Mask> merge_formula(const FragmentOf<Float, Mask>& fragment, const AggregateOf<Float, Mask>& old,
                                       const SamplePattern& pattern, const MergeRules& rules) {
  const Float zero(0.0f), one(1.0f), half(0.5f), bits(32.0f);
  const AggregateOf<Float, Mask>& in = fragment.surface;
  const auto clamp = [&](Float value, Float low, Float high) { return lesser(greater(value, low), high); };

  // (1) Partition xy by the masks.
  const Mask overlap = in.mask & old.mask;
  const Float only_i = bit_count(in.mask & ~old.mask), only_a = bit_count(old.mask & ~in.mask);

  // (2) Partition the overlap by depth: in front of, behind and within the aggregate's slab, position by position.
  // Equal depth counts as behind, so that the earlier fragment wins.
  const Float half_thickness = half * old.thickness;
  const bool cut_by_range = rules.extents == MergeRules::Extents::range;
  const auto slab_front = [&](Float base) {
    const Float front = base - half_thickness;
    return cut_by_range ? clamp(front, old.z_min, old.z_max) : front;
  };
  const auto slab_back = [&](Float base, Float front) {
    const Float back = base + half_thickness;
    return cut_by_range ? greater(lesser(back, old.z_max), front) : back;
  };
  const bool transition = rules.overlap == MergeRules::Overlap::transition;
  Mask front_mask(0u), back_mask(0u);
  Float fuzzy_u = zero, fuzzy_v = zero, apart = zero;
  for (int s = 0; s < 32; ++s) {
    const auto k = static_cast<std::size_t>(s);
    const Float u(static_cast<float>(pattern.x[k]) / kSubpixelUnits - 0.5f);
    const Float v(static_cast<float>(pattern.y[k]) / kSubpixelUnits - 0.5f);
    const Float depth = clamp(depth_at(in.plane, u, v), in.z_min, in.z_max);
    const Float base = depth_at(old.plane, u, v);
    const Float front = slab_front(base), back = slab_back(base, front);
    const auto is_front = depth < front, is_back = depth >= back;
    const Mask here = overlap & Mask(1u << s);
    front_mask = front_mask | select(is_front, here, Mask(0u));
    back_mask = back_mask | select(is_back, here, Mask(0u));
    const auto fuzzy = (here != Mask(0u)) & !(is_front | is_back);
    fuzzy_u = fuzzy_u + select(fuzzy, u, zero);
    fuzzy_v = fuzzy_v + select(fuzzy, v, zero);
    if (transition) {
      const Float distance = magnitude(depth - clamp(base, old.z_min, old.z_max));
      apart = apart + select(here != Mask(0u), distance, zero);
    }
  }
  const Float in_front = bit_count(front_mask), behind = bit_count(back_mask);
  const Float within = bit_count(overlap & ~front_mask & ~back_mask);

  // Delta: where the fragment lies in the slab, from 0 at its front to 1 at its back. It is taken at the mean of the
  // positions within the slab.
  const Float safe_within = greater(within, one);
  const Float u = fuzzy_u / safe_within, v = fuzzy_v / safe_within;
  const Float base = depth_at(old.plane, u, v);
  const Float front = slab_front(base), back = slab_back(base, front);
  const Float extent = back - front;
  const Float depth = clamp(depth_at(in.plane, u, v), in.z_min, in.z_max);
  const Float delta = clamp((depth - front) / select(extent > zero, extent, one), zero, one);

  // (3) Blending factors per region. Local coverage is alpha divided by the part of the mask that is set.
  const Float local_i = in.alpha * bits / greater(bit_count(in.mask), one);
  const Float local_a = old.alpha * bits / greater(bit_count(old.mask), one);
  const bool keep = rules.local == MergeRules::Local::keep;
  const Float cover_i = keep ? local_i : lesser(local_i, one), cover_a = keep ? local_a : lesser(local_a, one);
  struct Cover {
    Float i, a, open_i, open_a;
  };
  const auto cover_of = [&](Float i, Float a) { return Cover{i, a, greater(one - i, zero), greater(one - a, zero)}; };
  const bool by_share = rules.regional == MergeRules::Regional::area;
  const Cover local_cover = cover_of(cover_i, cover_a);
  const auto cover_in = [&](Float count) {
    if (!by_share) return local_cover;
    const Float share = count / bits;
    return cover_of(cover_i * share, cover_a * share);
  };
  // The fuzziness of slide 12. The slide does not define sadp(A, B). Here it is the mean absolute difference of the two
  // depths over the overlap, divided by the depth range of both together. It is near 0 for neighbours in a mesh, which
  // lie beside each other. The other factor is the part of A's mask that A leaves open, 0 for a closed surface.
  Float fuzziness = zero;
  if (transition) {
    const Float span = greater(in.z_max, old.z_max) - lesser(in.z_min, old.z_min);
    const Float distance = apart / greater(bit_count(overlap), one) / select(span > zero, span, one);
    fuzziness = lesser(magnitude(bit_count(old.mask) / bits - old.alpha) * distance, one);
  }
  const auto tiny = fragment.tiny != Mask(0u);
  const auto what_is_left = [&](Float cover, Float open) {
    const Float added = lesser(cover, open), independent = cover * open;
    switch (rules.overlap) {
      case MergeRules::Overlap::over:
        return independent;
      case MergeRules::Overlap::add:
        return added;
      case MergeRules::Overlap::transition:
        return added + (independent - added) * fuzziness;
      case MergeRules::Overlap::tiny:
        break;
    }
    return select(tiny, added, independent);
  };
  const auto over_in = [&](const Cover& c) { return BlendFactors<Float>{c.i, what_is_left(c.a, c.open_i)}; };
  const auto under_in = [&](const Cover& c) { return BlendFactors<Float>{what_is_left(c.i, c.open_a), c.a}; };
  const BlendFactors<Float> over = over_in(cover_in(in_front)), under = under_in(cover_in(behind));
  const Cover slab = cover_in(within);
  const BlendFactors<Float> slab_over = by_share ? over_in(slab) : over, slab_under = by_share ? under_in(slab) : under;
  BlendFactors<Float> fuzzy;
  if (rules.fuzzy == MergeRules::Fuzzy::mix) {
    fuzzy = {slab_over.i + (slab_under.i - slab_over.i) * delta, slab_over.a + (slab_under.a - slab_over.a) * delta};
  } else if (rules.overlap == MergeRules::Overlap::over) {
    fuzzy = {slab.i * (one - delta), slab.a * delta};
  } else {  // specks are anti-correlated "over the overlapping regions" (section 2.2.1), and this is one of them
    fuzzy = {select(tiny, slab_over.i, slab.i * (one - delta)), select(tiny, slab_over.a, slab.a * delta)};
  }

  // (4) Combine: each region counts with its number of bits, unless its coverage is an area already. Because masks have
  // errors the sum may exceed 1; then it is scaled down to 1.
  const Float times_over = by_share ? bits : in_front, times_under = by_share ? bits : behind,
              times_fuzzy = by_share ? bits : within;
  const Float weight_i =
      (only_i * local_i + times_over * over.i + times_under * under.i + times_fuzzy * fuzzy.i) / bits;
  const Float weight_a =
      (only_a * local_a + times_over * over.a + times_under * under.a + times_fuzzy * fuzzy.a) / bits;
  const Float scale = one / greater(weight_i + weight_a, one);
  const Float scale_i = weight_i * scale / greater(in.alpha, Float(1e-30f));
  const Float scale_a = weight_a * scale / greater(old.alpha, Float(1e-30f));

  AggregateOf<Float, Mask> merged;
  merged.alpha = (weight_i + weight_a) * scale;
  merged.mask = in.mask | old.mask;
  for (int c = 0; c < 3; ++c) merged.color[c] = in.color[c] * scale_i + old.color[c] * scale_a;

  // The new slab: the coverage-weighted mean of both planes, thick enough to reach the fragment at all of its
  // positions.
  const bool by_area = rules.plane == MergeRules::Plane::area;
  const Float part_i = by_area ? in.alpha : weight_i, part_a = by_area ? old.alpha : weight_a;
  const Float share_i = part_i / (part_i + part_a), share_a = one - share_i;
  const auto first = old.mask == Mask(0u);
  const auto blend = [&](Float p_i, Float p_a) { return select(first, p_i, p_i * share_i + p_a * share_a); };
  merged.plane = {blend(in.plane.z, old.plane.z), blend(in.plane.dzdu, old.plane.dzdu),
                  blend(in.plane.dzdv, old.plane.dzdv)};
  const bool visible_only = rules.slab == MergeRules::Slab::visible;
  const bool containing = rules.thickness == MergeRules::Thickness::containing;
  const Mask reached = visible_only ? in.mask & ~back_mask : in.mask;
  Float farthest = zero, moved = zero;
  for (int s = 0; s < 32; ++s) {
    const auto k = static_cast<std::size_t>(s);
    const Float at_u(static_cast<float>(pattern.x[k]) / kSubpixelUnits - 0.5f);
    const Float at_v(static_cast<float>(pattern.y[k]) / kSubpixelUnits - 0.5f);
    const Float at = clamp(depth_at(in.plane, at_u, at_v), in.z_min, in.z_max);
    const Float middle = depth_at(merged.plane, at_u, at_v);
    farthest = select((reached & Mask(1u << s)) != Mask(0u), greater(farthest, magnitude(at - middle)), farthest);
    if (containing) {
      const Float shift = magnitude(depth_at(old.plane, at_u, at_v) - middle);
      moved = select((old.mask & Mask(1u << s)) != Mask(0u), greater(moved, shift), moved);
    }
  }
  const Float kept = containing ? old.thickness + (moved + moved) : old.thickness;
  merged.thickness = select(first, zero, greater(kept, farthest + farthest));
  merged.z_min = lesser(in.z_min, old.z_min);
  merged.z_max = greater(in.z_max, old.z_max);
  if (visible_only) {
    const auto hidden = reached == Mask(0u);
    const auto unless_hidden = [&](Float now, Float earlier) { return select(hidden, earlier, now); };
    merged.plane = {unless_hidden(merged.plane.z, old.plane.z), unless_hidden(merged.plane.dzdu, old.plane.dzdu),
                    unless_hidden(merged.plane.dzdv, old.plane.dzdv)};
    merged.thickness = unless_hidden(merged.thickness, old.thickness);
    merged.z_min = unless_hidden(merged.z_min, old.z_min);
    merged.z_max = unless_hidden(merged.z_max, old.z_max);
  }
  return merged;
}

// Plain OVER of what is there on top of a fragment that lies behind it: alpha and colour alone, without masks.
template <class Float, class Mask>
AggregateOf<Float, Mask> over_formula(const FragmentOf<Float, Mask>& fragment, AggregateOf<Float, Mask> old) {
  const Float rest = Float(1.0f) - old.alpha;
  old.alpha = old.alpha + rest * fragment.surface.alpha;
  for (int c = 0; c < 3; ++c) old.color[c] = old.color[c] + rest * fragment.surface.color[c];
  return old;
}
