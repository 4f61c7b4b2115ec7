// A fragment: a pair with coverage, mask, depth and, once it is shaded, a colour. Fragments go from beam_fragment to
// composition.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "simd/merge.h"
#include "simd/wide_mask.h"

namespace beampipe {

struct Fragment {
  std::uint32_t triangle;        // index into SetupTriangles
  std::uint32_t quad;            // as in Pair
  std::uint32_t pixel;           // index within the tile, row by row
  bool front;                    // as in SetupTriangle
  bool tiny;                     // a speck: it covers no mask position
  bool whole;                    // it covers every mask position, and its area is 1
  bool is_discarded;             // after it was tested: it has no colour
  float centroid_u, centroid_v;  // of the clipped triangle: pixels from the pixel's upper left corner
  float centroid_z;              // depth at the centroid; only set with clipped_depth and for specks, else 0
  float alpha;                   // area of the clipped triangle, 0..1
  WideMask mask;
  DepthPlane<float> plane;
  float z_min, z_max;  // bounds of its depth in the pixel
  glm::vec3 color;     // linear RGB times alpha; 0 until it is shaded
};

}  // namespace beampipe
