// blend: translucent sample fragments -> the colours of samples, in the order of the draws.
//
// Translucent fragments are tested against depth but do not write it.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/sample_tile.h"
#include "stages/data/setup_triangle.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

// `places`: where each fragment is shaded, in its pixel. `width`: of a cell, in pixels. surface.over must have a value
// for each sample. Replaces `accesses` by one access per fragment.
void blend(const SetupTriangles& triangles, const TileShader& shader, const std::vector<SampleFragment>& fragments,
           const std::vector<glm::vec2>& places, float width, const Tile& tile, const Sampling& sampling,
           StageCounters& counters, SampleTile& surface, std::vector<SampleAccess>& accesses);

}  // namespace beampipe
