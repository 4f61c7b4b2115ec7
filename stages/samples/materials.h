// What makes two triangles of the same material: a shading sample of one may stand for the other.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/data/setup_triangle.h"

namespace beampipe {

enum class MaterialBy {
  color,  // the draw and the Kd: an OBJ's material groups, which a renderer would draw one by one
  draw,   // the draw alone, as if a texture made its colours
};

// A number for each triangle's material.
std::vector<std::uint32_t> material_ids(const SetupTriangles& triangles, MaterialBy by);

}  // namespace beampipe
