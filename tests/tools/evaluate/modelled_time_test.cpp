#include "tools/evaluate/modelled_time.h"

#include "tests/test.h"
#include "tools/evaluate/frame_report.h"
#include "traces/scenes.h"

namespace beampipe::modelled_time_test {

StageCounters stage(StageId id) {
  StageCounters counters{id};
  counters.items_in = 6000, counters.items_out = 9600;
  counters.ops = {5120, 5120, 0, 0, 1280, 0};
  counters.l2_bytes = 1536 * 3, counters.dram_bytes = 3455;
  return counters;
}

double clocks(const Hardware& hardware, double ms) { return ms * hardware.clock_mhz * 1e3; }

// Each unit takes its work divided by its rate: 6000 triangles at 6 per clock, 9600 pixels at 96 per clock, two clocks
// of float operations, three clocks of L2 and ten of DRAM, which reaches 77 % of 448.7 bytes per clock.
TEST(ModelledTime, TimeIsWorkOverRate) {
  const Hardware titan = titan_v();
  const Implementation& shaders = titan.implementations.at(0);
  const auto raster = unit_times(titan, shaders, stage(StageId::sample_raster));
  EXPECT_NEAR(clocks(titan, raster.at("raster")), 1000, 1e-6);
  EXPECT_NEAR(clocks(titan, raster.at("l2")), 3, 1e-6);
  EXPECT_NEAR(clocks(titan, raster.at("dram")), 10, 1e-3);
  EXPECT_FALSE(raster.contains("shader"));
  EXPECT_NEAR(clocks(titan, unit_times(titan, shaders, stage(StageId::compose)).at("shader")), 2, 1e-6);
}

// 3840 bytes of colours at 384 per clock, where ROPs follow. Composition in shaders keeps its colours, that in ROPs
// does not.
TEST(ModelledTime, ColoursGoToRops) {
  const Hardware titan = titan_v();
  StageCounters shade{StageId::shade};
  shade.bytes_written = 3840;
  const auto of = [&](StageId last, std::size_t implementation) {
    const std::vector<StageCounters> stages = {shade, StageCounters{last}};
    return clocks(titan, modelled_time(titan, titan.implementations.at(implementation), {stages}).in_turn_ms);
  };
  EXPECT_NEAR(of(StageId::depth_test, 0), 10, 1e-6);
  EXPECT_NEAR(of(StageId::accumulate, 0), 10, 1e-6);
  EXPECT_NEAR(of(StageId::compose, 0), 3840.0 / 10240, 1e-6);
  EXPECT_NEAR(of(StageId::compose, 1), 10, 1e-6);
}

// A picture of small triangles takes as long as their setup; rasterizing them has units of its own.
TEST(ModelledTime, SetupAndRasterTakeTurnsOnlyInTurn) {
  const Hardware titan = titan_v();
  StageCounters setup{StageId::vertex_setup}, raster{StageId::sample_raster};
  setup.items_in = raster.items_in = 6000, raster.items_out = 3000;
  const std::vector<StageCounters> stages = {setup, raster};
  const ModelledTime time = modelled_time(titan, titan.implementations.at(0), {stages});
  EXPECT_NEAR(clocks(titan, time.at_once_ms), 1000, 1e-6);
  EXPECT_NEAR(clocks(titan, time.in_turn_ms), 2000, 1e-6);
}

TEST(ModelledTime, OverlapIsTheBusiestUnitAndSumEachStagesBusiest) {
  const Hardware titan = titan_v();
  const std::vector<StageCounters> stages = {stage(StageId::sample_raster), stage(StageId::compose),
                                             stage(StageId::compose)};
  const ModelledTime time = modelled_time(titan, titan.implementations.at(0), {stages});
  EXPECT_NEAR(clocks(titan, time.in_turn_ms), 1000 + 10 + 10, 1e-3);
  EXPECT_NEAR(clocks(titan, time.at_once_ms), 1000, 1e-6);
  EXPECT_EQ(time.busiest, "raster");
  ASSERT_EQ(time.stages.size(), 3u);
  EXPECT_EQ(time.stages[1].stage, StageId::compose);
  EXPECT_NEAR(clocks(titan, time.stages[1].ms), 10, 1e-3);
  EXPECT_EQ(time.stages[0].busiest, "raster");
  EXPECT_EQ(time.stages[1].busiest, "dram");
}

TEST(ModelledTime, ShadersShareTheirUnitBetweenStages) {
  const Hardware titan = titan_v();
  StageCounters busy{StageId::compose};
  busy.ops.bit = 5120 * 100;
  const std::vector<StageCounters> stages = {busy, busy};
  const ModelledTime time = modelled_time(titan, titan.implementations.at(0), {stages});
  EXPECT_NEAR(clocks(titan, time.at_once_ms), 200, 1e-6);
  EXPECT_EQ(time.busiest, "shader");
}

TEST(ModelledTime, LanesThatAStageNamesTwiceWorkOnce) {
  Hardware titan = titan_v();
  StageCounters busy{StageId::shade};
  busy.ops.bit = 5120 * 100;
  const std::vector<StageCounters> stages = {busy};
  const double once = modelled_time(titan, titan.implementations.at(0), {stages}).at_once_ms;
  titan.implementations.at(0).units.at(StageId::shade).push_back("shader");
  EXPECT_EQ(modelled_time(titan, titan.implementations.at(0), {stages}).at_once_ms, once);
}

// 9600 positions of masks at 9216 per clock, but 960 pairs at 96; 1000 comparisons at 96; 7680 contested positions at
// 768; 20480 bytes at 2048.
TEST(ModelledTime, FixedFunctionsFollowTheirWork) {
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
  EXPECT_NEAR(composition(0, 20480), 10, 1e-6);
  const auto rop = [&](std::uint64_t bytes) {
    return of(StageId::depth_test, "rop_samples", [&](auto& s) { s.items_in = 512, s.bytes_written = bytes; });
  };
  EXPECT_NEAR(rop(2048), 1, 1e-6);
  EXPECT_NEAR(rop(2 * 2048), 2, 1e-6) << "wider formats take longer";
}

// 20480 bytes of pixels take 10 clocks of ROPs, which move 2048 a clock, and 2 of 80 cores, which move 128 each: those
// of shaders, and of ROPs where the pixels are on chip. Texels, which have a rate of their own, do not count for
// shaders.
TEST(ModelledTime, BytesOfPixelsMoveWhereThePixelsAre) {
  const Hardware titan = titan_v();
  const auto of = [&](std::size_t implementation, StageId id, const char* unit, double bin_bytes) {
    StageCounters counters{id};
    counters.bytes_read = 20480;
    if (unit == std::string("shader")) counters.bytes_read += 1000, counters.texture_bytes = 1000;
    return clocks(titan, unit_times(titan, titan.implementations.at(implementation), counters, bin_bytes).at(unit));
  };
  EXPECT_NEAR(of(1, StageId::compose, "composer", 0), 10, 1e-6);
  EXPECT_NEAR(of(1, StageId::compose, "composer", 1024), 2, 1e-6);
  EXPECT_NEAR(of(0, StageId::depth_test, "rop_samples", 0), 10, 1e-6);
  EXPECT_NEAR(of(0, StageId::depth_test, "rop_samples", 1024), 2, 1e-6);
  EXPECT_NEAR(of(0, StageId::accumulate, "rop_fragments", 1024), 2, 1e-6);
  EXPECT_NEAR(of(0, StageId::compose, "shader", 0), 2, 1e-6);
  EXPECT_NEAR(of(0, StageId::compose, "shader", 1024), 2, 1e-6);
}

// What is on chip beside the pixels, such as closed depths, has memory of its own.
TEST(ModelledTime, OnlyPixelsOnChipTakeRoomInCores) {
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
    options.memory.on_chip_bytes = 1 << 20;
    FrameReport report;
    report.buffers = parse_technique(spec).render(trace, 0, options).buffers;
    EXPECT_EQ(report.open_pixel_bytes(), bytes) << spec;
  }
}

