// Composition by the published rules without an A-buffer: a few aggregates per pixel.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/memory/aggregate_memory.h"
#include "pipeline/units/owner_units.h"
#include "stages/beam/compose_layers.h"

namespace beampipe {

class ComposeLayersUnit {
 public:
  // `framebuffer`: the surfaces of the aggregates in memory. The pattern must outlive the unit.
  ComposeLayersUnit(Bin& bin, const SamplePattern& pattern, const MergeRules& rules, std::size_t layers,
                    PaperStorage storage, OpenPixels where, const std::vector<Surface>& framebuffer)
      : bin_(bin),
        stage_(bin.stage("compose")),
        pattern_(pattern),
        rules_(rules),
        merges_(bin.pixel_counter("merges")),
        layers_(bin.tile.pixels(), layers, storage) {
    if (where == OpenPixels::on_chip) {
      hold_open_pixels(bin, layers_.bytes_per_pixel());
    } else {
      memory_.emplace(bin.memory(), bin.z_order(), framebuffer);
    }
  }

  void operator()(const std::vector<Fragment>& fragments) {
    layers_.add(fragments, pattern_, rules_, stage_.timed(), merges_);
    if (memory_)
      for (const Fragment& fragment : fragments) memory_->merge(fragment.triangle, fragment.pixel, stage_.counters);
  }

  std::vector<glm::vec4> resolve_layers() {
    const BinStage resolving = bin_.stage("resolve");
    if (memory_) {
      memory_->flush({}, stage_.counters);
      memory_->read_all(resolving.counters);
      if (bin_.models_memory()) memory_->add_bytes(bin_.pixel_counter("bytes"));
    }
    const std::vector<PixelColor> colors = pixel_colors(layers_.finish(pattern_, rules_, stage_.timed()));
    return resolve(colors, bin_.background(), static_cast<std::uint32_t>(layers_.bytes_per_pixel()), resolving.timed());
  }

 private:
  Bin& bin_;
  BinStage stage_;
  const SamplePattern& pattern_;
  MergeRules rules_;
  std::vector<float>& merges_;
  AggregateLayers layers_;
  std::optional<AggregateMemory> memory_;
};

}  // namespace beampipe
