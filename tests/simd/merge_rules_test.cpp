// The rules of merging, on the scalar twin: what always holds, and cases that can be worked out by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "tests/simd/merge_cases.h"
#include "tests/thorough.h"

namespace beampipe {
namespace {

const SamplePattern kPattern = hammersley_pattern();

Aggregate merged(const Aggregate& fragment, const Aggregate& old, const MergeRules& rules = {}) {
  return merge_scalar<float, std::uint32_t>({fragment, 0u}, old, kPattern, rules);
}
Aggregate merged_tiny(const Aggregate& fragment, const Aggregate& old, const MergeRules& rules = {}) {
  return merge_scalar<float, std::uint32_t>({fragment, kAllBits}, old, kPattern, rules);
}

void expect_invariants(const MergeFragment& fragment, const Aggregate& old, const MergeRules& rules,
                       const Aggregate& now) {
  const Aggregate& in = fragment.surface;
  ASSERT_GE(now.alpha, 0.0f);
  ASSERT_LE(now.alpha, 1.0f + 1.2e-7f);  // scaled down to 1, which rounds
  ASSERT_EQ(now.mask, in.mask | old.mask);
  if (rules.slab == MergeRules::Slab::full) {
    ASSERT_EQ(now.z_min, std::min(in.z_min, old.z_min));
    ASSERT_EQ(now.z_max, std::max(in.z_max, old.z_max));
  }
  ASSERT_GE(now.thickness, old.thickness);
  for (int c = 0; c < 3; ++c) {  // convex combination of what went in, to rounding
    const float from_in = in.color[c] / in.alpha, from_old = old.alpha > 0 ? old.color[c] / old.alpha : from_in;
    ASSERT_GE(now.color[c], now.alpha * std::min(from_in, from_old) * 0.999998f);
    ASSERT_LE(now.color[c], now.alpha * std::max(from_in, from_old) * 1.000002f);
  }
}

TEST(MergeRules, InvariantsOnChains) {
  Random random(43);
  SCOPED_TRACE(random.name());
  for (const MergeRules& rules : every_merge_rule())
    for (int chain = 0; chain < 1'000 * thoroughness(); ++chain) {
      Aggregate aggregate = kEmptyAggregate;
      for (int i = 0; i < 8; ++i) {
        const MergeFragment fragment = random_fragment(random);
        const Aggregate now = merge_scalar(fragment, aggregate, kPattern, rules);
        ASSERT_NO_FATAL_FAILURE(expect_invariants(fragment, aggregate, rules, now))
            << "chain " << chain << ", fragment " << i;
        aggregate = now;
      }
    }
}

TEST(MergeRules, FirstFragmentIsTheAggregate) {
  const Aggregate in{0.25f, 0xffu, {-0.5f, 0.01f, -0.02f}, 0.0f, -0.51f, -0.49f, {0.1f, 0.2f, 0.3f}};
  const Aggregate now = merged(in, kEmptyAggregate);
  EXPECT_FLOAT_EQ(now.alpha, 0.25f);
  EXPECT_EQ(now.mask, 0xffu);
  EXPECT_EQ(now.plane.z, in.plane.z);
  EXPECT_EQ(now.plane.dzdu, in.plane.dzdu);
  EXPECT_EQ(now.plane.dzdv, in.plane.dzdv);
  EXPECT_EQ(now.thickness, 0.0f);
  EXPECT_EQ(now.z_min, in.z_min);
  EXPECT_EQ(now.z_max, in.z_max);
  for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(now.color[c], in.color[c]);
}

TEST(MergeRules, OpaqueFrontHidesWhatIsThere) {
  const Aggregate now = merged(flat_surface(1, kAllBits, -0.9f, 1, 0), flat_surface(1, kAllBits, -0.1f, 0, 1));
  EXPECT_EQ(now.alpha, 1.0f);
  EXPECT_EQ(now.color[0], 1.0f);
  EXPECT_EQ(now.color[1], 0.0f);
}

TEST(MergeRules, OpaqueFrontHidesWhatComes) {
  const Aggregate now = merged(flat_surface(1, kAllBits, -0.1f, 1, 0), flat_surface(1, kAllBits, -0.9f, 0, 1));
  EXPECT_EQ(now.alpha, 1.0f);
  EXPECT_EQ(now.color[0], 0.0f);
  EXPECT_EQ(now.color[1], 1.0f);
}

TEST(MergeRules, EqualDepthKeepsTheEarlier) {
  const Aggregate now = merged(flat_surface(1, kAllBits, -0.5f, 1, 0), flat_surface(1, kAllBits, -0.5f, 0, 1));
  EXPECT_EQ(now.color[0], 0.0f);
  EXPECT_EQ(now.color[1], 1.0f);
}

TEST(MergeRules, DisjointHalvesAdd) {
  const Aggregate now =
      merged(flat_surface(0.5f, 0x0000ffffu, -0.1f, 1, 0), flat_surface(0.5f, 0xffff0000u, -0.9f, 0, 1));
  EXPECT_FLOAT_EQ(now.alpha, 1.0f);
  EXPECT_FLOAT_EQ(now.color[0], 0.5f);
  EXPECT_FLOAT_EQ(now.color[1], 0.5f);
}

// Where the masks overlap nothing is known of how the coverages lie: independent, as OVER has it.
// In front: 1/2, and of the old 1/2 x (1 - 1/2) = 1/4 remains.
TEST(MergeRules, OverlappingHalvesAreIndependent) {
  const Aggregate back = flat_surface(0.5f, kAllBits, -0.1f, 1, 0), front = flat_surface(0.5f, kAllBits, -0.9f, 0, 1);
  for (const Aggregate& now : {merged(front, back), merged(back, front)}) {
    EXPECT_FLOAT_EQ(now.alpha, 0.75f);
    EXPECT_FLOAT_EQ(now.color[0], 0.25f);
    EXPECT_FLOAT_EQ(now.color[1], 0.5f);
  }
}

// A tiny triangle lies beside what is there as long as there is room: 1/2 + 1/4 in the one position that it was given.
TEST(MergeRules, TinyTriangleLiesBeside) {
  const Aggregate old = flat_surface(0.5f, kAllBits, -0.9f, 0, 1), tiny = flat_surface(0.25f / 32, 1u, -0.1f, 1, 0);
  const Aggregate beside = merged_tiny(tiny, old);
  EXPECT_FLOAT_EQ(beside.alpha, 0.5f + 0.25f / 32);
  EXPECT_FLOAT_EQ(beside.color[0], 0.25f / 32);
  EXPECT_FLOAT_EQ(beside.color[1], 0.5f);
  // Not tiny, half of it is hidden.
  EXPECT_FLOAT_EQ(merged(tiny, old).alpha, 0.5f + 0.125f / 32);
}

// In a slab of depths -0.6 to -0.4 a fragment at -0.45 is 3/4 on the way to its back: 1/4 of it and 3/4 of the slab
// show.
TEST(MergeRules, WithinTheSlabDeltaShares) {
  Aggregate old = flat_surface(1, kAllBits, -0.5f, 0, 1);
  old.thickness = 0.2f;
  old.z_min = -0.6f, old.z_max = -0.4f;
  const Aggregate now = merged(flat_surface(1, kAllBits, -0.45f, 1, 0), old);
  EXPECT_NEAR(now.alpha, 1.0f, 1e-6);
  EXPECT_NEAR(now.color[0], 0.25f, 1e-6);
  EXPECT_NEAR(now.color[1], 0.75f, 1e-6);
  EXPECT_GE(now.thickness, 0.2f);
}

// Crossing planes: the fragment is nearer left of the middle, the old one right of it. 16 positions each.
TEST(MergeRules, CrossingPlanesShareThePixel) {
  Aggregate in = flat_surface(1, kAllBits, -0.5f, 1, 0);
  in.plane.dzdu = 0.2f;
  in.z_min = -0.6f, in.z_max = -0.4f;
  const Aggregate now = merged(in, flat_surface(1, kAllBits, -0.5f, 0, 1));
  EXPECT_FLOAT_EQ(now.alpha, 1.0f);
  EXPECT_FLOAT_EQ(now.color[0], 0.5f);
  EXPECT_FLOAT_EQ(now.color[1], 0.5f);
}

// A steep old plane passes, in parts of the pixel, far behind the depth range that its triangle really has there. What
// lies behind that range is behind everywhere; what lies before it is in front everywhere.
TEST(MergeRules, DepthRangeBoundsTheSlabOnBothSides) {
  for (const float slope : {-4.0f, 4.0f}) {
    Aggregate old = flat_surface(1, kAllBits, -0.5f, 0, 1);
    old.plane.dzdu = slope;
    old.z_min = -0.55f, old.z_max = -0.45f;
    const Aggregate behind = merged(flat_surface(1, kAllBits, -0.4f, 1, 0), old);
    EXPECT_FLOAT_EQ(behind.color[0], 0.0f) << slope;
    EXPECT_FLOAT_EQ(behind.color[1], 1.0f) << slope;
    const Aggregate before = merged(flat_surface(1, kAllBits, -0.6f, 1, 0), old);
    EXPECT_FLOAT_EQ(before.color[0], 1.0f) << slope;
    EXPECT_FLOAT_EQ(before.color[1], 0.0f) << slope;
  }
}

// The slab reaches the fragment: every covered position's depth is within half a thickness of the new plane.
TEST(MergeRules, ThicknessReachesTheFragment) {
  Random random(44);
  SCOPED_TRACE(random.name());
  for (int i = 0; i < 20'000; ++i) {
    const MergeFragment first = random_fragment(random), second = random_fragment(random);
    const Aggregate now = merge_scalar(second, merge_scalar(first, kEmptyAggregate, kPattern, {}), kPattern, {});
    const Aggregate& in = second.surface;
    for (std::size_t s = 0; s < 32; ++s) {
      if (!(in.mask >> s & 1)) continue;
      const double u = kPattern.x[s] / 256.0 - 0.5, v = kPattern.y[s] / 256.0 - 0.5;
      const double z =
          std::clamp(in.plane.z + in.plane.dzdu * u + in.plane.dzdv * v, double(in.z_min), double(in.z_max));
      const double middle = now.plane.z + now.plane.dzdu * u + now.plane.dzdv * v;
      const double rounding = 1e-6 * (1 + std::abs(double(now.plane.dzdu)) + std::abs(double(now.plane.dzdv)));
      ASSERT_LE(std::abs(z - middle), now.thickness / 2 + rounding);
    }
  }
}

MergeRules with_overlap(MergeRules::Overlap overlap) {
  MergeRules rules;
  rules.overlap = overlap;
  return rules;
}

// 1/4 over 1/2: independent 1/4 + 1/2 x 3/4, beside each other 1/4 + 1/2.
TEST(MergeRules, OverlapIsIndependentOrBeside) {
  using Overlap = MergeRules::Overlap;
  const Aggregate back = flat_surface(0.5f, kAllBits, -0.1f, 0, 1), front = flat_surface(0.25f, kAllBits, -0.9f, 1, 0);
  for (const bool front_last : {true, false}) {
    const Aggregate &in = front_last ? front : back, &old = front_last ? back : front;
    EXPECT_FLOAT_EQ(merged_tiny(in, old, with_overlap(Overlap::over)).alpha, 0.25f + 0.375f);
    EXPECT_FLOAT_EQ(merged(in, old, with_overlap(Overlap::add)).alpha, 0.75f);
    EXPECT_FLOAT_EQ(merged_tiny(in, old, with_overlap(Overlap::tiny)).alpha, 0.75f);
    EXPECT_FLOAT_EQ(merged(in, old, with_overlap(Overlap::tiny)).alpha, 0.625f);
  }
}

// Slide 12's transition: the aggregate leaves half of its mask open, and the two lie as far apart as they span in
// depth: fuzziness 1/2 x 1, halfway between 0.75 and 0.625. At the same depth it is ADD.
TEST(MergeRules, TransitionGoesFromAddToOverWithDistance) {
  const MergeRules rules = with_overlap(MergeRules::Overlap::transition);
  const Aggregate old = flat_surface(0.5f, kAllBits, -0.9f, 0, 1);
  EXPECT_FLOAT_EQ(merged(flat_surface(0.25f, kAllBits, -0.1f, 1, 0), old, rules).alpha, (0.75f + 0.625f) / 2);
  EXPECT_FLOAT_EQ(merged(flat_surface(0.25f, kAllBits, -0.9f, 1, 0), old, rules).alpha, 0.75f);
}

// 1/16 in one position is twice what the position holds: `keep` shows all of it, `clamp` half.
TEST(MergeRules, LocalCoverageAboveOneIsKeptOrClamped) {
  MergeRules rules;
  const Aggregate in = flat_surface(1.0f / 16, 1u, -0.9f, 1, 0), old = flat_surface(0.5f, 0x0000ffffu, -0.1f, 0, 1);
  EXPECT_FLOAT_EQ(merged(in, old, rules).color[0], 1.0f / 32);
  rules.local = MergeRules::Local::keep;
  const Aggregate now = merged(in, old, rules);
  EXPECT_FLOAT_EQ(now.color[0], 1.0f / 16);
  EXPECT_FLOAT_EQ(now.color[1], 15.0f / 32);  // the position that is hidden shows nothing of it, and not less
}

// Two coverages of 1/2 in the middle of the slab: the published blend keeps 1/4 of each; `mix` is halfway between
// 1/2 over 1/4 and 1/4 under 1/2.
TEST(MergeRules, WithinTheSlabAreaIsLostOrMixed) {
  Aggregate old = flat_surface(0.5f, kAllBits, -0.5f, 0, 1);
  old.thickness = 0.2f;
  old.z_min = -0.6f, old.z_max = -0.4f;
  const Aggregate in = flat_surface(0.5f, kAllBits, -0.5f, 1, 0);
  EXPECT_NEAR(merged(in, old).alpha, 0.5f, 1e-6);
  MergeRules rules;
  rules.fuzzy = MergeRules::Fuzzy::mix;
  const Aggregate now = merged(in, old, rules);
  EXPECT_NEAR(now.color[0], 0.375f, 1e-6);
  EXPECT_NEAR(now.color[1], 0.375f, 1e-6);
}

// A slab of thickness 0.4 around -0.5 whose surfaces lie between -0.55 and -0.45. A fragment at -0.4 is behind the
// surfaces, but in the slab.
TEST(MergeRules, ExtentsAreCutByTheRangeOrNot) {
  Aggregate old = flat_surface(1, kAllBits, -0.5f, 0, 1);
  old.thickness = 0.4f;
  old.z_min = -0.55f, old.z_max = -0.45f;
  const Aggregate in = flat_surface(1, kAllBits, -0.4f, 1, 0);
  EXPECT_EQ(merged(in, old).color[0], 0.0f);
  MergeRules rules;
  rules.extents = MergeRules::Extents::slab;
  EXPECT_NEAR(merged(in, old, rules).color[0], 0.25f, 1e-6);  // 3/4 on the way to its back
}

TEST(MergeRules, WhatIsHiddenLeavesTheSlabAlone) {
  const Aggregate front = flat_surface(1, kAllBits, -0.9f, 0, 1), behind = flat_surface(1, kAllBits, -0.1f, 1, 0);
  EXPECT_NEAR(merged(behind, front).thickness, 0.8f, 1e-6);  // reaches from the middle of both to either
  MergeRules rules;
  rules.slab = MergeRules::Slab::visible;
  const Aggregate now = merged(behind, front, rules);
  EXPECT_EQ(now.plane.z, front.plane.z);
  EXPECT_EQ(now.thickness, 0.0f);
  EXPECT_EQ(now.z_max, front.z_max);
  EXPECT_NEAR(merged(front, behind, rules).thickness, 0.8f, 1e-6);  // what hides is seen
}

TEST(MergeRules, PlanesAreWeightedByAreaOrByWhatShows) {
  const Aggregate front = flat_surface(1, kAllBits, -0.9f, 0, 1), behind = flat_surface(1, kAllBits, -0.1f, 1, 0);
  EXPECT_FLOAT_EQ(merged(behind, front).plane.z, -0.5f);
  MergeRules rules;
  rules.plane = MergeRules::Plane::visible;
  EXPECT_FLOAT_EQ(merged(behind, front, rules).plane.z, -0.9f);
}

// A thin slab at -0.9 and a second surface at -0.1: the plane moves to -0.5, and must still reach the first one's slab.
TEST(MergeRules, ThicknessContainsWhatWasThereBefore) {
  Aggregate old = flat_surface(1, kAllBits, -0.9f, 0, 1);
  old.thickness = 0.1f;
  old.z_min = -0.95f, old.z_max = -0.85f;
  const Aggregate in = flat_surface(1, kAllBits, -0.1f, 1, 0);
  EXPECT_NEAR(merged(in, old).thickness, 0.8f, 1e-6);
  MergeRules rules;
  rules.thickness = MergeRules::Thickness::containing;
  EXPECT_NEAR(merged(in, old, rules).thickness, 0.1f + 2 * 0.4f, 1e-6);
}

// OVER by hand: 1/2 and behind it 1/2 of 1/4.
TEST(MergeRules, PlainOver) {
  const Aggregate now = over_scalar<float, std::uint32_t>({flat_surface(0.25f, 1u, -0.1f, 1, 0), 0u},
                                                          flat_surface(0.5f, 1u, -0.9f, 0, 1));
  EXPECT_FLOAT_EQ(now.alpha, 0.625f);
  EXPECT_FLOAT_EQ(now.color[0], 0.125f);
  EXPECT_FLOAT_EQ(now.color[1], 0.5f);
}

}  // namespace
}  // namespace beampipe
