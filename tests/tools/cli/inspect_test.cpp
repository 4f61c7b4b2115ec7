// beampipe inspect, as a user runs it.

#include <nlohmann/json.hpp>

#include "tests/tools/cli/program_fixture.h"
#include "tests/tools/varying_trace.h"
#include "tools/evaluate/metrics.h"
#include "tools/evaluate/results.h"
#include "tools/files/image_io.h"

namespace beampipe::inspect_test {

using Parsed = nlohmann::json;  // independent of the program's own Json

const Names kSpecs = {"beam",
                      "beam:order=stream",
                      "beam:order=sorted",
                      "casav",
                      "casav:order=stream",
                      "alpha",
                      "z3",
                      "msaa:4",
                      "msaa:8,prepass",
                      "acaa:8",
                      "visibility:4",
                      "deferred"};

class InspectTest : public ProgramTest {
 protected:
  // The inspections of the pixels as JSON.
  Parsed inspected(const Names& pixels, const std::string& frame = "0", const std::string& threads = "2") {
    const Names arguments = {"inspect", path("trace.json"), "--json", "--frame",
                             frame,     "--threads",        threads,  "--pixel"};
    return Parsed::parse(succeed(joined(joined(arguments, pixels), joined({"-t"}, specs_))))["pixels"];
  }

  // Expects that weights times colours, as the JSON says them, are the pixels of the pictures that `run` writes.
  void expect_pictures(const Parsed& pixels, const std::string& frame) {
    succeed(joined({"run", path("trace.json"), "--frames", frame, "-o", path("out"), "-t"}, specs_));
    for (const Parsed& pixel : pixels) {
      const Image image = read_exr(folder_ / "out" / spec_folder(pixel["technique"].get<std::string>()) /
                                   ("frame_000" + frame + ".exr"));
      const std::size_t at = 4 * (pixel["y"].get<std::size_t>() * image.width + pixel["x"].get<std::size_t>());
      SCOPED_TRACE(pixel["technique"].get<std::string>() + " at " + pixel["x"].dump() + "," + pixel["y"].dump());
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (const Parsed& term : pixel["terms"]) sum += term["weight"].get<double>() * term["color"][c].get<double>();
        sum += pixel["rest"][c].get<double>();
        EXPECT_EQ(static_cast<float>(sum), pixel["stored"][c].get<float>()) << "channel " << c;
        EXPECT_EQ(pixel["color"][c].get<float>(), image.rgba[at + c]);
        const double stored = pixel["stored"][c];
        const double linear = stored <= 0.04045 ? stored / 12.92 : std::pow((stored + 0.055) / 1.055, 2.4);
        EXPECT_NEAR(pixel["color"][c].get<double>(), is_encoded_ ? linear : stored, 1e-7);
      }
      EXPECT_EQ(pixel["color"][3].get<float>(), image.rgba[at + 3]) << "alpha";
      if (!is_by_depth_) continue;  // the reference's weights are not known
      double weight = 0, truth = 0;
      for (const Parsed& surface : pixel["surfaces"])
        weight += surface["weight"].get<double>(), truth += surface["reference_weight"].get<double>();
      EXPECT_NEAR(weight, 1, 1e-5);
      EXPECT_NEAR(truth, 1, 1e-9);
      double causes = 0;
      for (const Parsed& cause : pixel["causes"]) causes += cause.get<double>();
      EXPECT_NEAR(causes, pixel.value("visibility_error", pixel["error"].get<double>()), 1e-6);
    }
  }

  // Changes each frame of the trace.
  void change_frames(const std::function<void(Parsed&)>& change) {
    Parsed trace = Parsed::parse(read_text(folder_ / "trace.json"));
    trace["beampipe_trace"] = 2;
    for (Parsed& frame : trace["frames"]) change(frame);
    write_text(folder_ / "trace.json", trace.dump());
  }

  Names specs_ = kSpecs;
  bool is_encoded_ = false, is_by_depth_ = true;
};

void expect_readable(const std::string& text) {
  for (std::size_t start = 0, end; start < text.size(); start = end + 1) {
    end = text.find('\n', start);
    ASSERT_NE(end, text.npos);
    EXPECT_LE(end - start, 120u) << text.substr(start, end - start);
  }
  EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); }))
      << "not all ASCII, although no terminal shows it";
}

TEST_F(InspectTest, TextTellsWhoOwnsThePixel) {
  const std::string text = succeed({"inspect", path("trace.json"), "--pixel", "10,9", "-t", "beam", "msaa:4"});
  expect_readable(text);
  for (const char* part : {"pixel 10,9 of ", "with beam\n", "with msaa:4\n", "1 'green'", "owners",
                           "picture, to the bit", "Weights", "reference"})
    EXPECT_NE(text.find(part), text.npos) << part << " is missing in\n" << text;
}

TEST_F(InspectTest, WeightsTimesColoursAreThePicture) {
  expect_pictures(inspected({"10,9", "3,3", "12,8", "0,0"}), "0");
}

