// The parts of the report page, for a report whose numbers can be computed by hand.

#include "tests/tools/fixtures.h"
#include "tools/files/image_io.h"
#include "tools/report/figures.h"
#include "tools/report/inspections.h"
#include "tools/report/layers.h"
#include "tools/report/page.h"
#include "tools/report/tables.h"

namespace beampipe {
namespace {

// A report with two frames of one technique, which has one stage, and of the reference.
constexpr const char* kReport = R"({"beampipe_report": 1, "trace": "dots.json", "threads": 1, "simd": "AVX2",
  "hardware": {"clock_mhz": 1000, "rates": {"issue_per_clk": 100, "dram_bytes_per_clk": 10},
               "implementations": {"shaders": {}}},
  "claims": [{"name": "beam, \"RGB16F\"", "unit": "bytes", "published_low": 36, "published_high": 42, "ours": 42,
              "difference": 0, "source": "slide 30", "command": "beampipe report DIR"}],
  "msaa_ladder": [{"samples": 1, "rmse": 0.1}, {"samples": 8, "rmse": 0.03}],
  "results": [
   {"technique": "beam", "framebuffer_bytes_per_pixel": 42, "peak_bytes_per_pixel": 49, "a_buffer_peak_bytes": 7,
    "framebuffer": [{"name": "mask", "format": "R32UI x 8", "bytes_per_pixel": 42}],
    "error": {"rmse": 0.02, "bias": 0, "p99": 0.1, "max": 0.2},
    "equivalent_msaa": 8, "equivalent_msaa_is_lower_bound": true,
    "frames": [
     {"index": 3, "picture": "beam/frame_0003.png", "counters": "beam/frame_0003_counters.exr",
      "wall_ms": {"median": 4, "min": 4, "max": 4, "runs": 1}, "modelled_ms": {"shaders": {"overlap": 2, "sum": 3}},
      "dram_bytes": 800,
      "stages": [{"stage": "compose", "ops": {"total": 3000000, "bit": 2}, "bytes_read": 500000,
                  "bytes_written": 250000, "dram_bytes": 1000000, "lanes_used": 3, "lanes_issued": 8,
                  "modelled_ms": {"shaders": 0.5}}]},
     {"index": 4, "picture": "beam/frame_0004.png", "wall_ms": {"median": 8, "min": 8, "max": 8, "runs": 1},
      "modelled_ms": {"shaders": {"overlap": 4, "sum": 5}}, "dram_bytes": 1200,
      "stages": [{"stage": "compose", "ops": {"total": 1000000, "bit": 3}, "bytes_read": 200000,
                  "bytes_written": 50000, "dram_bytes": 1000000, "lanes_used": 1, "lanes_issued": 8,
                  "modelled_ms": {"shaders": 0.3}}]}]},
   {"technique": "reference", "framebuffer_bytes_per_pixel": 65536, "peak_bytes_per_pixel": 65536, "a_buffer_peak_bytes": 0,
    "framebuffer": [],
    "frames": [{"index": 3, "picture": "reference/frame_0003.png", "wall_ms": {"median": 1}, "stages": []},
               {"index": 4, "picture": "reference/frame_0004.png", "wall_ms": {"median": 1}, "stages": []}]}]})";

class ReportParts : public testing::Test {
 protected:
  ReportFile read(const std::string& text = kReport) const {
    write_text(folder_ / "report.json", text);
    return read_report(folder_.string());
  }

  TemporaryFolder folder_;
};

const Table& named(const std::vector<Table>& tables, const std::string& name) {
  for (const Table& table : tables) {
    if (table.name == name) return table;
  }
  throw std::runtime_error("no table " + name);
}

Json cell(const Table& table, std::size_t row, const std::string& key) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].key == key) return table.rows.at(row).at(i);
  }
  return "no such column";
}

