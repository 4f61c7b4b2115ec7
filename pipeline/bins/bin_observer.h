// The observers of a bin's pixels: those whose histories FrameSinks asks for, or all if it asks for weights. Stages
// tell them what they do. What no stage saw, because it was left out early, is added when the bin is finished.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "pipeline/bins/frame_context.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/sample_fragment.h"
#include "stages/data/tile.h"

namespace beampipe {

struct BeamFragmentOptions;

class BinObserver {
 public:
  // Both must outlive it.
  BinObserver(const FrameContext& context, const Tile& tile);

  const PixelObservers& pixels() const { return pixels_; }

  // The positions are those of masks. The options must live until the bin is finished.
  void has_masks(const BeamFragmentOptions& options);

  // The positions are samples. Returns the number of the first one of this sampling, which must live until the bin is
  // finished.
  std::size_t first_sample(const Sampling& sampling);

  // The only sample of `one` is this sample of `all`. Both must live as long.
  void has_sample_of(const Sampling& one, const Sampling& all, std::size_t sample) {
    rounds_.push_back({&one, first_sample(all) + sample});
  }

  // The fragments of all triangles that are drawn, though some may be left out as hidden, before and after alpha.
  void has_fragments(const Sampling& sampling, const std::vector<SampleFragment>& before_alpha,
                     const std::vector<SampleFragment>& fragments);

  // Hands everything to the run. `list`: of the bin; `order`: in which pixels take fragments; `picture`: of the bin.
  void finish(const TriangleList& list, const std::string& order, const std::vector<glm::vec4>& picture);

 private:
  // All sample fragments of one sampling.
  struct Round {
    const Sampling* sampling;
    std::size_t first;
    std::vector<SampleFragment> before_alpha = {}, fragments = {};
  };

  void add_positions(const std::vector<glm::vec2>& positions);
  void complete(const TriangleList& list, const Tile& pixel, PixelObserver& observer) const;
  void describe(const Pair& pair, const Tile& pixel, PixelObserver& observer) const;

  const FrameContext& context_;
  const Tile& tile_;
  PixelObservers pixels_;
  const BeamFragmentOptions* masks_ = nullptr;  // null: positions are samples
  std::size_t positions_ = 0;
  std::vector<Round> rounds_;
};

}  // namespace beampipe
