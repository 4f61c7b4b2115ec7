#include "tools/evaluate/blocks.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace beampipe {
namespace {

constexpr std::size_t kDraws = 200, kBelow = 32, kAbove = 167;  // ranks, from 0, of the ends of 68 %

using Times = std::array<double, kBlocks>;  // how often each block is drawn

// Distributions of the standard library differ between machines, the generator does not.
Times draw(std::mt19937_64& random) {
  static_assert(kBlocks == 256);
  Times times{};
  for (std::size_t i = 0; i < kBlocks; ++i) ++times[random() >> 56];
  return times;
}

// Up to the number of values, which rates do not depend on.
double drawn_rmse(const BlockSquares& squares, const Times& times) {
  double sum = 0;
  for (std::size_t i = 0; i < kBlocks; ++i) sum += times[i] * squares[i];
  return std::sqrt(sum);
}

}  // namespace

void add_block_squares(const Image& image, const Image& reference, BlockSquares& sums) {
  require_same_size(image, reference);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const std::size_t row = std::size_t{y} * kBlocksAcross / image.height;
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t column = std::size_t{x} * kBlocksAcross / image.width;
      const std::size_t first = 4 * (std::size_t{y} * image.width + x);
      for (std::size_t value = first; value < first + 3; ++value) {
        const double error = static_cast<double>(image.rgba[value]) - static_cast<double>(reference.rgba[value]);
        sums[row * kBlocksAcross + column] += error * error;
      }
    }
  }
}

EmrRange resampled_range(const BlockSquares& technique, const std::vector<std::uint32_t>& samples,
                         const std::vector<BlockSquares>& ladder) {
  std::mt19937_64 random;
  std::vector<EquivalentMsaa> rates;
  for (std::size_t i = 0; i < kDraws; ++i) {
    const Times times = draw(random);
    std::vector<LadderRung> rungs;
    for (std::size_t k = 0; k < ladder.size(); ++k) rungs.push_back({samples[k], drawn_rmse(ladder[k], times)});
    rates.push_back(equivalent_msaa(drawn_rmse(technique, times), rungs));
  }
  std::ranges::sort(rates, {}, [](const EquivalentMsaa& rate) {
    return std::pair(rate.samples, rate.is_lower_bound - rate.is_upper_bound);
  });
  return range_of(rates[kBelow], rates[kAbove]);
}

}  // namespace beampipe
