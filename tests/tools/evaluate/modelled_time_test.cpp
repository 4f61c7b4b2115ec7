#include "tools/evaluate/modelled_time.h"

#include "tests/test.h"
#include "tools/evaluate/frame_report.h"
#include "tools/evaluate/hardware_units.h"
#include "traces/scenes.h"

namespace beampipe::modelled_time_test {

// Whose threads wait for nothing, so that a few fill it.
Hardware titan_without_latency() {
  Hardware titan = titan_v();
  for (const char* rate : {"operation_clocks", "fetch_clocks", "l2_clocks", "dram_clocks"})
    titan.rates.at(rate) = kLeastRate;
  return titan;
}

double clocks(const Hardware& hardware, double ms) { return ms * hardware.clock_mhz * 1e3; }

constexpr std::size_t kShaders = 0, kFixed = 1;  // implementations of a Titan V

// The clocks that a unit takes for a stage alone.
struct UnitCase {
  const char* unit;
  StageCounters work;
  double clocks;
  std::size_t implementation = kShaders;
  BinSize bin = {};
  double bins = 1;
};

void expect_clocks(const std::vector<UnitCase>& cases, const Hardware& hardware = titan_v()) {
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const UnitCase& each = cases[i];
    const auto times =
        unit_times(hardware, hardware.implementations.at(each.implementation), each.work, each.bin, each.bins);
    EXPECT_NEAR(clocks(hardware, times.at(each.unit)), each.clocks, 1e-9) << "case " << i << ", " << each.unit;
  }
}

ModelledTime time_of(const Hardware& hardware, const std::vector<StageCounters>& stages,
                     std::size_t implementation = kShaders, const BinSize& bin = {},
                     const std::vector<std::uint64_t>& bin_operations = {},
                     const std::vector<std::uint64_t>& bin_invocations = {}) {
  return modelled_time(hardware, hardware.implementations.at(implementation),
                       {stages, bin, bin_operations, bin_invocations});
}

const StageCounters kRaster{
    .stage = StageId::sample_raster, .items_in = 6000, .items_out = 9600, .l2_bytes = 1536 * 3, .dram_bytes = 3455};
const StageCounters kCompose{
    .stage = StageId::compose, .ops = {5120, 5120, 0, 0, 1280, 0}, .l2_bytes = 1536 * 3, .dram_bytes = 3455};

// Each unit takes its work divided by its rate: 6000 triangles at 6 per clock, 9600 pixels at 96 per clock, two clocks
// of float operations, three clocks of L2 and ten of DRAM, which reaches 77 % of 448.7 bytes per clock.
TEST(ModelledTime, TimeIsWorkOverRate) {
  expect_clocks({{"raster", kRaster, 1000},
                 {"l2", kRaster, 3},
                 {"dram", kRaster, 3455 / (448.7 * 0.77)},
                 {"shader", kCompose, 2}});
  const Hardware titan = titan_v();
  EXPECT_FALSE(unit_times(titan, titan.implementations[kShaders], kRaster).contains("shader"));
  EXPECT_FALSE(unit_times(titan, titan.implementations[kFixed], kCompose).contains("latency"));
}

// 3840 bytes of colours at 384 per clock, where ROPs follow. Composition in shaders keeps its colours, that in ROPs
// does not.
TEST(ModelledTime, ColoursGoToRops) {
  const StageCounters shade{.stage = StageId::shade, .bytes_written = 3840};
  const auto of = [&](const Hardware& hardware, std::size_t implementation, const std::vector<StageId>& after) {
    std::vector<StageCounters> stages = {shade};
    for (const StageId id : after) stages.push_back({id});
    return clocks(hardware, time_of(hardware, stages, implementation).in_turn_ms);
  };
  const Hardware titan = titan_without_latency(), mali = read_hardware("mali_g710");
  EXPECT_NEAR(of(titan, kShaders, {StageId::depth_test}), 10, 1e-6);
  EXPECT_NEAR(of(titan, kShaders, {StageId::accumulate}), 10, 1e-6);
  EXPECT_NEAR(of(titan, kShaders, {StageId::compose}), 3840.0 / 10240, 1e-6);
  EXPECT_NEAR(of(titan, kFixed, {StageId::compose}), 10, 1e-6);
  EXPECT_NEAR(of(mali, 0, {StageId::compose, StageId::resolve}), 3840.0 / 640, 1e-6)
      << "ROPs resolve what cores have kept on chip";
}

