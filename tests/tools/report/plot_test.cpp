// Plots: means over reports, labels that do not cover each other, and the files that gnuplot draws.

#include "tools/report/plot.h"

#include <csignal>

#include "tests/tools/program.h"
#include "tools/report/gnuplot.h"
#include "tools/report/label_placement.h"
#include "traces/files/image_file.h"

namespace beampipe::plot_test {

// A report of `compare` on msaa:1, msaa:8 and one other technique.
std::string report_text(const std::string& spec, int bytes, double emr, double rmse, double ms,
                        const std::string& more = "") {
  const auto result = [](const std::string& name, int size, double n, double error, double time,
                         const std::string& keys) {
    return R"({"technique": ")" + name + R"(", "peak_bytes_per_pixel": )" + std::to_string(size) +
           R"(, "error": {"rmse": )" + std::to_string(error) + R"(}, "equivalent_msaa": )" + std::to_string(n) + keys +
           R"(, "frames": [{"wall_ms": {"median": )" + std::to_string(time) + "}}]}";
  };
  return R"({"beampipe_report": 2, "trace": "some/where/rods.json",
             "msaa_ladder": [{"samples": 1, "rmse": 0.1}, {"samples": 8, "rmse": 0.03}], "results": [)" +
         result(spec, bytes, emr, rmse, ms, more) + "," + result("msaa:8", 80, 8, 0.03, 20, "") + "," +
         result("msaa:1", 10, 1, 0.1, 10, "") + "," + result("reference", 65536, 8, 0, 1000, "") + "]}";
}

class PlotTest : public RunInFolder {
 protected:
  std::filesystem::path make_report(const std::string& name, const std::string& text) {
    std::filesystem::create_directory(folder_ / name);
    write_text(folder_ / name / "report.json", text);
    return folder_ / name;
  }
};

TEST_F(PlotTest, FrontierHasThePointsOfTheLadderAndOfEveryTechniqueButTheReference) {
  const ReportFile report = read_report(make_report("a", report_text("beam", 42, 100, 0.01, 50)));
  EXPECT_EQ(report.scene, "rods");
  const ScatterPlot plot = frontier_plot({report});
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[0].name, "msaa");
  EXPECT_TRUE(plot.series[0].line);
  ASSERT_EQ(plot.series[0].points.size(), 2u);
  EXPECT_EQ(plot.series[0].points[1].x, 80);
  EXPECT_EQ(plot.series[0].points[1].y, 8);
  ASSERT_EQ(plot.series[1].points.size(), 1u);
  EXPECT_EQ(plot.series[1].points[0].x, 42);
  EXPECT_EQ(plot.series[1].points[0].y, 100);
  EXPECT_EQ(plot.series[1].points[0].label, "beam");
  EXPECT_EQ(plot.series[1].points[0].bound, PlotPoint::Bound::none);
  const std::string script = gnuplot_script(plot, PlotFormat::svg);
  EXPECT_NE(script.find("textcolor rgb '" + plot.series[0].color), script.npos) << "labels of a line have its colour";
}

TEST_F(PlotTest, SamplesOnChipTakeNoMemoryOnTheFrontier) {
  std::string text = report_text("beam", 6, 100, 0.01, 50);
  text.insert(1, R"("memory_system": {"modelled": true, "framebuffer": "on-chip"}, )");
  const ScatterPlot plot = frontier_plot({read_report(make_report("a", text))});
  for (const PlotPoint& rung : plot.series[0].points) EXPECT_EQ(rung.x, 6) << rung.label << ": the picture alone";
}

TEST_F(PlotTest, WithoutMemoryThereIsNoPoint) {
  std::string text = report_text("own", 0, 100, 0.01, 50);
  for (const char* bytes : {": 80,", ": 10,"})
    for (std::size_t at = 0; (at = text.find(bytes, at)) != text.npos; ++at) text.replace(at, 5, ": 0,");
  const ScatterPlot plot = storage_plot({read_report(make_report("a", text))});
  for (const PlotSeries& series : plot.series) EXPECT_TRUE(series.points.empty()) << series.name;
  ASSERT_EQ(plot.notes.size(), 3u);
  EXPECT_TRUE(plot.notes[0].starts_with("own is not drawn: ")) << plot.notes[0];
}

