// ordered_reference: setup triangles -> the reference's samples, whose depths, stencil values and colours draws change
// in the API's order.
//
// What shaders say of depth and coverage (FragmentVerdict) holds for a cell: all of its samples, or none.
//
// Blending takes place at every sample, with colours of its cell: a triangle is shaded at the cell's centre. What hides
// other colours is shaded when somebody reads it, or at the end (resolve in stages/raster/reference_raster.h).
#pragma once

#include "stages/cost/counters.h"
#include "stages/raster/reference_raster.h"
#include "stages/rop/rop_rules.h"

namespace beampipe {

void ordered_reference(const ListedTriangles& drawn, const RopRules& rules, const TileShader& shader,
                       StageCounters& counters, ReferenceTile& surface);

}  // namespace beampipe
