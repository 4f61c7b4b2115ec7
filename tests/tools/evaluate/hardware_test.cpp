#include "tools/evaluate/hardware.h"

#include <regex>

#include "tests/message_of.h"
#include "tests/test.h"
#include "tools/evaluate/results.h"
#include "traces/scenes.h"

namespace beampipe::hardware_test {

StageCounters stage(StageId id) {
  StageCounters counters{id};
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
  const auto raster = unit_times(titan, shaders, stage(StageId::sample_raster));
  EXPECT_NEAR(clocks(titan, raster.at("triangles")), 1000, 1e-6);
  EXPECT_NEAR(clocks(titan, raster.at("raster")), 100, 1e-6);
  EXPECT_NEAR(clocks(titan, raster.at("l2")), 3, 1e-6);
  EXPECT_NEAR(clocks(titan, raster.at("dram")), 10, 1e-6);
  EXPECT_FALSE(raster.contains("shader"));
  EXPECT_NEAR(clocks(titan, unit_times(titan, shaders, stage(StageId::compose)).at("shader")), 2, 1e-6);
}

TEST(Hardware, OverlapIsTheBusiestUnitAndSumEachStagesBusiest) {
  const Hardware titan = titan_v();
  const ModelledTime time =
      modelled_time(titan, titan.implementations.at(0),
                    {stage(StageId::sample_raster), stage(StageId::compose), stage(StageId::compose)});
  EXPECT_NEAR(clocks(titan, time.sum_ms), 1000 + 10 + 10, 1e-6);
  EXPECT_NEAR(clocks(titan, time.overlap_ms), 1000, 1e-6);
  EXPECT_EQ(time.busiest, "triangles");
  ASSERT_EQ(time.stages.size(), 3u);
  EXPECT_EQ(time.stages[1].stage, StageId::compose);
  EXPECT_NEAR(clocks(titan, time.stages[1].ms), 10, 1e-6);
}

TEST(Hardware, ShadersShareTheirUnitBetweenStages) {
  const Hardware titan = titan_v();
  StageCounters busy{StageId::compose};
  busy.ops.bit = 5120 * 100;
  const ModelledTime time = modelled_time(titan, titan.implementations.at(0), {busy, busy});
  EXPECT_NEAR(clocks(titan, time.overlap_ms), 200, 1e-6);
  EXPECT_EQ(time.busiest, "shader");
}

TEST(Hardware, LanesThatAStageNamesTwiceWorkOnce) {
  Hardware titan = titan_v();
  StageCounters busy{StageId::shade};
  busy.ops.bit = 5120 * 100;
  const double once = modelled_time(titan, titan.implementations.at(0), {busy}).overlap_ms;
  titan.implementations.at(0).units.at(StageId::shade).push_back("shader");
  EXPECT_EQ(modelled_time(titan, titan.implementations.at(0), {busy}).overlap_ms, once);
}

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
      EXPECT_TRUE(
          std::regex_search(source, std::regex("choice|see |\\(.*\\)|NVIDIA|Arm|AnandTech|MediaTek|Mesa|Volta|GB/s")))
          << name << ", " << rate << ": " << source;
    }
  }
}