TEST_F(InspectTest, WeightsTimesStoredColoursAreTheStoredPicture) {
  change_frames([](Parsed& frame) { frame["target"] = "unorm"; });
  is_encoded_ = true;
  const Parsed pixels = inspected({"10,9", "3,3", "12,8", "0,0"});
  expect_pictures(pixels, "0");
  for (const Parsed& pixel : pixels)
    EXPECT_LE(std::abs(pixel["causes"].value("rounding", 0.0)), 0.1 * double(pixel["error"]) + 1e-3);
}

// The green triangle is added to what is there, wherever that is.
TEST_F(InspectTest, InTheApisOrderWeightsAreWhatDrawsHavePutIntoThePixel) {
  change_frames([](Parsed& frame) {
    for (Parsed& draw : frame["draws"])
      if (draw["mesh"] == "green")
        draw["state"] = {{"depth_test", false}, {"blend", {{"source", "one"}, {"destination", "one"}}}};
  });
  is_by_depth_ = false;
  specs_ = {"beam", "msaa:4"};
  const Parsed pixels = inspected({"10,7", "5,4"});
  expect_pictures(pixels, "0");
  for (const Parsed& surface : pixels[0]["surfaces"]) EXPECT_FALSE(surface.contains("reference_weight"));
  EXPECT_EQ(pixels[0]["surfaces"].size(), pixels[0]["fragments"].size() + 1) << "the background, too";
  const std::string text = succeed({"inspect", path("trace.json"), "--pixel", "10,7", "-t", "msaa:4"});
  expect_parts(text, {"blended"});
  EXPECT_EQ(text.find("causes"), text.npos) << "they are not known\n" << text;
  EXPECT_NE(text.find("Samples: what each fragment covers\n"), text.npos) << "nobody owns them\n" << text;
}

TEST_F(InspectTest, WeightsTimesColoursAreThePictureOfTranslucentSheets) {
  write_varying_trace(folder_, {R"({"mesh": "wall"}, {"mesh": "flat"}, {"mesh": "sheets"})"});
  const Parsed pixels = inspected({"16,9", "20,8", "12,6", "9,12"});
  expect_pictures(pixels, "0");
  for (const Parsed& pixel : pixels) EXPECT_TRUE(pixel.contains("visibility_error"));
}

TEST_F(InspectTest, CutoutsSayWhatAlphaLeavesOut) {
  succeed({"make", "leaves", "--triangles", "1000", "--width", "16", "--height", "10", "-o", path("trace.json")});
  Parsed pixels = inspected({"8,5", "5,6", "10,3", "7,7", "3,8"});
  expect_pictures(pixels, "0");
  int cut_out = 0;
  for (const Parsed& pixel : pixels)
    for (const Parsed& fragment : pixel["fragments"]) cut_out += fragment["fate"] == "below alpha cutoff";
  EXPECT_GT(cut_out, 0);
}

TEST_F(InspectTest, ThePixelOfTheBackgroundIsTheBackground) {
  for (const Parsed& pixel : inspected({"7,0"}, "1")) {
    EXPECT_TRUE(pixel["fragments"].empty()) << pixel["technique"];
    EXPECT_EQ(pixel["error"], 0);
    ASSERT_EQ(pixel["terms"].size(), 1u);
    EXPECT_EQ(pixel["terms"][0]["fragment"], nullptr);
    EXPECT_EQ(pixel["terms"][0]["weight"], 1);
    EXPECT_EQ(pixel["rest"], (Parsed{0.0, 0.0, 0.0}));
  }
  const std::string text = succeed({"inspect", path("trace.json"), "--frame", "1", "--pixel", "7,0", "-t", "beam"});
  expect_readable(text);
  expect_parts(text, {"0 triangles touch it"});
}

