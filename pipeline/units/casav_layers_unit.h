// Composition by the published rules without an A-buffer: a few aggregates per pixel.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/owner_units.h"
#include "stages/beam/compose_layers.h"

namespace beampipe {

class ComposeLayersUnit {
 public:
  // `surfaces`: of the aggregates. The positions of `merging` must outlive the unit.
  ComposeLayersUnit(Bin& bin, std::size_t layers, const CasavMerging& merging, const std::vector<Surface>& surfaces)
      : bin_(bin),
        stage_(bin.stage(StageId::compose)),
        merges_(bin.pixel_counter("merges")),
        layers_(bin.tile.pixels(), layers, merging, bin.observers()),
        store_(bin, surfaces) {}

  void operator()(const std::vector<Fragment>& fragments) {
    layers_.add(fragments, stage_.timed(), merges_);
    store_.merge(fragments);
  }

  std::vector<glm::vec4> resolve_layers() {
    store_.finish();
    const std::vector<PixelColor> colors = pixel_colors(layers_.finish(stage_.timed()));
    return resolve(colors, bin_.background(), static_cast<std::uint32_t>(layers_.bytes_per_pixel()),
                   bin_.stage(StageId::resolve).timed(), bin_.observers());
  }

 private:
  Bin& bin_;
  BinStage stage_;
  std::vector<float>& merges_;
  AggregateLayers layers_;
  OpenPixelStore store_;
};

}  // namespace beampipe
