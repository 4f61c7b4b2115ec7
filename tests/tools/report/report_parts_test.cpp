// The parts of the report page, for a report whose numbers can be computed by hand.

#include "pipeline/error_causes.h"
#include "stages/cost/stage.h"
#include "tests/tools/report/made_report.h"
#include "tools/evaluate/memory_system.h"
#include "tools/files/image_io.h"
#include "tools/report/cards.h"
#include "tools/report/colors.h"
#include "tools/report/conditions.h"
#include "tools/report/figures.h"
#include "tools/report/inspections.h"
#include "tools/report/layers.h"
#include "tools/report/page.h"
#include "tools/report/tables.h"

namespace beampipe::report_parts_test {

// The report with `more` inserted before `place`.
std::string report_with(const std::string& place, const std::string& more, std::string text = kMadeReport) {
  return text.insert(text.find(place), more);
}

class ReportParts : public InFolder {
 protected:
  ReportFile read(const std::string& text = kMadeReport) const {
    write_text(folder_ / "report.json", text);
    return read_report(folder_.string());
  }
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

// Null: the cell is empty.
void expect_cells(const Table& table, std::size_t row, const std::vector<std::pair<const char*, Json>>& cells) {
  for (const auto& [key, value] : cells) EXPECT_EQ(cell(table, row, key), value) << table.name << ' ' << key;
}

TEST_F(ReportParts, StagesAreMeansOverFrames) {
  const std::vector<Table> tables = report_tables(read());
  const Table& stages = named(tables, "stages");
  ASSERT_EQ(stages.rows.size(), 1u);
  expect_cells(stages, 0,
               {{"ops", 2000000},
                {"bit", 2.5},
                {"logical_bytes", 500000},
                {"ops_per_byte", 4.0},
                {"lane_use", 0.25},
                {"modelled_ms_shaders", 0.4},
                {"sector_bytes", "no such column"}});  // none has values
  const Table& frames = named(tables, "frames");
  ASSERT_EQ(frames.rows.size(), 4u);
  expect_cells(frames, 1, {{"modelled_ms_shaders_in_turn", 5}, {"dram_bytes", 1200}});
  expect_cells(frames, 2, {{"modelled_ms_shaders_in_turn", nullptr}});
}

// A frame has the stages for alpha only where something needs them.
TEST_F(ReportParts, StagesOfFramesAreAddedUpByName) {
  const std::vector<Table> tables = report_tables(
      read(report_with(R"({"stage": "compose", "ops": {"total": 1000000)",
                       R"({"stage": "alpha_mask", "ops": {"total": 8}, "bytes_read": 0, "bytes_written": 0},)")));
  const Table& stages = named(tables, "stages");
  ASSERT_EQ(stages.rows.size(), 2u);
  expect_cells(stages, 0, {{"stage", "compose"}, {"ops", 2000000}});
  expect_cells(stages, 1, {{"stage", "alpha_mask"}, {"ops", 4}});
}

TEST_F(ReportParts, TechniquesHaveTimesBoundsAndWhatMsaaWouldTake) {
  const std::vector<Table> tables = report_tables(read());
  const Table& techniques = named(tables, "techniques");
  expect_cells(techniques, 0,
               {{"wall_ms", 6.0},
                {"modelled_ms_shaders_at_once", 3.0},
                {"modelled_ms_shaders_in_turn", 4.0},
                {"dram_bytes", 1000.0},  // the mean over the frames
                {"emr_bound", "at least"},
                {"peak_bytes_per_pixel", 49},
                {"msaa_bytes_per_pixel", 80.0}});
  // No hardware is modelled for the reference, and it has no error.
  expect_cells(techniques, 1, {{"modelled_ms_shaders_at_once", nullptr}, {"rmse", nullptr}});
}

// EMR 8: with 96 KiB its samples fit on chip, with 4 KiB they do not.
TEST_F(ReportParts, AsMuchAsMsaaTakesWhereItsSamplesAre) {
  for (const auto& [bytes, expected] : {std::pair{98304, 6.0}, {4096, 80.0}}) {
    Json memory = parameters_json({});
    memory["modelled"] = false, memory["framebuffer"] = "on-chip", memory["on_chip_bytes"] = bytes;
    const ReportFile report = read(replaced(kMadeReport, R"({"modelled": false, "cores": 2})", memory.dump()));
    expect_cells(named(report_tables(report), "techniques"), 0, {{"msaa_bytes_per_pixel", expected}});
  }
}

TEST_F(ReportParts, PartsOfErrorsAreColumnsWhereSurfacesVary) {
  const std::vector<Table> flat = report_tables(read());
  for (const char* key : {"visibility_rmse", "visibility_emr", "visibility_emr_bound", "shading_rmse"})
    expect_cells(named(flat, "techniques"), 0, {{key, "no such column"}});
  expect_cells(named(flat, "frames"), 0, {{"shading_rmse", "no such column"}});

  std::string text = kMadeReport;
  text.insert(text.find("\"error\""), R"("shading": {"rmse": 0.5}, "visibility": {"rmse": 0.25, "equivalent_msaa": 1,
    "equivalent_msaa_is_lower_bound": false, "equivalent_msaa_is_upper_bound": true}, )");
  text.insert(text.find("\"image\": \"beam/frame_0004.exr\""),
              R"("visibility": {"rmse": 0.125}, "shading": {"rmse": 0.75}, )");
  const std::vector<Table> tables = report_tables(read(text));
  const Table &techniques = named(tables, "techniques"), &frames = named(tables, "frames");
  expect_cells(techniques, 0,
               {{"visibility_rmse", 0.25},
                {"visibility_emr", 1},
                {"visibility_emr_bound", "at most"},
                {"shading_rmse", 0.5},
                {"emr_bound", "at least"}});  // the last of the whole error
  expect_cells(frames, 0, {{"visibility_rmse", nullptr}});
  expect_cells(frames, 1, {{"visibility_rmse", 0.125}, {"shading_rmse", 0.75}});
}

TEST_F(ReportParts, CsvQuotesWhatNeedsIt) {
  EXPECT_EQ(csv_text(named(report_tables(read()), "claims")),
            "claim,unit,published_low,published_high,ours,per_cent,holds,source,command\r\n"
            "\"beam, \"\"RGB16F\"\"\",bytes,36,42,42,0,true,slide 30,beampipe report DIR\r\n");
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

TEST_F(ReportParts, ATechniqueWithoutModelledTimesHasNoRoofline) {  // as `compare --reference-error` adds one
  const ReportFile report = read(report_with(R"({"technique": "reference")", R"({"technique": "reference:set=2",
    "peak_bytes_per_pixel": 1, "frames": [{"wall_ms": {"median": 1}, "stages": [
      {"stage": "compose", "ops": {"total": 3}, "bytes_read": 1, "bytes_written": 1, "dram_bytes": 1}]}]},
   )"));
  ASSERT_EQ(report.techniques.size(), 2u);
  EXPECT_TRUE(roofline_plot(report, "reference:set=2").series.empty());
}

// Of two stages, one moves no DRAM bytes, and fixed functions do the other.
TEST_F(ReportParts, StagesThatTheRooflineHasNoPlaceForAreNamed) {
  const std::string more = R"({"stage": "shade", "ops": {"total": 40000000}, "bytes_read": 8, "bytes_written": 0,
      "dram_bytes": 0, "modelled_ms": {"shaders": 4}}, {"stage": "depth_test", "ops": {"total": 7}, "bytes_read": 8,
      "bytes_written": 0, "dram_bytes": 8, "modelled_ms": {"shaders": 4}}, )";
  std::string text = report_with(R"({"stage": "compose")", more);
  text = replaced(text, R"({"shaders": {}})",
                  R"({"shaders": {"units": {"shade": ["shading"], "depth_test": ["rop_samples"]}}})");
  const ScatterPlot plot = roofline_plot(read(text), "beam");
  ASSERT_EQ(plot.series.size(), 3u) << "two stages and the roof";
  const PlotPoint& shade = plot.series[0].points[0];
  EXPECT_EQ(shade.label, "shade");
  EXPECT_EQ(shade.bound, PlotPoint::Bound::beyond);
  EXPECT_EQ(shade.x, 20) << "twice as far as the roof's ridge";
  EXPECT_NEAR(shade.y, 10, 1e-9);
  EXPECT_EQ(plot.notes, (std::vector<std::string>{
                            "At the right edge, as they move no DRAM bytes: shade.",
                            "Not drawn, because the roof is that of shaders, and fixed functions do the work: "
                            "depth_test."}));
}

