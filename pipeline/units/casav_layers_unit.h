// Composition by the published rules without an A-buffer: a few aggregates per pixel.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/owner_units.h"
#include "stages/beam/compose_layers.h"

namespace beampipe {

class ComposeLayersUnit {
 public:
  // `surfaces`: of the aggregates. The positions must outlive the unit.
  ComposeLayersUnit(Bin& bin, const MergePositions& positions, const MergeRules& rules, std::size_t layers,
                    CasavStorage storage, const std::vector<Surface>& surfaces)
      : bin_(bin),
        stage_(bin.stage(StageId::compose)),
        positions_(positions),
        rules_(rules),
        merges_(bin.pixel_counter("merges")),
        layers_(bin.tile.pixels(), layers, storage, bin.observers()),
        store_(bin, surfaces) {}

  void operator()(const std::vector<Fragment>& fragments) {
    layers_.add(fragments, positions_, rules_, stage_.timed(), merges_);
    store_.merge(fragments);
  }

  std::vector<glm::vec4> resolve_layers() {
    store_.finish();
    const std::vector<PixelColor> colors = pixel_colors(layers_.finish(positions_, rules_, stage_.timed()));
    return resolve(colors, bin_.background(), static_cast<std::uint32_t>(layers_.bytes_per_pixel()),
                   bin_.stage(StageId::resolve).timed(), bin_.observers());
  }

 private:
  Bin& bin_;
  BinStage stage_;
  const MergePositions& positions_;
  MergeRules rules_;
  std::vector<float>& merges_;
  AggregateLayers layers_;
  OpenPixelStore store_;
};

}  // namespace beampipe