// 5120 bytes of pixels at 10240 per clock on chip or 2048 in memory, or 4800 samples at 768. The sums of a unit have
// the rate at which most of them go.
TEST(ModelledTime, TheRateThatLimitsAUnitIsNamed) {
  const Hardware titan = titan_without_latency();
  const auto rate = [&](std::uint64_t samples, std::uint64_t bytes, double bin_bytes) {
    const StageCounters test{.stage = StageId::depth_test, .items_in = samples, .bytes_read = bytes};
    const ModelledTime time = time_of(titan, {test}, kShaders, {bin_bytes});
    EXPECT_EQ(time.busiest, "rop_samples");
    EXPECT_EQ(time.stages.at(0).busiest_rate, time.busiest_rate);
    return time.busiest_rate;
  };
  EXPECT_EQ(rate(4800, 5120, 1024), "rop_samples_per_clk");
  EXPECT_EQ(rate(48, 5120, 1024), "core_on_chip_bytes_per_clk");
  EXPECT_EQ(rate(48, 5120, 0), "rop_bytes_per_clk");
  const StageCounters floats{.stage = StageId::compose, .ops = {.add = 5120 * 30}};
  const StageCounters bits{.stage = StageId::bin_sort, .ops = {.bit = 5120 * 40}};
  const ModelledTime sum = time_of(titan, {floats, bits, floats});
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
  const ModelledTime time = time_of(titan, {{.stage = StageId::vertex_setup, .items_in = 6000},
                                            {.stage = StageId::sample_raster, .items_in = 6000, .items_out = 3000}});
  EXPECT_NEAR(clocks(titan, time.at_once_ms), 1000, 1e-6);
  EXPECT_NEAR(clocks(titan, time.in_turn_ms), 2000, 1e-6);
}

TEST(ModelledTime, OverlapIsTheBusiestUnitAndSumEachStagesBusiest) {
  const Hardware titan = titan_without_latency();
  const ModelledTime time = time_of(titan, {kRaster, kCompose, kCompose});
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
  const StageCounters busy{.stage = StageId::compose, .ops = {.bit = 5120 * 100}};
  const Hardware titan = titan_without_latency();
  const ModelledTime time = time_of(titan, {busy, busy});
  EXPECT_NEAR(clocks(titan, time.at_once_ms), 200, 1e-6);
  EXPECT_EQ(time.busiest, "shader");
}

TEST(ModelledTime, LanesThatAStageNamesTwiceWorkOnce) {
  Hardware titan = titan_without_latency();
  const StageCounters busy{.stage = StageId::shade, .ops = {.bit = 5120 * 100}};
  const double once = time_of(titan, {busy}).at_once_ms;
  titan.implementations[kShaders].units.at(StageId::shade).push_back("shader");
  EXPECT_EQ(time_of(titan, {busy}).at_once_ms, once);
}

// 9600 positions of masks at 9216 per clock, but 960 pairs at 96; 1000 comparisons at 96; 7680 contested positions at
// 768; 20480 bytes at 2048.
TEST(ModelledTime, FixedFunctionsFollowTheirWork) {
  const auto masks = [](std::uint64_t tests) {
    return StageCounters{.stage = StageId::beam_fragment, .items_in = 960, .position_tests = tests};
  };
  const auto sorting = [](std::uint64_t comparisons) {
    return StageCounters{.stage = StageId::a_buffer, .items_in = 960, .ops = {.add = comparisons}};
  };
  const auto composition = [](std::uint64_t positions, std::uint64_t bytes) {
    return StageCounters{.stage = StageId::compose, .items_in = 96, .bytes_read = bytes, .position_tests = positions};
  };
  const auto rop = [](std::uint64_t bytes) {
    return StageCounters{.stage = StageId::depth_test, .items_in = 512, .bytes_written = bytes};
  };
  expect_clocks({{"mask_generator", masks(960 * 32 * 3), 10, kFixed},
                 {"mask_generator", masks(960 * 256 * 3), 80, kFixed},
                 {"sorter", sorting(0), 10, kFixed},
                 {"sorter", sorting(9600), 100, kFixed},  // long lists need more comparisons
                 {"composer", composition(0, 0), 1, kFixed},
                 {"composer", composition(7680, 0), 10, kFixed},
                 {"composer", composition(0, 20480), 10, kFixed},
                 {"rop_samples", rop(2048), 1, kFixed},
                 {"rop_samples", rop(2 * 2048), 2, kFixed}});  // wider formats take longer
}