TEST_F(ReportParts, TheTimesOfStagesNameWhatLimitsThem) {
  std::string text = kMadeReport;
  const std::string last = R"("modelled_ms": {"shaders": 0.3})";
  text =
      replaced(text, last,
               last + R"(, "busiest_unit": {"shaders": "shader"}, "busiest_rate": {"shaders": "core_issue_per_clk"})");
  const ReportFile report = read(text);
  EXPECT_EQ(time_plot(report, "shaders").parts.at(0).limits, std::vector<std::string>{"shader: issue"});
  expect_cells(named(report_tables(report), "stages"), 0, {{"busiest_unit_shaders", "shader: issue"}});
  EXPECT_TRUE(time_plot(read(), "shaders").parts.at(0).limits.empty()) << "an older version did not tell";
}

TEST_F(ReportParts, WithoutHardwareTheRooflineIsAboutLogicalBytes) {
  const ScatterPlot plot = roofline_plot(read(replaced(kMadeReport, "\"hardware\"", "\"software\"")), "beam");
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
  ASSERT_EQ(figures.size(), 5u);
  ASSERT_EQ(figures[1].choices.size(), 2u) << "modelled time and wall time";
  EXPECT_EQ(figures[1].choices[0].first, "modelled time: shaders") << "shown first";
  ASSERT_EQ(figures[2].choices.size(), 1u);
  EXPECT_EQ(figures[2].choices[0].first, "modelled time: shaders");
  ASSERT_EQ(figures[3].choices.size(), 2u) << "DRAM and logical bytes";
  EXPECT_TRUE(figures[3].choices[0].first.starts_with("DRAM")) << "shown first";
}

