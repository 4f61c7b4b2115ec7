#include "tools/evaluate/hardware.h"

#include <regex>

#include "tests/message_of.h"
#include "tests/test.h"

namespace beampipe::hardware_test {

// A stage without units would cost nothing. The reference is not a pipeline of a GPU.
TEST(Hardware, EveryStageHasUnits) {
  for (const std::string& name : hardware_names())
    for (const Implementation& implementation : read_hardware(name).implementations)
      for (const StageInfo& stage : stage_list())
        EXPECT_EQ(implementation.units.contains(stage.id), stage.id != StageId::reference_raster)
            << name << ", " << stage.name;
}

TEST(Hardware, EveryNumberHasASource) {
  EXPECT_GE(hardware_names().size(), 3u);
  for (const std::string& name : hardware_names()) {
    const Hardware hardware = read_hardware(name);
    EXPECT_EQ(hardware.label, name);
    const Json& sources = hardware.json.at("sources");
    EXPECT_GE(sources.at("clock_mhz").get<std::string>().size(), 4u);
    for (const auto& [rate, value] : hardware.rates) {
      const std::string source = sources.at(rate).get<std::string>();
      EXPECT_EQ(source.starts_with("choice"), source.starts_with("choice") && hardware.ranges.contains(rate)) << rate;
      EXPECT_TRUE(std::regex_search(
          source, std::regex("choice|see |two DRAM simulators|\\(.*\\)|NVIDIA|Arm|AnandTech|MediaTek|Mesa|Volta|GB/s")))
          << name << ", " << rate << ": " << source;
    }
  }
}

TEST(Hardware, CostsStandInTheDescription) {
  const Hardware priced = with_shading_costs(titan_v(), {1, 2, 3}, {4, 5, 6});
  const Hardware again = parse_hardware(priced.json, "h.json");
  EXPECT_EQ(again.material.fetches, 2);
  EXPECT_EQ(again.light.operations, 4);
  EXPECT_EQ(again.light.registers, 6);
}

std::string refusal(const std::string& from, const std::string& to) {
  std::string text = titan_v().json.dump();
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  text.replace(at, from.size(), to);
  return message_of<std::runtime_error>([&] { parse_hardware(parse_json_text(text, "h.json"), "h.json"); });
}

TEST(Hardware, AnInvocationHasRoomInACore) {
  Hardware titan = titan_v();
  EXPECT_FALSE(find_conflict(with_shading_costs(titan, {0, 0, 65536}, {})));
  const auto conflict = find_conflict(with_shading_costs(titan, {}, {0, 0, 65537}));
  ASSERT_TRUE(conflict);
  EXPECT_STREQ(conflict->rate, "core_registers");
  EXPECT_EQ(conflict->expected, "at least the 65537.0 of an invocation");
}

TEST(Hardware, ErrorsNameTheKey) {
  const std::string number = "expected a number from 1e-06 to 1e+12, found ", units = "/implementations/shaders/units/";
  const std::tuple<const char*, const char*, std::string> cases[] = {
      // text as it is, broken, start of the error
      {"\"clock_mhz\":1455", "\"clock_mhz\":-1", "/clock_mhz: expected a number from 1 to 100000, found -1"},
      {"\"dram_bytes_per_clk\":448.7", "\"dram_bytes_per_clk\":1e-300",
       "/rates/dram_bytes_per_clk: " + number + "1e-300"},
      {"\"compose\":[\"shader\"],", "", "/implementations/shaders/units: expected the key \"compose\", found none"},
      {"\"windows\":[\"shader\"],", "\"windows\":[],", units + "windows: expected at least one unit, found none"},
      {"\"compose\":[\"shader\"],", "\"compose\":[\"texture\"],",
       units + "compose: expected a unit that does the work of the stage, found an array of 1"},
      {"\"bins_per_core\":2", "\"bins_per_core\":0.5",
       "/memory_system/parameters/bins_per_core: expected an integer 1..64, found 0.5"},
      {"\"cores\":80", "\"cores\":0", "/memory_system/parameters/cores: expected an integer 1..65536, found 0"},
      {"\"rop_samples_per_clk\":[384,768]", "\"rop_samples_per_clk\":[384]",
       "/ranges/rop_samples_per_clk: expected two numbers, the lowest and the highest, found an array of 1"},
      {"\"rop_samples_per_clk\":[384,768]", "\"rop_samples_per_clk\":[513,768]",
       "/ranges/rop_samples_per_clk: expected a range around the rate of 512"},
      {"\"compose\":[\"shader\"],", "\"compose\":[\"quads\"],",
       units + "compose: expected a unit that does the work of the stage"},
      {"\"conservative_raster\":[\"conservative_raster\"]", "\"conservative_raster\":[\"shader\"]",
       units + "conservative_raster/0: expected a unit of fixed functions, in which alone conservative_raster is "
               "modelled (`beampipe counters conservative_raster`), found \"shader\""},
      {"\"motion\":[\"shader\"]", "\"motion\":[\"sorter\"]",
       units + "motion/0: expected a unit of shaders, in which alone motion is modelled"},
      {"\"compose\":[\"shader\"],", "\"compose\":[\"l2\"],", units + "compose/0: expected one of"},
      {"\"compose\":[\"shader\"],", "\"compose\":[\"latency\"],", units + "compose/0: expected one of"},
      {"\"dram_clocks\":375,", "\"dram_clocks\":100,", "/rates/dram_clocks: expected at least the l2_clocks of 193"},
      {"\"core_threads\":2048", "\"core_threads\":0.5", "/rates/core_threads: expected at least 1, found 0.5"},
      {"\"dram_efficiency\":0.77", "\"dram_efficiency\":1.5",
       "/rates/dram_efficiency: expected a number up to 1, found 1.5"},
      {"\"compose\":", "\"componse\":",
       units + "componse: expected the name of a stage, found \"componse\" (did you mean 'compose'?)"},
      {"\"sources\":{\"clock", "\"sources\":{\"rops\":\"x\",\"clock", "/sources/rops: expected one of the keys"},
      {"\"triangles_per_clk\":6,", "", "/rates: expected the key \"triangles_per_clk\", found none"},
      {"\"quads_per_clk\":24", "\"quads_per_clk\":24,\"x\":1", "/rates/x: expected one of"},
      {"\"clock_mhz\":\"boost clock, NVIDIA's product page\",", "",
       "/sources: expected the key \"clock_mhz\", found none"},
      {"\"boost clock, NVIDIA's product page\"", "\"\"",
       "/sources/clock_mhz: expected where the number is from, or that it is a choice, found nothing"},
      {"[\"rop_samples\"]", "[\"rop\"]", units + "depth_test/0: expected one of \"composer\""},
      // The counters of `shade` say nothing to a unit of composition.
      {"\"shade\":[\"quads\",", "\"shade\":[\"composer\",", units + "shade/0: expected a unit of shaders"},
      {"\"compose\":[\"shader\"", "\"prepass_compose\":[\"shader\"",
       units + "prepass_compose: expected the name of a stage"}};
  for (const auto& [whole, broken, start] : cases) {
    const std::string error = refusal(whole, broken);
    EXPECT_TRUE(error.starts_with("h.json: " + start)) << error;
    EXPECT_EQ(error.find('\n'), error.npos);
  }
}

}  // namespace beampipe::hardware_test
