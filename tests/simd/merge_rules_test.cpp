// The rules of merging, by the formula on float: what always holds, and cases worked out by hand.

#include "tests/simd/merge_cases.h"
#include "tests/thorough.h"

namespace beampipe::merge_rules_test {

const SamplePattern kPattern = hammersley_pattern();
const MergePositions kPositions(kPattern);

Aggregate merged(const Aggregate& fragment, const Aggregate& old, const MergeRules& rules = {}) {
  return merge_formula({fragment, 0u, 0u}, old, kPositions, rules);
}
Aggregate merged_tiny(const Aggregate& fragment, const Aggregate& old, const MergeRules& rules = {}) {
  return merge_formula({fragment, kAllBits, 0u}, old, kPositions, rules);
}

// Of a pixel whose surfaces are red and green.
void expect_shows(const Aggregate& found, double alpha, double red, double green, double bound = 1.2e-7) {
  EXPECT_NEAR(found.alpha, alpha, bound);
  EXPECT_NEAR(found.color[0], red, bound);
  EXPECT_NEAR(found.color[1], green, bound);
}

// Slab and plane as in the literal reading.
constexpr MergeRules kLiteralSlab{.slab = MergeRules::Slab::full, .plane = MergeRules::Plane::area};

constexpr MergeRules kByPosition{.partition = MergeRules::Partition::positions};

// A slab of this thickness around depth z, whose surfaces lie between z_min and z_max.
Aggregate slab(float z, float thickness, float z_min, float z_max, float alpha = 1) {
  Aggregate of = flat_surface(alpha, kAllBits, z, 0, 1);
  of.thickness = thickness;
  of.z_min = z_min, of.z_max = z_max;
  return of;
}

void expect_invariants(const MergeFragment& fragment, const Aggregate& old, const MergeRules& rules,
                       const Aggregate& now) {
  const Aggregate& in = fragment.surface;
  ASSERT_GE(now.alpha, 0.0f);
  ASSERT_LE(now.alpha, 1.0f + 1.2e-7f);  // scaling down to 1 rounds
  ASSERT_EQ(now.mask, in.mask | old.mask);
  if (rules.slab == MergeRules::Slab::full) {
    ASSERT_EQ(now.z_min, std::min(in.z_min, old.z_min));
    ASSERT_EQ(now.z_max, std::max(in.z_max, old.z_max));
  }
  ASSERT_GE(now.thickness, old.thickness);
  for (int c = 0; c < 3; ++c) {  // a convex combination of both colours, except for rounding
    const float from_in = in.color[c] / in.alpha, from_old = old.alpha > 0 ? old.color[c] / old.alpha : from_in;
    ASSERT_GE(now.color[c], now.alpha * std::min(from_in, from_old) * 0.999998f);
    ASSERT_LE(now.color[c], now.alpha * std::max(from_in, from_old) * 1.000002f);
  }
}

// A slab of thickness 0.4 around depth -0.5 reaches from -0.7 to -0.3; the depths that it was made of reach less far.
TEST(MergeRules, TheDepthRangeLimitsTheEndsOfASlab) {
  const Aggregate of = slab(-0.5f, 0.4f, -0.6f, -0.45f);
  const SlabEnds<float> limited = slab_ends(of, -0.5f, {.extents = MergeRules::Extents::range});
  EXPECT_EQ(limited.front, -0.6f);
  EXPECT_EQ(limited.back, -0.45f);
  const SlabEnds<float> free = slab_ends(of, -0.5f, {.extents = MergeRules::Extents::slab});
  EXPECT_FLOAT_EQ(free.front, -0.7f);
  EXPECT_FLOAT_EQ(free.back, -0.3f);
}

TEST(MergeRules, InvariantsOnChains) {
  Random random(43);
  for (const MergeRules& rules : every_merge_rule())
    for (int chain = 0; chain < 1'000 * thoroughness(); ++chain) {
      Aggregate aggregate = kEmptyAggregate;
      for (int i = 0; i < 8; ++i) {
        const MergeFragment fragment = random_fragment(random);
        const Aggregate now = merge_formula(fragment, aggregate, kPositions, rules);
        ASSERT_NO_FATAL_FAILURE(expect_invariants(fragment, aggregate, rules, now))
            << "chain " << chain << ", fragment " << i;
        aggregate = now;
      }
    }
}

TEST(MergeRules, FirstFragmentIsTheAggregate) {
  const Aggregate in{.alpha = 0.25f,
                     .mask = 0xffu,
                     .plane = {-0.5f, 0.01f, -0.02f},
                     .thickness = 0.0f,
                     .z_min = -0.51f,
                     .z_max = -0.49f,
                     .color = {0.1f, 0.2f, 0.3f}};
  const Aggregate now = merged(in, kEmptyAggregate);
  EXPECT_EQ(now.mask, 0xffu);
  const auto found = numbers_of(now), expected = numbers_of(in);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (i >= 1 && i <= 6) {
      EXPECT_EQ(found[i], expected[i]) << i << ": depths are taken as they are";
    }
    EXPECT_FLOAT_EQ(found[i], expected[i]) << i;
  }
}

