// The built program from end to end, on a trace of two triangles.

#include <nlohmann/json.hpp>

#include "simd/target.h"
#include "tests/tools/cli/program_fixture.h"
#include "tests/traces/gltf_builder.h"
#include "tools/evaluate/metrics.h"
#include "tools/files/image_io.h"
#include "traces/files/image_file.h"
#include "traces/files/trace_io.h"

namespace beampipe::program_test {

using Parsed = nlohmann::json;  // independent of the program's own Json

Parsed parsed(const std::filesystem::path& file) { return Parsed::parse(read_text(file)); }

// What stands at these places.
void expect_values(const Parsed& json, const std::vector<std::pair<const char*, Parsed>>& values) {
  for (const auto& [place, value] : values) EXPECT_EQ(json.at(Parsed::json_pointer(place)), value) << place;
}

TEST_F(ProgramTest, HelpTeachesAndVersionIsOneLine) {
  expect_parts(succeed({"--help"}), {"beampipe compare fence.json -t beam"});
  for (const char* command : {"run", "compare"}) expect_parts(succeed({command, "--help"}), {"msaa:N"});
  const std::string version = succeed({"--version"});
  EXPECT_EQ(version.rfind("beampipe 0.", 0), 0u) << version;
  EXPECT_EQ(version.find('\n'), version.size() - 1);
}

TEST_F(ProgramTest, RunWritesImagesCountersAndReport) {
  const std::string table =
      succeed({"run", path("trace.json"), "-t", "beam", "msaa:4", "-o", path("out"), "--repeat", "3"});
  EXPECT_EQ(
      folder_.list(),
      (Names{"out/", "out/beam/", "out/beam/frame_0000.exr", "out/beam/frame_0000.png",
             "out/beam/frame_0000_counters.exr", "out/beam/frame_0001.exr", "out/beam/frame_0001.png",
             "out/beam/frame_0001_counters.exr", "out/msaa_4/", "out/msaa_4/frame_0000.exr",
             "out/msaa_4/frame_0000.png", "out/msaa_4/frame_0000_counters.exr", "out/msaa_4/frame_0001.exr",
             "out/msaa_4/frame_0001.png", "out/msaa_4/frame_0001_counters.exr", "out/report.json", "trace.json"}));
  expect_parts(table, {"msaa:4", path("out/beam/frame_0000.png")});

  const Image image = read_exr(folder_ / "out/beam/frame_0001.exr");
  EXPECT_EQ(std::pair(image.width, image.height), std::pair(8u, 16u));
  const Parsed json = parsed(folder_ / "out/report.json");
  EXPECT_EQ(json["beampipe_report"], 2);
  EXPECT_EQ(json["trace"], path("trace.json"));
  EXPECT_GT(json["threads"], 0);
  EXPECT_FALSE(json.contains("msaa_ladder"));
  ASSERT_EQ(json["results"].size(), 2u);
  for (const Parsed& result : json["results"]) {
    EXPECT_FALSE(result.contains("error"));
    EXPECT_FALSE(result.contains("equivalent_msaa"));
    ASSERT_EQ(result["frames"].size(), 2u);
    int bytes = 0;
    for (const Parsed& surface : result["framebuffer"]) bytes += surface["bytes_per_pixel"].get<int>();
    EXPECT_EQ(result["framebuffer_bytes_per_pixel"], bytes);
    EXPECT_GT(bytes, 0);
    for (const Parsed& frame : result["frames"]) {
      EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / frame["image"].get<std::string>()));
      EXPECT_FALSE(frame.contains("error"));
      EXPECT_EQ(frame["wall_ms"]["runs"], 3);
      EXPECT_LE(frame["wall_ms"]["min"], frame["wall_ms"]["median"]);
      EXPECT_LE(frame["wall_ms"]["median"], frame["wall_ms"]["max"]);
      EXPECT_EQ(frame["wall_ms"]["with_memory_model"], false);
      EXPECT_GT(frame["wall_ms"]["modelling_run"], 0);
      EXPECT_GT(frame["dram_bytes"], 0) << "an additional run models memory";
      ASSERT_FALSE(frame["stages"].empty());
    }
  }
}

