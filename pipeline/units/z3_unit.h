// Composition in primitive order: the pixel's state is all that is kept, and every fragment reads and writes it.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/memory/aggregate_memory.h"
#include "stages/beam/compose_z3.h"
#include "stages/picture/resolve.h"

namespace beampipe {

template <std::size_t Words>
class ComposeZ3Unit {
 public:
  ComposeZ3Unit(Bin& bin, const PositionSet& positions, const std::vector<Surface>& framebuffer)
      : bin_(bin),
        stage_(bin.stage(StageId::compose)),
        positions_(positions),
        merges_(bin.pixel_counter("merges")),
        pixels_(bin.tile.pixels()),
        memory_(bin.memory(), bin.z_order(), framebuffer) {}

  void operator()(const std::vector<Fragment>& fragments) {
    compose_z3(fragments, positions_, stage_.timed(), pixels_, merges_, bin_.observers());
    for (const Fragment& fragment : fragments) memory_.merge(fragment.triangle, fragment.pixel, stage_.counters);
  }

  std::vector<glm::vec4> resolve_layers() {
    const BinStage resolving = bin_.stage(StageId::resolve);
    memory_.flush({}, stage_.counters);
    memory_.read_all(resolving.counters);
    if (bin_.models_memory()) memory_.add_bytes(bin_.pixel_counter("bytes"));
    return resolve(z3_colors(pixels_, bin_.observers()), bin_.background(), sizeof pixels_[0], resolving.timed(),
                   bin_.observers());
  }

 private:
  Bin& bin_;
  BinStage stage_;
  const PositionSet& positions_;
  std::vector<float>& merges_;
  std::vector<Z3Pixel<Words>> pixels_;
  AggregateMemory memory_;
};

}  // namespace beampipe
