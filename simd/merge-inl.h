// The formulas of simd/merge.h. No include guard: see simd/scalar.h. Unlike other formulas, merge_formula has
// early-outs: any() tells whether a part has work, and choose() takes its result where it has. Parts that are `inline`
// are so for g++, which would otherwise call them: a kernel takes a tenth longer then.

// How much of the fragment (i, for incoming) and of the aggregate (a) is visible in one region of mask positions, or in
// the whole pixel.
template <class Float>
struct BlendFactors {
  Float i, a;
};

// The positions that the fragment and the aggregate share.
template <class Mask>
struct SharedPositions {
  Mask mask, empty;                      // `empty`: without positions, a mask that counts, unlike a constant
  decltype(Mask() != Mask()) any_there;  // is there one?
};

// The positions at which the fragment is in front of the aggregate's slab or behind it.
template <class Mask>
struct DepthRegions {
  Mask front, back;
};

// What is where in the overlap of both.
template <class Float, class Mask>
struct OverlapParts {
  Mask front, back;  // positions at which the fragment is in front of the slab, and behind it
  Float within;      // how many positions are left, within the slab
  Float delta;       // where the fragment lies there, from 0 at the slab's front to 1 at its back
  Float fuzziness;   // with Overlap::transition
};

// The two ends of the aggregate's slab, in depth.
template <class Float>
struct SlabEnds {
  Float front, back;
};

// A direction in the pixel, as the table of masks sees it: the inward normal of half-planes.
template <class Float, class Mask>
struct LineDirection {
  decltype(to_integer(Float())) row;  // where the table's row for this angle begins
  Mask flip;                          // ~0 if the table has the opposite direction
  Float per_length;                   // 1 / length of the normal
};

// The row is that of table_angle(), with an approximation of the arc tangent that is wrong by at most 0.04 rows:
// atan(t) = t (pi / 4 + 0.273 (1 - t)) for 0 <= t <= 1.
template <class Float, class Mask>
LineDirection<Float, Mask> line_direction(Float a, Float b) {
  using Int = decltype(to_integer(Float()));
  const Float zero(0.0f), one(1.0f), right_angle(kTableAngles / 2);
  const auto is_below = b < zero, is_level = b == zero, is_left = a < zero;
  const auto flipped = is_below | (is_level & is_left);
  const Float size_a = magnitude(a), size_b = magnitude(b);
  const Float longer = greater(greater(size_a, size_b), Float(1e-30f)), t = lesser(size_a, size_b) / longer;
  const Float octant = t * (Float(kTableAngles / 4) + Float(2.781f) * (one - t));
  const Float acute = select(size_b > size_a, right_angle - octant, octant);
  const Float angle = select(is_left != flipped, right_angle + right_angle - acute, acute);
  const auto turns = angle >= Float(kTableAngles - 0.5f);  // pi is the reverse of 0
  const Int row = to_integer(select(turns, zero, angle + Float(0.5f)));
  return {row * Int(kTableDistances), select(flipped != turns, Mask(~0u), Mask(0u)),
          one / (longer * square_root(one + t * t))};
}

// The positions where a u + b v + c is 0 or more; (a, b) is the direction.
template <class Float, class Mask>
Mask half_plane(const LineDirection<Float, Mask>& direction, Float c, const MaskTable& table) {
  const auto flipped = direction.flip != Mask(0u);
  const Float distance = select(flipped, Float(0.0f) - c, c) * direction.per_length;
  return table_word<Mask>(direction.row, flipped, distance, table);
}

// Whether the line where the difference is 0 cuts the pixel, and if not, which side of it the pixel is on.
template <class Float>
auto cuts_pixel(Float c, Float reach) {
  const auto from_below = c < reach, from_above = Float(0.0f) - c < reach;
  return from_below & from_above;
}
template <class Float, class Mask>
Mask side_of_pixel(Float c, Float reach) {
  return select(c >= reach, Mask(~0u), Mask(0u));
}

template <class Float, class Mask>
Float clamped_depth(const AggregateOf<Float, Mask>& surface, Float u, Float v) {
  return lesser(greater(depth_at(surface.plane, u, v), surface.z_min), surface.z_max);
}

