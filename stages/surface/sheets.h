// Which triangles form one sheet: a connected piece of a surface that lets light through. The triangles of a sheet
// share what they take of a pixel (stages/surface/opacity.h); those of different sheets are independent of each other.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/data/setup_triangle.h"

namespace beampipe {

// The number of each triangle's sheet, from 0 without gaps, in primitive order; opaque triangles have any number. Empty
// if all triangles are flat.
//
// Two triangles of a mesh belong to one sheet if they have an edge in common and lie on opposite sides of it on the
// screen. They then do not overlap, and in the pixels of their edge they take the positions that one triangle would
// have taken. Where a surface folds over, one side of the edge faces the viewer and the other does not: a new sheet
// begins. So a closed surface has one sheet in front and one at the back. Edges at which more than two triangles meet
// connect nothing, because some of the triangles overlap.
std::vector<std::uint32_t> number_sheets(const SetupTriangles& triangles);

}  // namespace beampipe
