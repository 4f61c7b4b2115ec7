#include "tools/evaluate/frame_reports.h"

#include "tests/test.h"
#include "tools/evaluate/frame_json.h"

namespace beampipe::frame_reports_test {

FrameReport report_of_frame(std::size_t index) {
  FrameReport frame;
  frame.index = index;
  frame.image = "beam/frame_" + std::to_string(index) + ".exr";
  frame.error = ErrorStats{0.1 * static_cast<double>(index), -1.0 / 3, 1e-30, 1};
  frame.wall_ms = {.median = 1.0 / 7, .min = 0.1, .max = 0.3, .runs = 3, .with_memory_model = true};
  frame.pixels = 1000 + index;
  frame.buffers = {{"open_pixels", 1ull << 60, true}};
  frame.pixel_counters["fragments"] = {2.5, 61};
  frame.stopped = {{3, 120 + index}, {5, 1}};
  StageCounters stage{StageId::compose};
  stage.items_in = (1ull << 63) + index;
  frame.stages = {stage, StageCounters{StageId::resolve}};
  return frame;
}

std::string text_of(const FrameReport& frame) { return stored_json(frame).dump(); }

TEST(FrameReports, KeepsFramesInMemoryAndInAFile) {
  for (const std::size_t in_memory : {std::size_t{0}, std::size_t{1}, std::size_t{3}, FrameReports::kAll}) {
    SCOPED_TRACE(in_memory);
    FrameReports reports(in_memory);
    EXPECT_TRUE(reports.empty());
    for (std::size_t i = 0; i < 5; ++i) {
      reports.push_back(report_of_frame(i));
      EXPECT_EQ(reports.size(), i + 1);
      EXPECT_EQ(text_of(reports.back()), text_of(report_of_frame(i)));
      EXPECT_EQ(text_of(reports.front()), text_of(report_of_frame(0)));
    }
    std::size_t next = 0;
    for (const FrameReport& frame : reports) EXPECT_EQ(text_of(frame), text_of(report_of_frame(next++)));
    EXPECT_EQ(next, 5u);
    for (const std::size_t i : {4, 0, 2, 1, 3}) EXPECT_EQ(text_of(reports[i]), text_of(report_of_frame(i)));
  }
}

TEST(FrameReports, CopiesDoNotSeeWhatOthersAdd) {
  FrameReports one(1);
  one.push_back(report_of_frame(0));
  one.push_back(report_of_frame(1));
  FrameReports other = one;
  one.push_back(report_of_frame(2));
  other.push_back(report_of_frame(3));
  one.push_back(report_of_frame(4));
  ASSERT_EQ(one.size(), 4u);
  ASSERT_EQ(other.size(), 3u);
  EXPECT_EQ(one[2].index, 2u);
  EXPECT_EQ(one[3].index, 4u);
  EXPECT_EQ(other[1].index, 1u);
  EXPECT_EQ(other[2].index, 3u);
}

}  // namespace beampipe::frame_reports_test