TEST_F(ReportParts, TimesOfStagesHaveAMarkWhereAllWouldEndAtOnce) {
  const BarPlot plot = time_plot(read(), "shaders");
  EXPECT_EQ(plot.categories, std::vector<std::string>{"beam"});
  ASSERT_EQ(plot.parts.size(), 1u);
  EXPECT_EQ(plot.parts[0].values, std::vector<double>{0.4}) << "the mean over the frames";
  EXPECT_EQ(plot.marks, std::vector<double>{3});
}

TEST_F(ReportParts, CausesAreBarsInPercent) {
  EXPECT_FALSE(causes_plot(read()).has_value());
  const ReportFile report = read(report_with("\"error\"", R"("error_causes": {"leak": 1.25, "mask": -0.25}, )"));
  const BarPlot plot = causes_plot(report).value();
  EXPECT_EQ(plot.categories, std::vector<std::string>{"beam"});
  ASSERT_EQ(plot.parts.size(), 2u);
  EXPECT_EQ(plot.parts[0].values, std::vector<double>{125});
  EXPECT_EQ(plot.parts[1].values, std::vector<double>{-25});
  EXPECT_EQ(report_figures(report).back().section, "causes");
}

TEST(ReportColors, EachTechniqueAndStageHasItsOwn) {
  const std::vector<std::string> specs = {"beam", "msaa:8", "beam:order=sorted", "acaa:8"};
  std::set<std::string> colors;
  for (const std::string& spec : specs) EXPECT_TRUE(colors.insert(technique_color(specs, spec)).second) << spec;
  EXPECT_EQ(technique_color(specs, "msaa:32"), technique_color(specs, "msaa:8")) << "a line of plots";
  EXPECT_EQ(technique_color({"msaa:1", "beam"}, "beam"), technique_color({"beam", "msaa:1"}, "beam"));

  colors.clear();
  for (const StageInfo& stage : stage_list()) EXPECT_TRUE(colors.insert(stage_color(stage.name)).second) << stage.name;
  for (std::size_t i = 0; i < 20; ++i)
    EXPECT_TRUE(colors.insert(color_at(i)).second)
        << "a technique looks like a stage, or like another technique: " << i;
  for (const char* const cause : kErrorCauses) EXPECT_TRUE(colors.insert(cause_color(cause)).second) << cause;
  EXPECT_FALSE(colors.contains(stage_color("no such stage"))) << "a stage of the registry has no colour";
  EXPECT_FALSE(colors.contains(stage_color("prepass_depth_test"))) << "lighter";
}

// ---- Cards and conditions ----

// A report with these techniques; `more`: further members of each.
std::string report_of(const std::vector<std::string>& specs, const std::string& more = "") {
  std::string results;
  for (const std::string& spec : specs)
    results += (results.empty() ? "" : ",") + (R"({"technique": ")" + spec + R"(", "peak_bytes_per_pixel": 80)" + more +
                                               R"(, "frames": [{"wall_ms": {"median": 1}}]})");
  return R"({"beampipe_report": 2, "trace": "dots.json", "results": [)" + results + "]}";
}

