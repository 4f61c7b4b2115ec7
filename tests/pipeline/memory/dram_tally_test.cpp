// Bytes of DRAM and L2 by array: they add up to those of the stages, and are right where they can be worked out.

#include "pipeline/memory/dram_tally.h"

#include "pipeline/technique_table.h"
#include "tests/pipeline/surface_traces.h"
#include "tests/pipeline/test_pictures.h"

namespace beampipe::dram_tally_test {
namespace {

void expect_sums(const std::string& spec, const Trace& trace, const FrameInput& run) {
  const FrameResult result = parse_technique(spec).render(trace, 0, run);
  std::map<Stage, std::uint64_t> sums, of_l2;
  for (const ArrayBytes& each : result.dram_arrays) {
    sums[each.stage] += each.read + each.written;
    of_l2[each.stage] += each.l2;
    EXPECT_LE(each.compressed, each.read + each.written) << spec << ' ' << each.stage << ' ' << each.array;
    EXPECT_FALSE(each.array.empty());
  }
  for (const StageCounters& stage : result.stages) {
    EXPECT_EQ(sums[stage.stage], stage.dram_bytes) << spec << ' ' << stage.stage;
    EXPECT_EQ(of_l2[stage.stage], stage.l2_bytes) << spec << ' ' << stage.stage;
  }
  FrameInput alone = run;
  alone.threads = 1;
  EXPECT_EQ(parse_technique(spec).render(trace, 0, alone).dram_arrays, result.dram_arrays) << spec;
}

TEST(DramTally, ArraysAddUpToTheBytesOfStages) {
  for (const std::string& spec : example_specs()) {
    if (spec.starts_with("reference")) continue;  // its samples are in no memory
    for (const Trace& trace :
         {random_trace(70, 50, 200, 5), random_surfaces(60, 50, 60, 5), random_states(60, 50, 20, 5)})
      for (const auto place :
           {std::optional<Place>(), std::optional(Place::in_memory), std::optional(Place::on_chip)}) {
        FrameInput run{3};
        run.memory.framebuffer = place;
        run.memory.l2.bytes = 16384;  // so that records of pools reach DRAM
        run.memory.compression = place != Place::in_memory;
        expect_sums(spec, trace, run);
      }
  }
}

// Two layers over 64 x 64 pixels, the farther first: a layer of colours has 16 KiB, and a layer of depths 64 blocks
// with one plane each, which is a sector. The second layer reads the depths of the first. The caches are those of ROPs,
// so that L2 moves what DRAM does.
TEST(DramTally, DepthsAreCompressedAndColoursAreNot) {
  FrameInput run{1};
  run.memory.rop.bytes = 4096;
  run.memory.binned = false;
  const Trace trace = pixel_trace(64, 64, {covering(0.75), covering(0.25)});
  const FrameResult result = parse_technique("msaa:1,color=rgba8").render(trace, 0, run);
  std::vector<ArrayBytes> tests;
  for (const ArrayBytes& each : result.dram_arrays)
    if (each.stage.id == StageId::depth_test) tests.push_back(each);
  const std::vector<ArrayBytes> expected = {
      {StageId::depth_test, "depth", 64 * 32, 2 * 64 * 32, 3 * 64 * 32, 3 * 64 * 32},
      {StageId::depth_test, "samples", 0, 2 * 16384, 0, 2 * 16384}};
  EXPECT_EQ(tests, expected);
}

TEST(DramTally, PassesOverTheGeometryRepeatWhatItMoves) {
  DramTally pass, frame;
  pass.add(pass.array("meshes"), DramAccess::read, StageId::vertex_setup, 96);
  pass.add_l2(pass.array("meshes"), StageId::vertex_setup, 128);
  frame.add_l2(frame.array("bin_lists"), StageId::bin_sort, 5);
  frame.add(pass, Pass::prepass, 1);
  frame.add(pass, Pass::main, 2);
  frame.add(frame.array("depth"), DramAccess::write, StageId::depth_test, 64, true);
  frame.add(frame.array("depth"), DramAccess::write, StageId::none, 32);
  const std::vector<ArrayBytes> expected = {{{StageId::vertex_setup, Pass::prepass}, "meshes", 96, 0, 0, 128},
                                            {StageId::vertex_setup, "meshes", 192, 0, 0, 256},
                                            {StageId::bin_sort, "bin_lists", 0, 0, 0, 5},
                                            {StageId::depth_test, "depth", 0, 64, 64}};
  EXPECT_EQ(frame.sums(), expected);
}

}  // namespace
}  // namespace beampipe::dram_tally_test
