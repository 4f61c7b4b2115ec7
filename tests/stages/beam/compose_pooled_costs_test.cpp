// What compose_pooled is charged, worked out by hand: first each step, then what happens to a pixel as a sum of steps.
#include "stages/beam/compose_pooled_cost.h"
#include "tests/stages/open_pixels.h"

namespace beampipe::compose_pooled_costs_test {

using Ops = OperationCounts;

constexpr glm::vec3 kRed{1, 0, 0};

void expect_operations(const OperationCounts& found, const OperationCounts& expected, const char* name) {
  EXPECT_EQ(found.mul_add, expected.mul_add) << name;
  EXPECT_EQ(found.add, expected.add) << name;
  EXPECT_EQ(found.bit, expected.bit) << name;
  EXPECT_EQ(found.fetch, expected.fetch) << name;
  EXPECT_EQ(found.special, expected.special) << name;
  EXPECT_EQ(found.convert, expected.convert) << name;
}

// ---- The steps, with masks of eight words. Comparisons, choices, sums and differences are `add`. ----

constexpr std::uint64_t kWords = 8, kPositions = 256;

constexpr OperationCounts kComparison{.add = 1};

// Each plane halves each state so far: an and, and an and-not.
constexpr OperationCounts split(std::uint64_t planes) { return {.bit = kWords * 2 * ((1u << planes) - 1)}; }

// A plane is the union of the states whose numbers have its bit. States from 0 on have so many of these bits.
constexpr OperationCounts join(std::uint64_t bits) { return {.bit = kWords * bits}; }
constexpr std::uint64_t kTwoStates = 1, kThreeStates = 1 + 1;

constexpr OperationCounts kMeeting{.bit = 2 * kWords};  // an intersection, and whether it is empty
constexpr OperationCounts kWin{.bit = 2 * kWords};      // an intersection, and its union with what is won
constexpr OperationCounts kClaim{.bit = 3 * kWords};    // what is free and covered, with what is won; is that nothing?
constexpr OperationCounts kTake{.bit = 2 * kWords};     // a state without what is taken, and whether that is nothing

// A plane: for each axis a distance from the anchor, and a product and sum; three numbers become floats.
constexpr OperationCounts kPlane{.mul_add = 2, .add = 2 + 2, .convert = 3};

// How far a plane reaches in the pixel: two magnitudes, their sum, and half of it.
constexpr OperationCounts kReach{.mul_add = 1, .add = 1, .bit = 2};

// Three differences of planes; the reach of their difference; its negative; a comparison for each side.
const OperationCounts kContest = Ops{.add = 3 + 1 + 2} + kReach;

// Depth at a place: two products, two sums.
constexpr OperationCounts kDepthAt{.mul_add = 2, .add = 2};

// At each position two depths and their comparison; what is won is added; and who comes first in the trace.
const OperationCounts kPartition = kDepthAt * (2 * kPositions) + Ops{.add = kPositions} + kWin + kComparison;

// The bits of each word as a number, and their sum.
constexpr OperationCounts kCount{.add = 7, .bit = 8, .convert = 8};

// The error is a product and a difference. As eight bits: a product, two limits, its sign, half a step, a conversion
// and a shift. Each axis of the centroid: a product, half a step, a conversion, a shift. Three of the parts join
// others.
constexpr OperationCounts kSlot{.mul_add = 1 + 1 + 2, .add = 1 + 2 + 1 + 1 + 2, .bit = 1 + 2 + 3, .convert = 1 + 2};

// A reach, both bounds in the pixel, and a comparison of each with the watermark.
const OperationCounts kFinality = kReach + Ops{.add = 2 + 2};

// At each position a depth, the greater one, and whether it counts.
const OperationCounts kFarthest = kDepthAt * kPositions + Ops{.add = 2 * kPositions};

// Two sums over positions; of each a conversion, a product and a division for the scale, a product, and the centre.
constexpr OperationCounts kMean{.mul_add = 2 * 2, .add = 2 * kPositions + 2, .special = 2, .convert = 2};

// Three sums of products over positions. Two means, without centres; the area of a position, and a scale: a product and
// two divisions; three spreads: a conversion, two products and a difference of each, and the products of the means.
// Each side: a limit, a sum and a root; between them a division, a product and a difference.
constexpr OperationCounts kSides{.mul_add = 3 * kPositions + 4 + 1 + 3 * 2 + 3 + 1,
                                 .add = 3 + 2 * 2 + 1,
                                 .special = 2 + 2 + 2 + 1,
                                 .convert = 2 + 3};

// Of both planes at both means the depths, their difference and its magnitude; the sum of the two, the lesser area, and
// their product; and whether that is the least so far.
const OperationCounts kPair = kDepthAt * 4 + Ops{.mul_add = 1, .add = 2 + 1 + 1 + 1, .bit = 2};

// Two distances: the greater number, the lesser one, their difference. A comparison of both.
constexpr OperationCounts kTie{.add = 2 * 3 + 1};

// A hash: three shifts, three xors, two products. Its upper bits: a shift, a conversion, a sum and a product.
constexpr OperationCounts kThreshold{.mul_add = 2 + 1, .add = 1, .bit = 6 + 1, .convert = 1};

// What a slot is, without its number: two shifts and an xor.
constexpr OperationCounts kContent{.bit = 3};

// Two surfaces become one:
//  - what is left of each error: a division, and two products; its weight: a sum, a limit and a choice;
//  - the parts: the sum of the weights, a division, and two products; the sum of the errors;
//  - the contents of both, of which one counts three times, as a threshold;
//  - the mean colour: two products and a sum for each channel;
//  - its format: the largest channel (three comparisons), a product, a shift, a sum, a limit, whether it is black, a
//    difference and a shift; for each channel a product, two sums, two limits, a conversion, a shift and an or; the
//    exponent's sum, shift and or, and a choice;
//  - the error's format: a product, two limits, its sign, half a step, a conversion and a shift; two more ors in the
//    slot; and the union of the masks.
const OperationCounts kMerge = Ops{.mul_add = 2 * 2 + 2, .add = 2 * 3 + 1 + 1, .special = 2 + 1} + kContent * 2 +
                               Ops{.add = 3} + kThreshold + Ops{.mul_add = 2 * 3, .add = 3} +
                               Ops{.mul_add = 1, .add = 3 + 3 + 1, .bit = 2} +
                               Ops{.mul_add = 1, .add = 4, .bit = 2, .convert = 1} * 3 + Ops{.add = 2, .bit = 2} +
                               Ops{.mul_add = 1, .add = 4, .bit = 1 + 2 + kWords, .convert = 1};

constexpr OperationCounts kFraction{.special = 1};

// To a sum of 16 bits: a product, one unit less a threshold, a conversion, the sum and two limits.
constexpr OperationCounts kFixedSum{.mul_add = 1, .add = 2 + 1 + 2, .convert = 1};
constexpr OperationCounts kFixedValue{.mul_add = 1, .convert = 1};

// To six sums with a common exponent:
//  - the exponent: six shifts by 15, five to its place, and five ors; six mantissas;
//  - the largest of the addends in five comparisons, and its exponent in a shift;
//  - all sums become smaller by that: a sum and a shift each;
//  - whether that is enough: of each sum a conversion, the sum with its addend, one unit more, and a comparison;
//  - of each addend one unit less a threshold, a conversion, the sum, a limit, and its bit of the exponent.
// An addend that is not known to be 0 takes a product in the comparison, and a product, a limit and a sum in the end.
constexpr OperationCounts color_sums(std::uint64_t addends) {
  return {.mul_add = 2 * addends,
          .add = 5 + 6 + 6 * 3 + 6 * 3 + 2 * addends,
          .bit = 6 + 5 + 5 + 6 + 1 + 6 + 6,
          .convert = 6 + 6};
}

// A surface becomes final:
//  - what it is, as a threshold;
//  - its exact area: a sum, a limit, a division; the area of what is final already;
//  - of its visible area (simd/conserve.h) the fraction, its own error (a division, a difference), that of what is
//    taken (the same), the free positions (a difference, a limit), its share of them (a division, and a choice by a
//    comparison), the estimate (a division, three products, a sum, a difference), and three limits, of which one is a
//    difference;
//  - by positions: a division; the products of both with three channels;
//  - the sums of areas and of colours, that of positions, and the union of the masks.
const OperationCounts kRetired = kContent + kThreshold + Ops{.add = 2, .special = 1} + kFixedValue +
                                 Ops{.mul_add = 3, .add = 1 + 1 + 2 + 2 + 2 + 3 + 1, .special = 1 + 1 + 1 + 1 + 1} +
                                 Ops{.mul_add = 6, .special = 1} + kFixedSum + color_sums(6) +
                                 Ops{.add = 1, .bit = kWords};

// A reach, both bounds, two limits of each; and whether they are the farthest in the pixel.
const OperationCounts kBounds = kReach + Ops{.add = 2 + 4 + 1};

// The least and the greatest of three depths.
constexpr OperationCounts kVertices{.add = 2 + 2};

// A speck's place in the table: of each axis a product, a conversion, two limits; a look-up of three positions and one
// of each; of each plane a shift and an and for each; the sum of the votes.
constexpr OperationCounts votes(std::uint64_t planes) {
  return {.mul_add = 2, .add = 2 * 2 + 3, .bit = 3 * 2 * planes, .fetch = 1 + 3, .convert = 2};
}

// Its place from the centre; the surface's depth there; two magnitudes, their sum, a product; a sum and a comparison.
const OperationCounts kSpeckTest = Ops{.mul_add = 1, .add = 2 + 1 + 1 + 1, .bit = 2} + kDepthAt;

// A threshold from its area and depth. Both sides' areas, the greater one; the part that is seen: a product, a
// division; their new sum, its value, the greater one, the difference; what is left of the pixel: a value, a
// difference, a limit; and whether the result is above 0.
const OperationCounts kSpeckSeen =
    kThreshold + kFixedValue * 4 + kFixedSum + Ops{.mul_add = 1, .add = 2 + 1 + 1 + 1 + 1, .bit = 1, .special = 1};

// Three products, and the sums, of which those by positions are known to stay.
const OperationCounts kSpeckAdded = Ops{.mul_add = 3} + kFixedSum + color_sums(3);

// Two estimates become one:
//  - the count of positions as a part of the pixel; of seven sums the values;
//  - the area: at least a unit; a tolerance; a difference, a sum and two limits; at most 1; 1 by a comparison and a
//    choice; the scale of colours;
//  - the brightest channel: the larger of it and of two quotients for each channel, of which one has a limit, which is
//    a quotient, and a choice by a comparison; its tolerance: a quotient and a product;
//  - of each channel a product, a difference, a sum and two limits.
const OperationCounts kLimit = kCount + Ops{.mul_add = 1} + kFixedValue * 7 +
                               Ops{.add = 1 + 4 + 1 + 2, .special = 1 + 1} + Ops{.add = 2 + 1 + 2, .special = 3} * 3 +
                               Ops{.mul_add = 1, .special = 1} + Ops{.mul_add = 1, .add = 4} * 3;

constexpr std::uint64_t kSetup = 4 + 5 * 8, kSlotBytes = 8;  // to compute a plane: its triangle, and five doubles

TEST(PooledCosts, OneMergeIsAsDocsCostsSays) {
  EXPECT_EQ(kMerge, (OperationCounts{.mul_add = 20, .add = 40, .bit = 34, .special = 3, .convert = 5}));
}

TEST(PooledCosts, Steps) {
  using Work = PooledWork;
  struct Step {
    const char* name;
    std::uint64_t Work::*count;
    OperationCounts ops;
    std::uint64_t bytes_read = 0, tests = 0;
  };
  const Step steps[] = {
      {"a fragment, with the closed depth and the word", &Work::fragments, kComparison, 57 + 4 + 6},
      {"a mask", &Work::masks, kClaim},
      {"a claim: the positions that the fragment covers, and its slot", &Work::claims, kCount + kSlot},
      {"a state that may be met", &Work::masks_tested, kMeeting},
      {"a win in the whole pixel", &Work::wins, kWin},
      {"a state that loses positions", &Work::takes, kTake},
      {"a plane", &Work::planes, kPlane, kSetup},
      {"a contest", &Work::contests, kContest},
      {"a contest at all positions", &Work::planes_compared, kPartition, 0, kPositions},
      {"an owner's positions", &Work::listed, kCount},
      {"a word that a collection looks at, with its closed depth", &Work::words_scanned, kComparison, 4 + 6},
      {"a test against the watermark", &Work::finality_tests, kFinality},
      {"a farthest depth", &Work::farthest_found, kFarthest, 0, kPositions},
      {"a mean position", &Work::measured, kMean},
      {"a pair", &Work::pairs_compared, kPair},
      {"a tie", &Work::ties, kTie},
      {"a merge", &Work::merges, kMerge},
      {"a share", &Work::fractions, kFraction},
      {"a comparison of shares", &Work::order_tests, kComparison},
      {"the positions that are final before a retirement", &Work::retirements, kCount},
      {"an owner that becomes final", &Work::retired, kRetired},
      {"an owner's bounds", &Work::bounds_found, kBounds},
      {"the depths of its vertices", &Work::vertices_bounded, kVertices, 3 * 4},
      {"a comparison of a speck", &Work::speck_comparisons, kSpeckTest},
      {"a speck that is seen", &Work::specks_seen, kSpeckSeen},
      {"a speck that is added", &Work::specks_added, kSpeckAdded},
      {"a depth of specks", &Work::speck_depths, kComparison},
      {"a word at the end, with its closed depth", &Work::finished, kComparison, 4 + 6},
      {"a limit", &Work::limited, kLimit},
  };
  for (const Step& step : steps) {
    Work work;
    work.*step.count = 1;
    StageCounters counters;
    charge<kWords>(work, counters);
    expect_operations(counters.ops, step.ops, step.name);
    EXPECT_EQ(counters.bytes_read, step.bytes_read) << step.name;
    EXPECT_EQ(counters.bytes_written, 0u) << step.name;
    EXPECT_EQ(counters.position_tests, step.tests) << step.name;
  }
}

TEST(PooledCosts, AFootprint) { expect_operations(footprint_cost(kWords), kSides, "the sides of an area"); }

TEST(PooledCosts, StepsThatDependOnPlanesAndStates) {
  const auto charged = [](const PooledWork& work) {
    StageCounters counters;
    charge<kWords>(work, counters);
    return counters.ops;
  };
  PooledWork splits, joins, specks;
  splits.splits[1] = 1, splits.splits[3] = 2;
  expect_operations(charged(splits), split(1) + split(3) * 2, "splits");
  // Of states 0 to 4, two have bit 0, two bit 1, one bit 2.
  joins.joins[1] = 7, joins.joins[2] = 1, joins.joins[5] = 3;
  expect_operations(charged(joins), join(kTwoStates) + join(2 + 2 + 1) * 3, "joins");
  specks.specks[0] = 1, specks.specks[2] = 2;
  expect_operations(charged(specks), votes(0) + votes(2) * 2, "specks");
}

// ---- What happens to a pixel ----

// Records have a chunk of 16 bytes and a link of 2 for each half of a plane, each two surfaces, and the sums. A
// fragment comes with the closed depth and the word.
constexpr std::uint64_t kWhole = 21 + 4 + 6, kPartial = 57 + 4 + 6, kOwner = kSlotBytes + kSetup,
                        kBoundedOwner = kOwner + 3 * 4, kBitPlane = 32, kLink = 2, kWord = 6, kSums = 16;

struct Charge {
  OperationCounts ops;
  std::uint64_t read = 0, written = 0, reads_in_memory = 0, writes_in_memory = 0;
};

struct Happening {
  const char* name;
  TriangleList before;
  std::uint32_t last;  // the triangle whose fragment is charged so
  Charge charge;
};

// Composes each list with and without its last triangle. `new_tile`: makes one.
template <class NewTile>
void expect_charges(const std::vector<Happening>& happenings, NewTile&& new_tile,
                    const std::vector<float>& watermarks = {}) {
  for (const auto& [name, before, last, charge] : happenings) {
    const auto compose = [&](const TriangleList& list) {
      auto tile = new_tile();
      const std::vector<float> of_list(watermarks.begin(),
                                       watermarks.begin() + std::min(list.size(), watermarks.size()));
      tile.compose(list, watermarks.empty() ? nullptr : &of_list);
      return std::pair{tile.composing, tile.spills_of_composing};
    };
    TriangleList list = before;
    const auto [without, spills_without] = compose(list);
    list.push_back(last);
    const auto [with, spills] = compose(list);
    expect_operations(with.ops, without.ops + charge.ops, name);
    EXPECT_EQ(with.bytes_read - without.bytes_read, charge.read) << name;
    EXPECT_EQ(with.bytes_written - without.bytes_written, charge.written) << name;
    EXPECT_EQ(spills.reads - spills_without.reads, charge.reads_in_memory) << name;
    EXPECT_EQ(spills.writes - spills_without.writes, charge.writes_in_memory) << name;
  }
}

TEST(PooledCosts, SurfacesOfAPixel) {
  SetupTriangles triangles =
      triangles_of({everywhere(-0.25f),
                    left_of(128, -0.75f),
                    right_of(192, -0.8f),
                    everywhere(-0.9f),
                    {{50, 50, -0.84f}, {56, 50, -0.84f}, {50, 56, -0.84f}},  // a speck
                    right_of(128, -0.85f),
                    {{128, -20'000, -0.25f}, {10'128, 20'000, -0.15f}, {-9'872, 20'000, -0.35f}},  // slanted
                    left_of(128, -0.25f),
                    left_of(128, -0.88f)});
  const std::vector<glm::vec3> colors(9, kRed);
  const std::vector<Happening> happenings = {
      {"a surface: the word alone", {}, 0, {kComparison, kWhole, kWord}},
      {"the first fragment of an untouched pixel: what is empty and the surface take one plane and a slot, three "
       "chunks",
       {},
       1,
       {kComparison + kMeeting + kClaim + kCount + kSlot + kTake + join(kTwoStates), kPartial + 3 * kLink,
        kBitPlane + kSlotBytes + kWord}},
      {"a second owner, in front of the surface: its plane; two slots",
       {0},
       1,
       {kComparison + kPlane + kContest + kMeeting + kWin + kClaim + kCount + kSlot + kTake + join(kTwoStates),
        kPartial + kSetup + 3 * kLink, kBitPlane + 2 * kSlotBytes + kWord}},
      {"growth: a third owner meets one of two; three chunks more, linked to the others",
       {0, 1},
       2,
       {kComparison + split(1) + kMeeting * 2 + kPlane + kContest + kWin + kClaim + kCount + kSlot + kTake +
            join(kThreeStates),
        kPartial + kBitPlane + 3 * kLink + kOwner + 3 * kLink, kLink + kSlotBytes + 2 * kBitPlane + kWord}},
      {"shrinking: a fragment takes all from two of three owners, and the third slot becomes the first; the pixel may "
       "be closed nearer than before",
       {0, 1, 2},
       5,
       {kComparison + split(2) + kMeeting * 3 + kPlane * 2 + kContest * 2 + kWin * 2 + kClaim + kCount + kSlot +
            kTake * 2 + kPlane * 2 + kBounds * 2 + kVertices * 2 + join(kTwoStates),
        kPartial + 2 * kBitPlane + 6 * kLink + 2 * kOwner + kSlotBytes + 2 * kBoundedOwner,
        kSlotBytes + kLink + kBitPlane + kSlotBytes + kWord}},
      {"a surface in front of three: the record is given back",
       {0, 1, 2},
       3,
       {kComparison + split(2) + kMeeting * 3 + kPlane * 3 + kContest * 3 + kWin * 3 + kClaim + kCount + kSlot +
            kTake * 3 + kPlane + kBounds + kVertices,
        kWhole + 2 * kBitPlane + 6 * kLink + 3 * kOwner + kBoundedOwner, kLink + kWord}},
      {"a speck in front of three: six words of planes; the owners of three positions; a chunk for the sums, where "
       "nothing is final, with the nearest depth",
       {0, 1, 2},
       4,
       {kComparison + votes(2) + kPlane * 3 + kSpeckTest * 3 + kSpeckSeen + kComparison + kSpeckAdded,
        kPartial + 6 * 4 + 6 * kLink + 3 * kOwner + kLink, kLink + kSums + kWord}},
      {"a speck that is hidden when a fragment closes the pixel nearer: the sums are given back, and a slot moves",
       {0, 5, 4},
       8,
       {kComparison + split(1) + kMeeting * 2 + kPlane + kContest + kWin + kClaim + kCount + kSlot + kTake +
            kPlane * 2 + kBounds * 2 + kVertices * 2 + kComparison + join(kTwoStates),
        kPartial + kBitPlane + 4 * kLink + kOwner + kSlotBytes + 2 * kBoundedOwner + kSums,
        kSlotBytes + kLink + kBitPlane + kSlotBytes + kWord}},
      {"a partition: a slanted surface through another one",
       {0},
       6,
       {kComparison + kPlane + kContest + kMeeting + kPartition + kClaim + kCount + kSlot + kTake + join(kTwoStates),
        kWhole + kSetup + 3 * kLink, kBitPlane + 2 * kSlotBytes + kWord}},
      {"a tie: at equal depth the earlier surface keeps its positions",
       {0},
       7,
       {kComparison + kPlane + kContest + kMeeting + kPartition + kClaim, kPartial + kSetup, 0}},
  };
  expect_charges(happenings, [&] { return OpenTile<kWords>(triangles, colors); });
}

// A second surface that lies 0.002 behind the first, which is less than the change of depth within the pixel: so its
// nearest depth does not hide it, and its plane is compared with that of the first.
TEST(PooledCosts, AHiddenFragment) {
  SetupTriangles triangles;
  for (const float behind : {0.0f, 0.002f})
    add_triangle(triangles, {-9'000, -9'000, -0.9f + behind}, {9'000, -9'000, -0.1f + behind},
                 {0, 9'000, -0.5f + behind});
  const std::vector<glm::vec3> colors(2, kRed);
  expect_charges({{"hidden", {0}, 1, {kComparison + kPlane + kContest, kWhole + kSetup, 0}}},
                 [&] { return OpenTile<kWords>(triangles, colors); });
}

// Three parts of a pixel in front of nothing, with room for two. All three are listed, and their planes and means
// found; three pairs are compared; the third slot moves, and two are written. Where all lie at the same depth, each
// pair after the first one is a tie.
TEST(PooledCosts, Merges) {
  for (const std::uint64_t ties : {0, 2}) {
    SetupTriangles triangles;
    for (int i = 0; i < 3; ++i) {
      const float z = ties > 0 ? -0.5f : -0.5f + 0.1f * static_cast<float>(i * i);  // losses grow from pair to pair
      add_triangle(triangles, {32 * i, -9'000, z}, {32 * i + 32, -9'000, z}, {32 * i + 32, 9'000, z});
    }
    const std::vector<glm::vec3> colors(3, kRed);
    expect_charges({{ties > 0 ? "with ties" : "without ties",
                     {0, 1},
                     2,
                     {kComparison + split(2) + kMeeting * 3 + kClaim + kCount + kSlot + kTake + kCount * 3 +
                          kPlane * 3 + kMean * 3 + kPair * 3 + kTie * ties + kMerge + join(kThreeStates),
                      kPartial + 2 * kBitPlane + 5 * kLink + 3 * (kSlotBytes + kOwner) + kSlotBytes,
                      kSlotBytes + 2 * kBitPlane + 2 * kSlotBytes + kWord}}},
                   [&] { return OpenTile<kWords, 2>(triangles, colors); });
  }
}

// A pool without room: whatever a fragment takes, the next one collects.
TEST(PooledCosts, Collections) {
  SetupTriangles triangles =
      triangles_of({left_of(64, -0.9f), right_of(192, -0.9f), right_of(64, -0.8f), everywhere(-0.1f)});
  const std::vector<glm::vec3> colors(4, kRed);
  const std::vector<float> watermarks{-0.95f, -0.95f, -0.85f, -0.1f};
  const auto new_tile = [&] { return OpenTile<kWords>(triangles, colors, {0, 0, 1, 1}, ChunkPool(0)); };
  // What a collection reads of a pixel: the word and its closed depth, the record's links and owners. All chunks are in
  // memory.
  const std::vector<Happening> happenings = {
      {"nothing is final; another surface in front of nothing, and three chunks more",
       {0},
       1,
       {kComparison + kFinality + kPlane + kComparison + split(1) + kMeeting * 2 + kClaim + kCount + kSlot + kTake +
            join(kThreeStates),
        kWord + 4 + 3 * kLink + kOwner + kPartial + kBitPlane + 3 * kLink + 2 * kLink,
        kLink + kSlotBytes + 2 * kBitPlane + kWord, 3 + 3 + 2, 5}},
      {"two are final and have one share each; the new one takes what is left and closes the pixel",
       {0, 1},
       2,
       {kComparison + kFinality * 2 + kPlane * 2 + split(2) + kCount * 2 + kCount + kFraction * 2 + kComparison +
            kRetired * 2 + join(kTwoStates) + kComparison + split(1) + kMeeting + kClaim + kCount + kSlot + kTake +
            kPlane + kBounds + kVertices + join(kTwoStates),
        kWord + 4 + 5 * kLink + 2 * kOwner + 2 * kBitPlane + 5 * kLink + 2 * kSlotBytes + kPartial + kBitPlane +
            3 * kLink + kBoundedOwner + kLink,
        kSums + kLink + kBitPlane + kWord + kLink + kBitPlane + kSlotBytes + kWord, 5 + 5 + 3 + 1, 1 + 3 + 4}},
      {"all is final: the sums are read twice, the record is given back, and the colour written; the fragment is "
       "hidden",
       {0, 1, 2},
       3,
       {kComparison + kFinality + kPlane + split(1) + kCount + kCount + kRetired + kLimit + kComparison,
        kWord + 4 + 4 * kLink + kOwner + kBitPlane + 4 * kLink + kSlotBytes + 2 * kSums + kWhole, kSums + kLink + kWord,
        4 + 4, 1}},
  };
  expect_charges(happenings, new_tile, watermarks);
}

// A pool of three chunks: the others of a record are in memory. Once a record needs three, what was in memory moves.
TEST(PooledCosts, Spills) {
  SetupTriangles triangles =
      triangles_of({everywhere(-0.25f), left_of(128, -0.75f), right_of(192, -0.8f), right_of(128, -0.85f)});
  const std::vector<glm::vec3> colors(4, kRed);
  const std::vector<Happening> happenings = {
      {"three chunks more, in memory: their links are read, and they are written",
       {0, 1},
       2,
       {kComparison + split(1) + kMeeting * 2 + kPlane + kContest + kWin + kClaim + kCount + kSlot + kTake +
            join(kThreeStates),
        kPartial + kBitPlane + 3 * kLink + kOwner + 3 * kLink, kLink + kSlotBytes + 2 * kBitPlane + kWord, 3, 3}},
      {"three are read, moved, and given back with a link",
       {0, 1, 2},
       3,
       {kComparison + split(2) + kMeeting * 3 + kPlane * 2 + kContest * 2 + kWin * 2 + kClaim + kCount + kSlot +
            kTake * 2 + kPlane * 2 + kBounds * 2 + kVertices * 2 + join(kTwoStates),
        kPartial + 2 * kBitPlane + 6 * kLink + 2 * kOwner + kSlotBytes + 2 * kBoundedOwner + 3 * kChunkBytes,
        kSlotBytes + kLink + kBitPlane + kSlotBytes + kWord + 3 * kChunkBytes, 3 + 3, 1}},
  };
  expect_charges(happenings, [&] {
    return OpenTile<kWords>(triangles, colors, {0, 0, 1, 1}, ChunkPool(3 * (16 + 2)));
  });
}

// At the end all that is left is final: a word, a record, two owners whose shares are compared, and the limit.
TEST(PooledCosts, TheEndOfAPixel) {
  SetupTriangles triangles = triangles_of({everywhere(-0.25f), left_of(128, -0.75f)});
  const std::vector<glm::vec3> colors(2, kRed);
  OpenTile<kWords> covered(triangles, colors), shared(triangles, colors);
  covered.compose({0});
  expect_operations(covered.finishing.ops, kComparison, "covered");
  EXPECT_EQ(covered.finishing.bytes_read, kWord + 4);
  shared.compose({0, 1});
  expect_operations(shared.finishing.ops,
                    kComparison + split(1) + kCount * 2 + kCount + kFraction * 2 + kComparison + kRetired * 2 + kLimit,
                    "shared");
  EXPECT_EQ(shared.finishing.bytes_read, kWord + 4 + kBitPlane + 3 * kLink + 2 * kSlotBytes + kSums);
  EXPECT_EQ(shared.finishing.bytes_written, kSums);
}

}  // namespace beampipe::compose_pooled_costs_test