// `base`: the depth of the slab's plane.
template <class Float, class Mask>
SlabEnds<Float> slab_ends(const AggregateOf<Float, Mask>& old, Float base, const MergeRules& rules) {
  const Float half_thickness = Float(0.5f) * old.thickness;
  const Float front = base - half_thickness, back = base + half_thickness;
  if (rules.extents == MergeRules::Extents::slab) return {front, back};
  const Float limited = lesser(greater(front, old.z_min), old.z_max);
  return {limited, greater(lesser(back, old.z_max), limited)};
}

// Whether all of the fragment is in front of the slab, or behind it, by the depth ranges alone.
template <class Float, class Mask>
auto is_before(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old) {
  return in.z_max < old.z_min;
}
template <class Float, class Mask>
auto is_after(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old) {
  return in.z_min >= old.z_max;
}

// Partition::lines. The fragment's plane meets the front and the back of the slab in two parallel lines.
template <class Float, class Mask, class Bool>
DepthRegions<Mask> regions_by_lines(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old,
                                    Bool undecided, const MaskTable& table, MergeStepsOf<Mask>& steps) {
  const PlaneGap<Float> gap = plane_gap(in.plane, old.plane);
  const Float half_thickness = Float(0.5f) * old.thickness;
  const Float to_front = gap.z + half_thickness, to_back = gap.z - half_thickness;
  const auto cuts_front = undecided & cuts_pixel(to_front, gap.reach);
  const auto cuts_back = undecided & cuts_pixel(to_back, gap.reach);
  Mask behind_front = side_of_pixel<Float, Mask>(to_front, gap.reach);
  Mask behind_back = side_of_pixel<Float, Mask>(to_back, gap.reach);
  if (any(cuts_front | cuts_back)) {
    const auto direction = line_direction<Float, Mask>(gap.dzdu, gap.dzdv);
    if (any(cuts_front)) behind_front = choose(cuts_front, half_plane(direction, to_front, table), behind_front);
    if (any(cuts_back)) behind_back = choose(cuts_back, half_plane(direction, to_back, table), behind_back);
  }
  steps.lines = choose(undecided, Mask(1u), Mask(0u));
  steps.front_line = choose(cuts_front, Mask(1u), Mask(0u));
  steps.back_line = choose(cuts_back, Mask(1u), Mask(0u));
  return {~behind_front, behind_back};
}

// Calls visit(here, u, v, s) for the positions s, at (u, v), that a mask has in some lanes: those where `here` is true.
template <class Float, class Mask, class Visit>
inline void for_each_position(Mask mask, const SamplePattern& pattern, Visit&& visit) {
  for (int s = 0; s < 32; ++s) {
    const auto here = has_bit(mask, s);
    const auto i = static_cast<std::size_t>(s);
    if (any(here)) visit(here, Float(position_u(pattern, i)), Float(position_v(pattern, i)), s);
  }
}

// Partition::positions. Position by position, where the masks overlap.
template <class Float, class Mask>
DepthRegions<Mask> region_of_position(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old, Float u,
                                      Float v, Mask here, const MergeRules& rules) {
  const Float depth = clamped_depth(in, u, v);
  const SlabEnds<Float> ends = slab_ends(old, depth_at(old.plane, u, v), rules);
  return {select(depth < ends.front, here, Mask(0u)), select(depth >= ends.back, here, Mask(0u))};
}
template <class Float, class Mask>
inline DepthRegions<Mask> regions_by_positions(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old,
                                               DepthRegions<Mask> regions, const SamplePattern& pattern,
                                               const MergeRules& rules, const MergeStepsOf<Mask>& steps) {
  for_each_position<Float>(steps.tested, pattern, [&](const auto& is_here, Float u, Float v, int s) {
    const Mask here = choose(is_here, Mask(1u << s), Mask(0u));
    const DepthRegions<Mask> at = region_of_position(in, old, u, v, here, rules);
    regions = {regions.front | at.front, regions.back | at.back};
  });
  return regions;
}

