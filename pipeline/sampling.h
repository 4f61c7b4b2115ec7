// Where techniques sample a pixel.
#pragma once

#include <vector>

#include "stages/raster/sample_raster.h"

namespace beampipe {

// `samples`: a power of two, 1..1024. To 16, the standard positions. Above, the pixel is a grid of samples / 8 cells,
// at least as wide as high.
Sampling msaa_sampling(int samples);

// What each round of accumulation samples: together the samples of msaa:N, at most 16 at a time.
std::vector<Sampling> acaa_rounds(int samples);

}  // namespace beampipe
