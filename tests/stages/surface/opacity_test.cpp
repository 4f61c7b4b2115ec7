// Ranks of positions: how many a surface takes, and how many two surfaces share.
#include "stages/surface/opacity.h"

#include "tests/simd/random.h"

namespace beampipe::opacity_test {

constexpr std::uint32_t kPositions = 256;

TEST(Opacity, RanksAreDifferentAndInRange) {
  for (std::uint32_t positions = 1; positions <= kPositions; positions *= 2)
    for (std::uint32_t sheet = 0; sheet < 600; ++sheet) {
      const OpacityRanks ranks(sheet, 3, 5, positions);
      std::set<float> found;
      for (std::uint32_t p = 0; p < positions; ++p) {
        ASSERT_TRUE(ranks.rank(p) >= 0 && ranks.rank(p) < 256);
        found.insert(ranks.rank(p));
      }
      ASSERT_EQ(found.size(), positions) << "sheet " << sheet;
    }
}

TEST(Opacity, OpaqueTakesAllAndClearNone) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const OpacityRanks ranks(random.word(), random.int32(0, 16383), random.int32(0, 16383), kPositions);
    for (std::uint32_t p = 0; p < kPositions; ++p) {
      EXPECT_TRUE(ranks.takes(p, 1));
      EXPECT_FALSE(ranks.takes(p, 0));
    }
  }
}

std::uint32_t taken(const OpacityRanks& ranks, float opacity, std::uint32_t positions = kPositions) {
  std::uint32_t count = 0;
  for (std::uint32_t p = 0; p < positions; ++p) count += ranks.takes(p, opacity);
  return count;
}

