// The point where a fragment is shaded: the centre of its cell or, if its triangle does not cover that, the centroid of
// the samples that it covers (centroid interpolation in D3D and Vulkan).
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/sample_fragment.h"
#include "stages/data/setup_triangle.h"

namespace beampipe {

enum class ShadeAt {
  centre,    // always at the centre; if that is outside the triangle, varying attributes are extrapolated
  centroid,  // at the centroid if the triangle does not cover the centre; the centroid lies inside the triangle
  sample,    // at the pattern's first sample, as if the pixel's centre had been moved there
};

// The samples of the fragment's cell that the triangle covers, whatever the fragment's mask says.
std::uint32_t covered_samples(const SetupTriangle& triangle, const SampleFragment& fragment, const Sampling& sampling);

// Of a cell, in its pixel: 0..1.
inline glm::vec2 middle_in_pixel(const CellGrid& grid, std::int32_t x, std::int32_t y) {
  return {(static_cast<float>(x & (grid.columns - 1)) + 0.5f) / static_cast<float>(grid.columns),
          (static_cast<float>(y & (grid.rows - 1)) + 0.5f) / static_cast<float>(grid.rows)};
}

struct ShadingPoint {
  glm::dvec2 position;  // pixels, frame coordinates
  bool is_centre;
};
ShadingPoint shading_point(const SetupTriangle& triangle, const SampleFragment& fragment, const Sampling& sampling,
                           ShadeAt at);

// Charges what it costs to find each fragment's shading point with ShadeAt::centroid. Adds to `centroids`, one per
// pixel of the tile, the number of fragments that are not shaded at the centre.
void count_centroids(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments, const Tile& tile,
                     const Sampling& sampling, StageCounters& counters, std::vector<float>& centroids);

}  // namespace beampipe