// (2) Partition the overlap by depth: in front of, behind and within the aggregate's slab. Equal depth counts as
// behind, so that the earlier fragment wins.
template <class Float, class Mask>
DepthRegions<Mask> partition(const FragmentOf<Float, Mask>& fragment, const AggregateOf<Float, Mask>& old,
                             const SharedPositions<Mask>& shared, const MergePositions& positions,
                             const MergeRules& rules, MergeStepsOf<Mask>& steps) {
  if (rules.partition == MergeRules::Partition::given)
    return {shared.mask & fragment.front, shared.mask & ~fragment.front};
  const AggregateOf<Float, Mask>& in = fragment.surface;
  const bool ranged = rules.extents == MergeRules::Extents::range;
  const auto meets = shared.any_there;
  const auto never = meets & !meets;
  const auto before = ranged ? meets & is_before(in, old) : never;
  const auto after = ranged ? meets & is_after(in, old) : never;
  const auto undecided = meets & !(before | after);
  DepthRegions<Mask> regions{shared.empty, shared.empty};
  if (any(undecided)) {
    if (rules.partition == MergeRules::Partition::lines) {
      regions = regions_by_lines(in, old, undecided, positions.table, steps);
    } else {
      steps.tested = choose(undecided, shared.mask, Mask(0u));
      regions = regions_by_positions(in, old, regions, positions.pattern, rules, steps);
    }
  }
  return {choose(before, shared.mask, choose(after, shared.empty, regions.front & shared.mask)),
          choose(after, shared.mask, choose(before, shared.empty, regions.back & shared.mask))};
}

// Where the fragment lies in the slab, from 0 at its front to 1 at its back, at the mean of the positions within it.
template <class Float, class Mask>
Float place_in_slab(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old, Float sum_u, Float sum_v,
                    Float within, const MergeRules& rules) {
  const Float zero(0.0f), one(1.0f), count = greater(within, one), u = sum_u / count, v = sum_v / count;
  const SlabEnds<Float> ends = slab_ends(old, depth_at(old.plane, u, v), rules);
  const Float extent = ends.back - ends.front;
  const Float place = (clamped_depth(in, u, v) - ends.front) / select(extent > zero, extent, one);
  return lesser(greater(place, zero), one);
}

// The fuzziness of slide 12. The slide does not define sadp(A, B). Here it is the mean absolute difference of the two
// depths over the overlap, divided by the depth range of both together. It is near 0 for neighbours in a mesh, which
// lie beside each other. The other factor is the part of A's mask that A leaves open, 0 for a closed surface.
template <class Float, class Mask>
Float distance_apart(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old, Float u, Float v) {
  return magnitude(clamped_depth(in, u, v) - clamped_depth(old, u, v));
}
template <class Float, class Mask>
Float fuzziness_of(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old, Float apart, Mask overlap) {
  const Float zero(0.0f), one(1.0f);
  const Float span = greater(in.z_max, old.z_max) - lesser(in.z_min, old.z_min);
  const Float distance = apart / greater(bit_count(overlap), one) / select(span > zero, span, one);
  return lesser(magnitude(bit_count(old.mask) / Float(32.0f) - old.alpha) * distance, one);
}

// What visible_parts needs to know about the overlap, once it is partitioned.
template <class Float, class Mask>
inline OverlapParts<Float, Mask> overlap_parts(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old,
                                               const DepthRegions<Mask>& regions, const SamplePattern& pattern,
                                               const MergeRules& rules, MergeStepsOf<Mask>& steps) {
  const Float zero(0.0f);
  steps.fuzzy = steps.overlap & ~regions.front & ~regions.back;
  const auto is_fuzzy = steps.fuzzy != Mask(0u);
  const Float within = bit_count(steps.fuzzy), nothing = select(is_fuzzy, zero, within);
  OverlapParts<Float, Mask> parts{regions.front, regions.back, within, nothing, nothing};
  if (any(is_fuzzy)) {
    Float sum_u = nothing, sum_v = nothing;
    for_each_position<Float>(steps.fuzzy, pattern, [&](const auto& is_here, Float u, Float v, int) {
      sum_u = choose(is_here, sum_u + u, sum_u);
      sum_v = choose(is_here, sum_v + v, sum_v);
    });
    parts.delta = choose(is_fuzzy, place_in_slab(in, old, sum_u, sum_v, within, rules), nothing);
  }
  if (rules.overlap == MergeRules::Overlap::transition) {
    Float apart = zero;
    for_each_position<Float>(steps.overlap, pattern, [&](const auto& is_here, Float u, Float v, int) {
      apart = choose(is_here, apart + distance_apart(in, old, u, v), apart);
    });
    parts.fuzziness = fuzziness_of(in, old, apart, steps.overlap);
  }
  return parts;
}