TEST(Opacity, TakesItsPartOfThePositions) {
  Random random(2);
  for (int i = 0; i < 2'000; ++i)
    for (const std::uint32_t positions : {1u, 2u, 4u, 8u, 16u, 32u, 64u, 128u, 256u}) {
      const OpacityRanks ranks(random.word(), random.int32(0, 16383), random.int32(0, 16383), positions);
      const float opacity = random.real32(0, 1);
      ASSERT_LE(std::abs(double{opacity} * positions - taken(ranks, opacity, positions)), 1.0);
    }
}

// Every position is as likely as any other, so that the mean over pixels is the opacity, also in a part of the pixel.
TEST(Opacity, OverPixelsEachPositionIsTakenAsOftenAsOpacitySays) {
  constexpr int kPixels = 4096;
  for (std::uint32_t sheet : {0u, 1u, 7u, 15u, 16u, 1000u})
    for (const float opacity : {0.1f, 0.5f, 0.875f}) {
      std::vector<int> times(kPositions);
      for (int i = 0; i < kPixels; ++i) {
        const OpacityRanks ranks(sheet, i % 64, i / 64, kPositions);
        for (std::uint32_t p = 0; p < kPositions; ++p) times[p] += ranks.takes(p, opacity);
      }
      // 256 positions, each a sum of independent trials: five standard deviations.
      const double deviation = std::sqrt(kPixels * opacity * (1 - opacity));
      for (const int t : times) EXPECT_NEAR(t, kPixels * opacity, 5 * deviation) << sheet;
    }
}

// Not all of a cell's positions or none: each sheet of opacity 1/2 takes half of the 8 positions of every cell.
TEST(Opacity, HalfOfASheetIsHalfOfEachCell) {
  for (const std::uint32_t positions : {32u, 64u, 128u, 256u})
    for (std::uint32_t sheet = 0; sheet < 300; ++sheet) {
      const OpacityRanks ranks(sheet, 7, 9, positions);
      for (std::uint32_t cell = 0; cell < positions; cell += 8) {
        int found = 0;
        for (std::uint32_t p = cell; p < cell + 8; ++p) found += ranks.takes(p, 0.5f);
        ASSERT_EQ(found, 4) << sheet << ", " << positions;
      }
    }
}

// How many positions have ranks in the i-th part of one sheet's ranks and the j-th of the other's.
std::vector<int> in_both(std::uint32_t a, std::uint32_t b, int parts) {
  const OpacityRanks first(a, 2, 3, kPositions), second(b, 2, 3, kPositions);
  std::vector<int> both(static_cast<std::size_t>(parts * parts));
  for (std::uint32_t p = 0; p < kPositions; ++p) {
    const int i = static_cast<int>(first.rank(p)) * parts / 256, j = static_cast<int>(second.rank(p)) * parts / 256;
    ++both[static_cast<std::size_t>(i * parts + j)];
  }
  return both;
}

// Two sheets: of what the first leaves, the second takes its part. If their numbers differ by at most 12, that is exact
// for opacities in sixteenths.
TEST(Opacity, SheetsAreIndependentOfEachOther) {
  for (std::uint32_t a = 0; a < opacity::kOrders[8].count; ++a)
    for (std::uint32_t b = a - std::min(a, 12u); b < a; ++b)
      for (const int both : in_both(a, b, 16)) ASSERT_EQ(both, 1) << a << ", " << b;
}

// Leading bits are independent for all orders. Two leading bits depend on each other if the orders differ by a factor
// in GF(4), as each does from two others of 255.
TEST(Opacity, AllOrdersHalveEachOther) {
  const std::uint32_t orders = opacity::kOrders[8].count;
  EXPECT_EQ(orders, 224u);  // of 255, 31 have a leading bit that is the same in each cell
  std::size_t related = 0;
  for (std::uint32_t a = 0; a < orders; ++a)
    for (std::uint32_t b = 0; b < a; ++b) {
      for (const int both : in_both(a, b, 2)) ASSERT_EQ(both, 64) << a << ", " << b;
      const std::vector<int> quarters = in_both(a, b, 4);
      related += std::ranges::any_of(quarters, [](int both) { return both != 16; });
    }
  EXPECT_EQ(related, 196u);  // of 24976 pairs
}

// n sheets of the same opacity a leave the part (1 - a)^n.
double error_of_stack(std::uint32_t first, std::uint32_t sheets, float opacity, std::uint32_t positions) {
  double squares = 0;
  constexpr int kPixels = 256;
  for (int pixel = 0; pixel < kPixels; ++pixel) {
    std::vector<bool> is_left(positions, true);
    for (std::uint32_t sheet = first; sheet < first + sheets; ++sheet) {
      const OpacityRanks ranks(sheet, pixel % 16, pixel / 16, positions);
      for (std::uint32_t p = 0; p < positions; ++p) is_left[p] = is_left[p] && !ranks.takes(p, opacity);
    }
    const auto left = static_cast<double>(std::count(is_left.begin(), is_left.end(), true)) / positions;
    const double error = left - std::pow(1.0 - double{opacity}, sheets);
    squares += error * error;
  }
  return std::sqrt(squares / kPixels);
}

// Four sheets in a row have independent leading bits with any positions, six of them with 256.
TEST(Opacity, HalvesOfHalvesAreExact) {
  for (const std::uint32_t positions : {32u, 64u, 128u, 256u})
    for (std::uint32_t sheets = 1; sheets <= (positions == 256 ? 6u : 4u); ++sheets)
      for (std::uint32_t first = 0; first + sheets <= 28; ++first)
        ASSERT_EQ(error_of_stack(first, sheets, 0.5f, positions), 0) << sheets << " from " << first;
}

// The RMS error over many places in the row of orders, in thousandths of the light. Independent random choices would
// have 17.2, 17.5 and 17.9 with 256 positions and 50, 51 and 51 with 32.
TEST(Opacity, StacksTransmitTheirProduct) {
  struct Case {
    std::uint32_t positions;
    double most[3];  // of 3, 4 and 8 sheets
  };
  for (const Case& expected : {Case{256, {5.7, 2.2, 12.2}}, Case{128, {11, 8.3, 21}}, Case{64, {25.2, 13.8, 30.6}},
                               Case{32, {38, 36.5, 49.7}}}) {
    int i = 0;
    for (const auto& [sheets, opacity] : {std::pair{3u, 0.3f}, {4u, 0.25f}, {8u, 0.2f}}) {
      double squares = 0;
      constexpr std::uint32_t kStacks = 64;
      for (std::uint32_t k = 0; k < kStacks; ++k) {
        const double error = 1000 * error_of_stack(5 * k, sheets, opacity, expected.positions);
        squares += error * error;
      }
      EXPECT_LT(std::sqrt(squares / kStacks), expected.most[i++])
          << sheets << " sheets of " << opacity << ", " << expected.positions << " positions";
    }
  }
}

}  // namespace beampipe::opacity_test
