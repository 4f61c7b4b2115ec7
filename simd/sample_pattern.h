// Sample positions within a pixel, or within a cell of a pixel, in 1/256 px from its upper left corner.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace beampipe {

inline constexpr int kSubpixelUnits = 256;  // 8 sub-pixel bits, as D3D and Vulkan require
inline constexpr int kMaxMaskSamples = 32;  // bits of one mask word

struct SamplePattern {
  int count = 0;  // 1..32
  // Zeros after the first `count` entries, so that kernels can read whole vectors.
  alignas(64) std::array<std::int32_t, kMaxMaskSamples> x{};
  alignas(64) std::array<std::int32_t, kMaxMaskSamples> y{};
};

// The standard positions for 1, 2, 4, 8 and 16 samples (D3D11 "standard multisample patterns", Vulkan
// standardSampleLocations), scaled to a cell of `cell_width` x `cell_height` in 1/256 px; a whole pixel is 256 x 256.
// Throws std::invalid_argument for any other count.
SamplePattern standard_pattern(int count, int cell_width = kSubpixelUnits, int cell_height = kSubpixelUnits);

// Of a sample of a pattern for a whole pixel, in units of (1/256 px)^2.
int squared_distance_to_centre(const SamplePattern& pattern, std::size_t sample);

// The sample of which this is the least; of several, the first.
std::size_t nearest_to_centre(const SamplePattern& pattern);

// The pattern with this sample alone.
SamplePattern only(const SamplePattern& pattern, std::size_t sample);

// Splits a pixel into a grid of cells. `cells` is a power of two; there are as many columns as rows, or twice as many.
struct CellCounts {
  int columns = 1, rows = 1;
};
CellCounts split_into_cells(int cells);

// 32, 64, 128 or 256 positions, 32 per pattern: the standard 8 in each cell of a grid, row by row. msaa:count samples
// at the same positions. Throws std::invalid_argument for any other count.
std::vector<SamplePattern> cell_patterns(int count);

// 32 jittered positions: the Hammersley set (i / 32 + 1 / 64, bit-reversed i / 32 + 1 / 64). All of them are multiples
// of 1/256 px. Source: slide 7 of the talk on Crassin et al. 2018.
SamplePattern hammersley_pattern();

}  // namespace beampipe
