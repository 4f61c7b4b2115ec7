// Sample positions within a pixel (or a cell of a super-resolved pixel), in 1/256 px from its upper left corner.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace beampipe {

inline constexpr int kSubpixelUnits = 256;  // 8 sub-pixel bits, as D3D and Vulkan require
inline constexpr int kMaxMaskSamples = 32;  // bits of one mask word

struct SamplePattern {
  int count = 0;  // 1..32
  // Padded with zeros to a multiple of every vector length.
  alignas(64) std::array<std::int32_t, kMaxMaskSamples> x{};
  alignas(64) std::array<std::int32_t, kMaxMaskSamples> y{};
};

// The standard positions for 1, 2, 4, 8 and 16 samples (D3D11 "standard multisample patterns", Vulkan
// standardSampleLocations), for a cell of `cell_width` x `cell_height` units: 256 x 256 for a whole pixel.
// Throws std::invalid_argument for any other count.
SamplePattern standard_pattern(int count, int cell_width = kSubpixelUnits, int cell_height = kSubpixelUnits);

// A pixel as a grid of cells (super-resolution): `cells` is a power of two; columns = rows, or twice as many.
struct CellCounts {
  int columns = 1, rows = 1;
};
CellCounts split_into_cells(int cells);

// `count` positions (32, 64, 128 or 256), 32 to a pattern: the standard 8 in each cell of a grid, row by row. They are
// the positions of msaa:count. Throws std::invalid_argument for any other count.
std::vector<SamplePattern> cell_patterns(int count);

// 32 jittered positions: the Hammersley set (i / 32 + 1 / 64, bit-reversed i / 32 + 1 / 64), which fall on 1/256 px
// exactly (slide 7 of the paper's talk).
SamplePattern hammersley_pattern();

}  // namespace beampipe
