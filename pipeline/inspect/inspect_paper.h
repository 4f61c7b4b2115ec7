// The history of a pixel by the published rules, with an A-buffer or without, and of alpha.
#pragma once

#include <functional>

#include "pipeline/inspect/inspected_pixel.h"
#include "stages/beam/a_buffer.h"
#include "stages/data/paper_aggregate.h"

namespace beampipe {

struct PaperInspection {
  const MergePositions& positions;
  BeamFragmentOptions fragments;
  SortKey sort = SortKey::centroid;
  // Composes one pixel from near to far as the technique does.
  std::function<Aggregate(const std::vector<Fragment>&, const ABuffer&, PaperStorage)> compose;
  PaperStorage storage = PaperStorage::slides;
};
PixelHistory inspect_paper(const InspectedPixel& pixel, const PaperInspection& how);

// Without an A-buffer: `layers` aggregates.
struct PaperLayersInspection {
  const MergePositions& positions;
  BeamFragmentOptions fragments;
  MergeRules rules;
  std::size_t layers;
  PaperStorage storage;
  bool sorts;  // near to far, in sorted bins
};
PixelHistory inspect_paper_layers(const InspectedPixel& pixel, const PaperLayersInspection& how);

}  // namespace beampipe