TEST_F(ReportParts, TheBaselineIsMsaa8OrElseAnotherMsaaOrElseTheFirst) {
  EXPECT_EQ(baseline_of(read(report_of({"beam", "msaa:4", "msaa:8"}))), "msaa:8");
  EXPECT_EQ(baseline_of(read(report_of({"beam", "acaa:8", "msaa:4,prepass", "msaa:2"}))), "msaa:4,prepass");
  EXPECT_EQ(baseline_of(read(report_of({"beam", "alpha"}))), "beam");
  const Json cards = report_cards(read(report_of({"beam", "msaa:8"})));
  EXPECT_EQ(cards.at("cards").at(0).at("technique"), "msaa:8") << "the baseline comes first";
  EXPECT_EQ(cards.at("cards").at(1).at("technique"), "beam");
}

TEST_F(ReportParts, CardsHoldCostsAndErrors) {
  std::string text = kMadeReport;
  text.insert(text.find("\"peak_bytes_per_pixel\""), R"("on_chip_bytes_per_pixel": 2.5, )");
  text.insert(text.find("\"dram_bytes\": 800"),
              R"("bin_pixels": 1024, "buffers": [{"name": "bin_lists", "peak_bytes": 4},
      {"name": "a_buffer", "peak_bytes": 9}, {"name": "spilled_records", "peak_bytes": 7}], )");
  text.replace(text.find("\"in_turn\": 3"), 12, R"("in_turn": 3, "busiest": "dram")");
  text.replace(text.find("\"in_turn\": 5"), 12,
               R"("in_turn": 5, "busiest": "shader", "busiest_rate": "core_issue_per_clk")");
  const Json cards = report_cards(read(text));
  EXPECT_EQ(cards.at("implementations"), Json::array({"shaders"}));
  ASSERT_EQ(cards.at("cards").size(), 1u) << "the reference has none";
  const Json& card = cards.at("cards").at(0);
  EXPECT_EQ(card.at("dram_bytes"), 1000.0) << "the mean over the frames";
  EXPECT_EQ(card.at("on_chip_bytes_per_pixel"), 2.5);
  EXPECT_EQ(card.at("on_chip_bytes"), 2560.0);
  EXPECT_EQ(card.at("bytes_per_pixel"), 49.0);
  EXPECT_EQ(card.at("off_chip"), "mask, A-buffer, spilled records") << "what the frame has in memory, without its bins";
  EXPECT_EQ(card.at("modelled_ms").at("shaders"),
            (Json{{"at_once", 3.0}, {"on_cores", 0.0}, {"in_turn", 4.0}, {"busiest", "dram, shader: issue"}}));
  EXPECT_EQ(card.at("rmse"), 0.02);
  EXPECT_EQ(card.at("emr"), 8.0);
  EXPECT_EQ(card.at("emr_bound"), "at least");
  const Json run = report_cards(read(report_of({"beam"}))).at("cards").at(0);
  for (const char* key : {"rmse", "emr", "dram_bytes", "modelled_ms"}) EXPECT_FALSE(run.contains(key)) << key;
}

TEST_F(ReportParts, ConditionsTellHowTheNumbersWereFound) {
  std::string text = kMadeReport;
  text.insert(text.find("\"claims\""), R"("version": "1.2.3", "hardware_named": "our gpus/some.json", "trace_frames": 9,
    "frames": [{"index": 3, "width": 320, "height": 180, "triangles": 1234567, "draws": 2, "lights": 1},
               {"index": 4, "width": 320, "height": 180, "triangles": 7, "draws": 3, "lights": 1}],
    "notes": [{"reason": "stencil test", "left_out": true, "draws": 1, "triangles": 34},
              {"reason": "stopped", "left_out": false, "draws": 2, "triangles": 5, "invocations": 6789}],
    "command_line": "beampipe run 'my dots.json'", )");
  const ReportFile report = read(text);
  std::map<std::string, std::string> found;
  const Json conditions = report_conditions(report);
  for (const Json& each : conditions.elements()) found[each.at(0).get<std::string>()] = each.at(1).get<std::string>();
  EXPECT_EQ(found["picture"], "320 × 180 pixels, 2 frames of 9");
  EXPECT_EQ(found["scene"], "7 to 1\u202f234\u202f567 triangles, 2 to 3 draws, 1 light");
  EXPECT_EQ(found["hardware"], "some (Some GPU, 1000 MHz)");
  EXPECT_EQ(found["program"], "beampipe 1.2.3, 1 thread, AVX2");
  EXPECT_EQ(found["left out"], "stencil test: 1 draw, 34 triangles");
  EXPECT_EQ(found["drawn otherwise"], "stopped: 2 draws, 5 triangles, 6\u202f789 invocations");
  EXPECT_EQ(found["command"], "beampipe run 'my dots.json'");
}

