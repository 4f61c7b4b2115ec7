// The depth test of a bin with the multisampled surface that it reads and writes: depth, and with it colour or
// visibility ids.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/memory/sample_memory.h"
#include "pipeline/memory/tile_surface.h"
#include "stages/picture/resolve.h"
#include "stages/samples/shading_point.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

class DepthTestUnit {
 public:
  // `sampling` must outlive it. `color_bytes` of a sample beside its depth; 0: there is depth alone, and the first pass
  // is a depth pre-pass.
  DepthTestUnit(Bin& bin, const Sampling& sampling, std::uint32_t color_bytes)
      : DepthTestUnit(bin, sampling, color_bytes, color_bytes, std::equal_to<std::uint32_t>()) {}

  // For a surface with colours that the first pass does not write: a depth pre-pass.
  enum class FirstPass { writes_color, writes_depth_alone };
  DepthTestUnit(Bin& bin, const Sampling& sampling, std::uint32_t color_bytes, FirstPass first,
                SampleMemory::SameValue same_color)
      : DepthTestUnit(bin, sampling, first == FirstPass::writes_color ? color_bytes : 0, color_bytes,
                      std::move(same_color)) {}

  // Adds the bytes that tests and writes have moved to the bin's counter.
  ~DepthTestUnit() {
    if (bytes_) memory_.add_bytes(*bytes_);
  }
  DepthTestUnit(const DepthTestUnit&) = delete;
  DepthTestUnit& operator=(const DepthTestUnit&) = delete;

  // Translucent fragments are blended from here on, shaded there.
  void shade_translucent_at(ShadeAt at);

  // Tests and writes what passes, and blends translucent fragments, in their order. A surface without colours leaves
  // them out. Counts each pixel's fragments.
  void test(const std::vector<SampleFragment>& fragments);

  // Translucent fragments go into a layer of their own from here on, shaded there: SampleTile::over.
  void start_layer(ShadeAt at, std::uint32_t sample_bytes);

  // Blends translucent fragments in their order, and drops those of which no sample passes. `layer`: where it lies in
  // memory.
  void blend_into(TileSurface& layer, std::vector<SampleFragment>& fragments);

  // Leaves of each opaque fragment the samples that have the stored depth, and drops fragments without any. Translucent
  // fragments are blended, and those of which a sample passes follow with all their samples.
  void test_equal(std::vector<SampleFragment>& fragments);

  // After a depth pre-pass, tests are a part of stage `shade`.
  void tests_in_shader() { main_stage_ = StageId::shade; }
  const std::vector<SampleAccess>& accesses() const { return accesses_; }  // of the last test, or of the last blending

  // SampleRasterUnit::pass does it.
  void end_pass() {
    memory_.flush(stage().counters);
    pass_ = Pass::main;
  }

  // From here on the surface's colours count: what is written and resolved.
  void add_color(std::uint32_t color_bytes) { surface_.color_bytes = color_bytes; }

  // Passes of other stages that read every sample.
  void read_depths(const BinStage& by) { memory_.read_depth(by.counters); }
  // Or only those that are tested.
  void read_depths(const std::vector<SampleAccess>& accesses, const BinStage& by) {
    memory_.test(accesses, by.counters);
  }
  void read_colors(const BinStage& by) { memory_.read_color(by.counters); }

  // The mean colour of each pixel's samples.
  std::vector<glm::vec4> resolve_samples(ShadeAt at, StageCounters& resolving,
                                         ResolveSpace space = ResolveSpace::linear) const;

  const SampleTile& surface() const { return surface_; }
  const Sampling& sampling() const { return sampling_; }

 private:
  DepthTestUnit(Bin& bin, const Sampling& sampling, std::uint32_t first_color_bytes, std::uint32_t color_bytes,
                SampleMemory::SameValue same_color);

  BinStage stage() const { return bin_.stage(pass_ == Pass::main ? main_stage_ : StageId::depth_test, pass_); }
  SampledTriangles samples() const { return {bin_.triangles(), bin_.tile, sampling_}; }
  bool hides(const SampleFragment& fragment) const;  // what lies behind it
  void test_opaque(const std::vector<SampleFragment>& fragments);
  void blend_colors(const std::vector<SampleFragment>& fragments, const BinStage& blending);
  void blend_fragments(const std::vector<SampleFragment>& fragments);

  Bin& bin_;
  Pass pass_;
  StageId main_stage_ = StageId::depth_test;
  const Sampling& sampling_;
  ShadeAt translucent_at_ = ShadeAt::centre;
  SampleTile surface_;
  SampleMemory memory_;
  std::vector<float>& fragments_;  // per pixel
  std::vector<float>* bytes_;      // per pixel; null: memory is not modelled
  std::vector<SampleAccess> accesses_;
};

// Adds one to a pixel's count for each triangle that has a fragment there, in however many cells of the pixel. The
// fragments of one triangle follow each other.
void count_by_pixel(const std::vector<SampleFragment>& fragments, const Tile& tile, const CellGrid& grid,
                    std::vector<float>& counts);

// The triangles that the samples of a surface show, pixel by pixel.
std::vector<std::uint32_t> triangles_of(const SampleTile& surface, const Tile& tile);

}  // namespace beampipe
