// Where the camera stands, and in which size: `make`, `preview`, --camera, --width and --height, with the built
// program.

#include <nlohmann/json.hpp>

#include "tests/tools/cli/program_fixture.h"
#include "tools/files/image_io.h"
#include "traces/files/image_file.h"

namespace beampipe::view_test {

using Parsed = nlohmann::json;

// A box of 4 x 3 x 5 whose faces face inwards.
constexpr const char* kRoom = R"(v 0 0 0
v 4 0 0
v 4 3 0
v 0 3 0
v 0 0 5
v 4 0 5
v 4 3 5
v 0 3 5
f 1 2 3 4
f 6 5 8 7
f 5 1 4 8
f 2 6 7 3
f 5 6 2 1
f 4 3 7 8
)";
constexpr const char* kTriangle = "v 0 0 0\nv 4 0 0\nv 0 3 0\nf 1 2 3\n";

class ViewTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    write_text(folder_ / "room.obj", kRoom);
    write_text(folder_ / "model.obj", kTriangle);
    write_text(folder_ / "camera.json", R"({"eye": [1, 2, 9], "target": [1, 1, 0], "fovy_deg": 50})");
  }
  Parsed frame_of(const std::string& trace) const {
    return Parsed::parse(read_text(folder_ / trace)).at("frames").at(0);
  }
  // The text of this model's trace with the camera that was told.
  std::string made_again(const std::string& told, const std::string& model) const {
    std::istringstream words(told.substr(told.find("camera: ") + 8));
    Names again = {"make", path(model), "-o", path("again.json")};
    for (std::string word; words >> word;) again.push_back(word);
    succeed(again);
    return read_text(folder_ / "again.json");
  }
  Image picture(const std::string& folder) const { return read_exr(folder_ / folder / "msaa_4/frame_0000.exr"); }
};

std::pair<int, int> size_of_png(const std::string& bytes) {
  const TextureImage image = decode_image(bytes);
  return {image.width, image.height};
}

TEST_F(ViewTest, MakeStandsInsideOfARoomAndSaysSo) {
  const Outcome made = run_program({"make", path("room.obj"), "-o", path("room.json")});
  EXPECT_EQ(made.exit_code, 0);
  EXPECT_EQ(made.err, "beampipe: note: " + path("room.obj") +
                          ": its faces show their backs outside, as the walls of a room do, so the camera stands "
                          "inside, with --ambient 0.35; move it with --eye and --target, or with --view outside\n");
  const Parsed frame = frame_of("room.json");
  const std::vector<double> eye = frame["camera"]["eye"];
  EXPECT_TRUE(eye[0] > 0 && eye[0] < 4 && eye[1] > 0 && eye[1] < 3 && eye[2] > 0 && eye[2] < 5);
  EXPECT_TRUE(frame.contains("ambient"));
  succeed({"run", path("room.json"), "-t", "msaa:4", "-o", path("out")});
  const Image image = picture("out");
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) ASSERT_EQ(image.rgba[i], 1.0f) << "a wall everywhere";

  const std::string outside = succeed({"make", path("room.obj"), "--view", "outside", "-o", path("room.json")});
  EXPECT_GT(frame_of("room.json")["camera"]["eye"][2], 5.0);
  made_again(outside, "room.obj");
  for (const char* const key : {"eye", "target", "up", "fovy_deg"})
    EXPECT_EQ(frame_of("again.json")["camera"][key], frame_of("room.json")["camera"][key]) << key;
}

