// The colours of points that have the same material, with a point in each lane.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include "stages/surface/surface_formulas.h"

namespace beampipe {

// Sets colors[i] to the light, linear RGB, that points[i] reflects and emits towards the eye: lit_color of material_of,
// to the last bit.
void lit_colors(const ShaderInputs& shader, const Lighting& lighting, const PointInputs<float>* points,
                std::size_t count, glm::vec3* colors);

}  // namespace beampipe