TEST_F(PlotTest, RatesByDifferentMetricsHaveNoMean) {
  std::vector<ReportFile> reports;
  for (const std::string metric : {"rmse", "psnr"}) {
    std::string text = report_text("beam", 42, 4, 0.01, 50);
    reports.push_back(read_report(make_report(metric, text.insert(1, "\"metric\": \"" + metric + "\", "))));
  }
  try {
    frontier_plot(reports);
    FAIL();
  } catch (const ReportError& error) {
    EXPECT_EQ(std::string(error.what()), (folder_ / "psnr").string() + ": expected equivalent rates by rmse, as in " +
                                             (folder_ / "rmse").string() + ", found rates by psnr");
  }
  EXPECT_FALSE(speed_plot(reports).series.empty()) << "which has no rates";
}

TEST_F(PlotTest, GnuplotRunsNothingThatALabelSays) {
  const std::string spec = "beam`touch ran`";
  const std::string script = gnuplot_script(
      frontier_plot({read_report(make_report("a", report_text(spec, 42, 100, 0.01, 50)))}), PlotFormat::svg);
  expect_parts(script, {"set label '" + spec + "' at"});
}

TEST_F(PlotTest, StorageIsAllMemoryOnChipAndOffChip) {
  const auto report = [&](const std::string& name, int bytes) {
    return read_report(make_report(
        name, report_text("beam", bytes, 100, 0.01, 50, R"(, "on_chip_bytes_per_pixel": )" + std::to_string(bytes))));
  };
  const ScatterPlot plot = storage_plot({report("a", 20), report("b", 80)});
  ASSERT_EQ(plot.series.size(), 2u);
  ASSERT_EQ(plot.series[0].points.size(), 2u);
  EXPECT_EQ(plot.series[0].points[0].x, 10) << "a line by increasing memory";
  EXPECT_EQ(plot.series[0].points[1].x, 80);
  ASSERT_EQ(plot.series[1].points.size(), 1u);
  EXPECT_NEAR(plot.series[1].points[0].x, 80, 1e-9) << "the mean of 20 + 20 and 80 + 80";
  EXPECT_EQ(plot.series[1].points[0].y, 100);
}

TEST_F(PlotTest, TechniquesThatDifferInThePoolAreALine) {
  const auto result = [](const std::string& spec, int bytes) {
    return R"({"technique": ")" + spec + R"(", "peak_bytes_per_pixel": )" + std::to_string(bytes) +
           R"(, "error": {"rmse": 0.1}, "equivalent_msaa": 9, "frames": [{"wall_ms": {"median": 1}}]},)";
  };
  const ReportFile report = read_report(make_report(
      "a", R"({"beampipe_report": 2, "trace": "rods.json", "results": [)" + result("beam:bits=64,pool=30", 90) +
               result("beam:bits=64,pool=16", 70) + result("beam:pool=128,bin=8", 400) + result("beam", 150) +
               result("beam:pool=80", 200) + result("beam:bin=8", 160) + R"({"technique": "z3",
               "peak_bytes_per_pixel": 50, "frames": [{"wall_ms": {"median": 1}}]}]})"));
  const ScatterPlot plot = storage_plot({report});
  std::vector<std::string> found;
  for (const PlotSeries& series : plot.series) {
    found.push_back(series.name + (series.line ? " -" : ""));
    for (const PlotPoint& point : series.points) found.push_back("  " + point.label);
  }
  EXPECT_EQ(found, (std::vector<std::string>{"msaa -", "beam:bits=64 -", "  beam:bits=64,pool=16", "  30",
                                             "beam:bin=8 -", "  beam:bin=8", "  128", "beam -", "  beam", "  80"}));
}