// 5120 operations of 64 bits are issued twice and take two clocks of the integer lanes, which leaves nothing for the
// float lanes.
TEST(ModelledTime, WideIntegersHaveTheirOwnRate) {
  const Hardware titan = titan_v();
  StageCounters counters{StageId::compose};
  counters.ops.add = 5120;
  EXPECT_NEAR(clocks(titan, unit_times(titan, titan.implementations[0], counters).at("shader")), 1, 1e-6);
  counters.ops.wide = 5120;
  EXPECT_NEAR(clocks(titan, unit_times(titan, titan.implementations[0], counters).at("shader")), 2, 1e-6);
}

// Where integer lanes take no time, issuing is what is left: twice for each operation. Where that takes none either,
// nothing is: float lanes do none of this work.
TEST(ModelledTime, WideIntegersAreIssuedTwiceAndTakeNoFloatLanes) {
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
TEST(ModelledTime, ConservativeRastersTakeHiddenPixelsToo) {
  const Hardware titan = titan_v();
  StageCounters counters{StageId::conservative_raster};
  counters.lanes_used = 960, counters.items_out = 96;
  const auto times = unit_times(titan, titan.implementations.at(1), counters);
  EXPECT_NEAR(clocks(titan, times.at("conservative_raster")), 10, 1e-6);
}

// A core of 96 KiB has room for two bins of 48 KiB, and for one of 49. Then the stages that work on pixels take twice
// as long, but not geometry, L2 and DRAM.
TEST(ModelledTime, StagesWaitWhereFewerBinsHaveRoom) {
  Hardware titan = titan_v();
  StageCounters counters{StageId::compose};
  counters.ops.bit = 102400;
  counters.l2_bytes = 1536 * 100;
  const auto of = [&](const char* unit, double kib) {
    return clocks(titan, unit_times(titan, titan.implementations.at(0), counters, kib * 1024).at(unit));
  };
  EXPECT_NEAR(of("shader", 0), 20, 1e-6);
  EXPECT_NEAR(of("shader", 48), 20, 1e-6);
  EXPECT_NEAR(of("shader", 49), 40, 1e-6);
  EXPECT_NEAR(of("l2", 49), 100, 1e-6);
  titan.memory.bins_per_core = 6;
  EXPECT_NEAR(of("shader", 16), 20, 1e-6);
  EXPECT_NEAR(of("shader", 24), 30, 1e-6) << "four of six";
  EXPECT_NEAR(of("shader", 96), 120, 1e-6) << "one of six";
  counters.stage = StageId::vertex_setup;
  EXPECT_NEAR(of("shader", 96), 20, 1e-6);
}

TEST(ModelledTime, BinsHeldAreThoseWithRoom) {
  MemoryParameters memory;
  memory.on_chip_bytes = 1000, memory.bins_per_core = 4;
  EXPECT_EQ(bins_held(memory, 100), 4u) << "not more than a core works on";
  EXPECT_EQ(bins_held(memory, 250), 4u);
  EXPECT_EQ(bins_held(memory, 251), 3u);
  EXPECT_EQ(bins_held(memory, 1000), 1u);
  EXPECT_EQ(bins_held(memory, 5000), 1u) << "whatever a report says";
}

// Two cores, mean 8. In their order: 5 and 1 start; the 3 starts at 1 on the second core, the 4 at 4 there, and the
// last 3 at 5 on the first: ends at 8 both.
TEST(ModelledTime, BinsStartInTheirOrderOnTheCoreThatIsFreeFirst) {
  using Bins = std::vector<std::uint64_t>;
  EXPECT_EQ(imbalance(Bins{5, 1, 3, 4, 3}, 2), 1.0);
  EXPECT_EQ(imbalance(Bins{1, 3, 3, 4, 5}, 2), 9.0 / 8) << "1, then 3 and 5 until 9; 3 and 4 until 7";
  EXPECT_EQ(imbalance(Bins{45, 11, 11, 11, 11, 11}, 32), 45.0 * 32 / 100) << "one bin has 45 per cent";
  EXPECT_EQ(imbalance(Bins{7}, 1), 1.0);
  EXPECT_EQ(imbalance(Bins{}, 80), 1.0);
  EXPECT_EQ(imbalance(Bins{0, 0}, 80), 1.0);
}

// Of 80 cores one has twice the work of the mean. Geometry comes first: 1000 clocks of triangles. Then bins take 2 x 20
// clocks of shaders, or as long as DRAM takes for all of them.
TEST(ModelledTime, CoresWaitForTheirBusiestButShareDram) {
  const Hardware titan = titan_v();
  StageCounters setup{StageId::vertex_setup}, compose{StageId::compose};
  setup.items_in = 6000;
  compose.ops.bit = 102400;
  const std::vector<std::uint64_t> bins(40, 10);  // on 80 cores
  const auto scheduled = [&](double dram_clocks) {
    compose.dram_bytes = static_cast<std::uint64_t>(dram_clocks * 448.7 * 0.77);
    const std::vector<StageCounters> stages = {setup, compose};
    return clocks(titan, modelled_time(titan, titan.implementations.at(0), {stages, 0, bins}).on_cores_ms);
  };
  EXPECT_NEAR(scheduled(0), 1000 + 40, 1e-6);
  EXPECT_NEAR(scheduled(20), 1000 + 40, 1e-6);
  EXPECT_NEAR(scheduled(60), 1000 + 60, 1e-2);
}

// 512 invocations, each with 100 operations and 5 probes of 16 bytes: 10 clocks of the float lanes, 8 of the texture
// units. With 128 registers, half as many invocations fit as with 64.
TEST(ModelledTime, ShadingCostsAreAddedToInvocations) {
  const auto time_of = [](const ShadingCost& material, const ShadingCost& light, const std::vector<StageId>& stages) {
    const Hardware titan = with_shading_costs(titan_v(), material, light);
    std::vector<StageCounters> all;
    for (const StageId id : stages) all.emplace_back(StageCounters{id}).lanes_issued = 512;
    return clocks(titan, modelled_time(titan, titan.implementations.at(1), {all}).in_turn_ms);
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

}  // namespace beampipe::modelled_time_test
