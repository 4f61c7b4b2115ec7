#include "tests/tools/fixtures.h"
#include "tests/tools/report_frames.h"
#include "tools/report/report_text.h"

namespace beampipe::report_test {

std::vector<std::string> keys_of(const Json& json) {
  std::vector<std::string> keys;
  for (const auto& item : json.members()) keys.push_back(item.key);
  return keys;
}

Report sample_report() {
  Report report{.trace = "a.json", .version = "1.2.3", .simd = "AVX2", .threads = 2};
  TechniqueReport& result = report.results.emplace_back();
  result.technique = "msaa:8";
  result.framebuffer = {{"depth", "D32F x 8", 32}, {"color", "RGB16F x 8", 48}};
  result.framebuffer_bytes_per_pixel = 80;
  for (const std::size_t index : {4, 5}) {
    FrameReport frame;
    frame.index = index;
    frame.image = "msaa_8/frame_000" + std::to_string(index) + ".exr";
    frame.picture = "msaa_8/frame_000" + std::to_string(index) + ".png";
    frame.wall_ms = {
        .median = 2.0 * static_cast<double>(index), .min = 1.0, .max = 20.0, .runs = 3, .modelling_run = 44.0};
    frame.a_buffer_peak_bytes = 100 * (10 - index);
    frame.buffers = {{"pairs", 64, true}};
    frame.pixels = 50;
    frame.pixel_counters = {{"fragments", {1.5, 4, 0.5}}};
    frame.stages = {{.stage = StageId::vertex_setup,
                     .items_in = 3,
                     .items_out = 1,
                     .ops = {1, 2, 3, 4, 5, 6, 8},
                     .bytes_read = 36,
                     .bytes_written = 80,
                     .position_tests = 9,
                     .lanes_used = 3,
                     .lanes_issued = 4,
                     .sector_bytes = 128,
                     .l2_bytes = 112,
                     .dram_bytes = 96,
                     .hidden_items = 5,
                     .hidden_triangles = 6,
                     .empty_tiles = 7}};
    result.frames.push_back(frame);
  }
  return report;
}

Report compared_report() {
  Report report = sample_report();
  report.msaa_ladder = {{1, 0.5}, {8, 0.125}};
  report.results[0].error = ErrorStats{0.125, -0.25, 0.5, 1.0, 0.75, 0.25, 2.0};
  report.results[0].equivalent_msaa = EquivalentMsaa{8, false, false};
  change_frames(report.results[0], [&](FrameReport& frame, std::size_t) { frame.error = report.results[0].error; });
  return report;
}

TEST(ReportJson, HasTheKeysOfTheContract) {
  const Json json = report_json(sample_report());
  EXPECT_EQ(json["beampipe_report"], 2);
  EXPECT_EQ(json["trace"], "a.json");
  EXPECT_EQ(json["version"], "1.2.3");
  EXPECT_EQ(json["simd"], "AVX2");
  EXPECT_EQ(json["threads"], 2);
  const Json& result = json["results"].at(0);
  EXPECT_EQ(result["technique"], "msaa:8");
  EXPECT_EQ(result["framebuffer_bytes_per_pixel"], 80);
  EXPECT_EQ(result["peak_bytes_per_pixel"], 80 + 600.0 / 50) << "the A-buffer of the frame where it is largest";
  EXPECT_EQ(result["framebuffer"].at(1), (Json{{"name", "color"}, {"format", "RGB16F x 8"}, {"bytes_per_pixel", 48}}));
  EXPECT_EQ(result["a_buffer_peak_bytes"], 600) << "the largest of all frames";
  const Json& frame = result["frames"].at(1);
  EXPECT_EQ(frame["index"], 5);
  EXPECT_EQ(frame["image"], "msaa_8/frame_0005.exr");
  EXPECT_EQ(frame["wall_ms"], (Json{{"median", 10.0},
                                    {"min", 1.0},
                                    {"max", 20.0},
                                    {"runs", 3},
                                    {"with_memory_model", false},
                                    {"modelling_run", 44.0}}));
  const Json ops = {{"total", 21}, {"mul_add", 1}, {"add", 2},     {"bit", 3},
                    {"fetch", 4},  {"special", 5}, {"convert", 6}, {"wide", 8}};
  const Json stage = {
      {"stage", "vertex_setup"}, {"items_in", 3},           {"items_out", 1},        {"ops", ops},
      {"bytes_read", 36},        {"bytes_written", 80},     {"logical_bytes", 116},  {"sector_bytes", 128},
      {"l2_bytes", 112},         {"dram_bytes", 96},        {"texture_bytes", 0},    {"texture_sector_bytes", 0},
      {"texture_l2_bytes", 0},   {"texture_dram_bytes", 0}, {"position_tests", 9},   {"lanes_used", 3},
      {"lanes_issued", 4},       {"hidden_items", 5},       {"hidden_triangles", 6}, {"empty_tiles", 7}};
  EXPECT_EQ(frame["stages"].at(0), stage);
  EXPECT_EQ(frame["logical_bytes"], 116) << "the sum over all stages";
  EXPECT_EQ(frame["sector_bytes"], 128);
  EXPECT_EQ(frame["l2_bytes"], 112);
  EXPECT_EQ(frame["dram_bytes"], 96);
  EXPECT_EQ(frame["buffers"], (Json::array({{{"name", "depth"}, {"peak_bytes", 50 * 32}, {"held", "frame"}},
                                            {{"name", "color"}, {"peak_bytes", 50 * 48}, {"held", "frame"}},
                                            {{"name", "a_buffer"}, {"peak_bytes", 500}, {"held", "frame"}},
                                            {{"name", "pairs"}, {"peak_bytes", 64}, {"held", "bin"}}})));
  EXPECT_FALSE(frame.contains("modelled_ms")) << "no hardware is modelled";
  EXPECT_EQ(frame["pixel_counters"], (Json{{"fragments", {{"mean", 1.5}, {"max", 4.0}, {"share", 0.5}}}}));
  const Json& memory = json["memory_system"];
  EXPECT_EQ(memory["modelled"], true);
  EXPECT_EQ(memory["compression"], true);
  EXPECT_EQ(memory["sector_bytes"], 32);
  EXPECT_EQ(memory["rop_bytes"], 24 * 16384);
  EXPECT_EQ(memory["on_chip_bytes"], 98304);
}

TEST(ReportJson, WithoutMemoryThereAreNoModelledTimes) {
  Report report = sample_report();
  report.hardware = titan_v();
  const Json with = report_json(report)["results"][0]["frames"][0];
  EXPECT_TRUE(with.contains("modelled_ms"));
  EXPECT_TRUE(with["stages"][0].contains("modelled_ms"));
  change_frames(report.results[0], [](FrameReport& frame, std::size_t) {
    for (StageCounters& stage : frame.stages) stage.sector_bytes = 0;
  });
  const Json without = report_json(report)["results"][0]["frames"][0];
  EXPECT_FALSE(without.contains("modelled_ms"));
  EXPECT_FALSE(without["stages"][0].contains("modelled_ms"));
}

TEST(ReportJson, HasNotesOfDrawsIfThereAreAny) {
  EXPECT_FALSE(report_json(sample_report()).contains("notes"));
  Report noted = sample_report();
  noted.notes = {{"stencil test", true, 2, 34}, {"stopped", false, 2, 34, 567}};
  const Json notes = report_json(noted)["notes"];
  EXPECT_EQ(notes.at(0), (Json{{"reason", "stencil test"}, {"left_out", true}, {"draws", 2}, {"triangles", 34}}));
  EXPECT_EQ(notes.at(1).at("invocations"), 567);
}

TEST(ReportJson, HasErrorsAndEquivalentRatesAfterCompare) {
  Report report = compared_report();
  const Json error = {{"rmse", 0.125}, {"bias", -0.25}, {"p99", 0.5},    {"max", 1.0},
                      {"p999", 0.75},  {"mae", 0.25},   {"rel_mse", 2.0}};
  Json result = report_json(report)["results"][0];
  EXPECT_EQ(report_json(report)["msaa_ladder"].at(1), (Json{{"samples", 8}, {"rmse", 0.125}}));
  EXPECT_EQ(result["error"], error);
  EXPECT_EQ(result["frames"][0]["error"], error);
  EXPECT_EQ(result["equivalent_msaa"], 8.0);
  EXPECT_EQ(result["equivalent_msaa_is_lower_bound"], false);
  EXPECT_FALSE(result.contains("equivalent_msaa_is_upper_bound"));

  report.results[0].equivalent_msaa = EquivalentMsaa{256, true, false};
  EXPECT_EQ(report_json(report)["results"][0]["equivalent_msaa_is_lower_bound"], true);
  report.results[0].equivalent_msaa = EquivalentMsaa{1, false, true};
  result = report_json(report)["results"][0];
  EXPECT_EQ(result["equivalent_msaa_is_lower_bound"], false);
  EXPECT_EQ(result["equivalent_msaa_is_upper_bound"], true);
  report.results[0].equivalent_msaa = {.samples = 8, .low = 7, .high = 9};
  result = report_json(report)["results"][0];
  EXPECT_EQ(result["equivalent_msaa_low"], 7.0);
  EXPECT_EQ(result["equivalent_msaa_high"], 9.0);
  report.results[0].equivalent_msaa = {.samples = 8, .is_lower_bound = true, .does_not_converge = true};
  result = report_json(report)["results"][0];
  EXPECT_FALSE(result.contains("equivalent_msaa")) << "there is no number";
  EXPECT_EQ(result["equivalent_msaa_does_not_converge"], true);
}

TEST(ReportJson, HasThePartsOfErrorsWhereSurfacesVary) {
  Report report = compared_report();
  EXPECT_FALSE(report_json(report).contains("visibility_msaa_ladder"));
  EXPECT_FALSE(report_json(report)["results"][0].contains("visibility"));
  EXPECT_FALSE(report_json(report)["results"][0].contains("shading"));
  report.visibility_ladder = {{1, 0.25}, {8, 0.0625}};
  report.results[0].parts = ErrorParts{0.0625, 0.5};
  report.results[0].visibility_msaa = EquivalentMsaa{256, true, false};
  change_frames(report.results[0], [](FrameReport& frame, std::size_t i) {
    if (i == 1) frame.parts = ErrorParts{0.125, 0.25};
  });
  const Json json = report_json(report);
  EXPECT_EQ(json["visibility_msaa_ladder"].at(1), (Json{{"samples", 8}, {"rmse", 0.0625}}));
  const Json& result = json["results"][0];
  EXPECT_EQ(result["visibility"],
            (Json{{"rmse", 0.0625}, {"equivalent_msaa", 256.0}, {"equivalent_msaa_is_lower_bound", true}}));
  EXPECT_EQ(result["shading"], (Json{{"rmse", 0.5}}));
  EXPECT_EQ(result["frames"].at(1)["visibility"], (Json{{"rmse", 0.125}}));
  EXPECT_EQ(result["frames"].at(1)["shading"], (Json{{"rmse", 0.25}}));
  EXPECT_FALSE(result["frames"].at(0).contains("visibility"));
}

TEST(ReportJson, KeysKeepTheirOrder) {
  EXPECT_EQ(keys_of(report_json(compared_report())),
            (std::vector<std::string>{"beampipe_report", "trace", "version", "simd", "threads", "memory_system",
                                      "msaa_ladder", "results", "claims"}));
}

// As one value printed at once would be: empty arrays too, and text with line ends and braces.
TEST(ReportJson, HasTheTextOfAJsonValue) {
  Report report = compared_report();
  report.trace = "a \n } ] b.json";
  TechniqueReport& empty = report.results.emplace_back();
  empty.technique = "beam";
  EXPECT_EQ(report_text(report), json_text(report_json(report)));
  report.results.clear();
  EXPECT_EQ(report_text(report), json_text(report_json(report)));
}

TEST(ReportJson, IsTextEvenWhenAFileNameIsNotUtf8) {
  Report report = sample_report();
  report.trace = "caf\xE9.json";
  EXPECT_NO_THROW(report_json(report));
}

TEST(PixelCounters, AreSummedUpByMeanAndMax) {
  const PixelCounterStats stats = measure_counter({1, 0, 7, 2});
  EXPECT_DOUBLE_EQ(stats.share, 0.75);
  EXPECT_EQ(stats.mean, 2.5);
  EXPECT_EQ(stats.max, 7);
}

TEST(WallTime, IsMedianMinMaxAndRuns) {
  const WallTime odd = wall_time({5, 1, 3});
  EXPECT_EQ(odd.median, 3);
  EXPECT_EQ(odd.min, 1);
  EXPECT_EQ(odd.max, 5);
  EXPECT_EQ(odd.runs, 3);
  EXPECT_EQ(wall_time({4, 1, 2, 100}).median, 3);
  EXPECT_EQ(wall_time({7}).median, 7);
  EXPECT_THROW(wall_time({}), std::invalid_argument);
}

TEST(SpecFolder, TurnsEverythingElseIntoUnderscores) {
  EXPECT_EQ(spec_folder("msaa:8"), "msaa_8");
  EXPECT_EQ(spec_folder("beam:mask=exact,k=1.5-x"), "beam_mask=exact_k=1.5-x");
  EXPECT_EQ(spec_folder("a/b\\c d_\xC3\xA9"), "a_b_c_d___");
}

TEST(Table, HasOneRowPerTechnique) {
  EXPECT_EQ(table_text(sample_report(), "out"),
            "technique  B/px on chip  off chip  wall ms  picture\n"
            "msaa:8                0        92      9.0  out/msaa_8/frame_0004.png and 1 more\n");
}

TEST(Table, TellsNoTimeOfAnEarlierRun) {
  Report report = sample_report();
  change_frames(report.results[0], [](FrameReport& frame, std::size_t i) { frame.wall_ms.kept = i == 1; });
  EXPECT_EQ(table_text(report, "out"),
            "technique  B/px on chip  off chip  wall ms  picture\n"
            "msaa:8                0        92     kept  out/msaa_8/frame_0004.png and 1 more\n");
  const Json frames = report_json(report)["results"].at(0)["frames"];
  EXPECT_FALSE(frames.at(0).at("wall_ms").contains("kept"));
  EXPECT_EQ(frames.at(1).at("wall_ms").at("kept"), true);
}

TEST(Table, HasErrorsAfterCompare) {
  Report report = compared_report();
  FrameReports first;
  first.push_back(report.results[0].frames.front());
  report.results[0].frames = first;
  report.results.push_back(report.results[0]);
  report.results[1].technique = "beam";
  report.results[1].equivalent_msaa = EquivalentMsaa{256, true, false};
  FrameReport in_bins = first.front();
  in_bins.bin_pixels = 256;  // 64 bytes of pairs
  FrameReports second;
  second.push_back(in_bins);
  report.results[1].frames = second;
  EXPECT_EQ(table_text(report, "out"),
            "technique  B/px on chip  off chip      RMSE       bias      p99      max    EMR  wall ms  picture\n"
            "msaa:8                0        92  0.125000  -0.250000  0.50000  1.00000      8      8.0  "
            "out/msaa_8/frame_0004.png\n"
            "beam               0.25        92  0.125000  -0.250000  0.50000  1.00000  ≥ 256      8.0  "
            "out/msaa_8/frame_0004.png\n");
}

TEST(Table, HasTheOtherMeasuresBelow) {
  Report report = compared_report();
  report.results[0].error->srgb_rmse = 0.01;  // 40 dB
  report.results[0].error->ssim = 0.96875;
  report.results[0].equivalent_msaa = {.samples = 8, .low = 7.25, .high = 9.5};
  report.results[0].error->flip = report.results[0].error->hdr_flip = 0.125;
  report.results.push_back(report.results[0]);
  report.results[1].technique = "reference";
  report.results[1].equivalent_msaa = {.samples = 1024, .is_lower_bound = true, .low = 256};
  report.results[1].error = ErrorStats{.srgb_rmse = 0.0, .ssim = 1, .flip = 0.0, .hdr_flip = 0.0};
  EXPECT_EQ(measures_text(report),
            "\n"
            "technique    EMR within     p99.9       MAE  relMSE  sRGB RMSE   PSNR      SSIM      FLIP  HDR-FLIP\n"
            "msaa:8        7.25..9.5  0.750000  0.250000       2   0.010000  40.00  0.968750  0.125000  0.125000\n"
            "reference  at least 256  0.000000  0.000000       0   0.000000         1.000000  0.000000  0.000000\n");
  EXPECT_EQ(measures_text(sample_report()), "");
}

TEST(Table, MarksBoundsOfEquivalentRates) {
  EXPECT_EQ(emr_text({36.24, false, false}), "36.2");
  EXPECT_EQ(emr_text({1024, true, false}), "≥ 1024");
  EXPECT_EQ(emr_text({1, false, true}), "< 1");
  EXPECT_EQ(emr_text({1024, true, false, true}), "does not converge");
}

}  // namespace beampipe::report_test
