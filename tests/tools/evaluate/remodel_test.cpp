#include "tools/evaluate/remodel.h"

#include "tests/test.h"
#include "tests/tools/report_frames.h"
#include "tools/report/report_text.h"

namespace beampipe::remodel_test {

Report small_report() {
  Report report;
  report.trace = "here/fence.json";
  report.memory.modelled = true;
  report.hardware = titan_v();
  TechniqueReport& result = report.results.emplace_back();
  result.technique = "beam";
  for (std::size_t index = 0; index < 2; ++index) {
    FrameReport frame;
    frame.index = index;
    frame.pixels = frame.bin_pixels = 1024;
    frame.buffers = {{"open_pixels", 160 * 1024, true}, {"setup_triangles", 5000}};
    StageCounters stage{StageId::compose};
    stage.items_in = 1000 * (index + 1);
    stage.ops.add = 51200 * (index + 1);
    stage.ops.wide = 100;
    stage.position_tests = 768 * 20;
    stage.bytes_read = 100000;
    stage.sector_bytes = stage.l2_bytes = stage.dram_bytes = 640;
    frame.stages = {stage};
    result.frames.push_back(frame);
  }
  return report;
}

TEST(Remodel, TimesOfAReportAreThoseOfItsRun) {
  const Report report = small_report();
  const Report again = remodelled(report_json(report), {titan_v()});
  EXPECT_EQ(again.trace, report.trace);
  EXPECT_EQ(times_json(again).dump(), times_json(report).dump());
  EXPECT_EQ(times_text(again), times_text(report));
}

TEST(Remodel, OtherHardwareStandsBesideTheFirst) {
  const Report both = remodelled(report_json(small_report()), {read_hardware("rtx_4090"), titan_v()});
  const Json times = times_json(both);
  ASSERT_EQ(times.elements().size(), 4u);
  EXPECT_EQ(times.elements()[0].at("implementation").get<std::string>(), "rtx_4090.shaders");
  EXPECT_EQ(times.elements()[2].at("implementation").get<std::string>(), "titan_v.shaders");
  EXPECT_LT(times.elements()[0].at("sum").get<double>(), times.elements()[2].at("sum").get<double>());
  Report report = small_report();
  report.more_hardware = {read_hardware("rtx_4090")};
  const Json frame = report_json(report).at("results").elements()[0].at("frames").elements()[0];
  EXPECT_TRUE(frame.at("modelled_ms").contains("shaders"));
  EXPECT_TRUE(frame.at("modelled_ms").contains("rtx_4090.shaders"));
}

}  // namespace beampipe::remodel_test