// Of two triangles that fill the pixel, the technique and the reference see the nearer one, and the other one says who
// hides it.
TEST_F(InspectTest, AHiddenTriangleSaysWhoHidesIt) {
  write_text(folder_ / "trace.json", R"({"beampipe_trace": 1,
    "meshes": {"near": {"positions": [-9,-9,-0.5, 9,-9,-0.5, 0,9,-0.5], "indices": [0,1,2], "colors": [1,0,0]},
               "far": {"positions": [-9,-9,0.5, 9,-9,0.5, 0,9,0.5], "indices": [0,1,2], "colors": [0,1,0]}},
    "frames": [{"width": 4, "height": 4, "background": [0,0,1], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
                "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "far"}, {"mesh": "near"}]}]})");
  for (const Parsed& pixel : inspected({"1,1"})) {
    SCOPED_TRACE(pixel["technique"].get<std::string>());
    ASSERT_EQ(pixel["fragments"].size(), 2u);
    const std::size_t near = pixel["fragments"][0]["draw"] == 1 ? 0 : 1;
    EXPECT_EQ(pixel["fragments"][near]["draw_name"], "1 'near'");
    for (const Parsed& surface : pixel["surfaces"]) EXPECT_EQ(surface["weight"], surface["fragment"] == near ? 1 : 0);
    if (pixel["technique"] == "alpha" || pixel["technique"].get<std::string>().starts_with("casav")) continue;
    for (const Parsed& owner : pixel["owners"]) EXPECT_EQ(owner, near);
    const Parsed& far = pixel["fragments"][1 - near];
    ASSERT_EQ(far["lost"].size(), 1u);
    EXPECT_EQ(far["lost"][0]["fragment"], near);
    EXPECT_EQ(far["lost"][0]["positions"], pixel["positions"].size());
  }
}

TEST_F(InspectTest, TheWorstPixelsAreThoseFarthestFromTheReference) {
  succeed({"compare", path("trace.json"), "-t", "msaa:1", "--frames", "0", "-o", path("out"), "--ladder", "1"});
  const std::vector<float> errors =
      pixel_errors(read_exr(folder_ / "out/msaa_1/frame_0000.exr"), read_exr(folder_ / "out/reference/frame_0000.exr"));
  const Parsed worst =
      Parsed::parse(succeed({"inspect", path("trace.json"), "--worst", "3", "-t", "msaa:1", "--json"}))["pixels"];
  ASSERT_EQ(worst.size(), 3u);
  std::vector<float> sorted = errors;
  std::sort(sorted.rbegin(), sorted.rend());
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t at = worst[i]["y"].get<std::size_t>() * 20 + worst[i]["x"].get<std::size_t>();
    EXPECT_EQ(errors[at], sorted[i]);
    EXPECT_NEAR(worst[i]["error"].get<double>(), errors[at], 1e-7);
  }
}

TEST_F(InspectTest, ResultsDoNotDependOnThreads) {
  EXPECT_EQ(inspected({"10,9", "4,8"}, "0", "1"), inspected({"10,9", "4,8"}, "0", "7"));
}

TEST_F(InspectTest, WritesAPictureAndAPage) {
  const auto with = [&](const std::string& file) {
    succeed({"inspect", path("trace.json"), "--pixel", "10,9", "3,3", "-t", "beam", "z3", "-o", path(file)});
    return read_text(folder_ / file);
  };
  const std::string svg = with("pixel.svg"), page = with("pixel.html");
  EXPECT_EQ(count_of(svg, "class=\"title\""), 4u) << "a panel for each pixel and technique";
  EXPECT_EQ(count_of(svg, "<circle"), 2u * 256 + 2u * 32) << "every position is drawn";
  EXPECT_EQ(count_of(svg, "<text"), count_of(svg, "</text>"));
  EXPECT_EQ(count_of(svg, "<svg"), 1u);
  EXPECT_EQ(count_of(page, "<svg"), 4u);
  EXPECT_EQ(count_of(page, "<pre>"), 4u);
  EXPECT_EQ(count_of(page, "src="), 0u) << "the page opens offline";
  EXPECT_EQ(folder_.list(), (Names{"pixel.html", "pixel.svg", "trace.json"}));
}

TEST_F(InspectTest, MistakesAreOneLineAndLeaveNothing) {
  const std::tuple<Names, int, const char*> mistakes[] = {
      {{"-t", "beam"}, 2, "expected either --pixel X,Y or --worst N"},
      {{"-t", "beam", "--pixel", "1,1", "--worst", "1"}, 2, "expected either --pixel X,Y or --worst N"},
      {{"--pixel", "1,1"}, 2, "--technique"},
      {{"-t", "beam", "--pixel", "20,0"}, 2, "X from 0 to 19 and Y from 0 to 11"},
      {{"-t", "beam", "--pixel", "0,12"}, 2, "--pixel 0,12"},
      {{"-t", "beam", "--pixel", "3"}, 2, "--pixel 3: expected X,Y"},
      {{"-t", "beam", "--pixel", "3,4,5"}, 2, "expected X,Y"},
      {{"-t", "beam", "--pixel", "3;4"}, 2, "expected X,Y"},
      {{"-t", "beam", "--pixel", "-1,4"}, 2, ""},
      {{"-t", "baem", "--pixel", "3,4"}, 2, "did you mean 'beam'?"},
      {{"-t", "taa:8", "--pixel", "3,4"}, 2, "'taa:8' cannot be inspected: expected beam"},
      {{"-t", "reference", "--pixel", "3,4"}, 2, "cannot be inspected"},
      {{"-t", "dvm", "--pixel", "3,4"}, 2, "; its pixels depend on earlier frames and on their"},
      {{"-t", "beam", "--pixel", "3,4", "--frame", "2"}, 2, "--frame: expected 0 to 1, found 2"},
      {{"-t", "beam", "--worst", "0"}, 2, "--worst"},
      {{"-t", "beam", "--pixel", "3,4", "-o", path("a.png")}, 2, ".svg or .html"},
      {{"-t", "beam", "--pixel", "3,4", "-o", path("trace.json/a.svg")}, 1, "trace.json"},
  };
  for (const auto& [options, exit_code, part] : mistakes) {
    SCOPED_TRACE(part);
    expect_error(joined({"inspect", path("trace.json")}, options), exit_code, part);
  }
  expect_error({"inspect", path("missing.json"), "-t", "beam", "--pixel", "3,4"}, 1, "missing.json");
  expect_error({"inspct", path("trace.json")}, 2, "did you mean 'inspect'?");
  EXPECT_EQ(folder_.list(), Names{"trace.json"});
}

}  // namespace beampipe::inspect_test