// How two coverages are correlated where one surface is in front of the other: MergeRules::Overlap, whether the
// fragment is a speck, and the fuzziness of Overlap::transition.
template <class Float, class Mask>
struct Correlation {
  MergeRules::Overlap rule;
  decltype(Mask() != Mask()) tiny;
  Float fuzziness;
};

// What is visible of a surface behind another one, which leaves `open` of a region.
template <class Float, class Mask>
Float what_is_left(Float cover, Float open, const Correlation<Float, Mask>& how) {
  const Float added = lesser(cover, open), independent = cover * open;
  switch (how.rule) {
    case MergeRules::Overlap::over:
      return independent;
    case MergeRules::Overlap::add:
      return added;
    case MergeRules::Overlap::transition:
      return added + (independent - added) * how.fuzziness;
    case MergeRules::Overlap::tiny:
    case MergeRules::Overlap::unbounded:
      break;
  }
  return select(how.tiny, added, independent);
}

// How much of a region both cover, and what they leave open of it. A surface whose mask is smaller than its area covers
// more than 1, and leaves less than 0: what it hides beside its positions is taken from the surface behind.
template <class Float>
struct RegionCover {
  Float i, a, open_i, open_a;
};
template <class Float>
RegionCover<Float> region_cover(Float i, Float a) {
  const Float one(1.0f);
  return {i, a, one - i, one - a};
}

// Where the fragment is in front of the aggregate, or behind it.
template <class Float, class Mask>
BlendFactors<Float> over_in(const RegionCover<Float>& region, const Correlation<Float, Mask>& how) {
  const Float left = what_is_left(region.a, region.open_i, how);
  if (how.rule == MergeRules::Overlap::unbounded) return {region.i, select(how.tiny, region.a, left)};
  return {region.i, left};
}
template <class Float, class Mask>
BlendFactors<Float> under_in(const RegionCover<Float>& region, const Correlation<Float, Mask>& how) {
  return {what_is_left(region.i, region.open_a, how), region.a};
}

// Within the slab: from over, at its front, to under, at its back.
template <class Float, class Mask>
BlendFactors<Float> blended_in(const RegionCover<Float>& slab, const BlendFactors<Float>& over,
                               const BlendFactors<Float>& under, Float delta, const Correlation<Float, Mask>& how,
                               MergeRules::Fuzzy fuzzy) {
  const Float one(1.0f);
  if (fuzzy == MergeRules::Fuzzy::mix)
    return {over.i + (under.i - over.i) * delta, over.a + (under.a - over.a) * delta};
  BlendFactors<Float> blended{slab.i * (one - delta), slab.a * delta};
  if (fuzzy == MergeRules::Fuzzy::unite) {
    const Float scale = (over.i + over.a) / greater(blended.i + blended.a, Float(1e-30f));
    return {blended.i * scale, blended.a * scale};
  }
  if (how.rule == MergeRules::Overlap::over) return blended;
  // Specks are anti-correlated "over the overlapping regions" (section 2.2.1), and this is one of them.
  return {select(how.tiny, over.i, blended.i), select(how.tiny, over.a, blended.a)};
}

// Local coverage is alpha divided by the part of the mask that is set.
template <class Float, class Mask>
Float local_coverage(const AggregateOf<Float, Mask>& surface) {
  return surface.alpha * Float(32.0f) / greater(bit_count(surface.mask), Float(1.0f));
}

