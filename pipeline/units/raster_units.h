// The rasterizers of a bin, with what they keep on chip: pairs or sample fragments, and the depths at which pixels are
// closed.
//
// A unit is a stage as it runs in a bin, together with what it is charged: time, counters, memory traffic and on-chip
// buffers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/bins/bin.h"
#include "stages/raster/conservative_raster.h"
#include "stages/raster/sample_raster.h"

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

class ConservativeRasterUnit {
 public:
  // `buffer`: the name of the on-chip buffer that holds the pairs.
  enum class Hidden { kept, left_out };  // pairs that lie behind a triangle which covers their whole pixel
  ConservativeRasterUnit(Bin& bin, std::string buffer, PairDepths depths, Hidden hidden);

  // The pairs of the triangles in the box. They are valid until the next call.
  std::vector<Pair>& operator()(const TriangleList& triangles, const Tile& box);
  std::vector<Pair>& operator()() { return (*this)(bin_.list, bin_.tile); }

  // Another pass over the bin reads the list, the setup triangles and the closed depths from memory again.
  void start_next_pass();

  ClosedDepth& closed() { return *closed_; }  // with Hidden::left_out

 private:
  Bin& bin_;
  BinStage stage_;
  std::string buffer_;
  PairDepths depths_;
  std::optional<ClosedDepth> closed_;
  std::vector<Pair> pairs_;
};

class SampleRasterUnit {
 public:
  explicit SampleRasterUnit(Bin& bin) : bin_(bin), stage_(bin.stage("sample_raster")) {}

  // One geometry pass: calls body(fragments) for each batch of triangles. Leaves out what lies behind the cells that
  // this pass has closed so far, as a hierarchical depth buffer does.
  template <class Body>
  void pass(const Sampling& sampling, Body&& body) {
    ClosedDepth closed(cells_of(bin_.tile, sampling.grid));
    bin_.starts_geometry_pass();
    bin_.holds("closed_depth", closed.bytes());
    for_each_batch(bin_.list, [&](const TriangleList& batch) {
      fragments_.clear();
      sample_raster(bin_.triangles(), batch, bin_.tile, sampling, stage_.timed(), fragments_, &closed);
      bin_.holds("batch_fragments", fragments_.size() * kSampleFragmentBytes);
      body(fragments_);
    });
  }

 private:
  Bin& bin_;
  BinStage stage_;
  std::vector<SampleFragment> fragments_;
};

}  // namespace beampipe
