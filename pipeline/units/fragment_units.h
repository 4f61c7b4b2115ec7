// From pairs to shaded fragments: the fragment stage of the beam, and shading.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/raster_units.h"
#include "pipeline/units/sample_places.h"
#include "stages/beam/alpha_mask.h"
#include "stages/beam/beam_fragment.h"
#include "stages/picture/shade.h"
#include "stages/samples/shading_point.h"

namespace beampipe {

class BeamFragmentUnit {
 public:
  // `options` must outlive it.
  BeamFragmentUnit(Bin& bin, const BeamFragmentOptions& options)
      : bin_(bin), stage_(bin.stage(StageId::beam_fragment)), options_(options) {
    if (bin.context.has_alpha()) patterns_ = options.grid ? cell_patterns(options.grid->count()) : options.positions;
    if (BinObserver* const observer = bin.observer()) observer->has_masks(options);
  }

  // The fragments of pairs that follow each other in primitive order; `buffer` is the name of the on-chip buffer that
  // holds them. They are valid until the next call.
  std::vector<Fragment>& operator()(const std::vector<Pair>& pairs, const std::string& buffer) {
    make(pairs);
    bin_.holds(buffer, fragments_.size() * options_.fragment_bytes);
    return fragments_;
  }

  // The same, where a queue of kQueueItems fragments leads to the next stage.
  std::vector<Fragment>& queued(const std::vector<Pair>& pairs) {
    make(pairs);
    bin_.holds("fragment_queue", std::min(fragments_.size(), kQueueItems) * options_.fragment_bytes);
    return fragments_;
  }

  // As the first, for pairs in any order: their setup triangles are fetched by number.
  std::vector<Fragment>& fetched(const std::vector<Pair>& pairs, const std::string& buffer) {
    (*this)(pairs, buffer);
    bin_.triangle_fetches().setup(pairs, stage_.counters);
    return fragments_;
  }

 private:
  void make(const std::vector<Pair>& pairs) {
    fragments_.clear();
    beam_fragment(bin_.triangles(), pairs, bin_.tile, options_, stage_.timed(), fragments_);
    if (!bin_.context.has_alpha()) return;
    const BinStage masking = bin_.stage(StageId::alpha_mask);
    alpha_mask(bin_.shader(), patterns_, options_.alpha, masking.timed(), fragments_, bin_.texels());
    bin_.charge_texels(masking);
  }

  Bin& bin_;
  BinStage stage_;
  const BeamFragmentOptions& options_;
  std::vector<SamplePattern> patterns_;  // for alpha
  std::vector<Fragment> fragments_;
};

// Adds one to a pixel's count for each of its fragments that covers no mask position.
inline void count_specks(const std::vector<Fragment>& fragments, std::vector<float>& specks) {
  for (const Fragment& fragment : fragments) specks[fragment.pixel] += fragment.tiny;
}

class ShadeUnit {
 public:
  explicit ShadeUnit(Bin& bin)
      : bin_(bin),
        stage_(bin.stage(StageId::shade)),
        shader_(bin.shader()),
        in_order_(bin.memory(), bin.surface_fetches()) {}

  // Forward shading: fragments in primitive order, in 2x2 quads.
  void operator()(std::vector<Fragment>& fragments) {
    shade(shader_, fragments, stage_.timed(), bin_.texels());
    bin_.charge_texels(stage_);
    in_order_.read(fragments, stage_.counters);
  }
  // Fragments that are known to be visible, in any order: one by one, attributes fetched by triangle number.
  void visible(std::vector<Fragment>& fragments) {
    shade_visible(shader_, fragments, stage_.timed(), bin_.texels());
    bin_.charge_texels(stage_);
    bin_.triangle_fetches().attributes(fragments, stage_.counters);
  }
  // Composition shades these. Texels that it has read are charged here.
  void visible(const std::vector<Pair>& whole) { charge_visible(whole); }
  void visible(const std::vector<ShadedTriangle>& shaded, const OperationCounts& decisions) {
    charge_visible(shaded);
    stage_.counters.ops += decisions;
  }

 private:
  template <class Item>
  void charge_visible(const std::vector<Item>& shaded) {
    shade_visible(shader_, shaded, stage_.timed());
    bin_.charge_texels(stage_);
    bin_.triangle_fetches().attributes(shaded, stage_.counters);
  }

  Bin& bin_;
  BinStage stage_;
  TileShader shader_;
  AttributesInOrder in_order_;
};

// Forward shading of sample fragments in primitive order, in 2x2 quads.
class SampleShadeUnit {
 public:
  // `sampling` must outlive the pass. `color_bytes`: of the colour that goes on.
  SampleShadeUnit(Bin& bin, const Sampling& sampling, ShadeAt at, std::uint32_t color_bytes = kColorBytes)
      : bin_(bin),
        stage_(bin.stage(StageId::shade)),
        in_order_(bin.memory(), bin.surface_fetches()),
        sampling_(&sampling),
        at_(at),
        color_bytes_(color_bytes) {}

  // Counts, per pixel, the fragments that are shaded at the centroid and not at the centre.
  void counts_centroids() {
    if (at_ == ShadeAt::centroid) centroids_ = &bin_.pixel_counter("centroids");
  }

  void operator()(const std::vector<SampleFragment>& fragments) {
    if (TexelRequests* const texels = bin_.texels())
      SamplePlaces(bin_, *sampling_, at_).add_quad_texels(fragments, *texels);
    charge(fragments);
  }

  // The same, for colours that are wanted now: RGBA.
  std::vector<glm::vec4> colors(const std::vector<SampleFragment>& fragments) {
    std::vector<glm::vec4> found = SamplePlaces(bin_, *sampling_, at_).shade_quads(fragments, bin_.texels());
    charge(fragments);
    return found;
  }

  // Attributes are read again from the start.
  void start_pass(const Sampling& sampling) {
    sampling_ = &sampling;
    if (TriangleFetches* const fetches = bin_.surface_fetches()) fetches->flush(stage_.counters);
    in_order_ = AttributesInOrder(bin_.memory(), bin_.surface_fetches());
  }

 private:
  void charge(const std::vector<SampleFragment>& fragments) {
    shade(bin_.shader(), fragments, color_bytes_, stage_.timed());
    bin_.charge_texels(stage_);
    in_order_.read(fragments, stage_.counters);
    if (centroids_) count_centroids(bin_.triangles(), fragments, bin_.tile, *sampling_, stage_.timed(), *centroids_);
  }

  Bin& bin_;
  BinStage stage_;
  AttributesInOrder in_order_;
  const Sampling* sampling_;
  ShadeAt at_;
  std::uint32_t color_bytes_;
  std::vector<float>* centroids_ = nullptr;
};

}  // namespace beampipe