TEST_F(PlotTest, SeveralReportsGiveGeometricMeansAndTheirBounds) {
  const std::vector<ReportFile> reports = {
      read_report(make_report("a", report_text("beam", 42, 4, 0.01, 50))),
      read_report(
          make_report("b", report_text("beam", 42, 64, 0.04, 200, R"(, "equivalent_msaa_is_lower_bound": true)")))};
  const TechniqueSummary mean = mean_summaries(reports).front();
  EXPECT_NEAR(mean.emr->samples, 16, 1e-9);
  EXPECT_NEAR(*mean.rmse, 0.02, 1e-9);
  EXPECT_NEAR(mean.wall_ms, 100, 1e-9);
  EXPECT_NEAR(mean.bytes_per_pixel, 42, 1e-9);
  EXPECT_EQ(frontier_plot(reports).series[1].points[0].bound, PlotPoint::Bound::lower);

  const ReportFile other = read_report(make_report("c", report_text("alpha", 10, 4, 0.01, 50)));
  const std::vector<TechniqueSummary> common = mean_summaries({reports[0], other});
  ASSERT_EQ(common.size(), 2u) << "only techniques that are in all reports";
  EXPECT_EQ(common[0].spec, "msaa:8");
}

TEST_F(PlotTest, WhatALogarithmicAxisLacksIsNoted) {
  const ReportFile report = read_report(make_report("a", report_text("beam", 42, 100, 0, 50)));
  const ScatterPlot plot = speed_plot({report});
  EXPECT_EQ(plot.series.size(), 1u);
  ASSERT_EQ(plot.notes.size(), 1u);
  EXPECT_EQ(plot.notes[0].rfind("beam is not drawn: RMSE", 0), 0u) << plot.notes[0];
}

TEST(LabelPlacement, KeepsLabelsOffEachOtherOffPointsAndInside) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(60, 640), y(40, 380), width(20, 60);
  LabelTask task{.width = 700, .height = 420, .label_height = 14, .point_radius = 5};
  for (int i = 0; i < 12; ++i) {
    task.points.push_back({x(random), y(random)});
    task.label_widths.push_back(i % 4 == 3 ? 0 : width(random));
  }
  const std::vector<PixelPoint> centers = place_labels(task);
  ASSERT_EQ(centers.size(), task.points.size());
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const double w = task.label_widths[i];
    if (w == 0) continue;
    EXPECT_TRUE(centers[i].x >= w / 2 && centers[i].x <= 700 - w / 2 && centers[i].y >= 7 && centers[i].y <= 413) << i;
    for (std::size_t j = 0; j < centers.size(); ++j) {
      const double dx = std::abs(centers[i].x - task.points[j].x), dy = std::abs(centers[i].y - task.points[j].y);
      EXPECT_TRUE(dx > w / 2 + 4.999 || dy > 7 + 4.999) << "label " << i << " on point " << j;
      if (j == i || task.label_widths[j] == 0) continue;
      const bool apart = std::abs(centers[i].x - centers[j].x) > (w + task.label_widths[j]) / 2 - 1e-6 ||
                         std::abs(centers[i].y - centers[j].y) > 14 - 1e-6;
      EXPECT_TRUE(apart) << "labels " << i << " and " << j;
    }
  }
}