// ---- Layers ----

TEST(PageFrames, AreAllOrEvenlySpacedWithTheOneThatIsShown) {
  using Frames = std::vector<std::size_t>;
  EXPECT_EQ(frames_of_page(3, 1000, 1), (Frames{0, 1, 2}));
  EXPECT_EQ(frames_of_page(3, 2 * kMostPagePixels, 1), (Frames{1})) << "one is always shown";
  EXPECT_EQ(frames_of_page(100, kMostPagePixels / 2, 0), (Frames{0, 99}));
  EXPECT_EQ(frames_of_page(101, kMostPagePixels / 4, 0), (Frames{0, 50, 100}));
  EXPECT_EQ(frames_of_page(101, kMostPagePixels / 4, 7), (Frames{0, 7, 50, 100}));
  EXPECT_EQ(frames_of_page(1, 0, 0), (Frames{0}));
}

TEST_F(ReportParts, LayersTakeOnlyFilesOfTheFolder) {
  EXPECT_THROW(report_layers(read(replaced(kMadeReport, "beam/frame_0003.exr", "../frame_00000003.exr")), 0),
               ReportError);
  const TemporaryFolder other;
  write_text(other / "secret.exr", encode_exr(flat_image(2, 1, 0.5f)));
  std::filesystem::create_directory(folder_ / "beam");
  std::filesystem::create_symlink(other / "secret.exr", folder_ / "beam/frame_0003.exr");
  EXPECT_THROW(report_layers(read(), 0), ReportError) << "by way of a link";
}

TEST_F(ReportParts, LayersHoldThePicturesAndTheCounters) {
  std::filesystem::create_directory(folder_ / "beam");
  std::filesystem::create_directory(folder_ / "reference");
  for (const std::string name : {"beam", "reference"}) {
    write_text(folder_ / (name + "/frame_0003.exr"), encode_exr(flat_image(2, 1, name == "beam" ? 4.0f : 0.25f)));
  }
  write_text(folder_ / "beam/frame_0003_counters.exr",
             encode_exr(Planes{2, 1, {{"fragments", {0, 300}}, {"leak", {-0.25f, 0.5f}}}}));
  const auto layers = report_layers(read(), 0);
  EXPECT_EQ(layers.at("frame"), 3);
  EXPECT_EQ(layers.at("width"), 2);
  EXPECT_EQ(layers.at("height"), 1);
  ASSERT_EQ(layers.at("techniques").size(), 2u);
  const auto& maps = layers["techniques"][0].at("maps");
  ASSERT_EQ(maps.size(), 2u);
  EXPECT_EQ(maps[0].at("step"), 1) << "counts are exact";
  EXPECT_EQ(maps[0].at("high"), 300);
  EXPECT_EQ(maps[1].at("low"), -0.25);
  EXPECT_EQ(maps[1].at("step"), 0.75 / 65535);
  EXPECT_EQ(layers.at("kinds")[0].at("name"), "fragments");
  EXPECT_EQ(layers.at("techniques")[0].at("picture").at("high"), 4.0) << "brighter than white";
  EXPECT_EQ(layers.at("techniques")[0].at("picture").at("low"), 0.0);
  EXPECT_EQ(layers.at("techniques")[1].at("picture").at("high"), 1.0);
  EXPECT_TRUE(layers.at("techniques")[0].at("picture").at("png").get<std::string>().starts_with(
      "data:image/png;base64,iVBORw0KGgo"));

  const ReportFile hostile = read(replaced(kMadeReport, "dots.json", "</script>"));
  const std::string page = page_html(hostile, report_tables(hostile), report_figures(hostile), Json::array({layers}), 3,
                                     report_inspections(hostile));
  EXPECT_EQ(count_of(page, "</script>"), 3u) << "text from the report cannot end a script";
  EXPECT_EQ(page.find("{{"), page.npos) << "all places are filled";
}

}  // namespace beampipe::report_parts_test
