// What each triangle is worth in the pixels of a bin, recorded while the bin is composed when FrameSinks::weights asks
// for it. It observes; what is rendered and counted stays the same.
#pragma once

#include "pipeline/bins/bin.h"
#include "pipeline/bins/render_bins.h"

namespace beampipe {

class BinWeights {
 public:
  explicit BinWeights(const Bin& bin) : bin_(bin), weights_(bin.context.sinks.weights ? bin.tile.pixels() : 0) {}

  // Are they asked for?
  explicit operator bool() const { return !weights_.empty(); }

  std::size_t pixels() const { return weights_.size(); }
  PixelWeights& at(std::size_t pixel) { return weights_[pixel]; }

  // Hands them to the frame.
  void finish() const {
    if (*this) copy_to_frame(weights_, bin_.tile, bin_.context.frame, *bin_.context.sinks.weights);
  }

 private:
  const Bin& bin_;
  std::vector<PixelWeights> weights_;  // one per pixel of the tile; empty when they are not asked for
};

}  // namespace beampipe
