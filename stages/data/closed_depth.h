// The depth behind which a pixel is closed: a triangle that covers the whole pixel hides all that lies behind its
// farthest depth there. One float per pixel of the tile and one for the tile, as in a hierarchical depth buffer
// (Greene, Kass and Miller 1993). Techniques that test samples have it for the cells of their grid.
#pragma once

#include <algorithm>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

class ClosedDepth {
 public:
  explicit ClosedDepth(const Tile& tile) : tile_(tile), depth_(tile.pixels(), kBeyond) {}

  // Pixels in frame coordinates, inside the tile.
  bool hides(std::int32_t x, std::int32_t y, float nearest) {
    ++work_.pixel_tests;
    const bool hidden = nearest > depth_[tile_.index(x, y)];
    work_.hidden += hidden;
    return hidden;
  }
  bool hides_everywhere(float nearest) {
    ++work_.tile_tests;
    const bool hidden = nearest > farthest_;
    work_.hidden_everywhere += hidden;
    return hidden;
  }

  // A triangle covers the whole pixel, nowhere in it farther than this.
  void close(std::int32_t x, std::int32_t y, float farthest) {
    const std::size_t pixel = tile_.index(x, y);
    ++work_.closings;
    if (farthest >= depth_[pixel]) return;
    ++work_.changes;
    changes_ += depth_[pixel] == farthest_;
    depth_[pixel] = farthest;
  }

  // Brings hides_everywhere up to date, when as many pixels have changed as the tile has.
  void refresh() {
    if (changes_ < depth_.size()) return;
    ++work_.refreshes;
    farthest_ = *std::max_element(depth_.begin(), depth_.end());
    changes_ = static_cast<std::size_t>(
        std::count_if(depth_.begin(), depth_.end(), [this](float depth) { return depth < farthest_; }));
  }

  std::size_t bytes() const { return depth_.size() * sizeof(float) + sizeof farthest_; }

  // Charges a stage with what was done since the last call: a comparison each; a second one of a pixel that changes,
  // with what the tile's depth is; two of every pixel to refresh that.
  void charge(StageCounters& counters) {
    const std::uint64_t refreshed = work_.refreshes * depth_.size();
    counters.ops.add += work_.pixel_tests + work_.tile_tests + work_.closings + work_.changes + 2 * refreshed;
    counters.bytes_read += (work_.pixel_tests + work_.closings + 2 * refreshed) * sizeof(float);
    counters.bytes_written += work_.changes * sizeof(float);
    counters.hidden_items += work_.hidden;
    counters.hidden_triangles += work_.hidden_everywhere;
    work_ = {};
  }

 private:
  static constexpr float kBeyond = 1.0f;  // every depth

  Tile tile_;
  std::vector<float> depth_;
  float farthest_ = kBeyond;
  std::size_t changes_ = 0;  // pixels nearer than farthest_

  // What was done since it was charged.
  struct Work {
    std::uint64_t pixel_tests = 0, tile_tests = 0, closings = 0, changes = 0, refreshes = 0;
    std::uint64_t hidden = 0, hidden_everywhere = 0;
  } work_;
};

}  // namespace beampipe
