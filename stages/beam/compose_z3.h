// compose_z3: fragments in primitive order -> a few layers per pixel, in one pass (Z3, Jouppi and Chang 1999).
//
// A fragment takes the positions where it is nearer than their owners; at equal depth the earlier fragment keeps them.
// If a pixel gets one layer too many, two layers are merged: the closest in depth, as in Z3, or those whose colours
// lose least. A layer's weight is its share of the positions. Specks are lost.
#pragma once

#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/fragment.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/position_set.h"
#include "stages/data/z3_pixel.h"

namespace beampipe {

// Which two layers are merged.
enum class LayerMerge {
  depth,  // those with the least difference of depth at the pixel's centre
  color,  // those with the least squared distance of colours, times n m / (n + m) for n and m positions: the error of
          // the mean
};

// `pixels`: one per pixel of the tile, kept from batch to batch; zero at first. Adds to `merges`, one per pixel of the
// tile as well, the number of times that two layers were merged. Counts as items out the fragments that take a
// position.
template <std::size_t Words, std::size_t Layers>
void compose_z3(const std::vector<Fragment>& fragments, const PositionSet& positions, LayerMerge merge,
                StageCounters& counters, std::vector<Z3Pixel<Words, Layers>>& pixels, std::vector<float>& merges,
                const PixelObservers* observers = nullptr);

template <std::size_t Words, std::size_t Layers>
std::vector<PixelColor> z3_colors(const std::vector<Z3Pixel<Words, Layers>>& pixels,
                                  const PixelObservers* observers = nullptr);

}  // namespace beampipe
