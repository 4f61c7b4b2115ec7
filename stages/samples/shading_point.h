// Where a fragment is shaded: at its cell's centre or, where its triangle does not cover that, at the centroid of the
// samples that it covers (D3D's and Vulkan's centroid interpolation).
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/raster/sample_raster.h"

namespace beampipe {

enum class ShadeAt {
  centre,    // always: outside the triangle, what varies across it is extrapolated
  centroid,  // where the triangle does not cover the centre; it lies inside the triangle
};

struct ShadingPoint {
  glm::dvec2 position;  // pixels, frame coordinates
  bool is_centre;
};
ShadingPoint shading_point(const SetupTriangle& triangle, const SampleFragment& fragment, const Sampling& sampling,
                           ShadeAt at);

// What ShadeAt::centroid costs: charges finding each fragment's point, and adds to `centroids`, one per pixel of the
// tile, its fragments that are not shaded at the centre.
void count_centroids(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments, const Tile& tile,
                     const Sampling& sampling, StageCounters& counters, std::vector<float>& centroids);

}  // namespace beampipe
