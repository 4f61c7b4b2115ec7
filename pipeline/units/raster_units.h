// The rasterizers of a bin, with what they keep on chip: pairs or sample fragments, and the depths at which pixels are
// closed.
//
// A unit is a stage as it runs in a bin, together with what it is charged: time, counters, memory traffic and on-chip
// buffers.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/depth_test_unit.h"
#include "stages/raster/conservative_raster.h"
#include "stages/raster/sample_raster.h"
#include "stages/samples/alpha_test.h"
#include "stages/samples/shading_point.h"

namespace beampipe {

// Calls body(batch) for the list's triangles in order, 512 at a time, so that the fragments of a batch stay in cache.
template <class Body>
void for_each_batch(const TriangleList& list, Body&& body) {
  constexpr std::size_t kBatchTriangles = 512;
  for (std::size_t first = 0; first < list.size(); first += kBatchTriangles) {
    const auto begin = list.begin() + static_cast<std::ptrdiff_t>(first);
    body(TriangleList(begin, begin + static_cast<std::ptrdiff_t>(std::min(kBatchTriangles, list.size() - first))));
  }
}

// Entries of a queue between two stages on chip. A stage whose queue is full waits for the next stage. The simulator
// works on more items at a time.
inline constexpr std::size_t kQueueItems = 24;

// Size of a queued pair in the modelled machine: pixel (16 bits), the triangle's number in the bin's list (24), whether
// the pair is full (8), and its nearest depth as float32.
inline constexpr std::uint64_t kQueuedPairBytes = 10;

class ConservativeRasterUnit {
 public:
  // `buffer`: the name of the on-chip buffer that holds the pairs, at most `capacity` of them at once.
  enum class Hidden { kept, left_out };  // pairs that lie behind a triangle which covers their whole pixel
  ConservativeRasterUnit(Bin& bin, std::string buffer, PairDepths depths, Hidden hidden,
                         std::size_t capacity = std::numeric_limits<std::size_t>::max());

  // The pairs of the triangles in the box. They are valid until the next call.
  std::vector<Pair>& operator()(const TriangleList& triangles, const Tile& box);
  std::vector<Pair>& operator()() { return (*this)(bin_.list, bin_.tile); }

  // Calls body(pairs, first) for the pairs of the bin's pixels, in the order of the list, where a queue of kQueueItems
  // pairs leads to the next stage. With Hidden::left_out, the body closes pixels. The simulator takes more pairs at
  // once, which changes nothing but how soon a closed pixel hides pairs. The first pair belongs to list[first] or to a
  // later triangle.
  template <class Body>
  void queued(const TriangleList& list, Body&& body) {
    constexpr std::size_t kTriangles = 64, kPairs = 256;
    std::vector<Pair> chunk;
    for (std::size_t first = 0; first < list.size(); first += kTriangles) {
      const auto begin = list.begin() + static_cast<std::ptrdiff_t>(first);
      const TriangleList batch(begin, begin + static_cast<std::ptrdiff_t>(std::min(kTriangles, list.size() - first)));
      pairs_.clear();
      conservative_raster(bin_.triangles(), batch, bin_.tile, stage_.timed(), pairs_,
                          {closed_ ? &*closed_ : nullptr, depths_, Closing::by_later_stage});
      bin_.holds("pair_queue", std::min(pairs_.size(), kQueueItems) * kQueuedPairBytes);
      if (pairs_.size() <= kPairs) {
        if (!pairs_.empty()) body(pairs_, first);
        continue;
      }
      for (std::size_t at = 0; at < pairs_.size(); at += kPairs) {
        const auto from = pairs_.begin() + static_cast<std::ptrdiff_t>(at);
        chunk.assign(from, from + static_cast<std::ptrdiff_t>(std::min(kPairs, pairs_.size() - at)));
        if (at > 0 && closed_) drop_hidden(chunk);
        body(chunk, first);
      }
    }
  }

  ClosedDepth& closed() { return *closed_; }  // with Hidden::left_out

 private:
  // Drops pairs that closed pixels hide by now.
  void drop_hidden(std::vector<Pair>& pairs);

