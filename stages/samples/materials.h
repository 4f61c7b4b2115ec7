// Materials for decoupled shading: a shading sample of a triangle may stand for any triangle of the same material.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/data/setup_triangle.h"

namespace beampipe {

// What two triangles of the same material have in common.
enum class MaterialBy {
  color,  // the draw and the Kd, like the material groups of an OBJ file, which a renderer would draw one by one
  draw,   // the draw alone, as if the colours came from a texture
};

// Returns the number of each triangle's material.
std::vector<std::uint32_t> material_ids(const SetupTriangles& triangles, MaterialBy by);

// A frame's materials, to sort samples by.
struct Materials {
  std::vector<std::uint32_t> ids;  // of each triangle
  int digits = 1;                  // of 8 bits, that the largest number has; at least 1

  explicit Materials(std::vector<std::uint32_t> numbers);
};

}  // namespace beampipe
