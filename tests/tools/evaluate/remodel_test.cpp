#include "tools/evaluate/remodel.h"

#include "tests/message_of.h"
#include "tests/test.h"
#include "tests/tools/report_frames.h"
#include "tools/report/times_text.h"

namespace beampipe::remodel_test {

Report small_report() {
  Report report;
  report.trace = "here/fence.json";
  report.memory.modelled = true;
  report.hardware = titan_v();
  TechniqueReport& result = report.results.emplace_back();
  result.technique = "beam";
  result.pixels_on_chip = true;
  for (std::size_t index = 0; index < 2; ++index) {
    FrameReport frame;
    frame.index = index;
    frame.pixels = frame.bin_pixels = 1024;
    frame.buffers = {{"open_pixels", 40 * 1024, true}, {"setup_triangles", 5000}};
    StageCounters stage{StageId::compose};
    stage.items_in = 1000 * (index + 1);
    stage.ops.add = 51200 * (index + 1);
    stage.ops.wide = 100;
    stage.position_tests = 768 * 20;
    stage.bytes_read = 100000;
    stage.sector_bytes = stage.l2_bytes = stage.dram_bytes = 640;
    frame.stages = {stage};
    frame.bin_operations = {51200, 0, 400};
    frame.bin_invocations = {4, 0, 8};
    result.frames.push_back(frame);
  }
  return report;
}

TEST(Remodel, TimesOfAReportAreThoseOfItsRun) {
  const Report report = small_report();
  const Report again = remodelled(report_json(report));
  EXPECT_EQ(again.trace, report.trace);
  EXPECT_EQ(again.hardware.label, "titan_v");
  EXPECT_EQ(times_json(again).dump(), times_json(report).dump());
  EXPECT_EQ(times_text(again), times_text(report));
}

// A bin of 40 KiB has room twice on a core of 96 KiB, and once on one of 64.
TEST(Remodel, OptionsOfTheRunHoldForOtherHardware) {
  Report report = small_report();
  report.memory.on_chip_bytes = 64 * 1024;
  report.hardware.memory = report.memory;
  Hardware slower = titan_v();
  slower.named = "slower.json";
  slower.rates.at("core_bit_per_clk") /= 2;
  const Report again = remodelled(report_json(report), &slower);
  EXPECT_EQ(again.hardware.memory.on_chip_bytes, 64u * 1024);
  EXPECT_EQ(again.hardware.rates.at("core_bit_per_clk"), 32);
  EXPECT_EQ(times_json(again).at(0).at("bins_held"), 1);
}

TEST(Remodel, BytesOfAnotherMemorySystemAreRefused) {
  const Json json = report_json(small_report());
  const Hardware other = read_hardware("rtx_4090");
  EXPECT_EQ(message_of<OtherMemory>([&] { remodelled(json, &other); }),
            "counted with l1_bytes 32768, and rtx_4090 has 28672: run it again with --hardware rtx_4090");
  Hardware one = titan_v();
  one.named = "ours.json";
  one.memory.cores = 40;
  EXPECT_EQ(message_of<OtherMemory>([&] { remodelled(json, &one); }),
            "counted with cores 80, and ours.json has 40: run it again with --hardware ours.json");
}

}  // namespace beampipe::remodel_test
