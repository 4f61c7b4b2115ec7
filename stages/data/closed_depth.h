// The depth beyond which a pixel is closed. A triangle that covers a whole pixel hides everything behind its farthest
// depth there. There is one float per pixel of the tile and one for the whole tile, as in a hierarchical depth buffer
// (Greene, Kass and Miller 1993). Techniques that test samples use it for the cells of their grid.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "simd/closed_cells.h"
#include "stages/data/tile.h"

namespace beampipe {

// How often each operation was done; stages/cost/closed_depth_cost.h charges it.
struct ClosedDepthWork {
  std::uint64_t pixel_tests = 0, tile_tests = 0, closings = 0, changes = 0;
  std::uint64_t refreshed_pixels = 0;  // pixels that were looked at to refresh the tile's depth
  std::uint64_t hidden = 0, hidden_everywhere = 0;
};

class ClosedDepth {
 public:
  explicit ClosedDepth(const Tile& tile) : tile_(tile), depth_(tile.pixels() + kClosedSlack, kBeyond) {}

  // Is something with this nearest depth hidden in the pixel? (x, y): frame coordinates, inside the tile.
  bool hides(std::int32_t x, std::int32_t y, float nearest) {
    ++work_.pixel_tests;
    const bool hidden = nearest > depth_[tile_.index(x, y)];
    work_.hidden += hidden;
    return hidden;
  }

  // The same for several pixels.
  void hides(const std::int32_t* x, const std::int32_t* y, const float* nearest, std::size_t count, bool* hidden) {
    std::size_t found = 0;
    for (std::size_t i = 0; i < count; ++i) found += hidden[i] = nearest[i] > depth_[tile_.index(x[i], y[i])];
    work_.pixel_tests += count, work_.hidden += found;
  }

  // The same, for a stage that charges the test itself. `pixel`: index within the tile.
  bool is_hidden(std::size_t pixel, float nearest) const { return nearest > depth_[pixel]; }

  // Is it hidden in every pixel of the tile?
  bool hides_everywhere(float nearest) {
    ++work_.tile_tests;
    const bool hidden = nearest > farthest_;
    work_.hidden_everywhere += hidden;
    return hidden;
  }

  // A triangle covers the whole pixel and is nowhere in it farther than this.
  void close(std::int32_t x, std::int32_t y, float farthest) { close(tile_.index(x, y), farthest); }
  void close(std::size_t pixel, float farthest) {
    ++work_.closings;
    if (farthest >= depth_[pixel]) return;
    ++work_.changes;
    changes_ += depth_[pixel] == farthest_;
    depth_[pixel] = farthest;
  }

  // Is the triangle hidden in the pixel? If not and if it `closes` the pixel, it does. hides() and close() in one,
  // without branches that depend on the depths. The caller counts what it has asked for.
  bool hides_or_closes(std::int32_t x, std::int32_t y, float nearest, float farthest, bool closes) {
    float& depth = depth_[tile_.index(x, y)];
    const bool hidden = nearest > depth, changes = closes & !hidden & !(farthest >= depth);
    work_.changes += changes;
    changes_ += changes & (depth == farthest_);
    depth = changes ? farthest : depth;
    return hidden;
  }
  // The same for rows of quads of one triangle, of which it leaves the cells that are not hidden. Counts, and returns
  // how many cells these are.
  std::size_t hides_or_closes(const ClosingTriangle& triangle, ClosingRow* rows, std::size_t count) {
    const ClosedCells found =
        close_cells(triangle, {tile_.x0, tile_.y0, tile_.x1, tile_.y1, depth_.data(), farthest_}, rows, count);
    work_.changes += found.changed;
    changes_ += found.changed_from_farthest;
    this->count(found.tested, found.hidden, found.closed);
    return found.tested - found.hidden;
  }
  void count(std::uint64_t tests, std::uint64_t hidden, std::uint64_t closings) {
    work_.pixel_tests += tests, work_.hidden += hidden, work_.closings += closings;
  }

  // Brings hides_everywhere up to date once every pixel has become nearer than the tile's depth.
  void refresh() {
    if (changes_ < tile_.pixels()) return;
    work_.refreshed_pixels += tile_.pixels();
    const auto end = depth_.end() - kClosedSlack;
    farthest_ = *std::max_element(depth_.begin(), end);
    changes_ =
        static_cast<std::size_t>(std::count_if(depth_.begin(), end, [this](float depth) { return depth < farthest_; }));
  }

  std::size_t bytes() const { return tile_.pixels() * sizeof(float) + sizeof farthest_; }

  // Returns the work since the last call.
  ClosedDepthWork take_work() { return std::exchange(work_, {}); }

 private:
  static constexpr float kBeyond = 1.0f;  // beyond every depth

  Tile tile_;
  std::vector<float> depth_;
  float farthest_ = kBeyond;
  std::size_t changes_ = 0;  // pixels nearer than farthest_
  ClosedDepthWork work_;
};

}  // namespace beampipe
