#include "stages/counter_registry.h"

namespace beampipe {

const std::vector<CounterInfo>& stage_counters() {
  using S = StageCounters;
  static const std::vector<CounterInfo> counters = {
      {"items_in", "items in", "items", "what comes into the stage", [](const S& s) { return s.items_in; }},
      {"items_out", "items out", "items", "what goes out of it", [](const S& s) { return s.items_out; }},
      {"ops.total", "operations", "operations", "all kinds together", [](const S& s) { return s.ops.total(); }},
      {"ops.mul_add", "mul-add", "operations", "multiplications, with or without an addition behind them",
       [](const S& s) { return s.ops.mul_add; }},
      {"ops.add", "add", "operations", "additions, subtractions, comparisons, minima, maxima, selections",
       [](const S& s) { return s.ops.add; }},
      {"ops.bit", "bit", "operations", "and, or, not, absolute values, population counts",
       [](const S& s) { return s.ops.bit; }},
      {"ops.fetch", "fetch", "operations", "table look-ups", [](const S& s) { return s.ops.fetch; }},
      {"ops.special", "special", "operations", "divisions and square roots", [](const S& s) { return s.ops.special; }},
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
      {"dram_bytes", "DRAM", "bytes", "moved to and from DRAM behind the modelled caches, read and written",
       [](const S& s) { return s.dram_bytes; }},
      {"lanes_used", "lanes used", "lanes", "lanes with work", [](const S& s) { return s.lanes_used; }},
      {"lanes_issued", "lanes issued", "lanes", "lanes that ran", [](const S& s) { return s.lanes_issued; }},
  };
  return counters;
}

const std::vector<StageInfo>& stage_list() {
  static const std::vector<StageInfo> stages = {
      {"vertex_setup", "triangles of the draws, in each pass", "setup triangles, in each pass", "not counted",
       "HandWorked.TriangleMsaa"},
      {"conservative_raster", "setup triangles", "(pixel, triangle) pairs that touch and may be seen",
       "touched out of tested pixels", "Counters.BeamCountsEveryTouchedPixel"},
      {"sample_raster", "setup triangles, in each pass", "(cell, triangle) pairs with a sample",
       "covered samples out of those of partly covered cells", "HandWorked.TriangleMsaa"},
      {"beam_fragment", "(pixel, triangle) pairs", "fragments: pairs with area", "fragments out of pairs",
       "Counters.BeamCountsEveryTouchedPixel"},
      {"shade", "fragments (or shading samples)", "the same, with colour or material",
       "fragments out of the pixels of their 2x2 quads; behind visibility one by one",
       "Counters.ShadingRunsInWholeQuads"},
      {"light", "pixels with a material", "the same, with colour", "all", "Counters.ShadingRunsInWholeQuads"},
      {"a_buffer", "pairs (beam), fragments (published)", "the same, sorted per pixel", "not counted",
       "HandWorked.TriangleBeam"},
      {"compose", "fragments", "aggregates: windows (beam), pixels (others)",
       "compared positions out of those of all fragments looked at", "HandWorked.TriangleBeam"},
      {"claim", "fragments, in each pass", "fragments that took a position",
       "fragments that took a position out of all", "TwinCounts.Claim"},
      {"settle", "owners' fragments, in each pass", "pixels that need another pass", "owners, all",
       "Settle.CountsItsArithmetic"},
      {"depth_test", "samples tested, in each pass", "samples that passed",
       "samples tested out of those of their cells", "HandWorked.QuadsMsaa"},
      {"stencil_test", "samples tested", "samples that passed", "all", "Counters.AcaaReadsDepthTwiceAndOneColor"},
      {"accumulate", "fragments with visible samples", "the same, added", "all",
       "Counters.AcaaReadsDepthTwiceAndOneColor"},
      {"sample_select", "visibility samples", "shading samples",
       "shading samples with a triangle, out of four per quad", "CounterRegistry.EveryCounterMovesSomewhere"},
      {"motion", "samples", "motion vectors: pixels", "pixels that show a triangle out of all",
       "Motion.CountsItsArithmetic"},
      {"dilate", "pixels", "pixels with a colour", "pixels of which something is known out of all",
       "Dilate.CountsWhatItLooksAt"},
      {"temporal", "pixels", "pixels", "pixels with a history out of all", "Temporal.CountsWhatItLooksAt"},
      {"resolve", "samples, or aggregates, or accumulators", "pixels of the picture", "all", "HandWorked.TriangleMsaa"},
      {"reference_raster", "setup triangles", "samples that were nearer", "all",
       "CounterRegistry.EveryCounterMovesSomewhere"},
  };
  return stages;
}

const std::vector<PixelCounterInfo>& pixel_counters() {
  static const std::vector<PixelCounterInfo> counters = {
      {"fragments", "fragments", "triangles with a fragment in the pixel", "beam, alpha, msaa, visibility",
       "CounterRegistry.EveryPixelCounterMovesSomewhere"},
      {"bytes", "bytes", "logical bytes of the framebuffer's surfaces and the A-buffer, where memory is modelled",
       "beam, alpha, z3, msaa, acaa, visibility", "HandWorked.BytesOfAPixel"},
      {"merges", "fragments", "fragments that were looked at before the pixel was full", "beam, alpha",
       "CounterRegistry.EveryPixelCounterMovesSomewhere"},
      {"tiny_triangles", "fragments", "fragments that cover no mask position", "beam",
       "CounterRegistry.EveryPixelCounterMovesSomewhere"},
      {"largest_window", "fragments", "fragments of the largest window of overlapping depths", "beam",
       "CounterRegistry.EveryPixelCounterMovesSomewhere"},
      {"visible_fragments", "fragments", "triangles with a visible sample in the pixel", "acaa",
       "CounterRegistry.EveryPixelCounterMovesSomewhere"},
      {"passes", "passes", "passes over the triangles until the pixel was settled", "beam:order=stream",
       "CounterRegistry.EveryPixelCounterMovesSomewhere"},
      {"unknown", "part of the pixel", "what no shading sample was given to", "dvm",
       "CounterRegistry.EveryPixelCounterMovesSomewhere"},
  };
  return counters;
}

std::string counters_page() {
  std::string page =
      "# Counters\n\n"
      "Made from `stages/counter_registry.cpp`, which the program writes `report.json` from; the test "
      "`CounterRegistry` "
      "fails when this\npage is not what the registry says, when a technique has a stage or a pixel counter that is "
      "not "
      "here, or when a counter never\nmoves. What the three columns of bytes mean: [accounting.md](accounting.md).\n\n"
      "## Of a stage\n\n| counter | unit | what adds to it |\n|---|---|---|\n";
  for (const CounterInfo& counter : stage_counters())
    page += std::string("| `") + counter.name + "` | " + counter.unit + " | " + counter.meaning + " |\n";
  page += "\n## Stages\n\n| stage | items in | items out | lanes used out of issued | test |\n|---|---|---|---|---|\n";
  for (const StageInfo& stage : stage_list())
    page += std::string("| `") + stage.name + "` | " + stage.items_in + " | " + stage.items_out + " | " + stage.lanes +
            " | `" + stage.test + "` |\n";
  page += "\n## Of a pixel\n\n| counter | unit | what it counts | techniques | test |\n|---|---|---|---|---|\n";
  for (const PixelCounterInfo& counter : pixel_counters())
    page += std::string("| `") + counter.name + "` | " + counter.unit + " | " + counter.meaning + " | " +
            counter.techniques + " | `" + counter.test + "` |\n";
  page +=
      "\n## Of a frame\n\n| counter | unit | what it is |\n|---|---|---|\n"
      "| `logical_bytes`, `sector_bytes`, `dram_bytes` | bytes | sums over the stages |\n"
      "| `a_buffer_peak_bytes` | bytes | of the whole frame's A-buffer, which stands in memory until it is composed |\n"
      "| `buffers` | bytes | peak bytes of every buffer of the frame |\n"
      "| `wall_ms` | milliseconds | of the simulator on this machine; `with_memory_model` says whether the model's own "
      "time is in it, and `modelling_run`, with `--repeat`, how long the rendering took that it was in |\n"
      "| `modelled_ms` | milliseconds | of the described hardware: `overlap`, the busiest unit; `sum`, stage after "
      "stage |\n";
  return page;
}

}  // namespace beampipe
