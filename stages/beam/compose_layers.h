// compose_layers (stage `compose` of the published rules without an A-buffer): fragments in any order -> a few
// aggregates per pixel.
//
// A pixel keeps up to K aggregates from near to far. A fragment is one more; if there are more than K, the two
// neighbours whose depth ranges overlap most, or are closest, become one by the published rules (simd/merge.h). At the
// end all are merged near to far. Section 2.3 of Crassin et al. 2018 mentions such a "multilayer prototype using
// multiple aggregates" and leaves out how it chooses; multilayer alpha blending (Salvi and Vaidyanathan 2014) is its
// model.
#pragma once

#include <vector>

#include "simd/merge.h"
#include "stages/cost/counters.h"
#include "stages/data/casav_aggregate.h"
#include "stages/data/fragment.h"
#include "stages/data/pixel_observer.h"

namespace beampipe {

// The aggregates of the pixels of a tile as they are stored, `layers` for each pixel, empty ones last.
class AggregateLayers {
 public:
  // The positions of `merging` must outlive it. `observers` may be null.
  AggregateLayers(std::size_t pixels, std::size_t layers, const CasavMerging& merging,
                  const PixelObservers* observers = nullptr);

  // Adds shaded fragments. Counts as items out the fragments. Adds one to merges[pixel] for each two aggregates that
  // become one.
  void add(const std::vector<Fragment>& fragments, StageCounters& counters, std::vector<float>& merges);

  // Merges each pixel's aggregates.
  std::vector<Aggregate> finish(StageCounters& counters) const;

  std::size_t bytes_per_pixel() const { return layers_ * casav_aggregate_bytes(merging_.storage); }

 private:
  Aggregate stored(const Aggregate& aggregate) const;

  std::size_t layers_;
  CasavMerging merging_;
  const PixelObservers* observers_;
  std::vector<Aggregate> aggregates_;  // rounded as they are stored
};

}  // namespace beampipe