// 20480 bytes of pixels take 10 clocks of ROPs, which move 2048 a clock, and 2 of 80 cores, which move 128 each: those
// of shaders, and of ROPs where the pixels are on chip. Texels, which have a rate of their own, do not count for
// shaders.
TEST(ModelledTime, BytesOfPixelsMoveWhereThePixelsAre) {
  const auto moved = [](StageId id) { return StageCounters{.stage = id, .bytes_read = 20480}; };
  const StageCounters with_texels{.stage = StageId::compose, .bytes_read = 20480 + 1000, .texture_bytes = 1000};
  expect_clocks({{"composer", moved(StageId::compose), 10, kFixed},
                 {"composer", moved(StageId::compose), 2, kFixed, {1024}},
                 {"rop_samples", moved(StageId::depth_test), 10},
                 {"rop_samples", moved(StageId::depth_test), 2, kShaders, {1024}},
                 {"rop_fragments", moved(StageId::accumulate), 2, kShaders, {1024}},
                 {"shader", with_texels, 2},
                 {"shader", with_texels, 2, kShaders, {1024}}});
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
  expect_clocks({{"shader", {.stage = StageId::compose, .ops = {.add = 5120}}, 1},
                 {"shader", {.stage = StageId::compose, .ops = {.add = 5120, .wide = 5120}}, 2}});
}

// Where integer lanes take no time, issuing is what is left: twice for each operation. Where that takes none either,
// nothing is: float lanes do none of this work.
TEST(ModelledTime, WideIntegersAreIssuedTwiceAndTakeNoFloatLanes) {
  Hardware titan = titan_v();
  titan.rates.at("core_wide_per_clk") = 1e12;
  const StageCounters wide{.stage = StageId::compose, .ops = {.add = 5120, .wide = 5120}};
  titan.rates.at("core_issue_per_clk") = 6.4;
  expect_clocks({{"shader", wide, 20}}, titan);
  titan.rates.at("core_issue_per_clk") = 1e12;
  const double left = unit_times(titan, titan.implementations[kShaders], wide).at("shader");
  EXPECT_NEAR(clocks(titan, left), 0, 1e-6);
}

// 960 pixels at 96 per clock, of which 96 are visible.
TEST(ModelledTime, ConservativeRastersTakeHiddenPixelsToo) {
  expect_clocks({{"conservative_raster",
                  {.stage = StageId::conservative_raster, .items_out = 96, .lanes_used = 960},
                  10,
                  kFixed}});
}

StageCounters million_threads(StageCounters work) {
  work.items_in = work.lanes_issued = 1000000;
  return work;
}

// 80 cores with 2048 threads each: 163840. A thread waits 4 clocks for each of its operations, 28 for a load, and four
// of them together 193 for a sector of 32 bytes from L2, or 375 for one from DRAM. What DRAM moves, L2 moves too. A
// probe of a texture reads 16 bytes.
TEST(ModelledTime, ThreadsWaitForOperationsLoadsAndSectors) {
  constexpr std::uint64_t kThreads = 163840, kSectors = kThreads * 32, kProbes = kThreads * 16;
  constexpr StageId kId = StageId::compose;
  const std::pair<StageCounters, double> cases[] = {
      {{.stage = kId, .ops = {.bit = 10 * kThreads}}, 40},
      {{.stage = kId, .ops = {.add = 10 * kThreads, .wide = 10 * kThreads}}, 80},  // twice
      {{.stage = kId, .ops = {.fetch = 10 * kThreads}}, 280},
      {{.stage = kId, .l2_bytes = kSectors}, 4 * 193},
      {{.stage = kId, .l2_bytes = kSectors, .dram_bytes = kSectors}, 4 * 375},
      {{.stage = kId, .dram_bytes = kSectors}, 0},  // write-backs
      {{.stage = StageId::shade, .bytes_read = kProbes, .texture_bytes = kProbes}, 28}};
  for (const auto& [work, expected] : cases) expect_clocks({{"latency", million_threads(work), expected}});
}