TEST_F(ProgramTest, ImagesAreLinearWithRowZeroOnTop) {
  succeed({"run", path("trace.json"), "-t", "msaa:4", "beam", "--frames", "0", "-o", path("out")});
  const Parsed wall = parsed(folder_ / "out/report.json")["results"][0]["frames"][0]["wall_ms"];
  EXPECT_EQ(wall["with_memory_model"], true) << "the only run models memory";
  EXPECT_FALSE(wall.contains("modelling_run"));
  for (const std::string spec : {"msaa_4", "beam"}) {
    const Image image = read_exr(folder_ / "out" / spec / "frame_0000.exr");
    const std::vector<float>& values = image.rgba;
    EXPECT_EQ(std::vector<float>(values.begin(), values.begin() + 4), (std::vector<float>{1, 0.25f, 0, 1})) << spec;
    EXPECT_EQ(std::vector<float>(values.end() - 4, values.end()), (std::vector<float>{0, 0, 0.5f, 0})) << spec;
  }
}

TEST_F(ProgramTest, RunRendersOnlyTheFramesAskedFor) {
  succeed({"run", path("trace.json"), "-t", "msaa:1", "--frames", "1-1", "-o", path("out")});
  EXPECT_EQ(parsed(folder_ / "out/report.json")["results"][0]["frames"].size(), 1u);
  EXPECT_EQ(parsed(folder_ / "out/report.json")["results"][0]["frames"][0]["index"], 1);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/msaa_1/frame_0001.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/msaa_1/frame_0000.exr"));
}

TEST_F(ProgramTest, ATechniqueWithAHistorySaysThatOneFrameHasNone) {
  const Outcome outcome =
      run_program({"run", path("trace.json"), "-t", "taa:8", "msaa:1", "--frames", "0", "-o", path("out")});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "beampipe: note: taa:8 works over several frames; the first one has no history\n");
  succeed({"run", path("trace.json"), "-t", "taa:8", "-o", path("out")});
}

TEST_F(ProgramTest, ASecondRunReplacesTheFirst) {
  succeed({"run", path("trace.json"), "-t", "msaa:1", "-o", path("out")});
  const std::string image = read_text(folder_ / "out/msaa_1/frame_0000.exr");
  const Names names = folder_.list();
  write_text(folder_ / "out/msaa_1/frame_0000.exr", "spoilt");
  succeed({"run", path("trace.json"), "-t", "msaa:1", "-o", path("out"), "--threads", "2"});
  EXPECT_EQ(folder_.list(), names);
  EXPECT_EQ(read_text(folder_ / "out/msaa_1/frame_0000.exr"), image) << "the same bytes with any number of threads";
}