TEST_F(ReportParts, StagesAreSummedOverFrames) {
  const std::vector<Table> tables = report_tables(read());
  const Table& stages = named(tables, "stages");
  ASSERT_EQ(stages.rows.size(), 1u);
  EXPECT_EQ(cell(stages, 0, "ops"), 4000000);
  EXPECT_EQ(cell(stages, 0, "bit"), 5);
  EXPECT_EQ(cell(stages, 0, "logical_bytes"), 1000000);
  EXPECT_EQ(cell(stages, 0, "ops_per_byte"), 4.0);
  EXPECT_EQ(cell(stages, 0, "lane_use"), 0.25);
  EXPECT_EQ(cell(stages, 0, "modelled_ms_shaders"), 0.8);
  EXPECT_EQ(cell(stages, 0, "sector_bytes"), "no such column") << "columns without values are left out";
  const Table& frames = named(tables, "frames");
  ASSERT_EQ(frames.rows.size(), 4u);
  EXPECT_EQ(cell(frames, 1, "modelled_ms_shaders_sum"), 5);
  EXPECT_EQ(cell(frames, 1, "dram_bytes"), 1200);
  EXPECT_TRUE(cell(frames, 2, "modelled_ms_shaders_sum").is_null());
}

TEST_F(ReportParts, TechniquesHaveTimesBoundsAndWhatMsaaWouldTake) {
  const std::vector<Table> tables = report_tables(read());
  const Table& techniques = named(tables, "techniques");
  EXPECT_EQ(cell(techniques, 0, "wall_ms"), 6.0);
  EXPECT_EQ(cell(techniques, 0, "modelled_ms_shaders_overlap"), 3.0);
  EXPECT_EQ(cell(techniques, 0, "modelled_ms_shaders_sum"), 4.0);
  EXPECT_EQ(cell(techniques, 0, "dram_bytes"), 1000.0) << "the mean over the frames";
  EXPECT_TRUE(cell(techniques, 1, "modelled_ms_shaders_overlap").is_null())
      << "no hardware is modelled for the reference";
  EXPECT_EQ(cell(techniques, 0, "emr_bound"), "at least");
  EXPECT_EQ(cell(techniques, 0, "peak_bytes_per_pixel"), 49);
  EXPECT_EQ(cell(techniques, 0, "msaa_bytes_per_pixel"), 80.0);
  EXPECT_TRUE(cell(techniques, 1, "rmse").is_null());
}

TEST_F(ReportParts, PartsOfErrorsAreColumnsWhereSurfacesVary) {
  const std::vector<Table> flat = report_tables(read());
  for (const char* key : {"visibility_rmse", "visibility_emr", "visibility_emr_bound", "shading_rmse"})
    EXPECT_EQ(cell(named(flat, "techniques"), 0, key), "no such column");
  EXPECT_EQ(cell(named(flat, "frames"), 0, "shading_rmse"), "no such column");

  std::string text = kReport;
  text.insert(text.find("\"error\""), R"("shading": {"rmse": 0.5}, "visibility": {"rmse": 0.25, "equivalent_msaa": 1,
    "equivalent_msaa_is_lower_bound": false, "equivalent_msaa_is_upper_bound": true}, )");
  text.insert(text.find("\"picture\": \"beam/frame_0004.png\""),
              R"("visibility": {"rmse": 0.125}, "shading": {"rmse": 0.75}, )");
  const std::vector<Table> tables = report_tables(read(text));
  const Table &techniques = named(tables, "techniques"), &frames = named(tables, "frames");
  EXPECT_EQ(cell(techniques, 0, "visibility_rmse"), 0.25);
  EXPECT_EQ(cell(techniques, 0, "visibility_emr"), 1);
  EXPECT_EQ(cell(techniques, 0, "visibility_emr_bound"), "at most");
  EXPECT_EQ(cell(techniques, 0, "shading_rmse"), 0.5);
  EXPECT_EQ(cell(techniques, 0, "emr_bound"), "at least") << "of the whole error";
  EXPECT_TRUE(cell(frames, 0, "visibility_rmse").is_null());
  EXPECT_EQ(cell(frames, 1, "visibility_rmse"), 0.125);
  EXPECT_EQ(cell(frames, 1, "shading_rmse"), 0.75);
}

TEST_F(ReportParts, CsvQuotesWhatNeedsIt) {
  EXPECT_EQ(csv_text(named(report_tables(read()), "claims")),
            "claim,unit,published_low,published_high,ours,difference,source,command\r\n"
            "\"beam, \"\"RGB16F\"\"\",bytes,36,42,42,0,slide 30,beampipe report DIR\r\n");
}