// A bin of 16 x 16 pixels has 256 threads. With room for two of them, 80 cores have 40960 threads in place of 163840;
// with room for one, half as many.
TEST(ModelledTime, FewerBinsHideLessLatency) {
  const StageCounters compose = million_threads({.stage = StageId::compose, .ops = {.bit = 1638400}});
  const StageCounters setup = million_threads({.stage = StageId::vertex_setup, .ops = {.bit = 1638400}});
  constexpr double kKiB = 1024;
  expect_clocks({{"latency", compose, 40, kShaders, {0, 0}},
                 {"latency", compose, 160, kShaders, {48 * kKiB, 256}},
                 {"latency", compose, 320, kShaders, {49 * kKiB, 256}},
                 {"latency", compose, 40, kShaders, {48 * kKiB, 1024}},
                 // In memory eight have room, with as many pixels as two of 32 x 32.
                 {"latency", compose, 40, kShaders, {0, 256}},
                 {"latency", setup, 40, kShaders, {49 * kKiB, 256}}});  // not of bins
  Hardware titan = titan_v();
  titan.memory.bins_per_core = 6;
  expect_clocks({{"latency", compose, 80, kShaders, {24 * kKiB, 256}}}, titan);  // four have room
  // Without bins the cores share a frame's triangles evenly, and none waits for a bin.
  titan.memory.binned = false;
  expect_clocks({{"latency", compose, 40, kShaders, {0, 256}}}, titan);
  const std::vector<std::uint64_t> one_bin = {7};
  EXPECT_EQ(bin_spread(titan, {{}, {}, one_bin}).busiest_core, 1);
}

// A thousand bins of 16 x 16 pixels, of which a core holds two. Of a bin 1280 fragments are shaded, so that the 2048
// threads of a core are all in flight, but 256 are composed, one of each pixel. Helper lanes are threads, too.
TEST(ModelledTime, ThreadsAreFragmentsOrPixels) {
  const auto row = [](StageId id, std::uint64_t items, std::uint64_t lanes, std::uint64_t bins, double expected) {
    const StageCounters work{
        .stage = id, .items_in = items * bins, .ops = {.bit = 1638400}, .lanes_issued = lanes * bins};
    return UnitCase{"latency", work, expected, kShaders, {48 * 1024, 256}, static_cast<double>(bins)};
  };
  expect_clocks({row(StageId::beam_fragment, 1280, 0, 1000, 40), row(StageId::compose, 1280, 0, 1000, 160),
                 row(StageId::compose, 64, 0, 1000, 640),  // a fragment in each fourth pixel
                 row(StageId::beam_fragment, 256, 0, 1000, 160),
                 row(StageId::shade, 128, 256, 1000, 160),             // every second is a helper
                 row(StageId::beam_fragment, 640, 0, 1, 40 * 256),     // 640 threads are all that there are
                 row(StageId::beam_fragment, 0, 0, 1, 40 * 163840)});  // at least one
}

// 65536 registers of a core are those of 512 threads of 128 registers, a quarter of 2048.
TEST(ModelledTime, RegistersLimitThreads) {
  const StageCounters shade = million_threads({.stage = StageId::shade, .ops = {.bit = 1638400}});
  for (const auto& [registers, expected] :
       {std::pair{0.0, 40.0}, {32, 40}, {128, 160}, {100, 40 * 2048 / 655.}})  // whole threads
    expect_clocks({{"latency", shade, expected}}, with_shading_costs(titan_v(), {0, 0, registers}, {}));
}

