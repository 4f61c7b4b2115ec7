#include "tools/evaluate/hardware.h"

#include <gtest/gtest.h>

#include <set>

#include "stages/cost/counter_registry.h"
#include "tools/claims/claims.h"

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

// Work over rate, unit by unit: 6000 triangles at 6 per clock; 9600 pixels at 96; two clocks of float operations; three
// of L2; ten of DRAM.
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

// A stage without one would work for nothing. The reference is no pipeline of a GPU.
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
    parse_hardware(nlohmann::ordered_json::parse(text.replace(at, from.size(), to)), "h.json");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Hardware, ErrorsNameTheKey) {
  EXPECT_EQ(refusal("\"clock_mhz\":1455", "\"clock_mhz\":-1"),
            "h.json: clock_mhz: expected a number above 0, found -1");
  EXPECT_EQ(refusal("\"triangles_per_clk\":6,", ""), "h.json: rates.triangles_per_clk: expected this key, found none");
  EXPECT_EQ(refusal("\"quads_per_clk\":24", "\"quads_per_clk\":24,\"x\":1"), "h.json: rates.x: there is no such key");
  EXPECT_NE(refusal("[\"rop_samples\"]", "[\"rop\"]").find("implementations.shaders.units.depth_test: expected units"),
            std::string::npos);
}

// Of no report there are the numbers that need no rendering.
TEST(Claims, BytesPerPixelAreThePublishedOnes) {
  const std::vector<Claim> claims = answered_claims({});
  EXPECT_GE(claims.size(), 20u);
  for (const Claim& claim : claims)
    EXPECT_NEAR(*claim.difference(), 0, claim.unit == "MiB" ? 0.5 : 0.001) << claim.name;
}

TEST(Claims, HaveDistinctNamesAndCommandsThatRun) {
  std::set<std::string> names;
  for (const Claim& claim : all_claims({})) {
    EXPECT_TRUE(names.insert(claim.name).second) << claim.name;
    EXPECT_FALSE(claim.source.empty()) << claim.name;
    EXPECT_EQ(claim.command.rfind("beampipe ", 0), 0u) << claim.command;
    for (const char* placeholder : {"TRACE", "SPEC", "DIR"})
      EXPECT_EQ(claim.command.find(placeholder), std::string::npos) << claim.command;
    EXPECT_TRUE(claim.published_low <= claim.published_high) << claim.name;
    const std::size_t technique = claim.command.rfind(" -t ");
    if (technique == std::string::npos) continue;
    const std::size_t end = claim.command.find(' ', technique + 4);
    EXPECT_NO_THROW(parse_technique(claim.command.substr(technique + 4, end - technique - 4))) << claim.command;
  }
  EXPECT_GT(names.size(), 150u);
}

TEST(Claims, DifferenceIsFromTheNearerEnd) {
  Claim claim{"", "", 24, 32, 40, "", "", ""};
  EXPECT_EQ(claim.difference(), 8);
  claim.ours = 20;
  EXPECT_EQ(claim.difference(), -4);
  claim.ours = 30;
  EXPECT_EQ(claim.difference(), 0);
  claim.ours.reset();
  EXPECT_FALSE(claim.difference());
  EXPECT_TRUE(to_json(claim)["ours"].is_null());
}

// 30 bytes more at 1x to MSAA, half of which ACAA saves.
TEST(Claims, AcaaGivesBack) {
  Report report;
  const auto add = [&](const char* spec, std::uint64_t dram) {
    TechniqueReport& result = report.results.emplace_back();
    result.technique = spec;
    StageCounters setup{"vertex_setup"}, raster{"sample_raster"}, testing{"depth_test"}, resolving{"resolve"};
    setup.dram_bytes = 1000, raster.dram_bytes = 2000, testing.dram_bytes = dram - 5, resolving.dram_bytes = 5;
    result.frames.emplace_back().stages = {setup, raster, testing, resolving};
  };
  add("msaa:1,prepass", 10);
  const auto given_back = [&]() -> std::optional<double> {
    for (const Claim& claim : all_claims(report))
      if (claim.name.starts_with("ACAA, part of what MSAA adds to 1x in framebuffer traffic")) return claim.ours;
    return {};
  };
  EXPECT_FALSE(given_back());
  add("msaa:8,color=rgba16f,prepass", 40);
  add("acaa:8", 25);
  EXPECT_EQ(given_back(), 0.5);
}

TEST(Claims, MostFragmentsOfAPixelAreThoseOfTheClassroom) {
  Report report;
  TechniqueReport& result = report.results.emplace_back();
  result.technique = "beam:rules=paper";
  result.frames.emplace_back().pixel_counters["fragments"] = {2.5, 61};
  const auto most = [&]() -> std::optional<double> {
    for (const Claim& claim : all_claims(report))
      if (claim.unit == "fragments") return claim.ours;
    return {};
  };
  report.trace = "fence.json";
  EXPECT_FALSE(most());
  report.trace = "some/classroom.json";
  EXPECT_EQ(most(), 61);
}

}  // namespace
}  // namespace beampipe