// (3) and (4): what is visible of both if their masks overlap. Each region counts with its number of positions, unless
// its coverage is an area already.
template <class Float, class Mask>
BlendFactors<Float> visible_parts(const FragmentOf<Float, Mask>& fragment, const AggregateOf<Float, Mask>& old,
                                  const OverlapParts<Float, Mask>& parts, const MergeRules& rules) {
  const Float zero(0.0f), bits(32.0f);
  const AggregateOf<Float, Mask>& in = fragment.surface;
  const Float only_i = bit_count(in.mask & ~old.mask), only_a = bit_count(old.mask & ~in.mask);
  const Float in_front = bit_count(parts.front), behind = bit_count(parts.back);
  const Float local_i = local_coverage(in), local_a = local_coverage(old);
  const bool by_share = rules.regional == MergeRules::Regional::area;
  const RegionCover<Float> local_cover = region_cover(local_i, local_a);
  const auto cover_in = [&](Float count) {
    if (!by_share) return local_cover;
    const Float share = count / bits;
    return region_cover(local_i * share, local_a * share);
  };
  const Correlation<Float, Mask> how{rules.overlap, fragment.tiny != Mask(0u), parts.fuzziness};
  const BlendFactors<Float> over = over_in(cover_in(in_front), how), under = under_in(cover_in(behind), how);
  const RegionCover<Float> slab = cover_in(parts.within);
  const BlendFactors<Float> fuzzy = blended_in(slab, by_share ? over_in(slab, how) : over,
                                               by_share ? under_in(slab, how) : under, parts.delta, how, rules.fuzzy);
  const Float times_over = by_share ? bits : in_front, times_under = by_share ? bits : behind,
              times_fuzzy = by_share ? bits : parts.within;
  const BlendFactors<Float> sums{
      (only_i * local_i + times_over * over.i + times_under * under.i + times_fuzzy * fuzzy.i) / bits,
      (only_a * local_a + times_over * over.a + times_under * under.a + times_fuzzy * fuzzy.a) / bits};
  return {greater(sums.i, zero), greater(sums.a, zero)};
}

// Both together, without the slab's thickness. Because masks have errors, the sum of the areas may exceed 1; then it is
// scaled down to 1. The plane is the coverage-weighted mean of both.
template <class Float, class Mask>
AggregateOf<Float, Mask> joined(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old,
                                const BlendFactors<Float>& weight, const MergeRules& rules) {
  const Float one(1.0f);
  const Float scale = one / greater(weight.i + weight.a, one);
  const Float scale_i = weight.i * scale / greater(in.alpha, Float(1e-30f));
  const Float scale_a = weight.a * scale / greater(old.alpha, Float(1e-30f));
  AggregateOf<Float, Mask> merged;
  merged.alpha = (weight.i + weight.a) * scale;
  merged.mask = in.mask | old.mask;
  for (int c = 0; c < 3; ++c) merged.color[c] = in.color[c] * scale_i + old.color[c] * scale_a;
  const bool by_area = rules.plane == MergeRules::Plane::area;
  const Float part_i = by_area ? in.alpha : weight.i, part_a = by_area ? old.alpha : weight.a;
  const Float share_i = part_i / greater(part_i + part_a, Float(1e-30f)), share_a = one - share_i;
  merged.plane = {in.plane.z * share_i + old.plane.z * share_a, in.plane.dzdu * share_i + old.plane.dzdu * share_a,
                  in.plane.dzdv * share_i + old.plane.dzdv * share_a};
  merged.thickness = old.thickness;
  merged.z_min = lesser(in.z_min, old.z_min);
  merged.z_max = greater(in.z_max, old.z_max);
  return merged;
}

// The larger of `farthest` and the distance of a depth from a plane.
template <class Float>
Float farther_from(const DepthPlane<Float>& plane, Float depth, Float u, Float v, Float farthest) {
  return greater(farthest, magnitude(depth - depth_at(plane, u, v)));
}

// A slab that is as thick as before, and reaches from its plane as far as the fragment.
template <class Float>
Float thick_enough(Float kept, Float farthest) {
  return greater(kept, farthest + farthest);
}

// `yes` where the condition holds, else `no`: all of it, or what belongs to the slab.
template <class Float, class Mask, class Bool>
AggregateOf<Float, Mask> with_slab_of(Bool condition, const AggregateOf<Float, Mask>& yes,
                                      AggregateOf<Float, Mask> no) {
  no.plane = {choose(condition, yes.plane.z, no.plane.z), choose(condition, yes.plane.dzdu, no.plane.dzdu),
              choose(condition, yes.plane.dzdv, no.plane.dzdv)};
  no.thickness = choose(condition, yes.thickness, no.thickness);
  no.z_min = choose(condition, yes.z_min, no.z_min);
  no.z_max = choose(condition, yes.z_max, no.z_max);
  return no;
}
template <class Float, class Mask, class Bool>
AggregateOf<Float, Mask> choose_aggregate(Bool condition, const AggregateOf<Float, Mask>& yes,
                                          const AggregateOf<Float, Mask>& no) {
  AggregateOf<Float, Mask> chosen = with_slab_of(condition, yes, no);
  chosen.alpha = choose(condition, yes.alpha, no.alpha);
  chosen.mask = choose(condition, yes.mask, no.mask);
  for (int c = 0; c < 3; ++c) chosen.color[c] = choose(condition, yes.color[c], no.color[c]);
  return chosen;
}

