// Where techniques sample a pixel.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/raster/sample_raster.h"

namespace beampipe {

// In a pixel, in units of 1/256 px from its upper left corner.
std::vector<glm::ivec2> places_of(const Sampling& sampling);
std::vector<glm::ivec2> places_of(const std::vector<SamplePattern>& patterns);

// `samples`: a power of two, 1..1024. Up to 16 samples are at the standard positions. Above, the pixel is a grid of
// samples / 8 cells, at least as wide as high, with the 8 standard positions in each cell.
Sampling msaa_sampling(int samples);

// The samples of each round of accumulation. The rounds together have the samples of msaa:N, at most 16 each. The last
// one has the sample that is nearest to the pixel's centre.
std::vector<Sampling> acaa_rounds(int samples);

}  // namespace beampipe
