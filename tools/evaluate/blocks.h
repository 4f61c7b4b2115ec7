// How far the choice of pixels leaves an equivalent rate open: a bootstrap over blocks of the picture. Errors of
// neighbouring pixels depend on each other, so that blocks are drawn and not pixels, as in H. R. Künsch: The Jackknife
// and the Bootstrap for General Stationary Observations. The Annals of Statistics 17 (3), 1989.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/evaluate/metrics.h"

namespace beampipe {

// Every picture has as many blocks, so that frames of any size add up.
inline constexpr std::uint32_t kBlocksAcross = 16;  // in x, and in y
inline constexpr std::size_t kBlocks = std::size_t{kBlocksAcross} * kBlocksAcross;

// The squared errors of R, G and B, summed over the pixels of each block, row by row.
using BlockSquares = std::array<double, kBlocks>;

// Adds those of a picture. Throws std::invalid_argument if the sizes differ.
void add_block_squares(const Image& image, const Image& reference, BlockSquares& sums);

// The range of equivalent rates by RMSE if 256 blocks are drawn with replacement, 200 times from a fixed seed, for the
// technique and the ladder together. It contains 68 % of these rates, as a standard deviation in both directions does.
// `ladder`: of each rung in `samples`, which rise.
EmrRange resampled_range(const BlockSquares& technique, const std::vector<std::uint32_t>& samples,
                         const std::vector<BlockSquares>& ladder);

}  // namespace beampipe
