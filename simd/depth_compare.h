// The depth test per sample of a multisampled surface, for one triangle in one cell at a time. The comparison is LESS.
// The surface keeps the nearest depth of every sample and the triangle that it belongs to.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/depth_plane.h"
#include "simd/sample_pattern.h"

namespace beampipe {

// What a triangle does to the samples of a cell. Bit s of a mask is sample s.
struct SampleAccess {
  std::uint32_t cell;      // its samples start at cell * pattern.count
  std::uint32_t triangle;  // what is stored where the test passes
  std::uint32_t tested;    // samples whose depth is read
  std::uint32_t passed;    // of them, those that pass
};

// Arrays of cells * pattern.count samples. Another kSampleSlack samples after them must be readable and writable.
inline constexpr std::size_t kSampleSlack = 64;
struct SampleSurface {
  float* depth;
  std::uint32_t* triangle;
};

struct SampleCounts {
  std::uint64_t tested, passed;
};

// Sets what has passed. planes[i]: of items[i]. Works in order: an item sees what earlier items stored. Lanes are
// across samples.
SampleCounts depth_test(SampleAccess* items, const CellPlane<float>* planes, std::size_t count,
                        const SamplePattern& pattern, const SampleSurface& surface);

// For the pass that follows a depth-only pass: what passes are the samples whose depth equals the stored one, to the
// last bit. Reads as far past the end of `depth` as depth_test does. Lanes are across samples.
SampleCounts depth_equal(SampleAccess* items, const CellPlane<float>* planes, std::size_t count,
                         const SamplePattern& pattern, const float* depth);

// The scalar twins for one sample or position: does it pass?
template <class Float>
bool depth_test_scalar(const CellPlane<Float>& plane, Float x, Float y, Float stored, Float& depth) {
  depth = plane.z + plane.dzdx * x + plane.dzdy * y;
  return depth < stored;
}
template <class Float>
bool depth_equal_scalar(const CellPlane<Float>& plane, Float x, Float y, Float stored) {
  return plane.z + plane.dzdx * x + plane.dzdy * y == stored;
}

}  // namespace beampipe
