// Reports that someone else wrote: every mistake in them is one line that names the file, and no name in them becomes a
// path, a command or a number that a plot cannot show.

#include "tests/tools/program.h"
#include "tests/tools/report/made_report.h"
#include "tools/report/conditions.h"
#include "tools/report/figures.h"
#include "tools/report/gnuplot.h"
#include "tools/report/inspections.h"
#include "tools/report/layers.h"
#include "tools/report/tables.h"

namespace beampipe::hostile_report_test {

// Compared, with modelled times, and with pixels that were inspected.
const std::string kReport =
    replaced(kMadeReport, R"("error": {)", R"("inspections": "beam/inspections.json", "error": {)");

class HostileReport : public RunInFolder {
 protected:
  ReportFile read(const std::string& text) const {
    write_text(folder_ / "report.json", text);
    return read_report(folder_.string());
  }

  // What follows the name of report.json. "" if reading, tables, figures, layers and inspections have no error.
  std::string refusal(const std::string& text) const {
    try {
      const ReportFile report = read(text);
      report_tables(report);
      report_figures(report);
      if (report.json.at("results").at(0).at("inspections") != "beam/inspections.json") report_inspections(report);
      report_layers(report, 0);
    } catch (const JsonError& error) {  // where commands call read_from_report()
      return error.what();
    } catch (const std::exception& error) {
      const std::string what = error.what(), name = (folder_ / "report.json").string() + ": ";
      EXPECT_EQ(what.find('\n'), what.npos);
      EXPECT_TRUE(what.starts_with(name)) << what;
      return what.substr(what.starts_with(name) ? name.size() : 0);
    }
    return "";
  }
};

TEST_F(HostileReport, TechniquesAndFramesMustBeThere) {
  EXPECT_EQ(refusal(R"({"beampipe_report": 2, "trace": "a", "results": [{"technique": "beam", "frames": [],
                       "peak_bytes_per_pixel": 6}]})"),
            "not a report of beampipe: expected a technique with at least one frame, found none of \"beam\"");
  EXPECT_EQ(refusal(replaced(kReport, R"("implementations": {"shaders": {}})", R"("implementations": {})")),
            "expected hardware with an implementation, found none");
}

TEST_F(HostileReport, NamesInMessagesAreOneLine) {
  EXPECT_EQ(refusal(replaced(kReport, R"("beam/frame_0003.exr")", R"("../\n")")),
            R"(it names "../\n"; expected a file in its own folder)");
  EXPECT_EQ(refusal(replaced(kReport, R"("beam/inspections.json")", R"("a\n")")),
            R"(expected the inspections of "beam" in "beam/inspections.json", found "a\n")");
  EXPECT_EQ(refusal(replaced(kReport, R"("beam/frame_0003.exr")", R"("a\n.exr")")),
            R"(it names "a\n.exr"; expected a file in its own folder)");
  const std::string long_name(5000, 'x');
  EXPECT_TRUE(refusal(replaced(kReport, "beam/frame_0003.exr", long_name)).starts_with("it names \"xxx"));
}

TEST_F(HostileReport, ConditionsAreThoseThatMakeSense) {
  const auto conditions = [&](const std::string& members) {
    return report_conditions(read(std::string(kReport).insert(1, members + ",")));
  };
  EXPECT_GT(conditions(R"("frames": [], "trace_frames": 0)").size(), 0u);
  EXPECT_THROW(conditions(R"("frames": [{"index": 0}], "trace_frames": 1)"), JsonError);
  EXPECT_THROW(conditions(R"("command_line": 7)"), JsonError);
}

// The names of plots are names of files.
TEST_F(HostileReport, NamesOfImplementationsCannotLeaveTheFolder) {
  std::string text = kReport;
  for (std::size_t at = text.find("shaders"); at != text.npos; at = text.find("shaders", at + 20))
    text.replace(at, 7, "/../../../shaders");
  const std::vector<Figure> figures = report_figures(read(text));
  int plots = 0;
  for (const Figure& figure : figures)
    for (const auto& choice : figure.choices) {
      const std::string file = plot_file(choice.second);
      EXPECT_EQ(file.rfind('/'), file.find('/')) << file;
      ++plots;
    }
  EXPECT_GE(plots, 4);
}

TEST_F(HostileReport, AxesShowNumbersOfAnySize) {
  for (const char* number : {"1.7e308", "1e-308", "1e300"}) {
    const ReportFile report =
        read(replaced(kReport, R"("equivalent_msaa": 8)", std::string(R"("equivalent_msaa": )") + number));
    EXPECT_LT(gnuplot_script(frontier_plot({report}), PlotFormat::svg).size(), 10000u) << number;
  }
}

TEST_F(HostileReport, MeansNeedTheSameHardware) {
  const ReportFile one = read(kReport);
  std::string text = kReport;
  for (std::size_t at = text.find("shaders"); at != text.npos; at = text.find("shaders", at + 1))
    text.replace(at, 7, "units");
  const ReportFile other = read(text);
  const std::vector<TechniqueSummary> means = mean_summaries({one, other});
  ASSERT_EQ(means.size(), 1u);
  EXPECT_TRUE(means[0].modelled_ms.empty()) << "neither is in both";
  EXPECT_EQ(mean_summaries({one, one})[0].modelled_ms.size(), 1u);
}

// `model` and `claims` say which file is wrong.
TEST_F(HostileReport, CommandsNameTheFile) {
  write_text(folder_ / "report.json", replaced(kReport, R"("memory_system": {"modelled": false, "cores": 2},)", ""));
  const std::string file = (folder_ / "report.json").string();
  EXPECT_EQ(
      run_program({"model", folder_.string()}).err,
      "beampipe: error: " + file + ": not a report of beampipe: expected the key \"memory_system\", found none\n");
  write_text(folder_ / "report.json", replaced(kReport, R"("claims": [{"name")", R"("claims": [{"nmae")"));
  EXPECT_EQ(run_program({"claims", folder_.string()}).err,
            "beampipe: error: " + file + ": not a report of beampipe: expected the key \"name\", found none\n");
}

}  // namespace beampipe::hostile_report_test
