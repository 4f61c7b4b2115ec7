// Composition in sorted order: windows of pairs from the A-buffer, and the aggregates that their fragments go into.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/technique.h"
#include "stages/beam/compose_beam.h"
#include "stages/beam/windows.h"
#include "stages/picture/resolve.h"

namespace beampipe {

class WindowsUnit {
 public:
  // `sorted`: the pairs that `lists` sorts by nearest depth. Both must outlive the unit.
  WindowsUnit(Bin& bin, const std::vector<Pair>& sorted, const ABuffer& lists)
      : stage(bin.stage(StageId::windows)), bin_(bin), windows_(sorted, lists, kStoredPairBytes) {}

  // The next window of every pixel that is open; false when there is none.
  template <class IsOpen>
  bool next(IsOpen&& is_open) {
    if (!windows_.next(is_open, stage.timed(), pairs, whole)) return false;
    bin_.holds("window_pairs", (pairs.size() + whole.size()) * kPairWithDepthBytes);
    return true;
  }

  // Records the counters of each pixel. Returns how many records of each were looked at.
  const std::vector<float>& finish() {
    bin_.pixel_counter("largest_window") = windows_.largest;
    bin_.pixel_counter("merges") = windows_.taken;
    return windows_.looked_at;
  }

  const BinStage stage;
  std::vector<Pair> pairs;  // of the windows, pixel by pixel, each in primitive order
  std::vector<Pair> whole;  // single-pair windows that cover their whole pixel

 private:
  Bin& bin_;
  Windows windows_;
};

// Charges aggregates that were composed on chip: `compose` writes those that are `written`, `resolve` reads them all.
// Both are one per pixel; `full`: the pixel is closed.
void charge_aggregates(Bin& bin, const std::vector<Surface>& framebuffer, const std::vector<bool>& written,
                       const std::vector<bool>& full);

template <std::size_t Words>
class ComposeBeamUnit {
 public:
  ComposeBeamUnit(Bin& bin, const PositionSet& positions)
      : bin_(bin), stage_(bin.stage(StageId::compose)), positions_(positions), pixels_(bin.tile.pixels()) {}

  bool is_open(std::size_t pixel) const { return !is_closed(pixels_[pixel]); }

  // `fragments`: at most one window of each pixel. `whole`: pairs that are all that can be seen of their pixels.
  void operator()(const std::vector<Fragment>& fragments, const std::vector<Pair>& whole) {
    compose_window(fragments, positions_, stage_.timed(), pixels_, areas_, bin_.observers());
    compose_whole({whole, bin_.tile, bin_.shader(), bin_.texels()}, stage_.timed(), pixels_, bin_.observers());
    bin_.charge_texels(bin_.stage(StageId::shade));
  }

  // The picture. `framebuffer`: the surfaces that hold an aggregate.
  std::vector<glm::vec4> resolve_aggregates(const std::vector<Surface>& framebuffer) {
    charge_aggregates(bin_, framebuffer, covered_pixels(pixels_), closed_pixels(pixels_));
    return resolve(composed_colors(pixels_), bin_.background(), sizeof pixels_[0], bin_.stage(StageId::resolve).timed(),
                   bin_.observers());
  }

 private:
  Bin& bin_;
  BinStage stage_;
  const PositionSet& positions_;
  std::vector<StoredAggregate<Words>> pixels_;
  std::vector<float> areas_;  // what each of the last fragments added to its pixel
};

}  // namespace beampipe
