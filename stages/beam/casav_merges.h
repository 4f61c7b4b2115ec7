// What merges by the published rules are charged, in compose_casav and compose_layers.
#pragma once

#include <bit>

#include "simd/merge.h"
#include "stages/beam/casav_fragment.h"
#include "stages/cost/counting.h"

namespace beampipe {

// The nearest surface at a position of a fragment: the fragment, if it is in front of what was nearest before it.
template <class Float>
struct Nearest {
  decltype(Float() < Float()) is_fragment;
  Float depth;
};
template <class Float, class Mask>
Nearest<Float> nearest_with(const AggregateOf<Float, Mask>& fragment, Float u, Float v, Float nearest) {
  const Float depth = clamped_depth(fragment, u, v);
  const auto is_fragment = depth < nearest;
  return {is_fragment, select(is_fragment, depth, nearest)};
}

// How often each part of merge_formula had work.
struct MergeWork {
  std::uint64_t merges = 0, merged = 0, overlaps = 0;
  std::uint64_t lines = 0, directions = 0, front_lines = 0, back_lines = 0;
  std::uint64_t fuzzy = 0, fuzzy_positions = 0;
  std::uint64_t tested = 0, shared = 0, reached = 0, moved = 0;  // positions
  std::uint64_t kept_depths = 0;  // positions of fragments, where the nearest depth is kept

  void add(const MergeSteps& steps) {
    const auto positions = [](std::uint32_t mask) { return static_cast<std::uint64_t>(std::popcount(mask)); };
    ++merges;
    merged += steps.merged;
    overlaps += steps.overlap != 0;
    lines += steps.lines;
    directions += steps.front_line | steps.back_line;
    front_lines += steps.front_line;
    back_lines += steps.back_line;
    fuzzy += steps.fuzzy != 0;
    fuzzy_positions += positions(steps.fuzzy);
    tested += positions(steps.tested);
    shared += positions(steps.overlap);
    reached += positions(steps.reached);
    moved += positions(steps.moved);
  }
};

// What all these merges are charged.
inline OperationCounts casav_merges_cost(const MergeWork& work, const MergeRules& rules, CasavStorage storage) {
  using Float = Counted<float>;
  using Mask = Counted<std::uint32_t>;
  OperationCounts total;
  // The cost of a part: what `formula` does with a fragment, which is an aggregate too, and a number.
  const auto charge = [&](std::uint64_t times, const auto& formula) {
    total += count_operations([&](OperationCounts& counts) {
               formula(counted_fragment(counts), Float(1.0f, counts), Mask(1u, counts));
             }) *
             times;
  };
  const bool ranged = rules.extents == MergeRules::Extents::range;
  const bool visible_only = rules.slab == MergeRules::Slab::visible;
  const bool containing = rules.thickness == MergeRules::Thickness::containing;
  const bool is_thick = rules.thickness != MergeRules::Thickness::none;
  const bool given = rules.partition == MergeRules::Partition::given;
  const bool transition = rules.overlap == MergeRules::Overlap::transition;
  charge(work.merges, [](const auto&, const Float&, const Mask& mask) { static_cast<void>(mask == mask); });
  charge(work.merged, [&](const auto& in, const Float& one, const Mask& mask) {
    static_cast<void>((mask & mask & mask) != mask);
    joined(in.surface, in.surface, BlendFactors<Float>{one, one}, rules);
    if (is_thick) lesser(one, one), thick_enough(containing ? one + (one + one) : one, one);
    if (visible_only) static_cast<void>((mask & ~mask) == mask);
  });
  charge(work.overlaps, [&](const auto& in, const Float& one, const Mask& mask) {
    if (ranged && !given)
      static_cast<void>(is_before(in.surface, in.surface)), static_cast<void>(is_after(in.surface, in.surface));
    static_cast<void>((mask & mask & ~mask & ~(mask & mask)) != mask);
    if (given) ~mask;
    select(true, one, one);
    visible_parts(in, in.surface, OverlapParts<Float, Mask>{mask, mask, bit_count(mask), one, one}, rules);
    if (transition) fuzziness_of(in.surface, in.surface, one, mask);
  });
  charge(work.lines, [](const auto& in, const Float& one, const Mask&) {
    const PlaneGap<Float> gap = plane_gap(in.surface.plane, in.surface.plane);
    const Float half_thickness = Float(0.5f) * one;
    for (const Float& c : {gap.z + half_thickness, gap.z - half_thickness}) {
      static_cast<void>(cuts_pixel(c, gap.reach));
      side_of_pixel<Float, Mask>(c, gap.reach);
    }
  });
  charge(work.directions, [](const auto&, const Float& one, const Mask&) { line_direction<Float, Mask>(one, one); });
  static const MergePositions positions(hammersley_pattern());  // whose entries cost the same as any other's
  charge(work.front_lines + work.back_lines, [](const auto&, const Float& one, const Mask&) {
    half_plane(LineDirection<Float, Mask>{Counted<std::int32_t>(0, *one.tally), Mask(0u), one}, one, positions.table);
  });
  charge(work.front_lines, [](const auto&, const Float&, const Mask& mask) { ~mask; });
  charge(work.fuzzy, [&](const auto& in, const Float& one, const Mask&) {
    place_in_slab(in.surface, in.surface, one, one, one, rules);
  });
  charge(work.fuzzy_positions, [](const auto&, const Float& one, const Mask&) { one + one, one + one; });
  charge(work.tested, [&](const auto& in, const Float&, const Mask& mask) {
    const Float u(0.0f);  // the positions are constants
    const DepthRegions<Mask> at = region_of_position(in.surface, in.surface, u, u, Mask(1u), rules);
    mask | at.front, mask | at.back;
  });
  if (transition)
    charge(work.shared, [](const auto& in, const Float& one, const Mask&) {
      const Float u(0.0f);
      one + distance_apart(in.surface, in.surface, u, u);
    });
  charge(work.reached, [](const auto& in, const Float& one, const Mask&) {
    const Float u(0.0f);
    farther_from(in.surface.plane, clamped_depth(in.surface, u, u), u, u, one);
  });
  charge(work.moved, [](const auto& in, const Float& one, const Mask&) {
    const Float u(0.0f);
    farther_from(in.surface.plane, depth_at(in.surface.plane, u, u), u, u, one);
  });
  charge(work.kept_depths, [](const auto& in, const Float& one, const Mask& mask) {
    const Float u(0.0f);
    nearest_with(in.surface, u, u, one), mask | mask;
  });
  total.convert += 2 * packed_numbers(storage) * work.merges;  // to load and to store the aggregate
  return total;
}

inline std::uint64_t position_tests(const MergeWork& work) {
  return 32 * (work.front_lines + work.back_lines) + work.tested + work.reached + work.moved + work.kept_depths;
}

}  // namespace beampipe
