// Composition in primitive order: the pixel's state is all that is kept, and every fragment reads and writes it.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/memory/aggregate_memory.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"
#include "stages/beam/claim.h"
#include "stages/beam/compose_z3.h"
#include "stages/beam/settle.h"
#include "stages/cost/closed_depth_cost.h"
#include "stages/picture/resolve.h"

namespace beampipe {

template <std::size_t Words, std::size_t Layers>
class ComposeZ3Unit {
 public:
  ComposeZ3Unit(Bin& bin, const PositionSet& positions, LayerMerge merge, const std::vector<Surface>& framebuffer)
      : bin_(bin),
        stage_(bin.stage("compose")),
        positions_(positions),
        merge_(merge),
        merges_(bin.pixel_counter("merges")),
        pixels_(bin.tile.pixels()),
        memory_(bin.memory(), bin.z_order(), framebuffer) {}

  void operator()(const std::vector<Fragment>& fragments) {
    compose_z3(fragments, positions_, merge_, stage_.timed(), pixels_, merges_, bin_.observers());
    for (const Fragment& fragment : fragments) memory_.merge(fragment.triangle, fragment.pixel, stage_.counters);
  }

  std::vector<glm::vec4> resolve_layers() {
    const BinStage resolving = bin_.stage("resolve");
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
  LayerMerge merge_;
  std::vector<float>& merges_;
  std::vector<Z3Pixel<Words, Layers>> pixels_;
  AggregateMemory memory_;
};

// Owners of mask positions: claim during a pass over the bin, settle at its end. In memory, the owners' state and the
// settled colour are surfaces of their own.
template <std::size_t Words, std::size_t Layers>
class OwnersUnit {
 public:
  // `framebuffer`: the state's surfaces, then the colour.
  OwnersUnit(Bin& bin, const PositionSet& positions, const std::vector<Surface>& framebuffer)
      : bin_(bin),
        claim_(bin.stage("claim")),
        settle_(bin.stage("settle")),
        positions_(positions),
        color_bytes_(framebuffer.back().bytes_per_pixel),
        pixels_(bin.tile.pixels(), cleared_pixel<Words, Layers>()),
        state_(bin.memory(), bin.z_order(), {framebuffer.begin(), framebuffer.end() - 1}),
        color_(bin.memory(), bin.z_order(), {framebuffer.back()}) {}

  // The pixels that need a pass; empty when there are none.
  Tile unfinished() const { return unfinished_box(pixels_, bin_.tile); }

  void start_pass() {
    std::vector<float>& passes = bin_.pixel_counter("passes");
    for (std::size_t i = 0; i < pixels_.size(); ++i) passes[i] += is_unfinished(pixels_[i]);
    bin_.triangle_fetches().load_setup();
  }

  void claim_positions(const std::vector<Fragment>& fragments) {
    const bool models = bin_.models_memory();
    std::vector<std::uint32_t> remade;
    claim(bin_.triangles(), fragments, bin_.tile, positions_, claim_.timed(), pixels_, models ? &remade : nullptr);
    if (models)
      for (const Fragment& item : fragments) state_.merge(item.triangle, item.pixel, claim_.counters);
    for (const std::uint32_t owner : remade) bin_.triangle_fetches().depth(owner, claim_.counters);
  }

  // The end of the geometry pass. Returns the pairs of the owners, whose fragments settle_positions() needs again.
  std::vector<Pair> finish_claims() {
    bin_.triangle_fetches().flush(claim_.counters);
    state_.flush({}, claim_.counters);
    return owners(bin_.triangles(), pixels_, bin_.tile, settle_.timed());
  }

  // `fragments`: shaded. Closes finished pixels in `closed`.
  void settle_positions(const std::vector<Fragment>& fragments, bool last_pass, ClosedDepth& closed) {
    settle(fragments, last_pass, settle_.timed(), pixels_);
    if (bin_.models_memory()) {
      move_settled(fragments, state_);
      move_settled(fragments, color_);
    }
    state_.flush({}, settle_.counters);
    color_.flush({}, settle_.counters);
    close_finished(pixels_, bin_.tile, closed);
    charge(closed, settle_.counters);
  }

  // The closed depths are kept for the next pass, with the pixels.
  void store_closed(const ClosedDepth& closed) {
    if (!bin_.keeps_pixels_on_chip()) settle_.writes("closed_depth", closed.bytes());
  }

  std::vector<glm::vec4> resolve_settled() {
    const BinStage resolving = bin_.stage("resolve");
    if (bin_.models_memory()) {
      state_.add_bytes(bin_.pixel_counter("bytes"));
      color_.add_bytes(bin_.pixel_counter("bytes"));
    }
    color_.read_all(resolving.counters);
    return resolve(settled_colors(pixels_), bin_.background(), color_bytes_, resolving.timed());
  }

 private:
  // Moves the state of each pixel that has owners once. The owners' fragments follow each other pixel by pixel.
  void move_settled(const std::vector<Fragment>& fragments, AggregateMemory& memory) {
    for (std::size_t i = 0; i < fragments.size(); ++i)
      if (i == 0 || fragments[i].pixel != fragments[i - 1].pixel) memory.merge(0, fragments[i].pixel, settle_.counters);
  }

  Bin& bin_;
  BinStage claim_, settle_;
  const PositionSet& positions_;
  std::uint32_t color_bytes_;
  std::vector<OwnerPixel<Words, Layers>> pixels_;
  AggregateMemory state_, color_;
};

}  // namespace beampipe