TEST_F(ViewTest, MakePrintsTheCameraThatItWasGiven) {
  const std::string told = succeed({"make", path("model.obj"), "--eye", "0.1234567891,2,9", "--up", "0.5,2,0", "--near",
                                    "0.25", "--far", "70", "-o", path("model.json")});
  expect_parts(told, {"camera: --eye 0.1234567891,2,9 --target ", " --up 0.5,2,0 --fovy 36 --near 0.25 --far 70\n"});
  EXPECT_EQ(made_again(told, "model.obj"), read_text(folder_ / "model.json"));
  write_text(folder_ / "planes.json", R"({"eye": [1, 2, 9], "target": [1, 1, 0], "near": 0.25, "far": 70})");
  const std::string from_file =
      succeed({"make", path("model.obj"), "--camera", path("planes.json"), "-o", path("model.json")});
  expect_parts(from_file, {"camera: --eye 1,2,9 --target 1,1,0 --fovy 36 --near 0.25 --far 70\n"});
}

TEST_F(ViewTest, MakeTakesACameraFromAFile) {
  succeed({"make", path("model.obj"), "--camera", path("camera.json"), "--fovy", "40", "-o", path("model.json")});
  const Parsed camera = frame_of("model.json")["camera"];
  EXPECT_EQ(camera["eye"], Parsed({1.0, 2.0, 9.0}));
  EXPECT_EQ(camera["target"], Parsed({1.0, 1.0, 0.0}));
  EXPECT_EQ(camera["up"], Parsed({0.0, 1.0, 0.0}));
  EXPECT_EQ(camera["fovy_deg"], 40.0) << "options win over the file";
  EXPECT_GT(camera["far"].get<double>(), 9.0);
}

TEST_F(ViewTest, AnEyeInsideIsToldOfAmbientLight) {
  const Names inside = {"make", path("room.obj"), "--eye", "1,1,1", "--target", "3,1,4", "-o", path("room.json")};
  expect_parts(finish(inside).err, {"--ambient 0.35 lights them, as with --view inside"});
  EXPECT_FALSE(frame_of("room.json").contains("ambient"));
  succeed(joined(inside, {"--ambient", "0"}));
  succeed({"make", path("room.obj"), "--eye", "1,1,9", "--target", "3,1,4", "-o", path("room.json")});
}

TEST_F(ViewTest, MakeTakesLight) {
  succeed({"make", path("model.obj"), "--light", "0,0,-2", "--ambient", "0.5", "-o", path("model.json")});
  const Parsed frame = frame_of("model.json");
  EXPECT_EQ(frame["lights"][0]["direction"], Parsed({0.0, 0.0, -1.0}));
  EXPECT_EQ(frame["ambient"]["sky"], Parsed({0.5, 0.5, 0.5}));
  succeed({"run", path("model.json"), "-t", "msaa:4", "-o", path("out")});
  const Image image = picture("out");  // the triangle faces the light and is upright
  const float color = image.rgba[4 * (std::size_t{90} * image.width + 150)];
  EXPECT_NEAR(color, 0.8 * 0.5 * (1 + 0.5 + 0.5 * 0.15 / 0.35), 2e-3);
}

TEST_F(ViewTest, RunAndCompareTakeASizeAndACamera) {
  const auto make = [this](const std::string& trace, const Names& options) {
    succeed(joined({"make", path("model.obj"), "--light", "0,0,-1", "-o", path(trace)}, options));
  };
  make("small.json", {"--width", "32", "--height", "16"});
  make("large.json", {"--width", "64", "--height", "40"});
  make("moved.json", {"--width", "32", "--height", "16", "--camera", path("camera.json")});
  const auto run = [this](const std::string& trace, const Names& options) {
    succeed(joined({"run", path(trace), "-t", "msaa:4", "-o", path("out"), "--force"}, options));
    return picture("out");
  };
  // The camera of the large trace is at another distance, so that it is given here.
  const Names camera = {"--camera", path("camera.json")};
  const Names resized = joined(camera, {"--width", "64", "--height", "40"});
  EXPECT_EQ(run("small.json", resized).rgba, run("large.json", camera).rgba);
  EXPECT_EQ(run("small.json", camera).rgba, run("moved.json", {}).rgba);
  EXPECT_NE(run("small.json", camera).rgba, run("small.json", {}).rgba);
  const Image tall = run("small.json", {"--height", "24"});
  EXPECT_EQ(tall.width, 48u) << "in proportion";
  EXPECT_EQ(tall.height, 24u);

  succeed({"compare", path("small.json"), "-t", "msaa:4", "--ladder", "1", "-o", path("compared"), "--width", "48"});
  EXPECT_EQ(picture("compared").width, 48u);
  EXPECT_EQ(picture("compared").height, 24u);
  const std::string told =
      succeed({"inspect", path("small.json"), "--pixel", "40,20", "-t", "msaa:4", "--width", "48"});
  expect_parts(told, {"40,20"});
}

