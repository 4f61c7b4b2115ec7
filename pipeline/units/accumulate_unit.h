// Accumulative antialiasing in a bin: stencil test and colour accumulator, round after round.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/depth_test_unit.h"
#include "stages/samples/accumulate.h"

namespace beampipe {

class AccumulateUnit {
 public:
  AccumulateUnit(Bin& bin, int samples, AccumulatorFormat format, DoubleCounting double_counting);

  // A round accumulates at the positions of `sampling`, whose depths a depth-only pass has found.
  void start_round(const Sampling& sampling, const SampleTile& depth);
  // After the stencil test, when there is one. A fragment is shaded at its pixel's centre or, if its triangle does not
  // cover that, at the centroid of the samples that it adds.
  void operator()(const std::vector<SampleFragment>& fragments, const Sampling& sampling);
  void finish_round();

  // After the last round: the bin's translucent triangles go over the accumulator in the order of draws, at one sample
  // per pixel, as the talk draws water. `depth_test`: of the last round. The sample that is nearest to the centre is
  // tested and covered, so that its stored depth is compared with a depth at the same place. `central`: this sample
  // alone; it must live until the bin is finished. Stages: sample_raster, blend, shade.
  void blend_translucent(DepthTestUnit& depth_test, const Sampling& central);

  // Reads the stencil values of the fragments' samples, and leaves of each fragment the samples that no earlier one has
  // taken. Does nothing without a stencil.
  void test_stencil(std::vector<SampleFragment>& fragments);

  // Does the background take part in accumulation? It then reads every depth once more.
  bool blends_background() const { return accumulator_.double_counting == DoubleCounting::saturate; }

  std::vector<glm::vec4> resolve_accumulator();

  const BinStage stage;

 private:
  // Adding to an accumulator reads and writes it.
  void access_color(std::uint32_t triangle, std::uint32_t pixel, const BinStage& by);
  void blend_background(const SampleTile& depth);
  void access_stencil(const std::vector<SampleFragment>& fragments, bool write);

  Bin& bin_;
  Accumulator accumulator_;
  TileSurface color_;
  std::optional<TileSurface> stencil_;  // of the round: a byte per sample
};

}  // namespace beampipe
