// alpha_mask: fragments -> fragments without what alpha leaves out of them.
//
// Of a cutout, a mask position belongs to the surface if alpha there is at least the cutoff. Where texels are smaller
// than the distance of positions, a position is covered in part: by as much of it as passes the test
// (stages/surface/tested_alpha.h), and as many positions are taken as fit. With fewer places than positions, alpha
// between the four texels at a place tells of all positions around it. Where tested alpha says of the whole pixel that
// it is covered or empty, nothing else is looked up. The fragment's area shrinks by the same
// share. A speck, which has no positions, is tested or shrinks as a whole. A translucent surface takes the part of its
// positions and of its area that is its opacity (stages/surface/opacity.h).
//
// In the API's order, shaders say more (FragmentVerdict): which positions are left, which part of them and of the area,
// and the depth of the whole fragment. If a shader asks for early tests, the positions that it takes away become a
// fragment of its own, which is tested and has no colour.
#pragma once

#include <vector>

#include "simd/sample_pattern.h"
#include "stages/cost/counters.h"
#include "stages/data/alpha_places.h"
#include "stages/data/fragment.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

// Drops fragments of which nothing is left, and adds those that are discarded after their tests, each right after what
// is left of it. `patterns`: the mask positions. Adds the texels that are read to `texels`, unless it is null: a request
// for each word of a mask, whose positions are tested at once, or for all parts of a pixel.
void alpha_mask(const TileShader& shader, const std::vector<SamplePattern>& patterns, AlphaPlaces places,
                StageCounters& counters, std::vector<Fragment>& fragments, TexelRequests* texels = nullptr);

}  // namespace beampipe