// 9600 positions of masks at 9216 per clock, but 960 pairs at 96; 1000 comparisons at 96; 7680 contested positions at
// 768; 30720 bytes at 3072.
TEST(Hardware, FixedFunctionsFollowTheirWork) {
  const Hardware titan = titan_v();
  const Implementation& fixed = titan.implementations.at(1);
  const auto of = [&](StageId id, const char* unit, const auto& set) {
    StageCounters counters{id};
    set(counters);
    return clocks(titan, unit_times(titan, fixed, counters).at(unit));
  };
  const auto masks = [&](std::uint64_t tests) {
    return of(StageId::beam_fragment, "mask_generator", [&](auto& s) { s.items_in = 960, s.position_tests = tests; });
  };
  EXPECT_NEAR(masks(960 * 32 * 3), 10, 1e-6);
  EXPECT_NEAR(masks(960 * 256 * 3), 80, 1e-6);
  const auto sorting = [&](std::uint64_t comparisons) {
    return of(StageId::a_buffer, "sorter", [&](auto& s) { s.items_in = 960, s.ops.add = comparisons; });
  };
  EXPECT_NEAR(sorting(0), 10, 1e-6);
  EXPECT_NEAR(sorting(9600), 100, 1e-6) << "long lists need more comparisons";
  const auto composition = [&](std::uint64_t positions, std::uint64_t bytes) {
    return of(StageId::compose, "composer",
              [&](auto& s) { s.items_in = 96, s.position_tests = positions, s.bytes_read = bytes; });
  };
  EXPECT_NEAR(composition(0, 0), 1, 1e-6);
  EXPECT_NEAR(composition(7680, 0), 10, 1e-6);
  EXPECT_NEAR(composition(0, 30720), 10, 1e-6);
  const auto rop = [&](std::uint64_t bytes) {
    return of(StageId::depth_test, "rop_samples", [&](auto& s) { s.items_in = 768, s.bytes_written = bytes; });
  };
  EXPECT_NEAR(rop(3072), 1, 1e-6);
  EXPECT_NEAR(rop(2 * 3072), 2, 1e-6) << "wider formats take longer";
}

// 30720 bytes of pixels take 10 clocks of 96 ROPs, which move 32 each, and 3 of 80 cores, which move 128 each: those of
// shaders, and of ROPs where the pixels are on chip. Texels, which have a rate of their own, do not count for shaders.
TEST(Hardware, BytesOfPixelsMoveWhereThePixelsAre) {
  const Hardware titan = titan_v();
  const auto of = [&](std::size_t implementation, StageId id, const char* unit, double bin_bytes) {
    StageCounters counters{id};
    counters.bytes_read = 30720;
    if (unit == std::string("shader")) counters.bytes_read += 1000, counters.texture_bytes = 1000;
    return clocks(titan, unit_times(titan, titan.implementations.at(implementation), counters, bin_bytes).at(unit));
  };
  EXPECT_NEAR(of(1, StageId::compose, "composer", 0), 10, 1e-6);
  EXPECT_NEAR(of(1, StageId::compose, "composer", 1024), 3, 1e-6);
  EXPECT_NEAR(of(0, StageId::depth_test, "rop_samples", 0), 10, 1e-6);
  EXPECT_NEAR(of(0, StageId::depth_test, "rop_samples", 1024), 3, 1e-6);
  EXPECT_NEAR(of(0, StageId::accumulate, "rop_fragments", 1024), 3, 1e-6);
  EXPECT_NEAR(of(0, StageId::compose, "shader", 0), 3, 1e-6);
  EXPECT_NEAR(of(0, StageId::compose, "shader", 1024), 3, 1e-6);
}

// What is on chip beside the pixels, such as closed depths, has memory of its own.
TEST(Hardware, OnlyPixelsOnChipTakeRoomInCores) {
  FrameReport frame;
  frame.buffers = {{"closed_depth", 32 * 1024, true}, {"pair_queue", 500, true}};
  EXPECT_EQ(frame.open_pixel_bytes(), 0);
  frame.buffers.push_back({kOpenPixels, 160 * 1024, true});
  EXPECT_EQ(frame.open_pixel_bytes(), 160 * 1024);
  const Trace trace = make_scene("fence", {.triangles = 1000, .width = 40, .height = 40});
  for (const auto& [spec, place, bytes] : {std::tuple{"msaa:8", Place::in_memory, 0},
                                           {"msaa:8", Place::on_chip, 80 * 1024},
                                           {"beam", Place::on_chip, 46 * 1024}}) {
    FrameInput options;
    options.memory.framebuffer = place;
    FrameReport report;
    report.buffers = parse_technique(spec).render(trace, 0, options).buffers;
    EXPECT_EQ(report.open_pixel_bytes(), bytes) << spec;
  }
}