TEST_F(PlotTest, SvgHoldsAPointAndALabelForEveryTechnique) {
  make_report("a", report_text("beam:it's", 42, 100, 0.01, 50));
  for (const std::string kind : {"frontier", "speed"}) {
    const Outcome outcome = run_program({"plot", path("a"), "--kind", kind, "-o", path("plot.svg")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string svg = read_text(folder_ / "plot.svg");
    EXPECT_EQ(count_of(svg, "<use xlink:href='#gpPt6' transform="), 3u) << kind;
    for (const std::string label : {">beam:it's<", ">msaa:1<", ">msaa:8<"}) {
      EXPECT_EQ(count_of(svg, label), 1u) << kind << " " << label;
    }
    EXPECT_EQ(count_of(svg, ">reference<"), 0u);
  }
}

TEST_F(PlotTest, PngDecodesAndIsNotBlank) {
  make_report("a", report_text("beam", 42, 100, 0.01, 50));
  ASSERT_EQ(run_program({"plot", path("a"), "-o", path("plot.png")}).exit_code, 0);
  const TextureImage png = decode_image(read_text(folder_ / "plot.png"));
  EXPECT_EQ(png.width, 1520u);
  EXPECT_EQ(png.texels[0].r, 255) << "the corner is white";
  int dark = 0;
  for (const glm::u8vec4& texel : png.texels)
    for (int c = 0; c < 3; ++c) dark += texel[c] < 128;
  EXPECT_GT(dark, 2000);
}

TEST_F(PlotTest, ErrorsAreOneLine) {
  make_report("good", report_text("beam", 42, 100, 0.01, 50));
  make_report("broken", "{\"beampipe_report\": 2, ");
  make_report("other", R"({"beampipe_trace": 1})");
  make_report("run", R"({"beampipe_report": 2, "trace": "t.json", "results": [{"technique": "beam",
      "peak_bytes_per_pixel": 42, "frames": [{"wall_ms": {"median": 3}}]}]})");
  std::filesystem::create_directory(folder_ / "empty");
  expect_error({"plot", path("good"), "-o", path("plot.pdf")}, 2, "ends in .svg or .png");
  expect_error({"plot", path("nowhere"), "-o", path("p.svg")}, 1, "no such folder");
  expect_error({"plot", path("empty"), "-o", path("p.svg")}, 1,
               "empty/report.json: expected a readable file, found none");
  expect_error({"plot", path("broken"), "-o", path("p.svg")}, 1, "broken/report.json: byte 24: expected valid JSON");
  expect_error({"plot", path("other"), "-o", path("p.svg")}, 1, "not a report of beampipe");
  expect_error({"plot", path("run"), "-o", path("p.svg")}, 1, "expected a report of `beampipe compare`");
  expect_error({"plot", path("run"), "-o", path("p.svg")}, 1, "--kind traffic for one of `run`");
  expect_error({"plot", path("run"), path("good"), "--kind", "traffic", "-o", path("p.svg")}, 2, "expected one folder");
  expect_error({"plot", path("good"), "--kind", "pie", "-o", path("p.svg")}, 2, "pie");

  const std::string search_path = getenv("PATH");
  setenv("PATH", path("empty").c_str(), 1);
  expect_error({"plot", path("good"), "-o", path("p.svg")}, 1, "cannot run the program gnuplot");
  setenv("PATH", search_path.c_str(), 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "p.svg"));
}

// If gnuplot never ends and the program is interrupted, no process and no file is left.
TEST_F(PlotTest, AnInterruptEndsGnuplotToo) {
  make_report("a", report_text("beam", 42, 100, 0.01, 50));
  std::filesystem::create_directory(folder_ / "temporary");
  std::filesystem::create_directory(folder_ / "bin");
  write_text(folder_ / "bin/gnuplot", "#!/bin/sh\necho $$ >" + path("pid.part") + " && mv " + path("pid.part") + " " +
                                          path("pid") + "\nexec sleep 60\n");
  std::filesystem::permissions(folder_ / "bin/gnuplot", std::filesystem::perms::owner_all);
  const std::string search_path = getenv("PATH");
  setenv("PATH", (path("bin") + ":" + search_path).c_str(), 1);
  setenv("TMPDIR", path("temporary").c_str(), 1);
  {
    Program program({"plot", path("a"), "-o", path("p.svg")});
    setenv("PATH", search_path.c_str(), 1);
    unsetenv("TMPDIR");
    for (int i = 0; i < 3000 && !std::filesystem::exists(folder_ / "pid"); ++i) pause(10);
    program.signal(SIGTERM);
    EXPECT_EQ(program.wait().exit_code, 128 + SIGTERM);
  }
  const auto runs = [process = "/proc/" + std::to_string(std::stoi(read_text(folder_ / "pid")))] {
    std::string command;  // empty for a process that has ended
    return static_cast<bool>(std::getline(std::ifstream(process + "/cmdline"), command));
  };
  for (int i = 0; i < 500 && runs(); ++i) pause(10);
  EXPECT_FALSE(runs());
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "temporary"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "p.svg"));
}

}  // namespace beampipe::plot_test
