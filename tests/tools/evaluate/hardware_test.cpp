#include "tools/evaluate/hardware.h"

#include <gtest/gtest.h>

#include "stages/cost/counter_registry.h"

namespace beampipe {
namespace {

StageCounters stage(const std::string& name) {
  StageCounters counters{name};
  counters.items_in = 6000, counters.items_out = 9600;
  counters.ops = {5120, 5120, 0, 0, 1280, 0};
  counters.l2_bytes = 1536 * 3, counters.dram_bytes = 4487;
  return counters;
}

double clocks(const Hardware& hardware, double ms) { return ms * hardware.clock_mhz * 1e3; }

// Each unit takes its work divided by its rate: 6000 triangles at 6 per clock, 9600 pixels at 96 per clock, two clocks
// of float operations, three clocks of L2 and ten of DRAM.
TEST(Hardware, TimeIsWorkOverRate) {
  const Hardware titan = titan_v();
  const Implementation& shaders = titan.implementations.at(0);
  const auto raster = unit_times(titan, shaders, stage("sample_raster"));
  EXPECT_NEAR(clocks(titan, raster.at("triangles")), 1000, 1e-6);
  EXPECT_NEAR(clocks(titan, raster.at("raster")), 100, 1e-6);
  EXPECT_NEAR(clocks(titan, raster.at("l2")), 3, 1e-6);
  EXPECT_NEAR(clocks(titan, raster.at("dram")), 10, 1e-6);
  EXPECT_FALSE(raster.contains("shader"));
  EXPECT_NEAR(clocks(titan, unit_times(titan, shaders, stage("compose")).at("shader")), 2, 1e-6);
}

TEST(Hardware, OverlapIsTheBusiestUnitAndSumEachStagesBusiest) {
  const Hardware titan = titan_v();
  const ModelledTime time =
      modelled_time(titan, titan.implementations.at(0), {stage("sample_raster"), stage("compose"), stage("compose")});
  EXPECT_NEAR(clocks(titan, time.sum_ms), 1000 + 10 + 10, 1e-6);
  EXPECT_NEAR(clocks(titan, time.overlap_ms), 1000, 1e-6);
  EXPECT_EQ(time.busiest, "triangles");
  ASSERT_EQ(time.stages.size(), 3u);
  EXPECT_NEAR(clocks(titan, time.stages[1]), 10, 1e-6);
}

TEST(Hardware, ShadersShareTheirUnitBetweenStages) {
  const Hardware titan = titan_v();
  StageCounters busy{"compose"};
  busy.ops.bit = 5120 * 100;
  const ModelledTime time = modelled_time(titan, titan.implementations.at(0), {busy, busy});
  EXPECT_NEAR(clocks(titan, time.overlap_ms), 200, 1e-6);
  EXPECT_EQ(time.busiest, "shader");
}

// A stage without units would cost nothing. The reference is not a pipeline of a GPU.
TEST(Hardware, EveryStageHasUnits) {
  for (const Implementation& implementation : titan_v().implementations)
    for (const StageInfo& stage : stage_list())
      EXPECT_EQ(implementation.units.contains(stage.name), stage.name != std::string("reference_raster")) << stage.name;
}

std::string refusal(const std::string& from, const std::string& to) {
  std::string text = titan_v().json.dump();
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  try {
    parse_hardware(parse_json_text(text.replace(at, from.size(), to), "h.json"), "h.json");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Hardware, ErrorsNameTheKey) {
  EXPECT_EQ(refusal("\"clock_mhz\":1455", "\"clock_mhz\":-1"),
            "h.json: /clock_mhz: expected a number above 0, found -1");
  EXPECT_EQ(refusal("\"triangles_per_clk\":6,", ""),
            "h.json: /rates: expected the key \"triangles_per_clk\", found none");
  EXPECT_EQ(refusal("\"quads_per_clk\":24", "\"quads_per_clk\":24,\"x\":1").find("h.json: /rates/x: expected one of"),
            0u);
  EXPECT_EQ(refusal("[\"rop_samples\"]", "[\"rop\"]")
                .find("h.json: /implementations/shaders/units/depth_test/0: expected one of the units"),
            0u);
}

}  // namespace
}  // namespace beampipe