// 5120 operations of 64 bits are issued twice and take two clocks of the integer lanes, which leaves nothing for the
// float lanes.
TEST(Hardware, WideIntegersHaveTheirOwnRate) {
  const Hardware titan = titan_v();
  StageCounters counters{StageId::compose};
  counters.ops.add = 5120;
  EXPECT_NEAR(clocks(titan, unit_times(titan, titan.implementations[0], counters).at("shader")), 1, 1e-6);
  counters.ops.wide = 5120;
  EXPECT_NEAR(clocks(titan, unit_times(titan, titan.implementations[0], counters).at("shader")), 2, 1e-6);
}

// Where integer lanes take no time, issuing is what is left: twice for each operation. Where that takes none either,
// nothing is: float lanes do none of this work.
TEST(Hardware, WideIntegersAreIssuedTwiceAndTakeNoFloatLanes) {
  Hardware titan = titan_v();
  titan.rates.at("wide_per_clk") = 1e12;
  StageCounters counters{StageId::compose};
  counters.ops.add = counters.ops.wide = 5120;
  const auto shader = [&] { return clocks(titan, unit_times(titan, titan.implementations[0], counters).at("shader")); };
  titan.rates.at("issue_per_clk") = 512;
  EXPECT_NEAR(shader(), 20, 1e-6);
  titan.rates.at("issue_per_clk") = 1e12;
  EXPECT_NEAR(shader(), 0, 1e-6);
}

// 960 pixels at 96 per clock, of which 96 are visible.
TEST(Hardware, ConservativeRastersTakeHiddenPixelsToo) {
  const Hardware titan = titan_v();
  StageCounters counters{StageId::conservative_raster};
  counters.lanes_used = 960, counters.items_out = 96;
  const auto times = unit_times(titan, titan.implementations.at(1), counters);
  EXPECT_NEAR(clocks(titan, times.at("conservative_raster")), 10, 1e-6);
}

// A core of 96 KiB has room for two bins of 40 KiB, for one of 80, and for half of one of 192. The first work at full
// rate, the others wait half of the time, and half of the last one's bytes go to L2. Geometry does not wait.
TEST(Hardware, BinsThatDoNotFitStallAndSpill) {
  const Hardware titan = titan_v();
  const Implementation& shaders = titan.implementations.at(0);
  StageCounters counters{StageId::compose};
  counters.ops.bit = 102400;
  counters.bytes_read = 1536 * 100;
  const auto times = [&](double kib) { return unit_times(titan, shaders, counters, kib * 1024); };
  EXPECT_NEAR(clocks(titan, times(40).at("shader")), 20, 1e-6);
  EXPECT_NEAR(clocks(titan, times(40).at("l2")), 0, 1e-6);
  EXPECT_NEAR(clocks(titan, times(80).at("shader")), 40, 1e-6);
  EXPECT_NEAR(clocks(titan, times(80).at("l2")), 0, 1e-6);
  EXPECT_NEAR(clocks(titan, times(192).at("shader")), 40, 1e-6);
  EXPECT_NEAR(clocks(titan, times(192).at("l2")), 50, 1e-6);
  counters.stage = StageId::vertex_setup;
  EXPECT_NEAR(clocks(titan, times(192).at("shader")), 20, 1e-6);
}

// 512 invocations, each with 100 operations and 5 probes of 16 bytes: 10 clocks of the float lanes, 8 of the texture
// units. With 128 registers, half as many invocations fit as with 64.
TEST(Hardware, ShadingCostsAreAddedToInvocations) {
  const auto time_of = [](const ShadingCost& material, const ShadingCost& light, const std::vector<StageId>& stages) {
    const Hardware titan = with_shading_costs(titan_v(), material, light);
    std::vector<StageCounters> all;
    for (const StageId id : stages) all.emplace_back(StageCounters{id}).lanes_issued = 512;
    return clocks(titan, modelled_time(titan, titan.implementations.at(1), all).sum_ms);
  };
  const double quads = 512 / 96.0;  // which `shade` takes without any cost
  EXPECT_NEAR(time_of({}, {}, {StageId::shade}), quads, 1e-6);
  EXPECT_NEAR(time_of({100, 0, 0}, {}, {StageId::shade}), 10, 1e-6);
  EXPECT_NEAR(time_of({100, 0, 64}, {}, {StageId::shade}), 10, 1e-6);
  EXPECT_NEAR(time_of({100, 0, 128}, {}, {StageId::shade}), 20, 1e-6);
  EXPECT_NEAR(time_of({0, 5, 0}, {}, {StageId::shade}), 8, 1e-6);
  EXPECT_NEAR(time_of({100, 0, 0}, {50, 0, 0}, {StageId::shade}), 15, 1e-6) << "lights are in the fragment shader";
  EXPECT_NEAR(time_of({100, 0, 0}, {50, 0, 0}, {StageId::shade, StageId::light}), 10 + 5, 1e-6);
  EXPECT_NEAR(time_of({}, {50, 0, 0}, {StageId::shade, StageId::light}), quads + 5, 1e-6);
}