  Bin& bin_;
  BinStage stage_;
  std::string buffer_;
  PairDepths depths_;
  std::size_t capacity_;
  std::optional<ClosedDepth> closed_;
  std::vector<Pair> pairs_;
};

class SampleRasterUnit {
 public:
  explicit SampleRasterUnit(Bin& bin, Pass pass = Pass::main)
      : SampleRasterUnit(bin, Translucent::left_out, AlphaCoverage::test, pass) {}

  // Translucent triangles: left out, drawn with all others, or drawn alone, in a pass that continues another one.
  enum class Translucent { left_out, drawn, alone };
  SampleRasterUnit(Bin& bin, Translucent translucent, AlphaCoverage coverage, Pass pass = Pass::main)
      : bin_(bin),
        pass_(pass),
        stage_(bin.stage(StageId::sample_raster, pass)),
        translucent_(translucent),
        coverage_(coverage) {}

  // Where no depth is tested, nothing is left out.
  void keeps_hidden() { keeps_hidden_ = true; }

  // Of the fragments that passed depth and stencil: takes away what shaders discard that ask for early tests. For the
  // body of pass(), with the same sampling.
  void test_alpha_after_tests(const Sampling& sampling, ShadeAt at);

  // Draws translucent triangles after all others, far to near by the mean depth of their vertices.
  void sorts_translucent() { sorts_translucent_ = true; }

  // One geometry pass: calls body(fragments) for each batch of triangles. Leaves out what lies behind the cells that
  // this pass has closed so far, as a hierarchical depth buffer does. Fragments of cutouts pass the alpha test first.
  // `at`: where fragments are shaded. `surface`: what the body tests them against; its pass ends with this one.
  template <class Body>
  void pass(DepthTestUnit& surface, ShadeAt at, Body&& body) {
    pass(surface.sampling(), at, body);
    surface.end_pass();
  }

  // The same, whatever the body tests them against. `sampling` must outlive the rendering of the bin.
  template <class Body>
  void pass(const Sampling& sampling, ShadeAt at, Body&& body) {
    std::optional<ClosedDepth> closed;
    if (!keeps_hidden_) closed.emplace(cells_of(bin_.tile, sampling.grid));
    bin_.starts_pass(pass_, translucent_ == Translucent::alone ? Bin::Geometry::goes_on : Bin::Geometry::read_again);
    if (closed) bin_.holds("closed_depth", closed->bytes());
    const TriangleList& drawn = drawn_triangles();
    if (bin_.observer()) tell_all(drawn, sampling, at);
    for_each_batch(drawn, [&](const TriangleList& batch) {
      fragments_.clear();
      sample_raster({bin_.triangles(), bin_.tile, sampling}, batch, stage_.timed(), fragments_,
                    closed ? &*closed : nullptr);
      bin_.holds("fragment_queue", std::min(fragments_.size(), kQueueItems) * kSampleFragmentBytes);
      if (tests_alpha()) test_alpha(sampling, at, false);
      body(fragments_);
    });
  }

 private:
  const TriangleList& drawn_triangles();
  bool tests_alpha() const { return bin_.context.has_cutouts() && translucent_ != Translucent::alone; }
  void test_alpha(const Sampling& sampling, ShadeAt at, bool is_after_tests);
  void test_alpha(const Sampling& sampling, ShadeAt at, bool is_after_tests, StageCounters& counters,
                  TexelRequests* texels, std::vector<SampleFragment>& fragments) const;
  // Tells the observer which samples the triangles cover, whether hidden or not.
  void tell_all(const TriangleList& drawn, const Sampling& sampling, ShadeAt at) const;

  Bin& bin_;
  Pass pass_;
  BinStage stage_;
  std::vector<SampleFragment> fragments_;
  TriangleList drawn_;  // if not all of the bin's triangles are drawn in their order
  Translucent translucent_;
  AlphaCoverage coverage_;
  bool keeps_hidden_ = false, sorts_translucent_ = false;
};

}  // namespace beampipe