TEST(MergeRules, TheNearerOpaqueSurfaceHidesTheOther) {
  const auto at = [](float z, float red, float green) { return flat_surface(1, kAllBits, z, red, green); };
  expect_shows(merged(at(-0.9f, 1, 0), at(-0.1f, 0, 1)), 1, 1, 0, 0);
  expect_shows(merged(at(-0.1f, 1, 0), at(-0.9f, 0, 1)), 1, 0, 1, 0);
  expect_shows(merged(at(-0.5f, 1, 0), at(-0.5f, 0, 1)), 1, 0, 1, 0);  // the earlier one
}

TEST(MergeRules, DisjointHalvesAdd) {
  expect_shows(merged(flat_surface(0.5f, 0x0000ffffu, -0.1f, 1, 0), flat_surface(0.5f, 0xffff0000u, -0.9f, 0, 1)), 1,
               0.5, 0.5);
}

// Where masks overlap, the coverages count as independent, as in OVER. The surface in front shows 1/2, and the one
// behind shows 1/2 x (1 - 1/2) = 1/4.
TEST(MergeRules, OverlappingHalvesAreIndependent) {
  const Aggregate back = flat_surface(0.5f, kAllBits, -0.1f, 1, 0), front = flat_surface(0.5f, kAllBits, -0.9f, 0, 1);
  for (const Aggregate& now : {merged(front, back), merged(back, front)}) expect_shows(now, 0.75, 0.25, 0.5);
}

// Two opaque halves at the same 16 positions. The coverage of their region is 1, so the one in front hides the other,
// or it is their area of 1/2, and half of the other one shows. Where the region is the whole pixel, both are the same.
// An opaque half in front of a whole pixel hides half of it, or half of that: 1/2 + 1/4 + 1/2 is scaled down to 1.
TEST(MergeRules, RegionalCoverageIsNormalizedOrAnArea) {
  const MergeRules area{.regional = MergeRules::Regional::area};
  const Aggregate back = flat_surface(0.5f, 0xffffu, -0.1f, 1, 0), front = flat_surface(0.5f, 0xffffu, -0.9f, 0, 1);
  for (const bool is_front : {true, false}) {
    const Aggregate &in = is_front ? front : back, &old = is_front ? back : front;
    EXPECT_FLOAT_EQ(merged(in, old).alpha, 0.5f);
    EXPECT_FLOAT_EQ(merged(in, old).color[0], 0.0f);
    expect_shows(merged(in, old, area), 0.75, 0.25, 0.5);
  }
  const Aggregate half = flat_surface(0.5f, kAllBits, -0.1f, 1, 0), nearer = flat_surface(0.5f, kAllBits, -0.9f, 0, 1);
  EXPECT_FLOAT_EQ(merged(nearer, half, area).alpha, 0.75f);
  expect_shows(merged(front, flat_surface(1, kAllBits, -0.1f, 1, 0), area), 1, 0.6, 0.4);
}

// A speck lies beside what is there as long as there is room: 1/2 + 1/4 in the one position that it was given.
TEST(MergeRules, SpeckLiesBeside) {
  const Aggregate old = flat_surface(0.5f, kAllBits, -0.9f, 0, 1), tiny = flat_surface(0.25f / 32, 1u, -0.1f, 1, 0);
  expect_shows(merged_tiny(tiny, old), 0.5 + 0.25 / 32, 0.25 / 32, 0.5);
  // If it were no speck, half of it would be hidden.
  EXPECT_FLOAT_EQ(merged(tiny, old).alpha, 0.5f + 0.125f / 32);
}

// In a slab from -0.6 to -0.4, a fragment at -0.45 is 3/4 of the way to the back: 1/4 of the fragment and 3/4 of the
// slab are visible.
TEST(MergeRules, WithinTheSlabDeltaShares) {
  const Aggregate now = merged(flat_surface(1, kAllBits, -0.45f, 1, 0), slab(-0.5f, 0.2f, -0.6f, -0.4f));
  expect_shows(now, 1, 0.25, 0.75, 1e-6);
  EXPECT_GE(now.thickness, 0.2f);
}

