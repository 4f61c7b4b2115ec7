// From pairs to shaded fragments: the fragment stage of the beam, and shading.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/raster_units.h"
#include "stages/beam/alpha_mask.h"
#include "stages/beam/beam_fragment.h"
#include "stages/picture/shade.h"
#include "stages/samples/shading_point.h"

namespace beampipe {

class BeamFragmentUnit {
 public:
  // `options` must outlive it.
  BeamFragmentUnit(Bin& bin, const BeamFragmentOptions& options)
      : bin_(bin), stage_(bin.stage("beam_fragment")), options_(options) {
    if (bin.context.has_alpha()) patterns_ = options.grid ? cell_patterns(options.grid->count()) : options.positions;
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
    if (bin_.context.has_alpha()) alpha_mask(bin_.shader(), patterns_, bin_.stage("alpha_mask").timed(), fragments_);
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
      : bin_(bin), stage_(bin.stage("shade")), shader_(bin.shader()), in_order_(bin.memory()) {}

  // Forward shading: fragments in primitive order, in 2x2 quads.
  void operator()(std::vector<Fragment>& fragments) {
    shade(shader_, fragments, stage_.timed());
    in_order_.read(fragments, stage_.counters);
  }
  // Fragments that are known to be visible, in any order: one by one, attributes fetched by triangle number.
  void visible(std::vector<Fragment>& fragments) {
    shade_visible(shader_, fragments, stage_.timed());
    bin_.triangle_fetches().attributes(fragments, stage_.counters);
  }
  void visible(const std::vector<Pair>& whole) {
    shade_visible(shader_, whole, stage_.timed());
    bin_.triangle_fetches().attributes(whole, stage_.counters);
  }

  void visible(const std::vector<ShadedTriangle>& shaded) {
    shade_visible(shader_, shaded, stage_.timed());
    bin_.triangle_fetches().attributes(shaded, stage_.counters);
  }

  void finish_fetches() { bin_.triangle_fetches().flush(stage_.counters); }

 private:
  Bin& bin_;
  BinStage stage_;
  TileShader shader_;
  AttributesInOrder in_order_;
};

// Forward shading of sample fragments in primitive order, in 2x2 quads.
class SampleShadeUnit {
 public:
  explicit SampleShadeUnit(Bin& bin) : bin_(bin), stage_(bin.stage("shade")), in_order_(bin.memory()) {}

  // `sampling` must outlive it. Shading at centroids counts, per pixel, the fragments that are not shaded at the
  // centre.
  SampleShadeUnit(Bin& bin, const Sampling& sampling, ShadeAt at) : SampleShadeUnit(bin) {
    if (at != ShadeAt::centroid) return;
    sampling_ = &sampling;
    centroids_ = &bin.pixel_counter("centroids");
  }

  void operator()(const std::vector<SampleFragment>& fragments) {
    shade(bin_.shader(), fragments, stage_.timed());
    in_order_.read(fragments, stage_.counters);
    if (centroids_) count_centroids(bin_.triangles(), fragments, bin_.tile, *sampling_, stage_.timed(), *centroids_);
  }

  // Attributes are read again from the start.
  void start_pass() { in_order_ = AttributesInOrder(bin_.memory()); }

 private:
  Bin& bin_;
  BinStage stage_;
  AttributesInOrder in_order_;
  const Sampling* sampling_ = nullptr;
  std::vector<float>* centroids_ = nullptr;
};

}  // namespace beampipe
