// The history of a pixel by the published rules, with an A-buffer or without, and of alpha.
#pragma once

#include <functional>

#include "pipeline/inspect/inspected_pixel.h"
#include "stages/beam/a_buffer.h"
#include "stages/data/casav_aggregate.h"

namespace beampipe {

struct CasavInspection {
  const MergePositions& positions;
  BeamFragmentOptions fragments;
  SortKey sort = SortKey::centroid;
  // Composes one pixel from near to far as the technique does.
  std::function<Aggregate(const std::vector<Fragment>&, const ABuffer&, CasavStorage)> compose;
  CasavStorage storage = CasavStorage::slides;
};
PixelHistory inspect_casav(const InspectedPixel& pixel, const CasavInspection& how);

// Without an A-buffer: `layers` aggregates.
struct CasavLayersInspection {
  const MergePositions& positions;
  BeamFragmentOptions fragments;
  MergeRules rules;
  std::size_t layers;
  CasavStorage storage;
  bool sorts;  // near to far, in sorted bins
};
PixelHistory inspect_casav_layers(const InspectedPixel& pixel, const CasavLayersInspection& how);

}  // namespace beampipe