// A steep plane leaves the depth range that its triangle really has in the pixel. What lies behind that range is behind
// everywhere, and what lies in front of it is in front everywhere.
TEST(MergeRules, DepthRangeBoundsTheSlabOnBothSides) {
  for (const float slope : {-4.0f, 4.0f}) {
    Aggregate old = slab(-0.5f, 0, -0.55f, -0.45f);
    old.plane.dzdu = slope;
    SCOPED_TRACE(slope);
    expect_shows(merged(flat_surface(1, kAllBits, -0.4f, 1, 0), old), 1, 0, 1);
    expect_shows(merged(flat_surface(1, kAllBits, -0.6f, 1, 0), old), 1, 1, 0);
  }
}

// A surface that covers `part` of every position of its mask.
Aggregate masked_surface(std::uint32_t mask, const DepthPlane<float>& plane, float red, float green, float part = 1) {
  Aggregate surface = flat_surface(part * static_cast<float>(std::popcount(mask)) / 32, mask, -0.5f, red, green);
  surface.plane = plane;
  surface.z_min = -4.0f, surface.z_max = 4.0f;  // no plane of these tests leaves this range within the pixel
  return surface;
}

// Depths in integers: the planes are multiples of 2^-10, so depths at positions are multiples of 2^-18, exact in float.
// Every position shows the nearer surface; at equal depth the earlier one.
TEST(MergeRules, CrossingPlanesShareTheirOverlapByPosition) {
  Random random(45);
  int ties = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto integers = [&] {
      return std::array{random.integer(-600, -400), random.integer(-200, 200), random.integer(-200, 200)};
    };
    const std::array<std::int64_t, 3> in = integers();
    std::array<std::int64_t, 3> old = integers();
    if (random.one_in(3)) old = {in[0], in[2], in[1]};  // equal depth where u = v
    const auto plane = [](const std::array<std::int64_t, 3>& p) {
      return DepthPlane<float>{static_cast<float>(p[0]) / 1024, static_cast<float>(p[1]) / 1024,
                               static_cast<float>(p[2]) / 1024};
    };
    const std::uint32_t in_mask = random.word() | 1u, old_mask = random.word() | 2u;
    int shows_in = 0, shows_old = 0;
    for (std::size_t s = 0; s < 32; ++s) {
      const auto depth = [&](const std::array<std::int64_t, 3>& p) {
        return 256 * p[0] + p[1] * (kPattern.x[s] - 128) + p[2] * (kPattern.y[s] - 128);
      };
      const bool has_in = in_mask >> s & 1, has_old = old_mask >> s & 1;
      const bool in_is_nearer = depth(in) < depth(old);
      shows_in += has_in && (!has_old || in_is_nearer);
      shows_old += has_old && (!has_in || !in_is_nearer);
      ties += has_in && has_old && depth(in) == depth(old);
    }
    const Aggregate now =
        merged(masked_surface(in_mask, plane(in), 1, 0), masked_surface(old_mask, plane(old), 0, 1), kByPosition);
    ASSERT_NEAR(now.color[0], shows_in / 32.0, 1e-6) << i;
    ASSERT_NEAR(now.color[1], shows_old / 32.0, 1e-6) << i;
    ASSERT_NEAR(now.alpha, std::popcount(in_mask | old_mask) / 32.0, 1e-6) << i;
  }
  EXPECT_GT(ties, 1'000);
}

// By lines, the planes part the pixel as a half-plane of the table does. The line of the table is off by at most half a
// row in angle, half a column in distance and the error of the arc tangent, which is 0.045 px within the pixel. So only
// positions that are nearer than that to the line may be on the other side of it.
TEST(MergeRules, LinesPartPositionsAsTheTableDoes) {
  Random random(48);
  int cut = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto plane = [&] {
      return DepthPlane<float>{random.real32(-0.6, -0.4), random.real32(-0.2, 0.2), random.real32(-0.2, 0.2)};
    };
    const Aggregate in = masked_surface(kAllBits, plane(), 1, 0), old = masked_surface(kAllBits, plane(), 0, 1);
    const double a = double(in.plane.dzdu) - old.plane.dzdu, b = double(in.plane.dzdv) - old.plane.dzdv;
    int in_front = 0, close = 0;
    for (std::size_t s = 0; s < 32; ++s) {
      const double u = kPattern.x[s] / 256.0 - 0.5, v = kPattern.y[s] / 256.0 - 0.5;
      const double gap = (a * u + b * v + double(in.plane.z) - old.plane.z) / std::hypot(a, b);
      in_front += gap < -0.05;
      close += std::abs(gap) <= 0.05;
    }
    cut += in_front > 0 && in_front + close < 32;
    const double shown = 32.0 * merged(in, old).color[0];
    ASSERT_GE(shown, in_front - 1e-4) << i;
    ASSERT_LE(shown, in_front + close + 1e-4) << i;
  }
  EXPECT_GT(cut, 5'000);
}

