#include "tools/evaluate/blocks.h"

#include "tests/tools/fixtures.h"

namespace beampipe::blocks_test {

// Errors 0.4 / N, which lie on a line, in every block alike.
const std::vector<std::uint32_t> kSamples = {1, 2, 4, 8, 16};

std::vector<BlockSquares> even_ladder() {
  std::vector<BlockSquares> ladder(kSamples.size());
  for (std::size_t i = 0; i < ladder.size(); ++i) ladder[i].fill(0.16 / (kSamples[i] * kSamples[i]));
  return ladder;
}

TEST(Blocks, HaveTheSquaresOfTheirPixels) {
  Image image = flat_image(32, 48, 0.5f);  // blocks of 2 x 3 pixels
  image.rgba[4 * (32 * 4 + 3)] = 0.25f;    // red at (3, 4): block 1 in block row 1
  image.rgba[4 * (32 * 47 + 31) + 2] = 1;  // blue in the last pixel
  image.rgba[3] = 0;                       // alpha does not count
  BlockSquares sums{};
  sums[17] = 1;
  add_block_squares(image, flat_image(32, 48, 0.5f), sums);
  BlockSquares expected{};
  expected[17] = 1 + 0.0625;
  expected[255] = 0.25;
  EXPECT_EQ(sums, expected);
  EXPECT_THROW(add_block_squares(image, flat_image(32, 47, 0.5f), sums), std::invalid_argument);
}

TEST(Blocks, EqualErrorsInAllBlocksLeaveNothingOpen) {
  BlockSquares technique;
  technique.fill(0.16 / 9);  // that of msaa:3
  const EmrRange range = resampled_range(technique, kSamples, even_ladder());
  EXPECT_NEAR(range.low.value(), 3, 1e-9);
  EXPECT_NEAR(range.high.value(), 3, 1e-9);
}

TEST(Blocks, AnErrorInOneBlockLeavesTheRateOpen) {
  BlockSquares technique{};
  technique[77] = 256 * 0.16 / 9;  // the same in the whole picture
  // The block is drawn k times, by a binomial distribution close to Poisson's: never in 37 % of the draws. Then the
  // error is 0. In 26 % of them it comes at least twice, and in 8 % at least three times: so the lower end has k = 2,
  // where the error is larger by sqrt(2).
  const EmrRange range = resampled_range(technique, kSamples, even_ladder());
  EXPECT_NEAR(range.low.value(), 3 / std::sqrt(2.0), 1e-9);
  EXPECT_FALSE(range.high);
}

TEST(Blocks, OfTheTechniqueAndTheLadderAreDrawnTogether) {
  // All errors are in one half of the blocks: how many of these are drawn changes both alike.
  BlockSquares technique{};
  std::vector<BlockSquares> ladder(kSamples.size());
  for (std::size_t i = 0; i < kBlocks; i += 2) {
    technique[i] = 0.16 / 9;
    for (std::size_t k = 0; k < ladder.size(); ++k) ladder[k][i] = 0.16 / (kSamples[k] * kSamples[k]);
  }
  const EmrRange range = resampled_range(technique, kSamples, ladder);
  EXPECT_NEAR(range.low.value(), 3, 1e-9);
  EXPECT_NEAR(range.high.value(), 3, 1e-9);
}

TEST(Blocks, RangesBesideTheLadderAreOpen) {
  BlockSquares worse, better;
  worse.fill(0.25);
  better.fill(1e-6);
  EXPECT_FALSE(resampled_range(worse, kSamples, even_ladder()).low);
  EXPECT_EQ(resampled_range(worse, kSamples, even_ladder()).high, 1);
  EXPECT_EQ(resampled_range(better, kSamples, even_ladder()).low, 16);
  EXPECT_FALSE(resampled_range(better, kSamples, even_ladder()).high);
}

}  // namespace beampipe::blocks_test