// The thickness of the slab around merged.plane: enough to reach the fragment at the positions steps.reached, and, with
// Thickness::containing, the earlier slab at the positions steps.moved.
template <class Float, class Mask>
inline Float merged_thickness(const AggregateOf<Float, Mask>& in, const AggregateOf<Float, Mask>& old,
                              const DepthPlane<Float>& plane, const SamplePattern& pattern, bool containing,
                              const MergeStepsOf<Mask>& steps) {
  Float farthest = lesser(old.thickness, Float(0.0f)), moved = farthest;  // 0
  for_each_position<Float>(steps.reached, pattern, [&](const auto& is_here, Float u, Float v, int) {
    farthest = choose(is_here, farther_from(plane, clamped_depth(in, u, v), u, v, farthest), farthest);
  });
  if (!containing) return thick_enough(old.thickness, farthest);
  for_each_position<Float>(steps.moved, pattern, [&](const auto& is_here, Float u, Float v, int) {
    moved = choose(is_here, farther_from(plane, depth_at(old.plane, u, v), u, v, moved), moved);
  });
  return thick_enough(old.thickness + (moved + moved), farthest);
}

template <class Float, class Mask>
AggregateOf<Float, Mask> merge_formula(const FragmentOf<Float, Mask>& fragment, const AggregateOf<Float, Mask>& old,
                                       const MergePositions& positions, const MergeRules& rules,
                                       MergeStepsOf<Mask>& steps) {
  const Mask none(0u);
  const AggregateOf<Float, Mask>& in = fragment.surface;
  steps = {.merged = none,
           .overlap = none,
           .lines = none,
           .front_line = none,
           .back_line = none,
           .tested = none,
           .fuzzy = none,
           .reached = none,
           .moved = none};
  const auto first = old.mask == none;
  if (!any(!first)) return in;
  steps.merged = choose(first, none, Mask(1u));

  // (1) Partition xy by the masks. Surfaces that share no position lie beside each other.
  const Mask overlap = in.mask & old.mask;
  const SharedPositions<Mask> shared{overlap, overlap & none, overlap != none};
  BlendFactors<Float> weight{in.alpha, old.alpha};
  DepthRegions<Mask> regions{shared.empty, shared.empty};
  if (any(shared.any_there)) {
    regions = partition(fragment, old, shared, positions, rules, steps);
    steps.overlap = overlap;
    const OverlapParts<Float, Mask> parts = overlap_parts(in, old, regions, positions.pattern, rules, steps);
    const BlendFactors<Float> visible = visible_parts(fragment, old, parts, rules);
    weight = {choose(shared.any_there, visible.i, weight.i), choose(shared.any_there, visible.a, weight.a)};
  }
  AggregateOf<Float, Mask> merged = joined(in, old, weight, rules);
  const bool visible_only = rules.slab == MergeRules::Slab::visible;
  const bool containing = rules.thickness == MergeRules::Thickness::containing;
  const bool is_thick = rules.thickness != MergeRules::Thickness::none;
  const Mask reached = visible_only ? in.mask & ~regions.back : in.mask;
  if (is_thick) steps.reached = choose(first, none, reached);
  if (containing) steps.moved = choose(first, none, old.mask);
  if (is_thick) merged.thickness = merged_thickness(in, old, merged.plane, positions.pattern, containing, steps);
  if (visible_only) merged = with_slab_of(reached == none, old, merged);
  return choose_aggregate(first, in, merged);
}

// Plain OVER of what is there on top of a fragment that lies behind it: alpha and colour alone, without masks.
template <class Float, class Mask>
AggregateOf<Float, Mask> over_formula(const FragmentOf<Float, Mask>& fragment, AggregateOf<Float, Mask> old) {
  const Float rest = Float(1.0f) - old.alpha;
  old.alpha = old.alpha + rest * fragment.surface.alpha;
  for (int c = 0; c < 3; ++c) old.color[c] = old.color[c] + rest * fragment.surface.color[c];
  return old;
}
