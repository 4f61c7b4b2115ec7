// Accumulative antialiasing (Enderton et al. 2015): a depth-only pass at N samples, then a pass that adds each visible
// fragment's colour, weighted by its visible samples, to one accumulator per pixel. Above 16 samples there are several
// such rounds, each with another part of the samples, on the same surfaces.
#pragma once

#include "pipeline/sampling.h"
#include "pipeline/technique.h"
#include "stages/samples/accumulate.h"

namespace beampipe {

inline constexpr int kMaxAcaaSamples = 256;

struct AcaaOptions {
  int samples = 8;  // a power of two, 1..256
  DoubleCounting double_counting = DoubleCounting::none;
  AccumulatorFormat color = AccumulatorFormat::fp16;
};

}  // namespace beampipe