TEST_F(ProgramTest, CompareMeasuresAgainstTheReference) {
  const std::string table = succeed({"compare", path("trace.json"), "-t", "msaa:1,8", "beam", "-o", path("out")});
  const Parsed json = parsed(folder_ / "out/report.json");
  ASSERT_EQ(json["results"].size(), 4u);
  EXPECT_EQ(json["results"][3]["technique"], "reference");
  EXPECT_EQ(json["results"][3]["error"]["max"], 0.0);

  const Parsed& ladder = json["msaa_ladder"];
  ASSERT_GE(ladder.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(ladder[i]["samples"], 1 << i);
  EXPECT_EQ(ladder[0]["rmse"], json["results"][0]["error"]["rmse"]);
  EXPECT_EQ(ladder[3]["rmse"], json["results"][1]["error"]["rmse"]);
  EXPECT_LT(ladder[8]["rmse"], ladder[0]["rmse"]);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/msaa_16"))
      << "pictures of rungs are written only if they are asked for";

  for (std::size_t i = 0; i < 3; ++i) {
    const Parsed& result = json["results"][i];
    ErrorAccumulator pooled(20 * 12 + 8 * 16);
    for (const Parsed& frame : result["frames"]) {
      const Image image = read_exr(folder_ / "out" / frame["image"].get<std::string>());
      const std::string name = std::filesystem::path(frame["image"].get<std::string>()).filename();
      const Image reference = read_exr(folder_ / "out/reference" / name);
      const ErrorStats stats = measure_error(image, reference);
      EXPECT_EQ(frame["error"]["rmse"], stats.rmse);
      EXPECT_EQ(frame["error"]["p99"], stats.p99);
      pooled.add(image, reference);
      const Planes counters = read_exr_planes(folder_ / "out" / frame["counters"].get<std::string>());
      EXPECT_EQ(counters.channels.at("error"), pixel_errors(image, reference));
    }
    EXPECT_EQ(result["error"]["rmse"], pooled.stats().rmse);
    EXPECT_EQ(result["error"]["bias"], pooled.stats().bias);
    EXPECT_EQ(result["error"]["p99"], pooled.stats().p99);
    EXPECT_EQ(result["error"]["max"], pooled.stats().max);
  }
  EXPECT_GT(json["results"][0]["error"]["rmse"], 0.0) << "one sample per pixel has errors on slanted edges";
  EXPECT_EQ(json["results"][0]["equivalent_msaa"], 1.0);
  EXPECT_EQ(json["results"][1]["equivalent_msaa"], 8.0);
  EXPECT_EQ(json["results"][1]["equivalent_msaa_is_lower_bound"], false);
  expect_parts(table, {"EMR"});
}

TEST_F(ProgramTest, CompareTakesALadderOfTheUsersChoice) {
  succeed({"compare", path("trace.json"), "-t", "beam", "reference", "-o", path("out"), "--ladder", "2,1,2"});
  const Parsed json = parsed(folder_ / "out/report.json");
  ASSERT_EQ(json["msaa_ladder"].size(), 2u);
  ASSERT_EQ(json["results"].size(), 2u) << "the reference appears once";
  expect_values(json, {{"/msaa_ladder/0/samples", 1},
                       {"/msaa_ladder/1/samples", 2},
                       {"/results/1/equivalent_msaa", 2},
                       {"/results/1/equivalent_msaa_is_lower_bound", true}});
}

TEST_F(ProgramTest, CompareFindsRatesByAnotherMetric) {
  succeed({"compare", path("trace.json"), "-t", "beam", "msaa:2", "-o", path("by_rmse"), "--ladder", "1,2,4"});
  const Parsed by_rmse = parsed(folder_ / "by_rmse/report.json");
  EXPECT_EQ(by_rmse["metric"], "rmse");
  EXPECT_FALSE(by_rmse.contains("metric_msaa_ladder"));
  for (const char* metric : {"ssim", "flip", "psnr"}) {
    const std::string table = succeed({"compare", path("trace.json"), "-t", "beam", "msaa:2", "-o", path(metric),
                                       "--ladder", "1,2,4", "--metric", metric});
    const Parsed json = parsed(folder_ / metric / "report.json");
    EXPECT_EQ(json["metric"], metric);
    EXPECT_EQ(json["made_by"]["metric"], metric);
    EXPECT_EQ(json["msaa_ladder"], by_rmse["msaa_ladder"]);
    const Parsed& error = json["results"][1]["error"];
    EXPECT_EQ(error, by_rmse["results"][1]["error"]) << "only the rates depend on the metric";
    const Parsed& ladder = json["metric_msaa_ladder"];
    ASSERT_EQ(ladder.size(), 3u);
    const double of_msaa_2 = metric == std::string("ssim")   ? 1 - error["ssim"].get<double>()
                             : metric == std::string("psnr") ? error["srgb_rmse"].get<double>()
                                                             : error["flip"].get<double>();
    EXPECT_EQ(ladder[1], (Parsed{{"samples", 2}, {"error", of_msaa_2}}));
    EXPECT_GT(ladder[0]["error"], ladder[2]["error"]);
    EXPECT_EQ(json["results"][1]["equivalent_msaa"], 2.0);
    expect_parts(table, {"EMR by "});
  }
  // A rung that is not among the techniques is measured as one of them would be.
  succeed({"compare", path("trace.json"), "-t", "msaa:1", "-o", path("one"), "--ladder", "1,2,4", "--metric", "flip"});
  EXPECT_EQ(parsed(folder_ / "one/report.json")["metric_msaa_ladder"],
            parsed(folder_ / "flip/report.json")["metric_msaa_ladder"]);
}

TEST_F(ProgramTest, CompareExtendsItsLadderForTechniquesThatAreBetter) {
  // The picture has one edge over a plain background, where analytic coverage is nearly exact.
  write_text(folder_ / "edge.json", R"({"beampipe_trace": 1,
    "meshes": {"red": {"positions": [-1,-0.9,0, 0.97,1,0, -1,1,0], "indices": [0,1,2], "colors": [1,0.25,0]}},
    "frames": [{"width": 20, "height": 12, "background": [0,0,0.5], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
                "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "red"}]}]})");
  succeed({"compare", path("edge.json"), "-t", "msaa:1024", "alpha", "-o", path("out")});
  const Parsed json = parsed(folder_ / "out/report.json");
  ASSERT_EQ(json["msaa_ladder"].size(), 11u);
  EXPECT_EQ(json["msaa_ladder"][9]["samples"], 512);
  EXPECT_EQ(json["msaa_ladder"][10]["rmse"], json["results"][0]["error"]["rmse"]);
  EXPECT_GT(json["results"][1]["equivalent_msaa"], 256.0);
  EXPECT_EQ(json["results"][0]["equivalent_msaa_is_lower_bound"], false);

  succeed({"compare", path("edge.json"), "-t", "msaa:1024", "-o", path("out")});
  EXPECT_EQ(parsed(folder_ / "out/report.json")["msaa_ladder"].size(), 9u) << "a good MSAA does not extend the ladder";
}

TEST_F(ProgramTest, PlotDrawsTheTrafficOfARun) {
  succeed({"run", path("trace.json"), "-t", "beam", "msaa:4", "-o", path("out")});
  succeed({"plot", path("out"), "--kind", "traffic", "-o", path("traffic.svg")});
  const std::string svg = read_text(folder_ / "traffic.svg");
  expect_parts(svg, {">beam<", ">msaa:4<", ">resolve<"});
  succeed({"run", path("trace.json"), "-t", "beam", "-o", path("other"), "--no-memory-model"});
  expect_error({"plot", path("other"), "--kind", "traffic", "-o", path("x.svg")}, 1,
               "other/report.json: it has no DRAM bytes; expected a report made without --no-memory-model");
}

TEST_F(ProgramTest, CountersListsWhatIsCounted) {
  const Parsed json = Parsed::parse(succeed({"counters", "depth_test", "--json"}));
  ASSERT_EQ(json["stages"].size(), 1u);
  expect_values(json["stages"][0],
                {{"/stage", "depth_test"}, {"/group", "visibility"}, {"/shader", false}, {"/counters/0", "items_in"}});
  expect_parts(succeed({"counters"}),
               {"depth_test (visibility; fixed function)\n", "  counters ", "\nCounters of pixels\n"});
}

TEST_F(ProgramTest, DiffTellsTheError) {
  write_text(folder_ / "a.exr", encode_exr(flat_image(4, 2, 0.75f)));
  write_text(folder_ / "b.exr", encode_exr(flat_image(4, 2, 0.5f)));
  const Parsed json = Parsed::parse(succeed({"diff", path("a.exr"), path("b.exr"), "--json"}));
  expect_values(json, {{"/beampipe_diff", 1},
                       {"/width", 4},
                       {"/height", 2},
                       {"/rmse", 0.25},
                       {"/bias", 0.25},
                       {"/p99", 0.25},
                       {"/max", 0.25},
                       {"/differing_pixels", 8}});
  expect_parts(succeed({"diff", path("a.exr"), path("b.exr")}), {"\nrmse       0.25\n", "\npsnr "});
  succeed({"diff", path("a.exr"), path("b.exr"), "--map", path("map.exr"), "--metric", "rmse"});
  EXPECT_EQ(read_exr_planes(folder_ / "map.exr").channels.at("rmse"), std::vector<float>(8, 0.25f));
  succeed({"diff", path("a.exr"), path("a.exr"), "--map", path("map.png"), "--metric", "ssim"});
  EXPECT_EQ(read_text(folder_ / "map.png"), encode_png(4, 2, std::vector<std::uint8_t>(24, 255))) << "equal is white";
  expect_error({"diff", path("a.exr"), path("b.exr"), "--map", path("map.jpg")}, 2, "ends in .exr or .png");
  expect_error({"diff", path("a.exr"), path("b.exr"), "--metric", "flip"}, 2, "--map");
  EXPECT_EQ(Parsed::parse(succeed({"diff", path("a.exr"), path("a.exr"), "--json"}))["differing_pixels"], 0);
  write_text(folder_ / "b.exr", encode_exr(flat_image(2, 4, 0.75f)));
  expect_error({"diff", path("a.exr"), path("b.exr")}, 1, "different sizes: 4 x 2 and 2 x 4");
}

TEST_F(ProgramTest, InfoTellsWhatIsInTheTrace) {
  const Parsed json = Parsed::parse(succeed({"info", path("trace.json"), "--json"}));
  ASSERT_EQ(json["frames"].size(), 2u);
  ASSERT_EQ(json["meshes"].size(), 2u);
  expect_values(json, {{"/frames/0/width", 20},
                       {"/frames/0/height", 12},
                       {"/frames/0/draws", 2},
                       {"/frames/0/triangles", 2},
                       {"/frames/0/bounds/min", {-1.0, -1.0, -0.5}},
                       {"/frames/0/bounds/max", {1.0, 1.0, 0.0}},
                       {"/frames/1/triangles", 1},
                       {"/meshes/0/triangles", 1}});
  expect_parts(succeed({"info", path("trace.json")}), {"20 x 12"});
}

TEST_F(ProgramTest, InfoTellsWhatSurfacesAreMadeOfAndWhatWasCaptured) {
  Trace trace;
  trace.source = {.program = "gears",
                  .api = "OpenGL",
                  .driver = "",
                  .date = "2026-01-02",
                  .tool = "",
                  .shading = "own",
                  .frame = 7};
  trace.images = {{.name = "wood", .width = 3, .height = 2, .texels = std::vector<glm::u8vec4>(6)}};
  trace.program_images = {{.name = "map", .format = TexelFormat::R8_UNORM, .width = 2, .levels = 1, .texels = {0, 0}}};
  trace.materials.resize(3);
  for (std::size_t i = 0; i < 3; ++i) trace.materials[i].name = std::to_string(i);
  trace.materials[0].normal_texture.emplace();
  trace.materials[0].alpha_mode = trace.materials[1].alpha_mode = AlphaMode::mask;
  Mesh& mesh = trace.meshes.emplace_back();
  mesh.name = "clip";
  mesh.positions = {{-2, 2, 0}, {0, 2, 2}, {2, 0, 0}};
  mesh.ws = {2, 2, 1};
  mesh.triangles = {{0, 1, 2}};
  mesh.colors = {kDefaultColor};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.uvs[0].resize(3);
  Frame& frame = trace.frames.emplace_back();
  frame.width = frame.height = 4;
  frame.lighting.lights.resize(2);
  frame.lighting.ambient.emplace();
  frame.draws.resize(2);
  frame.draws[1].state.depth.test = false;
  frame.capture.passes = {{"shadow map", 512, 512, 3, 99, false, "not shown"}};
  frame.capture.left_out = {{"lines", 2, 40}};
  write_trace(trace, path("captured.json"), ArrayStorage::binary);

  const Parsed json = Parsed::parse(succeed({"info", path("captured.json"), "--json"}));
  expect_values(json, {{"/source/program", "gears"},
                       {"/source/frame", 7},
                       {"/images", Parsed::parse(R"([{"name": "wood", "width": 3, "height": 2},
                                                     {"name": "map", "width": 2, "height": 1}])")},
                       {"/materials", {{"opaque", 1}, {"mask", 2}, {"blend", 0}, {"textured", 1}}},
                       {"/meshes/0/attributes", {"normals", "uv0"}},
                       {"/frames/0/lights", 2},
                       {"/frames/0/ambient", true},
                       {"/frames/0/state", {{"no depth test", 1}}},
                       {"/frames/0/capture/left_out/0/primitives", 40},
                       {"/frames/0/bounds/max", {2.0, 1.0, 1.0}}});  // x / w
  expect_parts(succeed({"info", path("captured.json")}),
               {"2 + ambient", "materials  opaque  mask  blend  with textures\n        3       1     2      0",
                "captured from gears, OpenGL, 2026-01-02, frame 7", "colours: own", "no depth test       1",
                "shadow map  512 x 512      3         99    no  not shown", "lines         2          40",
                "1 mesh of 1 triangle, 2 images"});
}

TEST_F(ProgramTest, MakeWritesBinaryArrays) {
  succeed({"make", "soup", "--triangles", "500", "-o", path("text.json")});
  succeed({"make", "soup", "--triangles", "500", "--binary", "-o", path("binary.json")});
  EXPECT_EQ(std::filesystem::exists(path("binary.bin")), true);
  EXPECT_EQ(std::filesystem::exists(path("text.bin")), false);
  Parsed text = Parsed::parse(succeed({"info", path("text.json"), "--json"}));
  Parsed binary = Parsed::parse(succeed({"info", path("binary.json"), "--json"}));
  text.erase("trace"), binary.erase("trace");
  EXPECT_EQ(text, binary);
}

TEST_F(ProgramTest, ExportSoupWritesTheTrianglesThatAreSeen) {
  succeed({"export-soup", path("trace.json"), "-o", path("frame.soup")});
  const std::string bytes = read_text(folder_ / "frame.soup");
  std::uint32_t head[4];
  ASSERT_GE(bytes.size(), 32u);
  std::memcpy(head, bytes.data() + 4, sizeof head);
  EXPECT_EQ(bytes.substr(0, 4), "SOUP");
  EXPECT_EQ(head[0], 1u);
  EXPECT_EQ(head[1], 20u);
  EXPECT_EQ(head[2], 12u);
  EXPECT_EQ(head[3], 2u);
  ASSERT_EQ(bytes.size(), 4 + 4 * 4 + 3 * 4 + 2 * 60u);
  for (std::size_t vertex = 0; vertex < 3; ++vertex) {
    float clip[4];
    std::memcpy(clip, bytes.data() + 32 + 16 * vertex, sizeof clip);
    EXPECT_TRUE(clip[2] >= -1 && clip[2] <= 1);
    EXPECT_EQ(clip[3], 1.0f);
  }
}

TEST_F(ProgramTest, ReportsSayWhichCommandMadeThem) {
  succeed({"run", path("trace.json"), "-t", "msaa:1", "--no-memory-model", "-o", path("out of it")});
  EXPECT_EQ(Parsed::parse(read_text(folder_ / "out of it/report.json"))["command_line"],
            "beampipe run " + path("trace.json") + " -t msaa:1 --no-memory-model -o '" + path("out of it") + "'");
}

TEST_F(ProgramTest, APageOfEarlierResultsIsNoted) {
  const Names command = {"run", path("trace.json"), "-t", "msaa:1", "--no-memory-model", "--force", "-o", path("out")};
  EXPECT_EQ(run_program(command).err.find("earlier results"), std::string::npos);
  write_text(folder_ / "out/report.html", "");
  expect_parts(run_program(command).err, {"out/report.html is of earlier results"});
}

TEST_F(ProgramTest, DescriptionsOfHardwareStartFromOneThatIsBuiltIn) {
  write_text(folder_ / "mine.json", succeed({"schema", "hardware", "--built-in", "mali_g710"}));
  succeed({"run", path("trace.json"), "-t", "msaa:1", "--hardware", path("mine.json"), "-o", path("out")});
}

TEST_F(ProgramTest, CheckCaptureSaysWhichFramesHaveNoDepth) {
  Parsed trace = Parsed::parse(kTrace);
  trace["beampipe_trace"] = 2;
  trace["frames"][0]["captured"]["depth"] = std::vector<float>(20 * 12, 1.0f);
  write_text(folder_ / "trace.json", trace.dump());
  const std::string text = succeed({"check-capture", path("trace.json")});
  expect_parts(text, {"\nframe 1: the trace has no captured depth\n"});
  const Parsed json = Parsed::parse(succeed({"check-capture", path("trace.json"), "--json"}));
  EXPECT_EQ(json["beampipe_check_capture"], 1);
  EXPECT_GT(json["frames"][0].size(), 1u);
  EXPECT_EQ(json["frames"][1].size(), 1u) << "its number";
}

TEST_F(ProgramTest, MakeListsAndMakesScenes) {
  expect_parts(succeed({"make", "--list"}), {"fence"});
  const auto make = [&](const std::string& seed, const std::string& file) {
    succeed(
        {"make", "soup", "--triangles", "200", "--seed", seed, "--width", "32", "--height", "24", "-o", path(file)});
  };
  make("7", "new/a.json");
  make("7", "b.json");
  make("8", "c.json");
  EXPECT_EQ(read_text(folder_ / "new/a.json"), read_text(folder_ / "b.json"));
  EXPECT_NE(read_text(folder_ / "new/a.json"), read_text(folder_ / "c.json"));
  const Parsed info = Parsed::parse(succeed({"info", path("b.json"), "--json"}));
  EXPECT_EQ(info["frames"][0]["width"], 32);
  EXPECT_EQ(info["frames"][0]["height"], 24);
  EXPECT_NEAR(info["frames"][0]["triangles"].get<double>(), 200, 50);
}

TEST_F(ProgramTest, MakeFramesAModel) {
  write_text(folder_ / "model.obj", "v 0 0 0\nv 4 0 0\nv 0 3 0\nv 0 0 2\nf 1 2 3\nf 1 3 4\n");
  succeed({"make", path("model.obj"), "-o", path("model.json"), "--width", "24", "--height", "24"});
  const Parsed trace = parsed(folder_ / "model.json");
  const Parsed& frame = trace["frames"][0];
  EXPECT_EQ(frame["draws"][0]["shading"], "lambert");
  EXPECT_EQ(frame["camera"]["target"], Parsed({2.0, 1.5, 1.0}));
  EXPECT_TRUE(frame.contains("light"));
  succeed({"run", path("model.json"), "-t", "msaa:1", "-o", path("out")});

  succeed({"make", path("model.obj"), "-o", path("model.json"), "--target", "1,1,1", "--background", "0.25,0.5,1",
           "--unlit"});
  const Parsed chosen = parsed(folder_ / "model.json")["frames"][0];
  EXPECT_EQ(chosen["camera"]["target"], Parsed({1.0, 1.0, 1.0}));
  EXPECT_EQ(chosen["background"], Parsed({0.25, 0.5, 1.0}));
}

TEST_F(ProgramTest, MakePlaysAnAnimatedModel) {
  GltfBuilder gltf;
  const int times = gltf.floats("SCALAR", {0, 4}), places = gltf.floats("VEC3", {0, 0, 0, 8, 0, 0});
  gltf.json["animations"] = {{{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
                              {"samplers", {{{"input", times}, {"output", places}}}}}};
  write_text(folder_ / "model.gltf", gltf.text());
  succeed({"make", path("model.gltf"), "--frames", "4", "-o", path("moves.json")});
  const Parsed moves = parsed(folder_ / "moves.json")["frames"];
  ASSERT_EQ(moves.size(), 4u);
  EXPECT_EQ(moves[3]["draws"][0]["transform"][12], 6.0);
  EXPECT_EQ(moves[0]["camera"], moves[3]["camera"]);
  EXPECT_EQ(moves[0]["camera"]["target"], Parsed({3.5, 0.5, 0.0}));  // of all frames
  ASSERT_TRUE(moves[0].contains("lights"));
  EXPECT_EQ(moves[0]["lights"], moves[3]["lights"]);
  succeed({"make", path("model.gltf"), "--frames", "4", "--orbit", "90", "-o", path("turns.json")});
  const Parsed turns = parsed(folder_ / "turns.json")["frames"];
  ASSERT_EQ(turns.size(), 4u);
  EXPECT_EQ(turns[3]["draws"], turns[0]["draws"]);
  EXPECT_NE(turns[3]["camera"], turns[0]["camera"]);
  EXPECT_EQ(turns[0]["camera"]["target"], Parsed({0.5, 0.5, 0.0}));
  succeed({"run", path("moves.json"), "-t", "msaa:1", "-o", path("out")});
}

TEST_F(ProgramTest, MakeSaysOnceWhatItDoesNotRead) {
  GltfBuilder gltf;
  gltf.json["extensionsUsed"] = {"KHR_materials_clearcoat"};
  gltf.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
  gltf.json["meshes"][0]["primitives"].push_back(gltf.json["meshes"][0]["primitives"][1]);
  write_text(folder_ / "model.gltf", gltf.text());
  const Outcome outcome = run_program({"make", path("model.gltf"), "--frames", "3", "-o", path("model.json")});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "beampipe: " + path("model.gltf") +
                             ": not read: extension KHR_materials_clearcoat, primitive of points (2)\n");
}

TEST_F(ProgramTest, EveryInstructionSetGivesTheSamePictures) {
  const std::string help = succeed({"run", "--help"});
  for (const std::string& target : simd_targets()) {
    expect_parts(help, {target});
    succeed({"run", path("trace.json"), "-t", "beam", "-o", path(target), "--simd", target});
    EXPECT_EQ(parsed(folder_ / target / "report.json")["simd"], target);
    for (const char* name : {"beam/frame_0000.exr", "beam/frame_0001_counters.exr"})
      EXPECT_EQ(read_text(folder_ / target / name), read_text(folder_ / simd_targets()[0] / name)) << target;
  }
  std::string capitals = simd_targets()[0];
  std::transform(capitals.begin(), capitals.end(), capitals.begin(), [](unsigned char c) { return std::toupper(c); });
  succeed({"run", path("trace.json"), "-t", "beam", "-o", path("capitals"), "--simd", capitals});
}

TEST_F(ProgramTest, StressWritesWhatItFoundAndItsTraces) {
  const std::string table =
      succeed({"stress", "-t", "msaa:1", "dvm", "--case", "one_pixel", "--case", "not_finite", "-o", path("stress")});
  expect_parts(table, {"one_pixel    exact  2^-2.0*"});
  const Parsed found = parsed(folder_ / "stress/stress.json");
  ASSERT_EQ(found.size(), 4u);
  expect_values(found, {{"/0/case", "not_finite"},
                        {"/3/technique", "dvm"},
                        {"/3/error", 0.25},
                        {"/3/passes", true},
                        {"/3/reason", "its 2x2 quad extends beyond the frame"}});
  succeed({"run", path("stress/traces/one_pixel.json"), "-t", "msaa:1", "-o", path("again")});
  expect_error({"stress", "--case", "none_such", "-o", path("other")}, 2, "none_such");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other"));
  std::filesystem::create_directory(folder_ / "other");
  write_text(folder_ / "other/traces", "");
  write_text(folder_ / "other/unfinished", "");
  const std::string something_else = ": expected a folder, found something else";
  expect_error({"stress", "-t", "msaa:1", "--case", "one_pixel", "-o", path("other")}, 1,
               path("other/traces") + something_else);
  expect_error({"run", path("stress/traces/one_pixel.json"), "-t", "msaa:1", "-o", path("other")}, 1,
               path("other/unfinished") + something_else);
}

// 200 layers over 12 tiles, rendered with the smallest amount of memory that one tile can do with.
TEST_F(ProgramTest, MemoryLimitBoundsThePeakAndChangesNothing) {
  succeed({"make", "stack", "--triangles", "200", "--width", "128", "--height", "96", "-o", path("deep.json")});
  const auto run = [&](const std::string& limit, const std::string& out) {
    return run_program({"run", path("deep.json"), "-t", "casav", "--no-memory-model", "--threads", "4",
                        "--memory-limit", limit, "-o", path(out)});
  };
  const Outcome refused = run("1MB", "refused");
  EXPECT_EQ(refused.exit_code, 1);
  const std::string needs =
      "error: the memory limit of 1 MiB is too low: the 200 triangles at pixels 0,0 to 31,31 need ";
  ASSERT_NE(refused.err.find(needs), std::string::npos) << refused.err;
  const std::uint64_t needed = std::stoull(refused.err.substr(refused.err.find(needs) + needs.size()));
  const Outcome banded = run(std::to_string(needed) + "MB", "banded"), whole = run("16GB", "whole");
  ASSERT_EQ(banded.exit_code, 0) << banded.err;
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers take memory themselves
  constexpr std::uint64_t kProgram = 40;                             // MiB, including the trace and the pictures
  EXPECT_LT(banded.peak_bytes >> 20, needed + kProgram);
  EXPECT_GT(whole.peak_bytes >> 20, needed + kProgram) << "otherwise this test shows nothing";
#endif
  for (const char* file : {"frame_0000.exr", "frame_0000_counters.exr"})
    EXPECT_EQ(read_text(folder_ / "banded/casav" / file), read_text(folder_ / "whole/casav" / file)) << file;
}

// A frame's results take 22 KiB as JSON. The first 64 frames' stay in memory.
TEST_F(ProgramTest, MemoryDoesNotGrowWithTheNumberOfFrames) {
  const auto peak = [&](const std::string& frames) {
    const std::string trace = path(frames + ".json"), out = path(frames);
    succeed({"make", "soup", "--triangles", "9", "--width", "4", "--height", "2", "--frames", frames, "--pan", "0.5,0",
             "-o", trace});
    const Outcome outcome = run_program({"run", trace, "-t", "beam", "--threads", "1", "-o", out});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(parsed(std::filesystem::path(out) / "report.json")["results"][0]["frames"].size(), std::stoul(frames));
    return outcome.peak_bytes;
  };
  const std::uint64_t few = peak("70"), many = peak("150");
  std::printf("%llu KiB for 70 frames, %llu KiB for 150\n", static_cast<unsigned long long>(few >> 10),
              static_cast<unsigned long long>(many >> 10));
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers keep freed memory
  EXPECT_LT(many, few + (1 << 20));
#endif
}

TEST_F(ProgramTest, TheFramebufferIsWhereTheOptionsSay) {
  std::string notes;
  const auto run = [&](const Names& options) {
    notes = finish(joined({"run", path("trace.json"), "-t", "beam", "msaa:4", "-o", path("out")}, options)).err;
    return parsed(folder_ / "out/report.json");
  };
  const auto expect = [](const Parsed& result, bool on_chip, int off_chip) {
    EXPECT_EQ(result["pixels_on_chip"], on_chip) << result["technique"];
    EXPECT_EQ(result["off_chip_bytes_per_pixel"], off_chip) << result["technique"];
    EXPECT_EQ(result["on_chip_bytes_per_pixel"].get<double>() > 40, on_chip) << result["technique"];
  };
  Parsed json = run({});
  EXPECT_EQ(json["memory_system"]["framebuffer"], "by-technique");
  expect(json["results"][0], true, 6);
  expect(json["results"][1], false, 40);
  json = run({"--framebuffer", "on-chip"});
  EXPECT_EQ(json["memory_system"]["framebuffer"], "on-chip");
  expect(json["results"][0], true, 6);
  expect(json["results"][1], true, 6);
  json = run({"--framebuffer", "in-memory"});
  expect(json["results"][0], false, 46);
  expect(json["results"][1], false, 40);
  json = run({"--on-chip-memory", "2KB"});
  EXPECT_EQ(json["memory_system"]["on_chip_bytes"], 2048);
  EXPECT_TRUE(notes.starts_with("beampipe: note: beam: pixels in memory: a bin of 8 x 8 pixels needs 2.")) << notes;
  expect(json["results"][0], false, 46);
  expect(run({"--on-chip-memory", "3KB"})["results"][0], true, 6);
  EXPECT_EQ(notes, "");
}

}  // namespace beampipe::program_test
