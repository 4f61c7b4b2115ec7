// compose_z3: fragments in primitive order -> a few layers per pixel, in one pass (Z3, Jouppi and Chang 1999).
//
// A fragment takes the positions where it is nearer than their owners; at equal depth the earlier fragment keeps them.
// If a pixel gets one layer too many, the two layers whose depths at the pixel's centre are closest are merged. A
// layer's weight is its share of the positions. Specks are lost.
#pragma once

#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/fragment.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/position_set.h"
#include "stages/data/z3_pixel.h"

namespace beampipe {

// `pixels`: one per pixel of the tile, kept from batch to batch; zero at first. Adds to `merges`, one per pixel of the
// tile as well, the number of times that two layers were merged. Counts as items out the fragments that take a
// position.
template <std::size_t Words>
void compose_z3(const std::vector<Fragment>& fragments, const PositionSet& positions, StageCounters& counters,
                std::vector<Z3Pixel<Words>>& pixels, std::vector<float>& merges,
                const PixelObservers* observers = nullptr);

template <std::size_t Words>
std::vector<PixelColor> z3_colors(const std::vector<Z3Pixel<Words>>& pixels, const PixelObservers* observers = nullptr);

}  // namespace beampipe