// All around, in steps of 1/4 degree: positions that are farther from the line than the table's steps can move it are
// on the right side. Half a step of the angle, 2.8 degrees, moves a line by at most 0.035, half a step of its distance
// by 0.011.
TEST(MergeRules, HalfPlanesFaceTheirDirection) {
  for (int step = 0; step < 4 * 360; ++step) {
    const double angle = step * std::numbers::pi / 720, a = std::cos(angle), b = std::sin(angle);
    for (const double c : {-0.4, -0.1, 0.0, 0.25}) {
      const auto direction = line_direction<float, std::uint32_t>(static_cast<float>(3 * a), static_cast<float>(3 * b));
      const std::uint32_t mask = half_plane(direction, static_cast<float>(3 * c), kPositions.table);
      for (std::size_t s = 0; s < 32; ++s) {
        const double u = kPattern.x[s] / 256.0 - 0.5, v = kPattern.y[s] / 256.0 - 0.5, distance = a * u + b * v + c;
        if (std::abs(distance) < 0.05) continue;
        ASSERT_EQ((mask >> s & 1) == 1, distance > 0) << step / 4.0 << " degrees, c " << c << ", position " << s;
      }
    }
  }
}

// Where nothing needs a look at positions, nothing looks at them.
TEST(MergeRules, EarlyOuts) {
  MergeSteps steps;
  const auto merging = [&](const Aggregate& in, const Aggregate& old) {
    merge_formula<float, std::uint32_t>({in, 0u, 0u}, old, kPositions, MergeRules{}, steps);
  };
  const Aggregate left = flat_surface(0.5f, 0xffffu, -0.5f, 1);
  merging(left, kEmptyAggregate);
  EXPECT_EQ(steps.merged, 0u);
  EXPECT_EQ(steps.reached, 0u);
  merging(left, flat_surface(0.5f, 0xffff0000u, -0.5f, 1));
  EXPECT_EQ(steps.merged, 1u);
  EXPECT_EQ(steps.overlap, 0u);
  EXPECT_EQ(steps.reached, 0xffffu);
  merging(left, flat_surface(0.5f, kAllBits, -0.6f, 1));
  EXPECT_EQ(steps.overlap, 0xffffu);
  EXPECT_EQ(steps.lines, 0u) << "the depth ranges are apart";
  Aggregate tilted = left;
  tilted.plane.dzdu = 0.2f;
  tilted.z_min = -0.6f, tilted.z_max = -0.4f;
  merging(tilted, left);
  EXPECT_EQ(steps.lines, 1u);
  EXPECT_EQ(steps.front_line + steps.back_line, 2u);
  EXPECT_EQ(steps.fuzzy, 0u);
  tilted.plane.z = -0.2f;
  merging(tilted, left);
  EXPECT_EQ(steps.lines, 1u);
  EXPECT_EQ(steps.front_line + steps.back_line, 0u) << "the planes do not meet within the pixel";
}

