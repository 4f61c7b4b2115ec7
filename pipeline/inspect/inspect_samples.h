// The history of a pixel of techniques that take samples: multisampling and accumulative antialiasing.
#pragma once

#include "pipeline/inspect/inspected_pixel.h"
#include "stages/data/accumulator.h"
#include "stages/picture/resolve.h"
#include "stages/samples/alpha_test.h"
#include "stages/samples/shading_point.h"

namespace beampipe {

struct MsaaInspection {
  Sampling sampling;
  ShadeAt at;
  AlphaCoverage alpha;
  bool prepass;
  ResolveSpace space;
};
PixelHistory inspect_msaa(const InspectedPixel& pixel, const MsaaInspection& how);

struct AcaaInspection {
  int samples;
  std::vector<Sampling> rounds;
  DoubleCounting double_counting;
  AccumulatorFormat format;
};
PixelHistory inspect_acaa(const InspectedPixel& pixel, const AcaaInspection& how);

}  // namespace beampipe
