#include "stages/cost/counter_registry.h"

#include <initializer_list>

namespace beampipe {
namespace {

// Where no other test does: the counter moves there, and nowhere that it is not listed.
constexpr const char* kMoves = "CounterRegistry.EveryCounterMovesWhereItIsListed";

constexpr const char* kPixelMoves = "CounterRegistry.EveryPixelCounterMovesSomewhere";
constexpr const char* kCorners = "Counters.PixelsOfFourCornersAndASpeck";

std::string row(std::initializer_list<std::string> cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

// Also of several, with ", " between them.
std::string code(std::string names) {
  for (std::size_t at = 0; (at = names.find(", ", at)) != names.npos; at += 4) names.replace(at, 2, "`, `");
  return "`" + names + "`";
}

// What adds to a counter in that stage.
std::string meaning(const StageInfo& stage, const CounterInfo& counter) {
  const std::string name = counter.name;
  if (name == "items_in") return stage.items_in;
  if (name == "items_out") return stage.items_out;
  const std::string lanes = stage.lanes;
  const std::size_t out_of = lanes.find(" out of ");
  if (out_of == lanes.npos) return name.starts_with("lanes_") ? lanes : counter.meaning;
  if (name == "lanes_used") return lanes.substr(0, out_of);
  return name == "lanes_issued" ? lanes.substr(out_of + 8) : counter.meaning;
}

}  // namespace

const std::vector<CounterInfo>& stage_counters() {
  using S = StageCounters;
  static const std::vector<CounterInfo> counters = {
      {"items_in", "items in", "items", "what comes into the stage", [](const S& s) { return s.items_in; }},
      {"items_out", "items out", "items", "what goes out of it", [](const S& s) { return s.items_out; }},
      {"ops.total", "operations", "operations", "all kinds together", [](const S& s) { return s.ops.total(); }},
      {"ops.mul_add", "mul-add", "operations", "multiplications; an addition behind one is an `ops.add`",
       [](const S& s) { return s.ops.mul_add; }},
      {"ops.add", "add", "operations", "additions, subtractions, comparisons, minima, maxima, selections",
       [](const S& s) { return s.ops.add; }},
      {"ops.bit", "bit", "operations", "and, or, not, absolute values, population counts",
       [](const S& s) { return s.ops.bit; }},
      {"ops.fetch", "fetch", "operations", "table look-ups", [](const S& s) { return s.ops.fetch; }},
      {"ops.special", "special", "operations", "divisions, remainders, square roots, arc tangents",
       [](const S& s) { return s.ops.special; }},
      {"ops.convert", "convert", "operations", "between integer and float, float and fp16 or normalized formats",
       [](const S& s) { return s.ops.convert; }},
      {"bytes_read", "read", "bytes",
       "logical: what the stage reads, each time it reads it, queues between stages included",
       [](const S& s) { return s.bytes_read; }},
      {"bytes_written", "written", "bytes", "logical: what it writes", [](const S& s) { return s.bytes_written; }},
      {"logical_bytes", "logical", "bytes", "bytes_read + bytes_written", [](const S& s) { return s.logical_bytes(); }},
      {"sector_bytes", "sectors", "bytes",
       "asked of the memory system in sectors of 32 bytes, read and written; nothing for queues on chip",
       [](const S& s) { return s.sector_bytes; }},
      {"l2_bytes", "L2", "bytes",
       "asked of L2 in sectors: what ROP caches and L1 do not hold, and what they write back or through",
       [](const S& s) { return s.l2_bytes; }},
      {"dram_bytes", "DRAM", "bytes", "moved to and from DRAM behind the modelled caches, read and written",
       [](const S& s) { return s.dram_bytes; }},
      {"lanes_used", "lanes used", "lanes", "lanes with work", [](const S& s) { return s.lanes_used; }},
      {"lanes_issued", "lanes issued", "lanes", "lanes that ran", [](const S& s) { return s.lanes_issued; }},
      {"hidden_items", "hidden", "items",
       "pairs (of samples' techniques cells) that a triangle touches and that are left out behind another, which "
       "covers "
       "the whole pixel (cell)",
       [](const S& s) { return s.hidden_items; }},
      {"hidden_triangles", "hidden triangles", "triangles",
       "left out of a tile whose every pixel (cell) is closed before them, once for each tile, in each pass",
       [](const S& s) { return s.hidden_triangles; }},
      {"empty_tiles", "empty tiles", "tiles", "tiles that no triangle touches, in each pass",
       [](const S& s) { return s.empty_tiles; }},
  };
  return counters;
}

const std::vector<StageInfo>& stage_list() {
  static const std::vector<StageInfo> stages = {
      {"vertex_setup", "triangles of the draws, in each pass", "setup triangles, in each pass", "", " ops.fetch ",
       "HandWorked.TriangleMsaa", "SetupTwins.VertexSetup", "HandWorked.TriangleMsaa", "HandWorked.TriangleMsaa",
       kMoves},
      {"conservative_raster", "setup triangles", "(pixel, triangle) pairs that touch and may be seen",
       "touched out of tested pixels", " ops.fetch ops.special ", "HandWorked.TriangleBeam",
       "RasterTwins.ConservativeRaster", "HandWorked.TriangleBeam", "HandWorked.TriangleBeam",
       "RasterTwins.ConservativeRaster"},
      {"sample_raster", "setup triangles, in each pass", "(cell, triangle) pairs with a sample",
       "covered samples out of those of partly covered cells", " ops.fetch ops.special ", "HandWorked.QuadsMsaa",
       "RasterTwins.SampleRaster", "HandWorked.QuadsMsaa", "HandWorked.QuadsMsaa", "RasterTwins.SampleRaster"},
      {"beam_fragment", "(pixel, triangle) pairs", "fragments: pairs with area", "fragments out of pairs", "",
       "HandWorked.TriangleBeam", "FragmentTwins.OnAGrid", "HandWorked.TriangleBeam", "HandWorked.TriangleBeam",
       "FragmentTwins.OnAGrid"},
      {"shade", "fragments (or shading samples)", "the same, with colour or material",
       "fragments out of the pixels of their 2x2 quads; behind visibility one by one", " ops.fetch ",
       "HandWorked.TriangleMsaa", "ShadingTwins.ShadeSampleFragmentsInQuads", "HandWorked.TriangleMsaa",
       "HandWorked.TriangleMsaa", "Counters.ShadingRunsInWholeQuads"},
      {"light", "pixels with a material", "the same, with colour", "all", " ops.bit ops.fetch ops.special ops.convert ",
       kMoves, "ShadingTwins.GBufferAndLight", kMoves, kMoves, "ShadingTwins.GBufferAndLight"},
      {"a_buffer", "pairs (beam), fragments (published)", "the same, sorted per pixel", "",
       " ops.mul_add ops.bit ops.fetch ops.special ops.convert ", "HandWorked.TriangleBeam", "TwinCounts.Sort",
       "HandWorked.TriangleBeam", "HandWorked.TriangleBeam", kMoves},
      {"windows", "pairs, near to far", "windows of pairs that overlap in depth", "",
       " ops.mul_add ops.bit ops.fetch ops.special ops.convert l2_bytes dram_bytes ", "HandWorked.TriangleBeam",
       "WindowTwins.Windows", "HandWorked.TriangleBeam", "HandWorked.TriangleBeam", kMoves},
      {"compose", "fragments", "aggregates: windows (beam), pixels (others)",
       "compared positions out of those of all fragments looked at", "", "HandWorked.TriangleBeam",
       "ComposeTwins.ComposeWindow, MergeTwins.Compose, MergeTwins.Over, MergeTwins.ComposeZ3",
       "HandWorked.TriangleBeam", "HandWorked.TriangleBeam", "ComposeTwins.ComposeWindow"},
      {"claim", "fragments, in each pass", "fragments that took a position",
       "fragments that took a position out of all", " ops.special ", "Claim.CountsWhatItReadsAndWrites",
       "TwinCounts.Claim", "Claim.CountsWhatItReadsAndWrites", kMoves, "TwinCounts.Claim"},
      {"settle", "owners' fragments, in each pass", "pixels that need another pass", "owners, all", " ops.fetch ",
       "Settle.CountsItsArithmetic", "SettleTwins.Settle", "Settle.CountsItsArithmetic", kMoves,
       "Settle.CountsItsArithmetic"},
      {"depth_test", "samples tested, in each pass", "samples that passed",
       "samples tested out of those of their cells", " ops.bit ops.fetch ops.special ", "HandWorked.QuadsMsaa",
       "TwinCounts.DepthTest", "HandWorked.QuadsMsaa", "HandWorked.QuadsMsaa", "TwinCounts.DepthTest"},
      {"stencil_test", "samples tested", "samples that passed", "all",
       " ops.mul_add ops.bit ops.fetch ops.special ops.convert ", "Counters.AcaaReadsDepthTwiceAndOneColor",
       "ShadingTwins.StencilTest", kMoves, kMoves, "ShadingTwins.StencilTest"},
      {"accumulate", "fragments with visible samples", "the same, added", "all", " ops.fetch ops.special ",
       "Counters.AcaaReadsDepthTwiceAndOneColor", "TwinCounts.Accumulate", "Counters.AcaaReadsDepthTwiceAndOneColor",
       kMoves, "TwinCounts.Accumulate"},
      {"sample_select", "visibility samples", "shading samples",
       "shading samples with a triangle, out of four per quad", " ops.fetch ops.convert ", kMoves,
       "SelectTwins.SampleSelect", kMoves, kMoves, "SelectTwins.SampleSelect"},
      {"motion", "samples", "motion vectors: pixels", "pixels that show a triangle out of all", "",
       "Motion.CountsItsArithmetic", "TemporalTwins.Motion, TemporalTwins.Contents", "Motion.CountsItsArithmetic",
       kMoves, kMoves},
      {"dilate", "pixels", "pixels with a colour", "pixels of which something is known out of all", " ops.fetch ",
       "Dilate.CountsWhatItLooksAt", "TemporalTwins.Dilate", "Dilate.CountsWhatItLooksAt", kMoves, kMoves},
      {"temporal", "pixels", "pixels", "pixels with a history out of all", " ops.bit ops.fetch ",
       "Temporal.CountsWhatItLooksAt", "TemporalTwins.Temporal, TemporalTwins.NeighborhoodBox",
       "Temporal.CountsWhatItLooksAt", kMoves, kMoves},
      {"resolve", "samples, or aggregates, or accumulators", "pixels of the picture", "all",
       " ops.bit ops.fetch ops.special ", "HandWorked.TriangleMsaa", "ShadingTwins.ResolveSamples",
       "HandWorked.TriangleMsaa", "HandWorked.TriangleMsaa", "ShadingTwins.ResolveSamples"},
      {"reference_raster", "setup triangles", "samples that were nearer", "all",
       " ops.bit ops.fetch ops.special ops.convert bytes_written sector_bytes l2_bytes dram_bytes hidden_items "
       "hidden_triangles ",
       "HandWorked.TriangleReference", "ReferenceRaster.FansCoverEverySample", kMoves, kMoves,
       "ReferenceRaster.FansCoverEverySample"},
  };
  return stages;
}

bool has_counter(const StageInfo& stage, const CounterInfo& counter) {
  const std::string name = counter.name;
  if (name.starts_with("lanes_")) return *stage.lanes != '\0';
  const bool rasterizes = std::string(stage.name).ends_with("_raster");
  if ((name.starts_with("hidden_") || name == "empty_tiles") && !rasterizes) return false;
  return std::string(stage.silent).find(" " + name + " ") == std::string::npos;
}

const char* test_of(const StageInfo& stage, const CounterInfo& counter) {
  const std::string name = counter.name;
  if (name.starts_with("ops.")) return stage.ops_test;
  if (name.starts_with("lanes_")) return stage.lanes_test;
  if (name.starts_with("hidden_") || name == "empty_tiles") return "Counters.WhatIsHiddenIsCountedOnce";
  if (name == "sector_bytes" || name == "l2_bytes" || name == "dram_bytes") return stage.memory_test;
  return name.find("bytes") == std::string::npos ? stage.items_test : stage.logical_test;
}

const std::vector<PixelCounterInfo>& pixel_counters() {
  static const std::vector<PixelCounterInfo> counters = {
      {"fragments", "fragments", "triangles with a fragment in the pixel; of acaa beyond 16 samples in each round",
       "all but reference", kCorners},
      {"bytes", "bytes",
       "logical bytes of the framebuffer's surfaces and the A-buffer, where memory is modelled; without passes that "
       "read "
       "all of a surface, each pixel once, and what accumulates over time",
       "all but reference", "HandWorked.BytesOfAPixel"},
      {"centroids", "fragments", "fragments that are shaded at the centroid, their triangle not covering the centre",
       "msaa:N,at=centroid", "Msaa.TheCentroidIsForFragmentsThatOneSampleMisses"},
      {"merges", "fragments",
       "fragments that were looked at before the pixel was full; of z3, layers that became one with another",
       "beam, alpha, z3", kCorners},
      {"tiny_triangles", "fragments", "fragments that cover no mask position", "beam", kCorners},
      {"largest_window", "fragments", "fragments of the largest window of overlapping depths", "beam", kCorners},
      {"visible_fragments", "fragments", "triangles with a visible sample in the pixel", "acaa", kCorners},
      {"passes", "passes", "passes over the triangles until the pixel was settled", "beam:order=stream", kCorners},
      {"unknown", "part of the pixel", "what no shading sample was given to", "dvm", kPixelMoves},
  };
  return counters;
}

const std::vector<PixelCounterInfo>& error_counters() {
  constexpr const char *kUnit = "linear light, 0..1", *kCauses = "compare --causes: beam, alpha",
                       *kCausesTest = "ErrorCauses.PartsAddUpToEachPixelsError";
  static const std::vector<PixelCounterInfo> counters = {
      {"error", kUnit, "root of the mean square error over R, G and B against the reference", "compare",
       "PixelErrors.AreTheRootOfTheMeanSquareOfTheChannels"},
      {"cause_leak", kUnit, "part of the pixel's error: a triangle that is hidden altogether shows", kCauses,
       "ErrorCauses.TheBackgroundLeaksThroughTwoTrianglesThatOverTakesForIndependent"},
      {"cause_mask", kUnit, "part of the pixel's error: an outline is in the wrong place between mask positions",
       kCauses, "ErrorCauses.AnOutlineBetweenPositionsIsTheMasks"},
      {"cause_order", kUnit, "part of the pixel's error: of two triangles the farther was taken for the nearer",
       kCauses, "ErrorCauses.WhatIsNearerButSortedBehindIsOutOfOrder"},
      {"cause_interpenetration", kUnit, "part of the pixel's error: two triangles are each nearer somewhere", kCauses,
       "ErrorCauses.CrossingTrianglesInterpenetrate"},
      {"cause_tiny", kUnit, "part of the pixel's error: a triangle covers no mask position", kCauses,
       "ErrorCauses.FansOfTinyTrianglesLeak"},
      {"cause_mixed", kUnit, "part of the pixel's error: one gave way in place of another that was merged before it",
       kCauses, "ErrorCauses.RedGivesWayWhereGreenIsHidden"},
      {"cause_rounding", kUnit, "part of the pixel's error: what weights do not explain, fp16 colours", kCauses,
       kCausesTest},
  };
  return counters;
}

const std::vector<FrameCounterInfo>& frame_counters() {
  static const std::vector<FrameCounterInfo> counters = {
      {"logical_bytes, sector_bytes, l2_bytes, dram_bytes", "bytes", "sums over the stages",
       "ReportJson.HasTheKeysOfTheContract"},
      {"a_buffer_peak_bytes", "bytes", "of the whole frame's A-buffer, which stands in memory until it is composed",
       "Counters.BeamCountsEveryTouchedPixel"},
      {"buffers", "bytes", "peak bytes of every buffer: of the frame, or of the bin that needs the most",
       "Buffers.AreWhatIsAllocated"},
      {"peak_bytes_per_pixel", "bytes per pixel",
       "of a technique: its framebuffer and, in the frame where it is largest, its A-buffer",
       "ReportJson.HasTheKeysOfTheContract"},
      {"pixel_counters", "as the counter's", "mean and max over the pixels of each counter of a pixel",
       "ReportJson.HasTheKeysOfTheContract"},
      {"saved", "see the page",
       "work that was not done, found from the stages' counters: hidden_pairs or hidden_cells, what raster left out "
       "behind "
       "triangles which cover their pixel or cell; hidden_triangles, left out of a whole tile; empty_tiles; "
       "whole_pixels, "
       "which took the short way; pairs_behind_closed, pairs in the A-buffer that nothing looked at",
       "SavedWork.IsFoundFromTheStages"},
      {"wall_ms", "milliseconds",
       "of the simulator on this machine; with_memory_model says whether the model's own time is in it, and "
       "modelling_run, with --repeat, how long the rendering took that it was in",
       "ReportJson.HasTheKeysOfTheContract"},
      {"modelled_ms", "milliseconds", "of the described hardware: overlap, the busiest unit; sum, stage after stage",
       "Hardware.OverlapIsTheBusiestUnitAndSumEachStagesBusiest"},
  };
  return counters;
}

std::string counters_page() {
  std::string page =
      "# Counters\n\n"
      "Made from `stages/cost/counter_registry.cpp`, which the program writes `report.json` from. The tests "
      "`CounterRegistry.*` fail when\nthis page is not what the registry says, when a technique has a stage or a pixel "
      "counter that is not here, when a counter never\nmoves in a stage that lists it or moves in one that does not, "
      "and when there is no test of a name that stands here. What the\ncolumns of bytes mean: "
      "[accounting.md](accounting.md).\n\n"
      "Operations are those of the stage's scalar twin on counting numbers. Where the test is "
      "`CounterRegistry.EveryCounterMovesWhereItIsListed`,\nnothing but that is tested of the counter there.\n\n"
      "## Of every stage\n\n";
  page += row({"counter", "unit", "what adds to it"}) + "|---|---|---|\n";
  for (const CounterInfo& counter : stage_counters()) page += row({code(counter.name), counter.unit, counter.meaning});
  for (const StageInfo& stage : stage_list()) {
    page += "\n## " + code(stage.name) + "\n\n" + row({"counter", "unit", "what adds to it", "test"}) +
            "|---|---|---|---|\n";
    for (const CounterInfo& counter : stage_counters())
      if (has_counter(stage, counter))
        page += row({code(counter.name), counter.unit, meaning(stage, counter), code(test_of(stage, counter))});
  }
  page += "\n## Of a pixel\n\n" + row({"counter", "unit", "what it counts", "techniques", "test"}) +
          "|---|---|---|---|---|\n";
  for (const PixelCounterInfo& counter : pixel_counters())
    page += row({code(counter.name), counter.unit, counter.meaning, counter.techniques, code(counter.test)});
  for (const PixelCounterInfo& counter : error_counters())
    page += row({code(counter.name), counter.unit, counter.meaning, counter.techniques, code(counter.test)});
  page += "\n## Of a frame\n\n" + row({"counter", "unit", "what it is", "test"}) + "|---|---|---|---|\n";
  for (const FrameCounterInfo& counter : frame_counters())
    page += row({code(counter.name), counter.unit, counter.meaning, code(counter.test)});
  return page;
}

}  // namespace beampipe