// A slab of thickness 1 that a plane crosses: positions in front of it show the fragment, those behind it the
// aggregate, and those within it a blend by Delta, which is taken at the mean of the positions within.
TEST(MergeRules, WithinTheSlabDeltaIsTakenAtTheMeanPosition) {
  Random random(46);
  int mixed = 0;
  for (int i = 0; i < 20'000; ++i) {
    const float steep = random.one_in(2) ? 0.1f : 1.0f;
    const auto plane = [&](float z) {
      return DepthPlane<float>{z, random.real32(-steep, steep), random.real32(-steep, steep)};
    };
    const std::uint32_t mask = random.word() | 1u << random.integer(0, 31);
    const float part_in = random.one_in(2) ? 1.0f : random.real32(0.1, 1);
    const float part_old = random.one_in(2) ? 1.0f : random.real32(0.1, 1);
    const Aggregate in = masked_surface(mask, plane(random.real32(-1, 0)), 1, 0, part_in);
    Aggregate old = masked_surface(mask, plane(-0.5f), 0, 1, part_old);
    old.thickness = 1.0f;
    // 0 at the slab's front, 1 at its back.
    const auto depth_in_slab = [&](double u, double v) {
      return in.plane.z - old.plane.z + 0.5 + (in.plane.dzdu - double(old.plane.dzdu)) * u +
             (in.plane.dzdv - double(old.plane.dzdv)) * v;
    };
    int in_front = 0, behind = 0, within = 0;
    double u_sum = 0, v_sum = 0;
    bool undecided = false;
    for (std::size_t s = 0; s < 32; ++s) {
      if (!(mask >> s & 1)) continue;
      const double u = kPattern.x[s] / 256.0 - 0.5, v = kPattern.y[s] / 256.0 - 0.5, depth = depth_in_slab(u, v);
      undecided |= std::abs(depth) < 1e-5 || std::abs(depth - 1) < 1e-5;
      in_front += depth<0, behind += depth> 1;
      if (depth < 0 || depth > 1) continue;
      ++within, u_sum += u, v_sum += v;
    }
    if (undecided) continue;
    mixed += within > 0 && in_front + behind > 0;
    const double delta = within > 0 ? depth_in_slab(u_sum / within, v_sum / within) : 0;
    MergeRules rules = kByPosition;
    if (random.one_in(2)) rules.overlap = MergeRules::Overlap::over;
    const bool unites = random.one_in(2);
    rules.fuzzy = unites ? MergeRules::Fuzzy::unite : MergeRules::Fuzzy::delta;
    const Aggregate now = merged(in, old, rules);
    const double blends_in = part_in * (1 - delta), blends_old = part_old * delta;
    const double both = part_in + part_old - double(part_in) * part_old;
    const double scale = unites && within > 0 ? both / (blends_in + blends_old) : 1;
    const double red = part_in * (in_front + behind * (1.0 - part_old)) + within * scale * blends_in;
    const double green = part_old * (in_front * (1.0 - part_in) + behind) + within * scale * blends_old;
    ASSERT_NEAR(now.color[0], red / 32, 2e-6) << i;
    ASSERT_NEAR(now.color[1], green / 32, 2e-6) << i;
  }
  EXPECT_GT(mixed, 5'000);
}

// Two surfaces beside each other that are larger than their masks, 1 in half of the positions and 1/2 in the other
// half, are scaled down to the pixel: 2/3 and 1/3.
TEST(MergeRules, AreasAboveOneAreScaled) {
  expect_shows(merged(flat_surface(1.0f, 0x0000ffffu, -0.1f, 1, 0), flat_surface(0.5f, 0xffff0000u, -0.9f, 0, 1)), 1,
               2.0 / 3, 1.0 / 3);
}

// The plane of `now` is the mean of both, of which `in` has this part.
void expect_mean(const Aggregate& now, const Aggregate& in, const Aggregate& old, double part) {
  const auto mean = [&](float of_in, float of_old) { return of_in * part + of_old * (1 - part); };
  ASSERT_NEAR(now.plane.z, mean(in.plane.z, old.plane.z), 1e-6);
  ASSERT_NEAR(now.plane.dzdu, mean(in.plane.dzdu, old.plane.dzdu), 1e-6);
  ASSERT_NEAR(now.plane.dzdv, mean(in.plane.dzdv, old.plane.dzdv), 1e-6);
}

TEST(MergeRules, PlanesAreMeansByArea) {
  Random random(47);
  for (int i = 0; i < 20'000; ++i) {
    const auto surface = [&] {
      Aggregate of = flat_surface(random.real32(0.01, 1), random.word() | 1u, random.real32(-1, 0), 1);
      of.plane.dzdu = random.real32(-1, 1), of.plane.dzdv = random.real32(-1, 1);
      return of;
    };
    const Aggregate in = surface(), old = surface(), now = merged(in, old, kLiteralSlab);
    ASSERT_NO_FATAL_FAILURE(expect_mean(now, in, old, double(in.alpha) / (double(in.alpha) + old.alpha))) << i;
  }
}

// The slab reaches the fragment: at every covered position the fragment is within half the thickness of the new plane.
TEST(MergeRules, ThicknessReachesTheFragment) {
  Random random(44);
  MergeRules containing = kLiteralSlab;
  containing.thickness = MergeRules::Thickness::containing;
  for (int i = 0; i < 20'000; ++i) {
    const MergeFragment fragments[3] = {random_fragment(random), random_fragment(random), random_fragment(random)};
    const MergeRules rules = random.one_in(2) ? containing : kLiteralSlab;
    const Aggregate old =
        merge_formula(fragments[1], merge_formula(fragments[0], kEmptyAggregate, kPositions, rules), kPositions, rules);
    const Aggregate now = merge_formula(fragments[2], old, kPositions, rules);
    const Aggregate& in = fragments[2].surface;
    double farthest = 0, moved = 0;
    for (std::size_t s = 0; s < 32; ++s) {
      const double u = kPattern.x[s] / 256.0 - 0.5, v = kPattern.y[s] / 256.0 - 0.5;
      const double z =
          std::clamp(in.plane.z + in.plane.dzdu * u + in.plane.dzdv * v, double(in.z_min), double(in.z_max));
      const double middle = now.plane.z + now.plane.dzdu * u + now.plane.dzdv * v;
      const double old_middle = old.plane.z + old.plane.dzdu * u + old.plane.dzdv * v;
      if (in.mask >> s & 1) farthest = std::max(farthest, std::abs(z - middle));
      if (old.mask >> s & 1) moved = std::max(moved, std::abs(old_middle - middle));
    }
    const auto steepness = [](const DepthPlane<float>& plane) {
      return std::abs(double(plane.dzdu)) + std::abs(double(plane.dzdv));
    };
    const double size = steepness(now.plane) + steepness(in.plane) + steepness(old.plane) + now.thickness;
    const double rounding = 1e-6 * (1 + size);
    ASSERT_LE(farthest, now.thickness / 2 + rounding);
    // Nor is it thicker than it must be.
    const double kept = rules == containing ? old.thickness + 2 * moved : old.thickness;
    ASSERT_NEAR(now.thickness, std::max(kept, 2 * farthest), rounding) << i;
  }
}

// 1/4 over 1/2: independent coverages give 1/4 + 1/2 x 3/4, coverages beside each other 1/4 + 1/2.
TEST(MergeRules, OverlapIsIndependentOrBeside) {
  using Overlap = MergeRules::Overlap;
  const Aggregate back = flat_surface(0.5f, kAllBits, -0.1f, 0, 1), front = flat_surface(0.25f, kAllBits, -0.9f, 1, 0);
  for (const bool front_last : {true, false}) {
    const Aggregate &in = front_last ? front : back, &old = front_last ? back : front;
    EXPECT_FLOAT_EQ(merged_tiny(in, old, {.overlap = Overlap::over}).alpha, 0.25f + 0.375f);
    EXPECT_FLOAT_EQ(merged_tiny(in, old, {.overlap = Overlap::tiny}).alpha, 0.75f);
    EXPECT_FLOAT_EQ(merged(in, old, {.overlap = Overlap::tiny}).alpha, 0.625f);
  }
}

// A speck of 1/4 in front of 7/8. Together they exceed the pixel, so the one behind keeps 3/4 of
// the pixel if sums are bounded. If they are not, both are scaled to 1 in the end: to 2/9 and 7/9. A speck behind finds
// 1/8.
TEST(MergeRules, UnboundedSpecksLieBesideAllThatIsThere) {
  const MergeRules bounded, unbounded{.overlap = MergeRules::Overlap::unbounded};
  const Aggregate old = flat_surface(0.875f, kAllBits, -0.5f, 0, 1), speck = flat_surface(0.25f, kAllBits, -0.9f, 1, 0);
  expect_shows(merged_tiny(speck, old, bounded), 1, 0.25, 0.75);
  expect_shows(merged_tiny(speck, old, unbounded), 1, 2.0 / 9, 7.0 / 9);
  expect_shows(merged_tiny(flat_surface(0.25f, kAllBits, -0.1f, 1, 0), old, unbounded), 1, 0.125, 0.875);
  expect_shows(merged(speck, old, unbounded), 0.25 + 0.75 * 0.875, 0.25, 0.75 * 0.875);  // no speck
}

// Where the fragment is in front is given: at half of the positions, whatever the depths.
TEST(MergeRules, APartitionMayBeGiven) {
  const Aggregate old = flat_surface(1, kAllBits, -0.9f, 0, 1);
  MergeFragment fragment{flat_surface(1, kAllBits, -0.1f, 1, 0), 0u, 0x0f0f0f0fu};
  const MergeRules given{.partition = MergeRules::Partition::given};
  expect_shows(merge_formula(fragment, old, kPositions, given), 1, 0.5, 0.5);
  expect_shows(merge_formula(fragment, old, kPositions, {}), 1, 0, 1);
}

TEST(MergeRules, ASlabWithoutThicknessStaysSo) {
  const Aggregate old = flat_surface(0.5f, 0x0000ffffu, -0.9f, 0, 1), in = flat_surface(0.5f, 0xffff0000u, -0.1f, 1, 0);
  EXPECT_GT(merged(in, old, {}).thickness, 0.5f);
  EXPECT_EQ(merged(in, old, {.thickness = MergeRules::Thickness::none}).thickness, 0);
}

// The transition of slide 12. The aggregate leaves half of its mask open, and the distance of the two is all of their
// depth range: a fuzziness of 1/2 x 1, halfway between 0.75 and 0.625. At the same depth it is ADD.
TEST(MergeRules, TransitionGoesFromAddToOverWithDistance) {
  const MergeRules rules{.overlap = MergeRules::Overlap::transition};
  const Aggregate old = flat_surface(0.5f, kAllBits, -0.9f, 0, 1);
  EXPECT_FLOAT_EQ(merged(flat_surface(0.25f, kAllBits, -0.1f, 1, 0), old, rules).alpha, (0.75f + 0.625f) / 2);
  EXPECT_FLOAT_EQ(merged(flat_surface(0.25f, kAllBits, -0.9f, 1, 0), old, rules).alpha, 0.75f);
}

// The same with sloping planes, partial masks and depth ranges that clamp the planes. The fragment is in front
// everywhere.
TEST(MergeRules, TransitionTakesTheMeanDistanceOverTheOverlap) {
  const MergeRules rules{.overlap = MergeRules::Overlap::transition};
  Random random(48);
  for (int i = 0; i < 20'000; ++i) {
    const float part_in = random.real32(0.1, 1), part_old = random.real32(0.1, 1);
    const auto surface = [&](float z, float part, float red, float green) {
      const DepthPlane<float> plane{z, random.real32(-0.2, 0.2), random.real32(-0.2, 0.2)};
      Aggregate of = masked_surface(random.word() | 1u, plane, red, green, part);
      of.z_min = z - random.real32(0, 0.1), of.z_max = z + random.real32(0, 0.1);
      return of;
    };
    const Aggregate in = surface(-0.9f, part_in, 1, 0), old = surface(-0.3f, part_old, 0, 1);
    double apart = 0;
    for (std::size_t s = 0; s < 32; ++s) {
      if (!(in.mask & old.mask & 1u << s)) continue;
      const double u = kPattern.x[s] / 256.0 - 0.5, v = kPattern.y[s] / 256.0 - 0.5;
      const auto depth = [&](const Aggregate& of) {
        return std::clamp(of.plane.z + of.plane.dzdu * u + of.plane.dzdv * v, double(of.z_min), double(of.z_max));
      };
      apart += depth(old) - depth(in);
    }
    const int overlap = std::popcount(in.mask & old.mask), only_old = std::popcount(old.mask & ~in.mask);
    const double open_part = std::popcount(old.mask) / 32.0 * (1 - part_old);
    const double fuzziness = open_part * apart / overlap / (double(old.z_max) - in.z_min);
    const double beside = std::min(part_old, 1 - part_in), independent = part_old * (1 - part_in);
    const double shows = only_old * part_old + overlap * (beside + (independent - beside) * fuzziness);
    const Aggregate now = merged(in, old, rules);
    ASSERT_NEAR(now.color[0], in.color[0], 2e-6) << i;
    ASSERT_NEAR(now.color[1], shows / 32, 2e-6) << i;
  }
}

// An area of 1/16 in one position is twice what the position can hold. In front it hides as much as it covers: what
// the position cannot give, 1 - alpha' = -1, is taken from the positions beside it.
TEST(MergeRules, LocalCoverageAboveOneConservesArea) {
  const Aggregate front = flat_surface(1.0f / 16, 1u, -0.9f, 1, 0), back = flat_surface(0.5f, 0x0000ffffu, -0.1f, 0, 1);
  for (const bool front_last : {true, false})
    expect_shows(front_last ? merged(front, back) : merged(back, front), 0.5, 2.0 / 32, 14.0 / 32);
}

// A speck of 1/4 px in one position, in front of 1/8 px in four: 4 - 8 x 1 is less than nothing.
TEST(MergeRules, NoSurfaceShowsLessThanNothing) {
  const Aggregate front = flat_surface(0.25f, 1u, -0.9f, 1, 0), back = flat_surface(0.125f, 0xfu, -0.1f, 0, 1);
  for (const bool front_last : {true, false})
    expect_shows(front_last ? merged(front, back) : merged(back, front), 0.25, 0.25, 0);
}

// Two coverages of 1/2 in the middle of the slab: 3/4 together, half of each. As areas, the blending factors keep 1/4
// of each. `mix` is halfway between 1/2 over 1/4 and 1/4 under 1/2.
TEST(MergeRules, WithinTheSlabCoverageIsTheUnion) {
  const Aggregate old = slab(-0.5f, 0.2f, -0.6f, -0.4f, 0.5f), in = flat_surface(0.5f, kAllBits, -0.5f, 1, 0);
  expect_shows(merged(in, old), 0.75, 0.375, 0.375, 1e-6);
  expect_shows(merged(in, old, {.fuzzy = MergeRules::Fuzzy::delta}), 0.5, 0.25, 0.25, 1e-6);
  expect_shows(merged(in, old, {.fuzzy = MergeRules::Fuzzy::mix}), 0.75, 0.375, 0.375, 1e-6);
}

// A speck of 1/4 in the middle of a slab of 7/8. Beside each other they fill the pixel; the speck has as much of it as
// its factor, 1/8, has of 1/8 + 7/16. With the factors of 2.2.1 it lies in front.
TEST(MergeRules, ASpeckWithinTheSlabLiesBesideWhatIsThere) {
  const Aggregate old = slab(-0.5f, 0.2f, -0.6f, -0.4f, 0.875f), speck = flat_surface(0.25f, kAllBits, -0.5f, 1, 0);
  expect_shows(merged_tiny(speck, old), 1, 2.0 / 9, 7.0 / 9, 1e-6);
  expect_shows(merged_tiny(speck, old, {.fuzzy = MergeRules::Fuzzy::delta}), 1, 0.25, 0.75, 1e-6);
}

// A slab of thickness 0.4 around -0.5 whose surfaces lie between -0.55 and -0.45. A fragment at -0.4 is behind the
// surfaces but within the slab.
TEST(MergeRules, ExtentsAreCutByTheRangeOrNot) {
  const Aggregate old = slab(-0.5f, 0.4f, -0.55f, -0.45f), in = flat_surface(1, kAllBits, -0.4f, 1, 0);
  EXPECT_EQ(merged(in, old).color[0], 0.0f);
  // 3/4 of the way to the back.
  EXPECT_NEAR(merged(in, old, {.extents = MergeRules::Extents::slab}).color[0], 0.25f, 1e-6);
}

// A thin fragment crosses a thin aggregate. The slab reaches the fragment at its visible positions and no farther.
TEST(MergeRules, VisiblePositionsAloneExtendTheSlab) {
  MergeRules rules = kByPosition;
  rules.plane = MergeRules::Plane::area;
  Random random(49);
  int hidden = 0, partly = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto surface = [&](float red, float green) {
      const DepthPlane<float> plane{random.real32(-0.55, -0.45), random.real32(-0.1, 0.1), random.real32(-0.1, 0.1)};
      Aggregate of = masked_surface(random.word() | 1u, plane, red, green);
      of.z_min = random.real32(-0.95, -0.9), of.z_max = random.real32(-0.1, -0.05);
      return of;
    };
    const Aggregate in = surface(1, 0);
    Aggregate old = surface(0, 1);
    if (random.one_in(3)) old.mask |= in.mask;
    const Aggregate now = merged(in, old, rules);
    double farthest = 0;
    int reached = 0;
    bool undecided = false;
    for (std::size_t s = 0; s < 32; ++s) {
      if (!(in.mask >> s & 1)) continue;
      const double u = kPattern.x[s] / 256.0 - 0.5, v = kPattern.y[s] / 256.0 - 0.5;
      const auto depth = [&](const Aggregate& of) { return of.plane.z + of.plane.dzdu * u + of.plane.dzdv * v; };
      undecided |= std::abs(depth(in) - depth(old)) < 1e-6;
      if ((old.mask >> s & 1) && depth(in) >= depth(old)) continue;
      ++reached, farthest = std::max(farthest, std::abs(depth(in) - depth(now)));
    }
    if (undecided) continue;
    (reached == 0 ? hidden : partly) += reached < std::popcount(in.mask);
    ASSERT_NEAR(now.thickness, 2 * farthest, 1e-6) << i;
    ASSERT_EQ(now.z_min, reached == 0 ? old.z_min : std::min(in.z_min, old.z_min)) << i;
    ASSERT_EQ(now.z_max, reached == 0 ? old.z_max : std::max(in.z_max, old.z_max)) << i;
    const double part = reached == 0 ? 0 : double(in.alpha) / (double(in.alpha) + old.alpha);
    ASSERT_NO_FATAL_FAILURE(expect_mean(now, in, old, part)) << i;
  }
  EXPECT_GT(hidden, 500);
  EXPECT_GT(partly, 5'000);
}

TEST(MergeRules, PlanesAreWeightedByAreaOrByWhatShows) {
  const Aggregate front = flat_surface(1, kAllBits, -0.9f, 0, 1), behind = flat_surface(1, kAllBits, -0.1f, 1, 0);
  EXPECT_FLOAT_EQ(merged(behind, front, kLiteralSlab).plane.z, -0.5f);
  EXPECT_FLOAT_EQ(merged(front, behind, {.plane = MergeRules::Plane::area}).plane.z, -0.5f);
  EXPECT_FLOAT_EQ(merged(front, behind).plane.z, -0.9f);
}

}  // namespace beampipe::merge_rules_test
