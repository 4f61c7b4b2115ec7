// The built program from end to end, on a trace of two triangles.

#include "tests/tools/program.h"

#include <pty.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "simd/target.h"
#include "tools/evaluate/metrics.h"
#include "tools/files/image_io.h"
#include "tools/files/output.h"

namespace beampipe {
namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

// Two frames of 20 x 12 and 8 x 16. The red triangle covers the upper left half, the green one a slanted sliver.
constexpr const char* kTrace = R"({"beampipe_trace": 1,
  "meshes": {"red":   {"positions": [-1,-1,0, 1,1,0, -1,1,0], "indices": [0,1,2], "colors": [1,0.25,0]},
             "green": {"positions": [-0.9,-0.7,-0.5, 0.9,-0.6,-0.5, 0.8,0.3,-0.5], "indices": [0,1,2], "colors": [0,1,0.5]}},
  "frames": [{"width": 20, "height": 12, "background": [0,0,0.5], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
              "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "red"}, {"mesh": "green"}]},
             {"width": 8, "height": 16, "background": [1,1,1], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
              "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "green"}]}]})";

class ProgramTest : public testing::Test {
 protected:
  void SetUp() override { write_text(folder_ / "trace.json", kTrace); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  Json report() const { return Json::parse(read_text(folder_ / "out/report.json")); }

  // Runs, and expects success and silence on standard error.
  std::string succeed(const std::vector<std::string>& arguments) {
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  }

  TemporaryFolder folder_;
};

void expect_one_error_line(const Outcome& outcome, int exit_code, const std::string& part) {
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.rfind("beampipe: error: ", 0), 0u) << outcome.err;
  EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
  EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err << "does not say: " << part;
}

TEST_F(ProgramTest, HelpTeachesAndVersionIsOneLine) {
  EXPECT_NE(succeed({"--help"}).find("beampipe compare fence.json -t beam"), std::string::npos);
  EXPECT_NE(succeed({"run", "--help"}).find("msaa:N"), std::string::npos) << "run lists the techniques";
  EXPECT_NE(succeed({"compare", "--help"}).find("msaa:N"), std::string::npos);
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
  EXPECT_NE(table.find("msaa:4"), std::string::npos);
  EXPECT_NE(table.find(path("out/beam/frame_0000.png")), std::string::npos);

  const Image image = read_exr(folder_ / "out/beam/frame_0001.exr");
  EXPECT_EQ(image.width, 8u);
  EXPECT_EQ(image.height, 16u);
  const Json json = report();
  EXPECT_EQ(json["beampipe_report"], 1);
  EXPECT_EQ(json["trace"], path("trace.json"));
  EXPECT_GT(json["threads"], 0);
  EXPECT_FALSE(json.contains("msaa_ladder"));
  ASSERT_EQ(json["results"].size(), 2u);
  for (const Json& result : json["results"]) {
    EXPECT_FALSE(result.contains("error"));
    EXPECT_FALSE(result.contains("equivalent_msaa"));
    ASSERT_EQ(result["frames"].size(), 2u);
    int bytes = 0;
    for (const Json& surface : result["framebuffer"]) bytes += surface["bytes_per_pixel"].get<int>();
    EXPECT_EQ(result["framebuffer_bytes_per_pixel"], bytes);
    EXPECT_GT(bytes, 0);
    for (const Json& frame : result["frames"]) {
      EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / frame["image"].get<std::string>()));
      EXPECT_EQ(frame["wall_ms"]["runs"], 3);
      EXPECT_LE(frame["wall_ms"]["min"], frame["wall_ms"]["median"]);
      EXPECT_LE(frame["wall_ms"]["median"], frame["wall_ms"]["max"]);
      EXPECT_EQ(frame["wall_ms"]["with_memory_model"], false);
      EXPECT_GT(frame["wall_ms"]["modelling_run"], 0);
      EXPECT_GT(frame["dram_bytes"], 0) << "one more run, for the counts";
      ASSERT_FALSE(frame["stages"].empty());
      EXPECT_EQ(frame["stages"][0]["stage"], "vertex_setup");
      const Json& ops = frame["stages"][0]["ops"];
      std::int64_t total = 0;
      for (const char* kind : {"mul_add", "add", "bit", "fetch", "special", "convert"})
        total += ops.at(kind).get<int>();
      EXPECT_EQ(ops["total"], total);
    }
  }
}

TEST_F(ProgramTest, ImagesAreLinearWithRowZeroOnTop) {
  succeed({"run", path("trace.json"), "-t", "msaa:4", "beam", "--frames", "0", "-o", path("out")});
  const Json wall = report()["results"][0]["frames"][0]["wall_ms"];
  EXPECT_EQ(wall["with_memory_model"], true) << "the only run is the one that counts";
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
  EXPECT_EQ(report()["results"][0]["frames"].size(), 1u);
  EXPECT_EQ(report()["results"][0]["frames"][0]["index"], 1);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/msaa_1/frame_0001.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/msaa_1/frame_0000.exr"));
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
  const Json json = report();
  ASSERT_EQ(json["results"].size(), 4u);
  EXPECT_EQ(json["results"][3]["technique"], "reference");
  EXPECT_EQ(json["results"][3]["error"]["max"], 0.0);

  const Json& ladder = json["msaa_ladder"];
  ASSERT_GE(ladder.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(ladder[i]["samples"], 1 << i);
  EXPECT_EQ(ladder[0]["rmse"], json["results"][0]["error"]["rmse"]);
  EXPECT_EQ(ladder[3]["rmse"], json["results"][1]["error"]["rmse"]);
  EXPECT_LT(ladder[8]["rmse"], ladder[0]["rmse"]);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/msaa_16")) << "rungs that nobody asked for are not written";

  for (std::size_t i = 0; i < 3; ++i) {
    const Json& result = json["results"][i];
    ErrorAccumulator pooled(20 * 12 + 8 * 16);
    for (const Json& frame : result["frames"]) {
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
  EXPECT_NE(table.find("EMR"), std::string::npos);
}

TEST_F(ProgramTest, CompareTakesALadderOfTheUsersChoice) {
  succeed({"compare", path("trace.json"), "-t", "beam", "reference", "-o", path("out"), "--ladder", "2,1,2"});
  const Json json = report();
  ASSERT_EQ(json["msaa_ladder"].size(), 2u);
  EXPECT_EQ(json["msaa_ladder"][0]["samples"], 1);
  EXPECT_EQ(json["msaa_ladder"][1]["samples"], 2);
  ASSERT_EQ(json["results"].size(), 2u) << "the reference is there once";
  EXPECT_EQ(json["results"][1]["equivalent_msaa"], 2.0);
  EXPECT_EQ(json["results"][1]["equivalent_msaa_is_lower_bound"], true);
}

TEST_F(ProgramTest, CompareExtendsItsLadderForTechniquesThatAreBetter) {
  // One edge over a plain background: its analytic coverage is nearly exact.
  write_text(folder_ / "edge.json", R"({"beampipe_trace": 1,
    "meshes": {"red": {"positions": [-1,-0.9,0, 0.97,1,0, -1,1,0], "indices": [0,1,2], "colors": [1,0.25,0]}},
    "frames": [{"width": 20, "height": 12, "background": [0,0,0.5], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
                "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "red"}]}]})");
  succeed({"compare", path("edge.json"), "-t", "msaa:1024", "alpha", "-o", path("out")});
  const Json json = report();
  ASSERT_EQ(json["msaa_ladder"].size(), 11u);
  EXPECT_EQ(json["msaa_ladder"][9]["samples"], 512);
  EXPECT_EQ(json["msaa_ladder"][10]["rmse"], json["results"][0]["error"]["rmse"]);
  EXPECT_GT(json["results"][1]["equivalent_msaa"], 256.0);
  EXPECT_EQ(json["results"][0]["equivalent_msaa_is_lower_bound"], false);

  succeed({"compare", path("edge.json"), "-t", "msaa:1024", "-o", path("out")});
  EXPECT_EQ(report()["msaa_ladder"].size(), 9u) << "MSAA itself is no reason to extend";
}

TEST_F(ProgramTest, DiffTellsTheError) {
  write_text(folder_ / "a.exr", encode_exr(flat_image(4, 2, 0.75f)));
  write_text(folder_ / "b.exr", encode_exr(flat_image(4, 2, 0.5f)));
  const Json json = Json::parse(succeed({"diff", path("a.exr"), path("b.exr"), "--json"}));
  EXPECT_EQ(json["beampipe_diff"], 1);
  EXPECT_EQ(json["width"], 4);
  EXPECT_EQ(json["height"], 2);
  EXPECT_EQ(json["rmse"], 0.25);
  EXPECT_EQ(json["bias"], 0.25);
  EXPECT_EQ(json["p99"], 0.25);
  EXPECT_EQ(json["max"], 0.25);
  EXPECT_EQ(json["differing_pixels"], 8);
  EXPECT_NE(succeed({"diff", path("a.exr"), path("b.exr")}).find("rmse  0.25"), std::string::npos);
  EXPECT_EQ(Json::parse(succeed({"diff", path("a.exr"), path("a.exr"), "--json"}))["differing_pixels"], 0);
}

TEST_F(ProgramTest, DiffRefusesPicturesOfDifferentSizes) {
  write_text(folder_ / "a.exr", encode_exr(flat_image(4, 2, 0.75f)));
  write_text(folder_ / "b.exr", encode_exr(flat_image(2, 4, 0.75f)));
  expect_one_error_line(run_program({"diff", path("a.exr"), path("b.exr")}), 1, "different sizes: 4 x 2 and 2 x 4");
}

TEST_F(ProgramTest, InfoTellsWhatIsInTheTrace) {
  const Json json = Json::parse(succeed({"info", path("trace.json"), "--json"}));
  ASSERT_EQ(json["frames"].size(), 2u);
  EXPECT_EQ(json["frames"][0]["width"], 20);
  EXPECT_EQ(json["frames"][0]["height"], 12);
  EXPECT_EQ(json["frames"][0]["draws"], 2);
  EXPECT_EQ(json["frames"][0]["triangles"], 2);
  EXPECT_EQ(json["frames"][0]["bounds"]["min"], Json({-1.0, -1.0, -0.5}));
  EXPECT_EQ(json["frames"][0]["bounds"]["max"], Json({1.0, 1.0, 0.0}));
  EXPECT_EQ(json["frames"][1]["triangles"], 1);
  ASSERT_EQ(json["meshes"].size(), 2u);
  EXPECT_EQ(json["meshes"][0]["triangles"], 1);
  EXPECT_NE(succeed({"info", path("trace.json")}).find("20 x 12"), std::string::npos);
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
  expect_one_error_line(run_program({"export-soup", path("trace.json"), "--frame", "9", "-o", path("x.soup")}), 2,
                        "--frame");
}

TEST_F(ProgramTest, MakeListsAndMakesScenes) {
  EXPECT_NE(succeed({"make", "--list"}).find("fence"), std::string::npos);
  succeed({"make", "soup", "--triangles", "200", "--seed", "7", "--width", "32", "--height", "24", "-o",
           path("new/a.json")});
  succeed(
      {"make", "soup", "--triangles", "200", "--seed", "7", "--width", "32", "--height", "24", "-o", path("b.json")});
  succeed(
      {"make", "soup", "--triangles", "200", "--seed", "8", "--width", "32", "--height", "24", "-o", path("c.json")});
  EXPECT_EQ(read_text(folder_ / "new/a.json"), read_text(folder_ / "b.json"));
  EXPECT_NE(read_text(folder_ / "new/a.json"), read_text(folder_ / "c.json"));
  const Json info = Json::parse(succeed({"info", path("b.json"), "--json"}));
  EXPECT_EQ(info["frames"][0]["width"], 32);
  EXPECT_EQ(info["frames"][0]["height"], 24);
  EXPECT_NEAR(info["frames"][0]["triangles"].get<double>(), 200, 50);
}

TEST_F(ProgramTest, MakeFramesAModel) {
  write_text(folder_ / "model.obj", "v 0 0 0\nv 4 0 0\nv 0 3 0\nv 0 0 2\nf 1 2 3\nf 1 3 4\n");
  succeed({"make", path("model.obj"), "-o", path("model.json"), "--width", "24", "--height", "24"});
  const Json trace = Json::parse(read_text(folder_ / "model.json"));
  const Json& frame = trace["frames"][0];
  EXPECT_EQ(frame["draws"][0]["shading"], "lambert");
  EXPECT_EQ(frame["camera"]["target"], Json({2.0, 1.5, 1.0}));
  EXPECT_TRUE(frame.contains("light"));
  succeed({"run", path("model.json"), "-t", "msaa:1", "-o", path("out")});

  succeed({"make", path("model.obj"), "-o", path("model.json"), "--eye", "-1,2,9", "--target", "1,1,1", "--up", "0,0,1",
           "--fovy", "50", "--near", "0.5", "--far", "20", "--background", "0.25,0.5,1", "--unlit"});
  const Json chosen = Json::parse(read_text(folder_ / "model.json"))["frames"][0];
  const Json camera = {{"eye", {-1.0, 2.0, 9.0}},
                       {"target", {1.0, 1.0, 1.0}},
                       {"up", {0.0, 0.0, 1.0}},
                       {"fovy_deg", 50.0},
                       {"near", 0.5},
                       {"far", 20.0}};
  EXPECT_EQ(chosen["camera"], camera);
  EXPECT_EQ(chosen["background"], Json({0.25, 0.5, 1.0}));
}

TEST_F(ProgramTest, EveryInstructionSetGivesTheSamePictures) {
  const std::string help = succeed({"run", "--help"});
  for (const std::string& target : simd_targets()) {
    EXPECT_NE(help.find(target), std::string::npos);
    succeed({"run", path("trace.json"), "-t", "beam", "-o", path(target), "--simd", target});
    EXPECT_EQ(Json::parse(read_text(folder_ / target / "report.json"))["simd"], target);
    for (const char* name : {"beam/frame_0000.exr", "beam/frame_0001_counters.exr"})
      EXPECT_EQ(read_text(folder_ / target / name), read_text(folder_ / simd_targets()[0] / name)) << target;
  }
  succeed({"run", path("trace.json"), "-t", "beam", "-o", path("capitals"), "--simd", "SCALAR"});
}

TEST_F(ProgramTest, EveryMistakeIsOneLineAndLeavesNothing) {
  write_text(folder_ / "broken.json", "{\"beampipe_trace\": 1,");
  write_text(folder_ / "model.obj", "v 0 0 0\nv 4 0 0\nv 0 3 0\nf 1 2 3\n");
  write_text(folder_ / "nested.json", std::string(1 << 20, '['));
  for (const char* report : {"piped", "endless"}) std::filesystem::create_directory(folder_ / report);
  ASSERT_EQ(mkfifo(path("piped/report.json").c_str(), 0666), 0);
  std::filesystem::create_symlink("/dev/zero", folder_ / "endless/report.json");
  const std::string trace = path("trace.json"), out = path("out");
  const struct {
    std::vector<std::string> arguments;
    int exit_code;
    std::string part;
  } mistakes[] = {
      {{}, 2, "subcommand"},
      {{"frobnicate"}, 2, "no command frobnicate"},
      {{"run", trace, "-t", "beam"}, 2, "--output"},
      {{"run", trace, "-o", out}, 2, "--technique"},
      {{"run", trace, "-t", "nonsense", "-o", out}, 2, "nonsense"},
      {{"run", trace, "-t", "beam\nbeam", "-o", out}, 2, "beam beam"},
      {{"run", trace, "-t", "msaa:3", "-o", out}, 2, "msaa:3"},
      {{"run", trace, "-t", "beam", "beam", "-o", out}, 2, "twice"},
      {{"run", "-t", "beam", trace, "-o", out}, 2, "was taken for a technique; write the trace before -t"},
      {{"run", "-t", "beam", "-o", out}, 2, "TRACE is missing"},
      {{"run", "/dev/zero", "-t", "beam", "-o", out}, 1, "expected a regular file"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", path("piped/report.json")}, 1, "expected a regular file"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", "/dev/zero"}, 1, "expected a regular file"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", path("broken.json")}, 1, "expected valid JSON"},
      {{"run", trace, "-t", "beam", "-o", out, "--hardware", path("nested.json")}, 1, "nested.json: byte 33"},
      {{"report", path("piped")}, 1, "piped/report.json: expected a regular file"},
      {{"plot", path("endless"), "-o", path("p.svg")}, 1, "endless/report.json: expected a regular file"},
      {{"claims", path("piped")}, 1, "piped/report.json: expected a regular file"},
      {{"diff", path("piped/report.json"), path("piped/report.json")}, 1, "not a file"},
      {{"run", trace, "-t", "beam", "-o", out, "--simd", "avx9"}, 2, "scalar"},
      {{"run", trace, "-t", "beam", "-o", out, "--frames", "1-2"}, 2, "--frames 1-2"},
      {{"run", trace, "-t", "beam", "-o", out, "--threads", "0"}, 2, "--threads"},
      {{"run", trace, "-t", "beam", "-o", out, "--repeat", "0"}, 2, "--repeat"},
      {{"run", path("missing.json"), "-t", "beam", "-o", out}, 1, "missing.json"},
      {{"run", path("broken.json"), "-t", "beam", "-o", out}, 1, "broken.json"},
      {{"run", trace, "-t", "beam", "-o", path("trace.json")}, 1, "expected a folder"},
      {{"run", trace, "-t", "beam", "-o", path("trace.json/below")}, 1, "expected a folder"},
      {{"run", trace, "-t", "beam", "-o", ""}, 1, "empty"},
      {{"compare", trace, "-t", "beam", "-o", out, "--ladder", "1,3"}, 2, "msaa:3"},
      {{"compare", trace, "-t", "nonsense", "-o", out}, 2, "nonsense"},
      {{"diff", trace, trace}, 1, "trace.json"},
      {{"diff", trace}, 2, "B"},
      {{"info", path("missing.json")}, 1, "missing.json"},
      {{"export-soup", trace, "-o", trace}, 2, "the trace itself"},
      {{"make", "-o", path("a.json")}, 2, "SCENE"},
      {{"make", "fence"}, 2, "-o"},
      {{"make", "no_such_scene", "-o", path("a.json")}, 2, "no_such_scene"},
      {{"make", "fence", "--eye", "1,2,3", "-o", path("a.json")}, 2, "--eye"},
      {{"make", "fence", "--width", "16385", "-o", path("a.json")}, 2, "--width"},
      {{"make", path("missing.obj"), "-o", path("a.json")}, 1, "missing.obj"},
      {{"make", path("model.obj"), "-o", path("./model.obj")}, 2, "the model itself"},
      {{"make", path("model.obj"), "--seed", "2", "-o", path("a.json")}, 2, "--seed"},
      {{"make", path("model.obj"), "--eye", "1,2", "-o", path("a.json")}, 2, "--eye"},
      {{"make", path("model.obj"), "--near", "3", "--far", "2", "-o", path("a.json")}, 2, "near"},
      {{"make", path("model.obj"), "--lambert", "--unlit", "-o", path("a.json")}, 2, "excludes"},
      {{"make", "soup", "-o", path("trace.json/a.json")}, 1, "trace.json"},
  };
  const Names before = folder_.list();
  for (const auto& mistake : mistakes) {
    std::string command;
    for (const std::string& argument : mistake.arguments) command += " " + argument;
    SCOPED_TRACE("beampipe" + command);
    expect_one_error_line(run_program(mistake.arguments), mistake.exit_code, mistake.part);
    EXPECT_EQ(folder_.list(), before);
  }
}

TEST_F(ProgramTest, MeshesOutsideTheTracesFolderNeedPermission) {
  std::filesystem::create_directory(folder_ / "inner");
  write_text(folder_ / "model.obj", "v 0 0 0\nv 4 0 0\nv 0 3 0\nf 1 2 3\n");
  write_text(folder_ / "inner/trace.json",
             R"({"beampipe_trace": 1, "meshes": {"m": {"obj": "../model.obj"}}, "frames": [
      {"width": 8, "height": 8, "background": [0,0,0], "draws": [{"mesh": "m"}],
       "camera": {"eye": [0,0,9], "target": [0,0,0], "up": [0,1,0], "fovy_deg": 36, "near": 1, "far": 20}}]})");
  expect_one_error_line(run_program({"info", path("inner/trace.json")}), 1, "model.obj");
  succeed({"info", path("inner/trace.json"), "--allow-outside"});
  expect_one_error_line(run_program({"run", path("inner/trace.json"), "-t", "msaa:1", "-o", path("out")}), 1,
                        "model.obj");
  succeed({"run", path("inner/trace.json"), "-t", "msaa:1", "-o", path("out"), "--allow-outside"});
}

// While one lives, files that this process and its children write may not have more bytes: stands for a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_;
};

TEST_F(ProgramTest, AFailedWriteIsOneLineAndLeavesEarlierResultsWhole) {
  const std::vector<std::string> run = {"run", path("trace.json"), "-t", "msaa:1", "-o", path("out")};
  Names before = folder_.list();
  {
    const FileSizeLimit limit(200);
    expect_one_error_line(run_program(run), 1, "frame_0000.exr: cannot write");
  }
  EXPECT_EQ(folder_.list(), before);

  succeed(run);
  before = folder_.list();
  const std::string image = read_text(folder_ / "out/msaa_1/frame_0000.exr");
  const std::string report = read_text(folder_ / "out/report.json");
  {
    const FileSizeLimit limit(200);
    expect_one_error_line(run_program(run), 1, "frame_0000.exr: cannot write");
  }
  EXPECT_EQ(folder_.list(), before);
  EXPECT_EQ(read_text(folder_ / "out/msaa_1/frame_0000.exr"), image);
  EXPECT_EQ(read_text(folder_ / "out/report.json"), report);
}

TEST_F(ProgramTest, StressWritesWhatItFoundAndItsTraces) {
  const std::string table =
      succeed({"stress", "-t", "msaa:1", "dvm", "--case", "one_pixel", "--case", "not_finite", "-o", path("stress")});
  EXPECT_NE(table.find("one_pixel    exact  2^-2.0*"), std::string::npos) << table;
  const Json found = Json::parse(read_text(folder_ / "stress/stress.json"));
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0]["case"], "not_finite");
  EXPECT_EQ(found[3]["technique"], "dvm");
  EXPECT_EQ(found[3]["error"], 0.25);
  EXPECT_EQ(found[3]["passes"], true);
  EXPECT_EQ(found[3]["reason"], "its 2x2 quad reaches beyond the frame");
  succeed({"run", path("stress/traces/one_pixel.json"), "-t", "msaa:1", "-o", path("again")});
  expect_one_error_line(run_program({"stress", "--case", "none_such", "-o", path("other")}), 2, "none_such");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other"));
  std::filesystem::create_directory(folder_ / "other");
  write_text(folder_ / "other/traces", "");
  write_text(folder_ / "other/unfinished", "");
  const std::string something_else = ": expected a folder, found something else";
  expect_one_error_line(run_program({"stress", "-t", "msaa:1", "--case", "one_pixel", "-o", path("other")}), 1,
                        path("other/traces") + something_else);
  expect_one_error_line(run_program({"run", path("stress/traces/one_pixel.json"), "-t", "msaa:1", "-o", path("other")}),
                        1, path("other/unfinished") + something_else);
}

void pause(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

// A run that goes on for hours after its first image.
std::vector<std::string> long_run(const std::string& trace, const std::string& out) {
  return {"run", trace, "-t", "msaa:1", "-o", out, "--frames", "0", "--repeat", "1000000", "--threads", "1"};
}

// 200 layers over 12 tiles, with the least memory that one tile can do with.
TEST_F(ProgramTest, MemoryLimitBoundsThePeakAndChangesNothing) {
  succeed({"make", "stack", "--triangles", "200", "--width", "128", "--height", "96", "-o", path("deep.json")});
  const auto run = [&](const std::string& limit, const std::string& out) {
    return run_program({"run", path("deep.json"), "-t", "beam:rules=paper", "--no-memory-model", "--threads", "4",
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
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they take memory of their own
  constexpr std::uint64_t kProgram = 40;                             // MiB, with the trace and the pictures
  EXPECT_LT(banded.peak_bytes >> 20, needed + kProgram);
  EXPECT_GT(whole.peak_bytes >> 20, needed + kProgram) << "or the test shows nothing";
#endif
  for (const char* file : {"frame_0000.exr", "frame_0000_counters.exr"})
    EXPECT_EQ(read_text(folder_ / "banded/beam_rules=paper" / file),
              read_text(folder_ / "whole/beam_rules=paper" / file))
        << file;
}

TEST_F(ProgramTest, CtrlCKeepsFinishedImagesAndLeavesNothingElse) {
  std::filesystem::create_directory(folder_ / "out");
  write_text(folder_ / "out/report.json", "of pictures that will be replaced");
  Program program(long_run(path("trace.json"), path("out")));
  for (int i = 0; i < 3000 && !std::filesystem::exists(folder_ / "out/msaa_1/frame_0000_counters.exr"); ++i) pause(10);
  pause(1500);  // long enough for progress to show, if it did
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "") << "progress is for terminals only";
  EXPECT_EQ(folder_.list(), (Names{"out/", "out/msaa_1/", "out/msaa_1/frame_0000.exr", "out/msaa_1/frame_0000.png",
                                   "out/msaa_1/frame_0000_counters.exr", "trace.json"}));
  EXPECT_EQ(read_exr(folder_ / "out/msaa_1/frame_0000.exr").width, 20u);
}

// Neither a frame nor a file that would take much longer is waited for.
TEST_F(ProgramTest, CtrlCEndsALongFrameAndALongFileAtOnce) {
  Program file({"make", "hairball", "--triangles", "5000000", "-o", path("big.json")});
  pause(1500);
  file.signal(SIGINT);
  EXPECT_EQ(file.wait().exit_code, 130);
  EXPECT_EQ(folder_.list(), Names{"trace.json"});

  succeed({"make", "soup", "--triangles", "2000", "--width", "4096", "--height", "4096", "-o", path("wide.json")});
  Program frame({"run", path("wide.json"), "-t", "reference", "-o", path("out")});
  pause(500);
  frame.signal(SIGINT);
  EXPECT_EQ(frame.wait().exit_code, 130);
  EXPECT_EQ(folder_.list(), (Names{"trace.json", "wide.json"}));
}

TEST_F(ProgramTest, CtrlCLeavesNoSoup) {
  succeed({"make", "hairball", "--triangles", "300000", "-o", path("big.json")});
  const Names before = folder_.list();
  Program program({"export-soup", path("big.json"), "-o", path("big.soup")});
  for (int i = 0; i < 30000 && folder_.list() == before; ++i) pause(1);
  program.signal(SIGTERM);
  if (program.wait().exit_code == 0) return;  // it was faster
  EXPECT_EQ(folder_.list(), before);
}

TEST_F(ProgramTest, OneProgramAtATimeWritesIntoAFolder) {
  Program program(long_run(path("trace.json"), path("out")));
  for (int i = 0; i < 3000 && !std::filesystem::exists(folder_ / "out/msaa_1/frame_0000_counters.exr"); ++i) pause(10);
  const Names before = folder_.list();
  const std::vector<Names> others = {{"run", path("trace.json"), "-t", "beam", "-o", path("out")},
                                     {"run", path("trace.json"), "-t", "beam", "-o", path("out"), "--resume"},
                                     {"compare", path("trace.json"), "-t", "beam", "-o", path("out")}};
  for (const Names& other : others) {
    expect_one_error_line(run_program(other), 1, path("out") + ": is being written by another program");
    EXPECT_EQ(folder_.list(), before);
  }
  program.signal(SIGKILL);
  program.wait();
  succeed(others[0]);
}

TEST_F(ProgramTest, ReportKeepsOutOfAFolderInUse) {
  succeed({"compare", path("trace.json"), "-t", "msaa:1", "--ladder", "1", "-o", path("out")});
  InterruptGate gate;
  OutputFolder writer(path("out"), gate);
  writer.lock();
  expect_one_error_line(run_program({"report", path("out")}), 1, "is being written by another program");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/report.html"));
}

TEST_F(ProgramTest, AFolderInTheReportsPlaceIsRefusedAtOnce) {
  std::filesystem::create_directories(folder_ / "out/report.json");
  const Names before = folder_.list();
  expect_one_error_line(run_program({"run", path("trace.json"), "-t", "msaa:1", "-o", path("out")}), 1,
                        "out/report.json: expected a regular file or none, found something else");
  EXPECT_EQ(folder_.list(), before);
}

TEST_F(ProgramTest, ATerminalShowsProgressAfterASecond) {
  int terminal = -1, program_side = -1;
  if (openpty(&terminal, &program_side, nullptr, nullptr, nullptr) != 0)
    GTEST_SKIP() << "there is no pseudo-terminal on this machine: " << std::strerror(errno);
  fcntl(terminal, F_SETFL, O_NONBLOCK);
  const auto start = std::chrono::steady_clock::now();
  Program program(long_run(path("trace.json"), path("out")), program_side);
  std::string shown;
  for (int i = 0; i < 3000 && shown.find("msaa:1") == std::string::npos; ++i) {
    char bytes[256];
    const ssize_t count = read(terminal, bytes, sizeof bytes);
    if (count > 0) shown.append(bytes, static_cast<std::size_t>(count));
    pause(10);
  }
  EXPECT_NE(shown.find("msaa:1"), std::string::npos);
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 130);
  close(terminal);
  close(program_side);
}

}  // namespace
}  // namespace beampipe