TEST(Hardware, CostsStandInTheDescription) {
  const Hardware priced = with_shading_costs(titan_v(), {1, 2, 3}, {4, 5, 6});
  const Hardware again = parse_hardware(priced.json, "h.json");
  EXPECT_EQ(again.material.fetches, 2);
  EXPECT_EQ(again.light.operations, 4);
  EXPECT_EQ(again.light.registers, 6);
}

TEST(Hardware, ListsNameEachOnce) {
  const std::vector<Hardware> all = read_hardware_list("rtx_4090,titan_v");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].label, "rtx_4090");
  EXPECT_EQ(all[1].label, "titan_v");
  EXPECT_THROW(read_hardware_list("titan_v,titan_v"), std::runtime_error);
}

std::string refusal(const std::string& from, const std::string& to) {
  std::string text = titan_v().json.dump();
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  text.replace(at, from.size(), to);
  return message_of<std::runtime_error>([&] { parse_hardware(parse_json_text(text, "h.json"), "h.json"); });
}

TEST(Hardware, ErrorsNameTheKey) {
  const std::string number = "expected a number from 1e-06 to 1e+12, found ", units = "/implementations/shaders/units/";
  const std::tuple<const char*, const char*, std::string> cases[] = {
      // text as it is, broken, start of the error
      {"\"clock_mhz\":1455", "\"clock_mhz\":-1", "/clock_mhz: " + number + "-1"},
      {"\"dram_bytes_per_clk\":448.7", "\"dram_bytes_per_clk\":1e-300",
       "/rates/dram_bytes_per_clk: " + number + "1e-300"},
      {"\"compose\":", "\"componse\":",
       units + "componse: expected the name of a stage, found \"componse\" (did you mean 'compose'?)"},
      {"\"sources\":{", "\"sources\":{\"rops\":\"x\",", "/sources/rops: expected one of the keys"},
      {"\"triangles_per_clk\":6,", "", "/rates: expected the key \"triangles_per_clk\", found none"},
      {"\"quads_per_clk\":24", "\"quads_per_clk\":24,\"x\":1", "/rates/x: expected one of"},
      {"\"clock_mhz\":\"boost clock, NVIDIA's product page\",", "",
       "/sources: expected the key \"clock_mhz\", found none"},
      {"\"boost clock, NVIDIA's product page\"", "\"\"",
       "/sources/clock_mhz: expected where the number is from, or that it is a choice, found nothing"},
      {"[\"rop_samples\",", "[\"rop\",", units + "depth_test/0: expected one of \"on_chip\", \"composer\""},
      // The counters of `shade` say nothing to a unit of composition.
      {"\"shade\":[\"quads\",", "\"shade\":[\"composer\",", units + "shade/0: expected one of \"on_chip\""},
      {"\"compose\":[\"shader\",", "\"prepass_compose\":[\"shader\",",
       units + "prepass_compose: expected the name of a stage"}};
  for (const auto& [whole, broken, start] : cases) {
    const std::string error = refusal(whole, broken);
    EXPECT_TRUE(error.starts_with("h.json: " + start)) << error;
    EXPECT_EQ(error.find('\n'), error.npos);
  }
}

}  // namespace beampipe::hardware_test
