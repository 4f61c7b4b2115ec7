// Per-sample depth test of one triangle in the cells of a multisampled surface. LESS; the surface keeps, per sample,
// the nearest depth and whose it is.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/sample_pattern.h"

namespace beampipe {

// Depth at sample (x, y) of the cell, in 1/256 px: z + dzdx x + dzdy y.
struct CellDepth {
  std::uint32_t cell;      // which cell: its samples start at cell * pattern.count
  std::uint32_t mask;      // samples to test
  std::uint32_t triangle;  // what to store where the test passes
  float z, dzdx, dzdy;
};

// Arrays of cells * pattern.count samples, readable and writable up to kSampleSlack further.
inline constexpr std::size_t kSampleSlack = 64;
struct SampleSurface {
  float* depth;
  std::uint32_t* triangle;
};

struct SampleCounts {
  std::uint64_t tested, passed;
};

// In order: a later item sees what an earlier one stored. `passed`, if not null, gets the samples that passed: a mask
// per item. Lanes are across samples.
SampleCounts depth_test(const CellDepth* items, std::size_t count, const SamplePattern& pattern,
                        const SampleSurface& surface, std::uint32_t* passed = nullptr);

// Behind a depth-only pass: masks[i] keeps those samples of items[i].mask that have the stored depth, to the last bit.
// Reads `depth` as far as depth_test does. Lanes are across samples.
SampleCounts depth_equal(const CellDepth* items, std::size_t count, const SamplePattern& pattern, const float* depth,
                         std::uint32_t* masks);

// Scalar twins of one sample: does it pass?
template <class Float>
bool depth_test_scalar(Float z, Float dzdx, Float dzdy, Float x, Float y, Float stored, Float& depth) {
  depth = z + dzdx * x + dzdy * y;
  return depth < stored;
}
template <class Float>
bool depth_equal_scalar(Float z, Float dzdx, Float dzdy, Float x, Float y, Float stored) {
  return z + dzdx * x + dzdy * y == stored;
}

}  // namespace beampipe