TEST_F(ViewTest, ResultsOfAnotherSizeAreThoseOfAnotherTrace) {
  succeed({"make", path("model.obj"), "--width", "32", "--height", "16", "-o", path("small.json")});
  const Names run = {"run", path("small.json"), "-t", "msaa:4", "-o", path("out"), "--width", "48"};
  const auto with = [&run](const Names& options) { return joined(run, options); };
  succeed(run);
  expect_parts(succeed(with({"--resume"})), {"already finished"});
  expect_error(with({"--height", "20"}), 1, "found those of another trace; --force writes over them");
  expect_error(with({"--height", "20", "--resume"}), 1, "another trace");
  expect_error(with({"--camera", path("camera.json")}), 1, "another trace");
  EXPECT_EQ(picture("out").height, 24u);
  succeed(with({"--height", "20", "--force"}));
  EXPECT_EQ(picture("out").height, 20u);
}

TEST_F(ViewTest, FramesWithoutACameraRefuse) {
  const auto with = [this](const Names& options) {
    return joined({"run", path("trace.json"), "-t", "msaa:4", "-o", path("out")}, options);
  };
  expect_error(with({"--width", "33", "--height", "100"}), 1,
               "trace.json: cannot be 33 x 100 pixels: expected frames that name a camera");
  expect_error(with({"--width", "41", "--height", "24"}), 1, "trace.json: cannot be 41 x 24 pixels");
  expect_error(with({"--camera", path("camera.json")}), 1,
               "frame 0 cannot have another camera: expected a frame that names one, found matrices");
  write_text(folder_ / "odd.json", R"({"eye": [1, 2, 9], "traget": [1, 1, 0]})");
  expect_error(with({"--camera", path("odd.json")}), 1, "did you mean 'target'");
  write_text(folder_ / "odd.json", R"({"eye": [1, 2, 9]})");
  expect_error(with({"--camera", path("odd.json")}), 1, "odd.json: /: expected the key \"target\"");
  write_text(folder_ / "odd.json", R"({"eye": [1, 2, 9], "target": [1, 2, 9]})");
  expect_error({"make", path("model.obj"), "--camera", path("odd.json"), "-o", path("x.json")}, 2,
               "--eye and --target are the same point");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(ViewTest, PreviewShowsModelsAndTraces) {
  const std::string told = succeed({"preview", path("model.obj"), "-o", path("model.png")});
  expect_parts(told, {"480 x 270 pixels\ncamera: --eye "});
  EXPECT_EQ(size_of_png(read_text(folder_ / "model.png")), std::pair(480, 270));
  succeed({"make", path("model.obj"), "--width", "1920", "--height", "1080", "-o", path("model.json")});
  succeed({"preview", path("model.json"), "-o", path("trace.png")});
  EXPECT_EQ(read_text(folder_ / "trace.png"), read_text(folder_ / "model.png")) << "the same view";
  succeed({"preview", path("model.json"), "--height", "54", "-o", path("trace.png")});
  EXPECT_EQ(size_of_png(read_text(folder_ / "trace.png")), std::pair(96, 54));
  succeed({"preview", path("trace.json"), "--frame", "1", "-o", path("trace.png")});
  EXPECT_EQ(size_of_png(read_text(folder_ / "trace.png")), std::pair(8, 16)) << "it has matrices";
}

}  // namespace beampipe::view_test
