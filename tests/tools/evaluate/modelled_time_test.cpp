#include "tools/evaluate/modelled_time.h"

#include <numeric>

#include "tests/test.h"
#include "tools/evaluate/frame_report.h"
#include "tools/evaluate/hardware_units.h"
#include "traces/scenes.h"

namespace beampipe::modelled_time_test {

StageCounters stage(StageId id) {
  StageCounters counters{id};
  counters.items_in = 6000, counters.items_out = 9600;
  counters.ops = {5120, 5120, 0, 0, 1280, 0};
  counters.l2_bytes = 1536 * 3, counters.dram_bytes = 3455;
  return counters;
}

// Whose threads wait for nothing, so that a few fill it.
Hardware titan_without_latency() {
  Hardware titan = titan_v();
  for (const char* rate : {"operation_clocks", "fetch_clocks", "l2_clocks", "dram_clocks"})
    titan.rates.at(rate) = kLeastRate;
  return titan;
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
  const Hardware titan = titan_without_latency();
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
  const Hardware mali = read_hardware("mali_g710");
  const std::vector<StageCounters> stages = {shade, StageCounters{StageId::compose}, StageCounters{StageId::resolve}};
  EXPECT_NEAR(clocks(mali, modelled_time(mali, mali.implementations.at(0), {stages}).in_turn_ms), 3840.0 / 640, 1e-6)
      << "ROPs resolve what cores have kept on chip";
}

// 5120 bytes of pixels at 10240 per clock on chip or 2048 in memory, or 4800 samples at 768. The sums of a unit have
// the rate at which most of them go.
TEST(ModelledTime, TheRateThatLimitsAUnitIsNamed) {
  const Hardware titan = titan_without_latency();
  const auto rate = [&](std::uint64_t samples, std::uint64_t bytes, double bin_bytes) {
    StageCounters counters{StageId::depth_test};
    counters.items_in = samples, counters.bytes_read = bytes;
    const ModelledTime time = modelled_time(titan, titan.implementations.at(0), {{counters}, {bin_bytes}});
    EXPECT_EQ(time.busiest, "rop_samples");
    EXPECT_EQ(time.stages.at(0).busiest_rate, time.busiest_rate);
    return time.busiest_rate;
  };
  EXPECT_EQ(rate(4800, 5120, 1024), "rop_samples_per_clk");
  EXPECT_EQ(rate(48, 5120, 1024), "core_on_chip_bytes_per_clk");
  EXPECT_EQ(rate(48, 5120, 0), "rop_bytes_per_clk");
  StageCounters floats{StageId::compose}, bits{StageId::bin_sort};
  floats.ops.add = 5120 * 30, bits.ops.bit = 5120 * 40;
  const auto sum = modelled_time(titan, titan.implementations.at(0), {{floats, bits, floats}});
  EXPECT_EQ(sum.stages.at(0).busiest_rate, "core_add_per_clk");
  EXPECT_EQ(sum.stages.at(1).busiest_rate, "core_bit_per_clk");
  EXPECT_EQ(sum.busiest_rate, "core_add_per_clk") << "30 + 30 clocks, and 40 of bits";
}

// On hardware of any kind, the rate that is named is the one to change.
TEST(ModelledTime, TheRateThatIsNamedShortensTheTime) {
  const Trace trace = make_scene("fence", {.triangles = 1000, .width = 64, .height = 40});
  for (const std::string& name : hardware_names()) {
    const Hardware hardware = read_hardware(name);
    for (const char* spec : {"beam", "casav", "msaa:32"}) {
      const FrameResult frame = parse_technique(spec).render(trace, 0, {.memory = hardware.memory});
      for (const Implementation& implementation : hardware.implementations) {
        const ModelledTime before = modelled_time(hardware, implementation, {frame.stages, {8192, 256}});
        Hardware faster = hardware;
        const bool is_wait = before.busiest == "latency";
        faster.rates.at(before.busiest_rate) *= is_wait ? 0.5 : 2;
        const ModelledTime after = modelled_time(faster, implementation, {frame.stages, {8192, 256}});
        EXPECT_LT(after.at_once_ms, before.at_once_ms) << name << ' ' << spec << ' ' << before.busiest_rate;
      }
    }
  }
}

TEST(ModelledTime, LimitsNameTheRateUnlessItIsTheUnitsOwn) {
  EXPECT_EQ(limit_text("rop_samples", "rop_samples_per_clk"), "rop_samples");
  EXPECT_EQ(limit_text("rop_samples", "core_on_chip_bytes_per_clk"), "rop_samples: on_chip_bytes");
  EXPECT_EQ(limit_text("dram", "dram_bytes_per_clk"), "dram");
  EXPECT_EQ(limit_text("latency", "dram_clocks"), "latency: dram_clocks");
  EXPECT_EQ(limit_text("shader", ""), "shader") << "of a report by an older version";
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
  const Hardware titan = titan_without_latency();
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
  const Hardware titan = titan_without_latency();
  StageCounters busy{StageId::compose};
  busy.ops.bit = 5120 * 100;
  const std::vector<StageCounters> stages = {busy, busy};
  const ModelledTime time = modelled_time(titan, titan.implementations.at(0), {stages});
  EXPECT_NEAR(clocks(titan, time.at_once_ms), 200, 1e-6);
  EXPECT_EQ(time.busiest, "shader");
}

TEST(ModelledTime, LanesThatAStageNamesTwiceWorkOnce) {
  Hardware titan = titan_without_latency();
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
    return clocks(titan, unit_times(titan, titan.implementations.at(implementation), counters, {bin_bytes}).at(unit));
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
  titan.rates.at("core_wide_per_clk") = 1e12;
  StageCounters counters{StageId::compose};
  counters.ops.add = counters.ops.wide = 5120;
  const auto shader = [&] { return clocks(titan, unit_times(titan, titan.implementations[0], counters).at("shader")); };
  titan.rates.at("core_issue_per_clk") = 6.4;
  EXPECT_NEAR(shader(), 20, 1e-6);
  titan.rates.at("core_issue_per_clk") = 1e12;
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

// 80 cores with 2048 threads each: 163840. A thread waits 4 clocks for each of its operations, 28 for a load, and four
// of them together 193 for a sector of 32 bytes from L2, or 375 for one from DRAM. What DRAM moves, L2 moves too.
TEST(ModelledTime, ThreadsWaitForOperationsLoadsAndSectors) {
  const Hardware titan = titan_v();
  const auto latency = [&](StageId id, const auto& set) {
    StageCounters counters{id};
    counters.items_in = counters.lanes_issued = 1000000;
    set(counters);
    return clocks(titan, unit_times(titan, titan.implementations.at(0), counters).at("latency"));
  };
  EXPECT_NEAR(latency(StageId::compose, [](auto& s) { s.ops.bit = 1638400; }), 40, 1e-9);
  EXPECT_NEAR(latency(StageId::compose, [](auto& s) { s.ops.add = s.ops.wide = 1638400; }), 80, 1e-9) << "twice";
  EXPECT_NEAR(latency(StageId::compose, [](auto& s) { s.ops.fetch = 1638400; }), 280, 1e-9);
  EXPECT_NEAR(latency(StageId::compose, [](auto& s) { s.l2_bytes = 163840 * 32; }), 4 * 193, 1e-9);
  EXPECT_NEAR(latency(StageId::compose, [](auto& s) { s.l2_bytes = s.dram_bytes = 163840 * 32; }), 4 * 375, 1e-9);
  EXPECT_NEAR(latency(StageId::compose, [](auto& s) { s.dram_bytes = 163840 * 32; }), 0, 1e-9) << "write-backs";
  EXPECT_NEAR(latency(StageId::shade, [](auto& s) { s.bytes_read = s.texture_bytes = 163840 * 16; }), 28, 1e-9)
      << "a probe reads 16 bytes";
  EXPECT_FALSE(unit_times(titan, titan.implementations.at(1), stage(StageId::compose)).contains("latency"));
}

// A bin of 16 x 16 pixels has 256 threads. With room for two of them, 80 cores have 40960 threads in place of 163840;
// with room for one, half as many.
TEST(ModelledTime, FewerBinsHideLessLatency) {
  Hardware titan = titan_v();
  StageCounters counters{StageId::compose};
  counters.items_in = 1000000;
  counters.ops.bit = 1638400;
  const auto latency = [&](double kib, double pixels) {
    return clocks(titan, unit_times(titan, titan.implementations.at(0), counters, {kib * 1024, pixels}).at("latency"));
  };
  EXPECT_NEAR(latency(0, 0), 40, 1e-9);
  EXPECT_NEAR(latency(48, 256), 160, 1e-9);
  EXPECT_NEAR(latency(49, 256), 320, 1e-9);
  EXPECT_NEAR(latency(48, 1024), 40, 1e-9);
  EXPECT_NEAR(latency(0, 256), 40, 1e-9) << "in memory eight have room, with as many pixels as two of 32 x 32";
  titan.memory.bins_per_core = 6;
  EXPECT_NEAR(latency(24, 256), 80, 1e-9) << "four have room";
  counters.stage = StageId::vertex_setup;
  EXPECT_NEAR(latency(49, 256), 40, 1e-9) << "not of bins";
}

// A thousand bins of 16 x 16 pixels, of which a core holds two. Of a bin 1280 fragments are shaded, so that the 2048
// threads of a core are all in flight, but 256 are composed, one of each pixel. Helper lanes are threads, too.
TEST(ModelledTime, ThreadsAreFragmentsOrPixels) {
  const Hardware titan = titan_v();
  const auto latency = [&](StageId id, std::uint64_t items, std::uint64_t lanes, std::uint64_t bins) {
    StageCounters counters{id};
    counters.items_in = items * bins, counters.lanes_issued = lanes * bins;
    counters.ops.bit = 1638400;
    const auto times =
        unit_times(titan, titan.implementations.at(0), counters, {48 * 1024, 256}, static_cast<double>(bins));
    return clocks(titan, times.at("latency"));
  };
  EXPECT_NEAR(latency(StageId::beam_fragment, 1280, 0, 1000), 40, 1e-9);
  EXPECT_NEAR(latency(StageId::compose, 1280, 0, 1000), 160, 1e-9);
  EXPECT_NEAR(latency(StageId::compose, 64, 0, 1000), 640, 1e-9) << "a fragment in each fourth pixel";
  EXPECT_NEAR(latency(StageId::beam_fragment, 256, 0, 1000), 160, 1e-9);
  EXPECT_NEAR(latency(StageId::shade, 128, 256, 1000), 160, 1e-9) << "every second is a helper";
  EXPECT_NEAR(latency(StageId::beam_fragment, 640, 0, 1), 40 * 256, 1e-9) << "640 threads are all that there are";
  EXPECT_NEAR(latency(StageId::beam_fragment, 0, 0, 1), 40 * 163840, 1e-9) << "at least one";
}

// Without bins the cores share a frame's triangles evenly, and none waits for a bin.
TEST(ModelledTime, WithoutBinsNothingIsScheduled) {
  Hardware titan = titan_v();
  titan.memory.binned = false;
  StageCounters compose{StageId::compose};
  compose.items_in = 1000000, compose.ops.bit = 1638400;
  EXPECT_NEAR(clocks(titan, unit_times(titan, titan.implementations.at(0), compose, {0, 256}).at("latency")), 40, 1e-9);
  const std::vector<std::uint64_t> one_bin = {7};
  EXPECT_EQ(bin_spread(titan, {{}, {}, one_bin}).busiest_core, 1);
}

// 65536 registers of a core are those of 512 threads of 128 registers, a quarter of 2048.
TEST(ModelledTime, RegistersLimitThreads) {
  StageCounters counters{StageId::shade};
  counters.lanes_issued = 1000000;
  counters.ops.bit = 1638400;
  const auto latency = [&](double registers) {
    const Hardware titan = with_shading_costs(titan_v(), {0, 0, registers}, {});
    return clocks(titan, unit_times(titan, titan.implementations.at(0), counters).at("latency"));
  };
  EXPECT_NEAR(latency(0), 40, 1e-9);
  EXPECT_NEAR(latency(32), 40, 1e-9);
  EXPECT_NEAR(latency(128), 160, 1e-9);
  EXPECT_NEAR(latency(100), 40 * 2048 / 655., 1e-9) << "whole threads";
}

// Two stages of 40 clocks each, one of lanes and one of textures. A core that holds one bin does one after the other;
// with two bins they overlap.
TEST(ModelledTime, BinsOfACoreOverlapTheirStages) {
  const Hardware titan = titan_without_latency();
  StageCounters compose{StageId::compose}, shade{StageId::shade};
  compose.ops.bit = 5120 * 40;
  shade.bytes_read = shade.texture_bytes = 5120 * 40;
  const std::vector<StageCounters> stages = {compose, shade};
  const auto on_cores = [&](double kib) {
    return clocks(titan, modelled_time(titan, titan.implementations.at(0), {stages, {kib * 1024}}).on_cores_ms);
  };
  EXPECT_NEAR(on_cores(96), 80, 1e-9);
  EXPECT_NEAR(on_cores(48), 40, 1e-9);
}

// One bin's threads hide half of the latency that two bins' do, so that holding two does not help a stage that waits.
TEST(ModelledTime, LatencyOfABinIsNotShared) {
  const Hardware titan = titan_v();
  StageCounters compose{StageId::compose};
  compose.items_in = 160 * 64;
  compose.ops.bit = 160 * 64 * 50;  // 50 operations of each of the 64 threads of a bin, two bins to a core: 400 clocks
  const std::vector<StageCounters> stages = {compose};
  const std::vector<std::uint64_t> bins(160, 1);
  const auto on_cores = [&](double kib) {
    return clocks(
        titan, modelled_time(titan, titan.implementations.at(0), {stages, {kib * 1024, 64}, bins, bins}).on_cores_ms);
  };
  EXPECT_NEAR(on_cores(96), 400, 1e-9);
  EXPECT_NEAR(on_cores(48), 200, 1e-9) << "two bins wait at the same time";
}

// Two cores, mean 8. In their order: 5 and 1 start; the 3 starts at 1 on the second core, the 4 at 4 there, and the
// last 3 at 5 on the first: ends at 8 both.
TEST(ModelledTime, BinsStartInTheirOrderOnTheCoreThatIsFreeFirst) {
  using Bins = std::vector<std::uint64_t>;
  const auto busiest = [](const Bins& bins, std::uint32_t cores) {
    Hardware hardware = titan_v();
    hardware.memory.cores = cores;
    return bin_spread(hardware, {{}, {}, bins}).busiest_core;
  };
  EXPECT_EQ(busiest({5, 1, 3, 4, 3}, 2), 1.0);
  EXPECT_EQ(busiest({1, 3, 3, 4, 5}, 2), 9.0 / 8) << "1, then 3 and 5 until 9; 3 and 4 until 7";
  EXPECT_EQ(busiest({45, 11, 11, 11, 11, 11}, 32), 45.0 * 32 / 100) << "one bin has 45 per cent";
  EXPECT_EQ(busiest({7}, 1), 1.0);
  EXPECT_EQ(busiest({}, 80), 1.0);
  EXPECT_EQ(busiest({0, 0}, 80), 1.0);
}

// 200 bins, 1 to 200, with a mean of 100.5: 99 % of them have at most 198. With 50 operations for each of 2 invocations
// all have 100 more.
TEST(ModelledTime, SpreadOfBins) {
  std::vector<std::uint64_t> operations(200), invocations(200, 2);
  std::iota(operations.rbegin(), operations.rend(), 1);
  const BinSpread bare = bin_spread(titan_v(), {{}, {}, operations, invocations});
  EXPECT_DOUBLE_EQ(bare.p99, 198 / 100.5);
  EXPECT_DOUBLE_EQ(bare.most, 200 / 100.5);
  const Hardware priced = with_shading_costs(titan_v(), {40, 0, 0}, {10, 0, 0});
  EXPECT_DOUBLE_EQ(bin_spread(priced, {{}, {}, operations, invocations}).most, 300 / 200.5);
}

// Of 80 cores one has twice the work of the mean. Geometry comes first: 1000 clocks of triangles. Then bins take 2 x 20
// clocks of shaders, or as long as DRAM takes for all of them.
TEST(ModelledTime, CoresWaitForTheirBusiestButShareDram) {
  const Hardware titan = titan_without_latency();
  StageCounters setup{StageId::vertex_setup}, compose{StageId::compose};
  setup.items_in = 6000;
  compose.ops.bit = 102400;
  const std::vector<std::uint64_t> bins(40, 10);  // on 80 cores
  const auto scheduled = [&](double dram_clocks) {
    compose.dram_bytes = static_cast<std::uint64_t>(dram_clocks * 448.7 * 0.77);
    const std::vector<StageCounters> stages = {setup, compose};
    return clocks(titan, modelled_time(titan, titan.implementations.at(0), {stages, {}, bins}).on_cores_ms);
  };
  EXPECT_NEAR(scheduled(0), 1000 + 40, 1e-6);
  EXPECT_NEAR(scheduled(20), 1000 + 40, 1e-6);
  EXPECT_NEAR(scheduled(60), 1000 + 60, 1e-2);
}

// 512 invocations, each with 100 operations and 5 probes of 16 bytes: 10 clocks of the float lanes, 8 of the texture
// units.
TEST(ModelledTime, ShadingCostsAreAddedToInvocations) {
  const auto time_of = [](const ShadingCost& material, const ShadingCost& light, const std::vector<StageId>& stages) {
    const Hardware titan = with_shading_costs(titan_without_latency(), material, light);
    std::vector<StageCounters> all;
    for (const StageId id : stages) all.emplace_back(StageCounters{id}).lanes_issued = 512;
    return clocks(titan, modelled_time(titan, titan.implementations.at(1), {all}).in_turn_ms);
  };
  const double quads = 512 / 96.0;  // which `shade` takes without any cost
  EXPECT_NEAR(time_of({}, {}, {StageId::shade}), quads, 1e-6);
  EXPECT_NEAR(time_of({100, 0, 0}, {}, {StageId::shade}), 10, 1e-6);
  EXPECT_NEAR(time_of({0, 5, 0}, {}, {StageId::shade}), 8, 1e-6);
  EXPECT_NEAR(time_of({100, 0, 0}, {50, 0, 0}, {StageId::shade}), 15, 1e-6) << "lights are in the fragment shader";
  EXPECT_NEAR(time_of({100, 0, 0}, {50, 0, 0}, {StageId::shade, StageId::light}), 10 + 5, 1e-6);
  EXPECT_NEAR(time_of({}, {50, 0, 0}, {StageId::shade, StageId::light}), quads + 5, 1e-6);
}

}  // namespace beampipe::modelled_time_test