// Two stages of 40 clocks each, one of lanes and one of textures. A core that holds one bin does one after the other;
// with two bins they overlap.
TEST(ModelledTime, BinsOfACoreOverlapTheirStages) {
  const Hardware titan = titan_without_latency();
  const std::vector<StageCounters> stages = {
      {.stage = StageId::compose, .ops = {.bit = 5120 * 40}},
      {.stage = StageId::shade, .bytes_read = 5120 * 40, .texture_bytes = 5120 * 40}};
  EXPECT_NEAR(clocks(titan, time_of(titan, stages, kShaders, {96 * 1024}).on_cores_ms), 80, 1e-9);
  EXPECT_NEAR(clocks(titan, time_of(titan, stages, kShaders, {48 * 1024}).on_cores_ms), 40, 1e-9);
}

// One bin's threads hide half of the latency that two bins' do, so that holding two does not help a stage that waits.
// Of each of the 64 threads of a bin 50 operations, two bins to a core: 400 clocks.
TEST(ModelledTime, LatencyOfABinIsNotShared) {
  const Hardware titan = titan_v();
  const StageCounters compose{.stage = StageId::compose, .items_in = 160 * 64, .ops = {.bit = 160 * 64 * 50}};
  const std::vector<std::uint64_t> bins(160, 1);
  for (const auto& [kib, expected] : {std::pair{96.0, 400.0}, {48, 200}})  // two bins wait at the same time
    EXPECT_NEAR(clocks(titan, time_of(titan, {compose}, kShaders, {kib * 1024, 64}, bins, bins).on_cores_ms), expected,
                1e-9);
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
  const std::vector<std::uint64_t> bins(40, 10);  // on 80 cores
  const auto scheduled = [&](double dram_clocks) {
    const auto dram = static_cast<std::uint64_t>(dram_clocks * 448.7 * 0.77);
    const std::vector<StageCounters> stages = {{.stage = StageId::vertex_setup, .items_in = 6000},
                                               {.stage = StageId::compose, .ops = {.bit = 102400}, .dram_bytes = dram}};
    return clocks(titan, time_of(titan, stages, kShaders, {}, bins).on_cores_ms);
  };
  EXPECT_NEAR(scheduled(0), 1000 + 40, 1e-6);
  EXPECT_NEAR(scheduled(20), 1000 + 40, 1e-6);
  EXPECT_NEAR(scheduled(60), 1000 + 60, 1e-2);
}

// 512 invocations, each with 100 operations and 5 probes of 16 bytes: 10 clocks of the float lanes, 8 of the texture
// units.
TEST(ModelledTime, ShadingCostsAreAddedToInvocations) {
  const auto clocks_of = [](const ShadingCost& material, const ShadingCost& light, const std::vector<StageId>& stages) {
    const Hardware titan = with_shading_costs(titan_without_latency(), material, light);
    std::vector<StageCounters> all;
    for (const StageId id : stages) all.emplace_back(StageCounters{id}).lanes_issued = 512;
    return clocks(titan, time_of(titan, all, kFixed).in_turn_ms);
  };
  const double quads = 512 / 96.0;  // which `shade` takes without any cost
  EXPECT_NEAR(clocks_of({}, {}, {StageId::shade}), quads, 1e-6);
  EXPECT_NEAR(clocks_of({100, 0, 0}, {}, {StageId::shade}), 10, 1e-6);
  EXPECT_NEAR(clocks_of({0, 5, 0}, {}, {StageId::shade}), 8, 1e-6);
  EXPECT_NEAR(clocks_of({100, 0, 0}, {50, 0, 0}, {StageId::shade}), 15, 1e-6) << "lights are in the fragment shader";
  EXPECT_NEAR(clocks_of({100, 0, 0}, {50, 0, 0}, {StageId::shade, StageId::light}), 10 + 5, 1e-6);
  EXPECT_NEAR(clocks_of({}, {50, 0, 0}, {StageId::shade, StageId::light}), quads + 5, 1e-6);
}

}  // namespace beampipe::modelled_time_test
