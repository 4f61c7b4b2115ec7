// Which triangles form one sheet: a connected piece of a surface that lets light through and does not lie in front of
// itself. The triangles of a sheet share what they take of a pixel (stages/surface/opacity.h); sheets that overlap on
// the screen are independent of each other.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "traces/trace.h"

namespace beampipe {

// The number of each triangle's sheet; opaque triangles have any number. Empty if all triangles are flat.
//
// Sheets grow across edges, from the triangle that comes first. An edge connects two triangles of a mesh if it belongs
// to no other and if they lie on opposite sides of it on the screen: in the pixels of the edge they then take the
// positions that one triangle would have taken. A triangle that overlaps one of the sheet is left out, and begins
// another sheet later.
//
// Sheets that come near each other on the screen have different numbers, as small as possible; others may have the same
// one. "Near" means a common cell of a grid, whose cells are about as large as the triangles.
//
// Time and memory grow with the number of triangles. So a sheet has at most 64 triangles in a cell.
std::vector<std::uint32_t> number_sheets(const SetupTriangles& triangles, const Frame& frame, StageCounters& counters);

}  // namespace beampipe