TEST_F(ReportParts, RooflineLiesUnderTheRoof) {
  const ScatterPlot plot = roofline_plot(read(), "beam");
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[0].points[0].x, 2) << "operations per DRAM byte";
  EXPECT_NEAR(plot.series[0].points[0].y, 5, 1e-9) << "4 million operations in 0.8 ms, in billions per second";
  const std::vector<PlotPoint>& roof = plot.series[1].points;
  ASSERT_EQ(roof.size(), 3u);
  EXPECT_EQ(roof[0].y, 10 * roof[0].x) << "10 bytes per clock at 1 GHz";
  EXPECT_EQ(roof[1].x, 10) << "100 operations per clock take 10 bytes per clock from here on";
  EXPECT_EQ(roof[2].y, 100);
}

TEST_F(ReportParts, WithoutHardwareTheRooflineIsAboutLogicalBytes) {
  std::string text = kReport;
  text.replace(text.find("\"hardware\""), 10, "\"software\"");
  const ScatterPlot plot = roofline_plot(read(text), "beam");
  ASSERT_EQ(plot.series.size(), 1u);
  EXPECT_EQ(plot.series[0].points[0].x, 4);
  EXPECT_EQ(plot.series[0].points[0].y, 2) << "millions per frame";
}

TEST_F(ReportParts, BytesArePerFrameAndOnlyThoseThatAreThere) {
  const ReportFile report = read();
  EXPECT_EQ(bytes_plot(report, "logical_bytes")->parts.at(0).values, std::vector<double>{0.5});
  EXPECT_EQ(bytes_plot(report, "dram_bytes")->parts.at(0).values, std::vector<double>{1});
  EXPECT_FALSE(bytes_plot(report, "sector_bytes").has_value());
  const std::vector<Figure> figures = report_figures(report);
  ASSERT_EQ(figures.size(), 4u);
  EXPECT_EQ(figures[1].choices.size(), 2u) << "wall time and modelled time";
  EXPECT_EQ(figures[2].choices.size(), 2u) << "logical and DRAM bytes";
}

TEST_F(ReportParts, LayersTakeOnlyFilesOfTheFolder) {
  std::string text = kReport;
  text.replace(text.find("beam/frame_0003.png"), 19, "../frame_00000003.png");
  EXPECT_THROW(report_layers(read(text), 0), ReportError);
  const TemporaryFolder other;
  write_text(other / "secret.png", "secret");
  std::filesystem::create_directory(folder_ / "beam");
  std::filesystem::create_symlink(other / "secret.png", folder_ / "beam/frame_0003.png");
  EXPECT_THROW(report_layers(read(), 0), ReportError) << "by way of a link";
}

TEST_F(ReportParts, LayersHoldThePicturesAndTheCounters) {
  std::filesystem::create_directory(folder_ / "beam");
  std::filesystem::create_directory(folder_ / "reference");
  for (const std::string name : {"beam", "reference"}) {
    write_text(folder_ / (name + "/frame_0003.png"), encode_png(flat_image(2, 1, 0.5f)));
  }
  write_text(folder_ / "beam/frame_0003_counters.exr",
             encode_exr(Planes{2, 1, {{"fragments", {0, 300}}, {"leak", {-0.25f, 0.5f}}}}));
  const auto layers = report_layers(read(), 0);
  EXPECT_EQ(layers.at("frame"), 3);
  ASSERT_EQ(layers.at("techniques").size(), 2u);
  const auto& maps = layers["techniques"][0].at("maps");
  ASSERT_EQ(maps.size(), 2u);
  EXPECT_EQ(maps[0].at("step"), 1) << "counts are exact";
  EXPECT_EQ(maps[0].at("high"), 300);
  EXPECT_EQ(maps[1].at("low"), -0.25);
  EXPECT_EQ(maps[1].at("step"), 0.75 / 65535);
  EXPECT_EQ(layers.at("kinds")[0].at("name"), "fragments");
  EXPECT_EQ(layers.at("techniques")[0].at("picture").get<std::string>().rfind("data:image/png;base64,iVBORw0KGgo", 0),
            0u);

  std::string text = kReport;
  text.replace(text.find("dots.json"), 9, "</script>");
  const ReportFile hostile = read(text);
  const std::string page =
      page_html(hostile, report_tables(hostile), report_figures(hostile), layers, report_inspections(hostile));
  std::size_t ends = 0;
  for (std::size_t at = page.find("</script>"); at != page.npos; at = page.find("</script>", at + 1)) ++ends;
  EXPECT_EQ(ends, 3u) << "text from the report cannot end a script";
  EXPECT_EQ(page.find("{{"), page.npos) << "all places are filled";
}

}  // namespace
}  // namespace beampipe
