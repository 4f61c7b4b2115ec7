#include "tests/pipeline/counter_page.h"

#include <initializer_list>
#include <map>

namespace beampipe {
namespace {

// The test that covers what no other test does: a counter moves in the stages that list it, and in no others.
constexpr const char* kMoves = "CounterRegistry.EveryCounterMovesWhereItIsListed";

struct StageTests {
  const char* items;
  const char* ops;  // compares them with the scalar formulas
  const char* logical_bytes;
  const char* memory;  // sector_bytes, l2_bytes, dram_bytes
  const char* lanes;
};

const std::map<std::string, StageTests>& tests_of_stages() {
  static const std::map<std::string, StageTests> tests = {
      {"vertex_setup",
       {"HandWorked.TriangleMsaa", "SetupTwins.VertexSetup", "HandWorked.TriangleMsaa", "HandWorked.TriangleMsaa",
        kMoves}},
      {"conservative_raster",
       {"HandWorked.TriangleBeam", "RasterTwins.ConservativeRaster", "HandWorked.TriangleBeam",
        "HandWorked.TriangleBeam", "RasterTwins.ConservativeRaster"}},
      {"sample_raster",
       {"HandWorked.QuadsMsaa", "RasterTwins.SampleRaster", "HandWorked.QuadsMsaa", "HandWorked.QuadsMsaa",
        "RasterTwins.SampleRaster"}},
      {"bin_sort", {"BinSort.CountsItsWork", "BinSort.CountsItsWork", "BinSort.CountsItsWork", kMoves, kMoves}},
      {"beam_fragment",
       {"HandWorked.TriangleBeam", "FragmentTwins.OnAGrid", "HandWorked.TriangleBeam", "HandWorked.TriangleBeam",
        "FragmentTwins.OnAGrid"}},
      {"alpha_mask",
       {"AlphaMask.CountsItsWork", "AlphaMask.CountsItsWork", "AlphaMask.CountsItsWork", kMoves,
        "AlphaMask.CountsItsWork"}},
      {"shade",
       {"HandWorked.TriangleMsaa", "ShadingTwins.ShadeSampleFragmentsInQuads", "HandWorked.TriangleMsaa",
        "HandWorked.TriangleMsaa", "Counters.ShadingRunsInWholeQuads"}},
      {"light", {kMoves, "ShadingTwins.GBufferAndLight", kMoves, kMoves, "ShadingTwins.GBufferAndLight"}},
      {"a_buffer",
       {"HandWorked.TriangleBeam", "TwinCounts.Sort", "HandWorked.TriangleBeam", "HandWorked.TriangleBeam", kMoves}},
      {"windows",
       {"HandWorked.TriangleBeam", "WindowTwins.Windows", "HandWorked.TriangleBeam", "HandWorked.TriangleBeam",
        kMoves}},
      {"compose",
       {"HandWorked.TriangleBeam",
        "ComposeTwins.ComposeWindow, MergeTwins.Compose, MergeTwins.Over, MergeTwins.ComposeZ3",
        "HandWorked.TriangleBeam", "HandWorked.TriangleBeam", "ComposeTwins.ComposeWindow"}},
      {"alpha_test",
       {"AlphaTest.CountsItsWork", "AlphaTest.CountsItsWork", "AlphaTest.CountsItsWork", kMoves,
        "AlphaTest.CountsItsWork"}},
      {"depth_test",
       {"HandWorked.QuadsMsaa", "TwinCounts.DepthTest", "HandWorked.QuadsMsaa", "HandWorked.QuadsMsaa",
        "TwinCounts.DepthTest"}},
      {"blend", {"Blend.CountsItsWork", "Blend.CountsItsWork", "Blend.CountsItsWork", kMoves, "Blend.CountsItsWork"}},
      {"stencil_test",
       {"Acaa.ReadsDepthTwiceAndOneColor", "ShadingTwins.StencilTest", kMoves, kMoves, "ShadingTwins.StencilTest"}},
      {"accumulate",
       {"Acaa.ReadsDepthTwiceAndOneColor", "TwinCounts.Accumulate", "Acaa.ReadsDepthTwiceAndOneColor", kMoves,
        "TwinCounts.Accumulate"}},
      {"sample_select", {kMoves, "SelectTwins.SampleSelect", kMoves, kMoves, "SelectTwins.SampleSelect"}},
      {"material_sort",
       {"MaterialSort.CountsItsWork", "MaterialSort.CountsItsWork", "MaterialSort.CountsItsWork", kMoves,
        "MaterialSort.CountsItsWork"}},
      {"motion",
       {"Motion.CountsItsArithmetic", "TemporalTwins.Motion, TemporalTwins.Contents", "Motion.CountsItsArithmetic",
        kMoves, kMoves}},
      {"dilate", {"Dilate.CountsWhatItLooksAt", "TemporalTwins.Dilate", "Dilate.CountsWhatItLooksAt", kMoves, kMoves}},
      {"temporal",
       {"Temporal.CountsWhatItLooksAt", "TemporalTwins.Temporal, TemporalTwins.NeighborhoodBox",
        "Temporal.CountsWhatItLooksAt", kMoves, kMoves}},
      {"resolve",
       {"HandWorked.TriangleMsaa", "ShadingTwins.ResolveSamples, Resolve.MeanInReinhardsSpace",
        "HandWorked.TriangleMsaa", "HandWorked.TriangleMsaa", "ShadingTwins.ResolveSamples"}},
      {"reference_raster",
       {"HandWorked.TriangleReference", "ReferenceRaster.FansCoverEverySample", kMoves, kMoves,
        "ReferenceRaster.FansCoverEverySample"}},
  };
  return tests;
}

const std::map<std::string, std::string>& tests_of_pixel_counters() {
  static const std::string corners = "Counters.PixelsOfFourCornersAndASpeck";
  static const std::map<std::string, std::string> tests = {
      {"fragments", corners},
      {"bytes", "HandWorked.BytesOfAPixel"},
      {"centroids", "Msaa.TheCentroidIsForFragmentsThatOneSampleMisses"},
      {"merges", corners},
      {"tiny_triangles", corners},
      {"largest_window", corners},
      {"visible_fragments", corners},
      {"quads_of_1", "Dvm.QuadsAreCountedByTheirMaterials"},
      {"quads_of_2", "Dvm.QuadsAreCountedByTheirMaterials"},
      {"quads_of_3", "Dvm.QuadsAreCountedByTheirMaterials"},
      {"quads_of_4", "Dvm.QuadsAreCountedByTheirMaterials"},
      {"quads_of_5_or_more", "Dvm.QuadsAreCountedByTheirMaterials"},
      {"partial_quads", "Dvm.QuadsAreCountedByTheirMaterials"},
      {"motion", "Msaa.MotionIsThatOfTheNearestSurface"},
      {"unknown", "CounterRegistry.EveryPixelCounterMovesSomewhere"},
      {"error", "PixelErrors.AreTheRootOfTheMeanSquareOfTheChannels"},
      {"visibility_error", "SplitError.PartsOfEachValueAddUpToItsError"},
      {"shading_error", "SplitError.PartsOfEachValueAddUpToItsError"},
      {"cause_leak", "ErrorCauses.TheBackgroundLeaksThroughTwoTrianglesThatOverTakesForIndependent"},
      {"cause_mask", "ErrorCauses.AnOutlineBetweenPositionsIsTheMasks"},
      {"cause_order", "ErrorCauses.WhatIsNearerButSortedBehindIsOutOfOrder"},
      {"cause_interpenetration", "ErrorCauses.CrossingTrianglesInterpenetrate"},
      {"cause_tiny", "ErrorCauses.FansOfTinyTrianglesLeak"},
      {"cause_mixed", "ErrorCauses.RedGivesWayWhereGreenIsHidden"},
      {"cause_rounding", "ErrorCauses.PartsAddUpToEachPixelsError"},
  };
  return tests;
}

const std::map<std::string, std::string>& tests_of_frame_counters() {
  static const std::string keys = "ReportJson.HasTheKeysOfTheContract";
  static const std::map<std::string, std::string> tests = {
      {"logical_bytes, sector_bytes, l2_bytes, dram_bytes", keys},
      {"a_buffer_peak_bytes", "BeamSorted.CountsEveryTouchedPixel"},
      {"buffers", "Buffers.AreWhatIsAllocated"},
      {"peak_bytes_per_pixel", keys},
      {"on_chip_bytes_per_pixel", "Beam.BuffersHaveTheSameSizeHoweverDeepAPixelIs"},
      {"off_chip_bytes_per_pixel", keys},
      {"bin_pixels", keys},
      {"pixel_counters", keys},
      {"saved", "SavedWork.IsFoundFromTheStages"},
      {"wall_ms", keys},
      {"modelled_ms", "Hardware.OverlapIsTheBusiestUnitAndSumEachStagesBusiest"},
  };
  return tests;
}

std::string row(std::initializer_list<std::string> cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

// A name, or several with ", " between them, as code.
std::string code(std::string names) {
  for (std::size_t at = 0; (at = names.find(", ", at)) != names.npos; at += 4) names.replace(at, 2, "`, `");
  return "`" + names + "`";
}

// What the counter counts in this stage.
std::string meaning(const StageInfo& stage, const CounterInfo& counter) {
  const std::string name = counter.name;
  if (name == "items_in") return stage.items_in;
  if (name == "items_out") return stage.items_out;
  if (name == "lanes_used") return stage.lanes_used;
  if (name == "lanes_issued") return stage.lanes_issued;
  return counter.meaning;
}

}  // namespace

std::string tests_of(const StageInfo& stage, const CounterInfo& counter) {
  const StageTests& tests = tests_of_stages().at(stage.name);
  const std::string name = counter.name;
  if (name == "ops.wide") return kMoves;  // twins may use 64 bits where the stage does not
  if (name.starts_with("ops.")) return tests.ops;
  if (name == "position_tests") return stage.name == std::string("compose") ? "MergeTwins.Compose" : kMoves;
  if (name.starts_with("lanes_")) return tests.lanes;
  if (name.starts_with("hidden_") || name == "empty_tiles") return "Counters.WhatIsHiddenIsCountedOnce";
  if (name.starts_with("texture_"))
    return std::string("TextureMemory.") +
           (std::string(stage.name) == "shade"
                ? "CountsTheTexelsOfEachInvocation, TextureMemory.AQuadAsksForASectorOnce"
                : "ReadingAlphaIsChargedToItsStage");
  if (name == "sector_bytes" || name == "l2_bytes" || name == "dram_bytes") return tests.memory;
  return name.find("bytes") == std::string::npos ? tests.items : tests.logical_bytes;
}

std::string tests_of(const PixelCounterInfo& counter) { return tests_of_pixel_counters().at(counter.name); }
std::string tests_of(const FrameCounterInfo& counter) { return tests_of_frame_counters().at(counter.name); }

std::string counters_page() {
  std::string page =
      "# Counters\n\n"
      "The test `CounterRegistry.ThePageIsWhatTheRegistrySays` generates this page from `stages/cost/counters.cpp` "
      "and\n"
      "`stages/cost/counter_registry.cpp`. Tests fail when this page differs from the registry, when a technique has a "
      "stage\nor a pixel counter that is not listed here, when a counter never moves in a stage that lists it or moves "
      "in a stage that\ndoes not, and when a test named here does not exist. [accounting.md](accounting.md) explains "
      "the columns of bytes.\n\n"
      "The operations of a stage are those of its scalar formulas, which are run on numbers that "
      "count.\n`CounterRegistry.EveryCounterMovesWhereItIsListed` only tests that a counter moves, not its value.\n\n"
      "The stages of a depth pre-pass are counted apart, as `prepass_vertex_setup`, `prepass_sample_raster`,\n"
      "`prepass_alpha_test` and `prepass_depth_test`. Their counters are those of the stages without `prepass_`. "
      "`acaa`,\n"
      "`deferred`, `msaa:N,prepass` and `taa:N` with deferred or forward shading have such a pass.\n\n"
      "## Of every stage\n\n";
  page += row({"counter", "unit", "what it counts"}) + "|---|---|---|\n";
  for (const CounterInfo& counter : stage_counters()) page += row({code(counter.name), counter.unit, counter.meaning});
  for (const StageInfo& stage : stage_list()) {
    page += "\n## " + code(stage.name) + "\n\n" + row({"counter", "unit", "what it counts", "test"}) +
            "|---|---|---|---|\n";
    for (const CounterInfo& counter : stage_counters())
      if (has_counter(stage, counter))
        page += row({code(counter.name), counter.unit, meaning(stage, counter), code(tests_of(stage, counter))});
  }
  page += "\n## Of a pixel\n\n" + row({"counter", "unit", "what it counts", "techniques", "test"}) +
          "|---|---|---|---|---|\n";
  for (const auto* counters : {&pixel_counters(), &error_counters()})
    for (const PixelCounterInfo& counter : *counters)
      page += row({code(counter.name), counter.unit, counter.meaning, counter.techniques, code(tests_of(counter))});
  page += "\n## Of a frame\n\n" + row({"counter", "unit", "what it is", "test"}) + "|---|---|---|---|\n";
  for (const FrameCounterInfo& counter : frame_counters())
    page += row({code(counter.name), counter.unit, counter.meaning, code(tests_of(counter))});
  return page;
}

}  // namespace beampipe
