// The colours of points that have the same material, and how far they vary around them, with a point in each lane.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include "stages/surface/surface_points.h"

namespace beampipe {

// Sets colors[i] to the light, linear RGB, that point i reflects and emits towards the eye, and the material's alpha:
// lit_color of material_of, to the last bit.
void lit_colors(const ShaderInputs& shader, const Lighting& lighting, const PointInputs<PointColumn>& points,
                std::size_t count, glm::vec4* colors);

// Sets ranges[i] to light_range of area i, to the last bit.
void light_ranges(const ShaderInputs& shader, const Lighting& lighting, const AreaInputs<PointColumn>& areas,
                  std::size_t count, float* ranges);

}  // namespace beampipe
