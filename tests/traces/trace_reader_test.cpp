#include <sys/stat.h>

#include "tests/traces/broken_values.h"
#include "tests/traces/difference.h"
#include "tests/traces/test_folder.h"
#include "traces/files/model_import.h"

namespace beampipe::trace_reader_test {

using Json = nlohmann::ordered_json;

const char kValid[] = R"({ "beampipe_trace": 1,
  "meshes": { "b": {"positions": [0,0,0, 1,0,0, 0,1,0, 0,0,1], "indices": [0,1,2, 3,2,1], "colors": [1,0,0, 0,0.5,0]},
              "a": {"positions": [0,0,0], "indices": []} },
  "frames": [ { "width": 320, "height": 180, "background": [0.1,0.2,0.3],
                "camera": {"eye": [1,2,3], "target": [0,0,0], "up": [0,1,0], "fovy_deg": 36, "near": 1, "far": 200},
                "light": {"direction": [0,0,-2]},
                "draws": [ {"mesh": "b", "transform": [2,0,0,0, 0,2,0,0, 0,0,2,0, 5,6,7,1], "kd": [0.5,0.6,0.7],
                            "cull": "front", "shading": "lambert"},
                           {"mesh": "a"} ] },
              { "width": 1, "height": 16384, "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 9,8,7,1],
                "projection": [1,0,0,0, 0,1,0,0, 0,0,-1,-1, 0,0,-2,0], "draws": [] } ] })";

class TraceReaderTest : public FolderTest {
 protected:
  Trace read_text(const std::string& text) const { return read_trace(write("scene.json", text)); }
  std::string error_in(const std::string& text) const {
    return error_of([&] { read_text(text); });
  }
  std::string error_without(const std::string& parent, const std::string& key) const {
    Json json = Json::parse(kValid);
    json.at(Json::json_pointer(parent)).erase(key);
    return error_in(json.dump());
  }
};

TEST_F(TraceReaderTest, ReadsEveryField) {
  Trace expected;
  expected.meshes.resize(2);  // in the order of the file
  Mesh& mesh = expected.meshes[0];
  mesh.name = "b", expected.meshes[1].name = "a";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, expected.meshes[1].positions = {{0, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 2, 1}};
  mesh.colors = {{1, 0, 0}, {0, 0.5f, 0}};
  expected.frames.resize(2);
  Frame &first = expected.frames[0], &second = expected.frames[1];
  first.width = 320, first.height = 180, first.background = {0.1f, 0.2f, 0.3f};
  set_camera(first, {.eye = {1, 2, 3}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 36, .near = 1, .far = 200});
  first.lighting.lights = {{glm::vec3(0, 0, -1)}};
  const glm::dmat4 moved{{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}, {5, 6, 7, 1}};
  first.draws = {{0, moved, glm::vec3(0.5f, 0.6f, 0.7f), Cull::front, Shading::lambert},
                 {1, glm::dmat4(1.0), {}, Cull::none, Shading::unlit}};
  second.width = 1, second.height = 16384, second.background = glm::vec3(0.0f);
  second.view[3] = {9, 8, 7, 1};
  second.projection = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -1, -1}, {0, 0, -2, 0}};
  EXPECT_EQ(difference(read_text(kValid), expected), "");
}

TEST_F(TraceReaderTest, CameraPutsTheTargetInTheMiddleAndUpUp) {
  const Frame frame = read_text(kValid).frames[0];
  const auto project = [&](const glm::dvec3& p) {
    const glm::dvec4 clip = frame.projection * frame.view * glm::dvec4(p, 1);
    return glm::dvec3(clip) / clip.w;
  };
  const glm::dvec3 eye(1, 2, 3), forward = -glm::normalize(eye);
  EXPECT_NEAR(project({0, 0, 0}).x, 0, 1e-12);
  EXPECT_NEAR(project({0, 0, 0}).y, 0, 1e-12);
  EXPECT_GT(project({0, 0.1, 0}).y, 0);
  EXPECT_NEAR(project(eye + 1.0 * forward).z, -1, 1e-9);
  EXPECT_NEAR(project(eye + 200.0 * forward).z, 1, 1e-9);
  // The upper edge is 18 degrees above the middle, and the picture is 16:9.
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0))), up = glm::cross(right, forward);
  const double tangent = std::tan(18 * 3.14159265358979 / 180);
  EXPECT_NEAR(project(eye + forward + tangent * up).y, 1, 1e-9);
  EXPECT_NEAR(project(eye + forward + tangent * 16 / 9 * right).x, 1, 1e-9);
}

TEST_F(TraceReaderTest, SaysWhereAndWhatIsWrong) {
  expect_errors(
      Json::parse(kValid), [&](const Json& json) { return error_in(json.dump()); },
      {
          {"/beampipe_trace", "3", "expected version 1 or 2, found 3"},
          {"/beampipe_trace", "1.5", "expected version 1 or 2, found 1.5"},
          {"/beampipe_trace", "\"1\"", "expected a number, found \"1\""},
          {"/meshes", "[]", "expected an object, found an array of 0"},
          {"/meshes/b", "{}", "expected the key \"obj\", or \"positions\" and \"indices\", found none"},
          {"/meshes/b/positions", "[1,2]", "expected an array of numbers, three for each item, found an array of 2"},
          {"/meshes/b/positions/4", "\"x\"", "expected a number in a float's range, found \"x\""},
          {"/meshes/b/positions/4", "1e39", "expected a number in a float's range, found 1e+39"},
          {"/meshes/b/positions/4", "null", "expected a number in a float's range, found null"},
          {"/meshes/b/indices/5", "4", "expected an integer below the number of positions, 4, found 4"},
          {"/meshes/b/indices/5", "-1", "expected an integer below the number of positions, 4, found -1"},
          {"/meshes/b/indices/5", "1.5", "expected an integer below the number of positions, 4, found 1.5"},
          {"/meshes/b/indices", "[0,1]", "expected an array of numbers, three for each item, found an array of 2"},
          {"/meshes/b/colors", "[1,1,1]",
           "expected an array of 6 numbers, r, g, b for each triangle, found an array of 3"},
          {"/meshes/b/colors/1", "-0.5", "expected a number from 0 to 65504, found -0.5"},
          {"/frames", "{}", "expected an array, found an object"},
          {"/frames", "[]", "expected at least one frame, found none"},
          {"/frames/0", "[]", "expected an object, found an array of 0"},
          {"/frames/0/width", "-3", "expected an integer 1..16384, found -3"},
          {"/frames/0/width", "0", "expected an integer 1..16384, found 0"},
          {"/frames/0/width", "320.5", "expected an integer 1..16384, found 320.5"},
          {"/frames/1/height", "16385", "expected an integer 1..16384, found 16385"},
          {"/frames/0/background", "[0,0]", "expected an array of 3 numbers, found an array of 2"},
          {"/frames/0/background/2", "-1", "expected a number from 0 to 65504, found -1"},
          {"/frames/0/camera/eye", "[1,2]", "expected an array of 3 numbers, found an array of 2"},
          {"/frames/0/camera/eye/1", "\"2\"", "expected a number, found \"2\""},
          {"/frames/0/camera/eye", "[0,0,0]",
           "/frames/0/camera/target: expected a point other than the eye, found the same point"},
          {"/frames/0/camera/up", "[-2,-4,-6]",
           "expected a vector not parallel to the view direction, found one that is zero or parallel"},
          {"/frames/0/camera/up", "[0,0,0]",
           "expected a vector not parallel to the view direction, found one that is zero or parallel"},
          {"/frames/0/camera/fovy_deg", "0", "expected a number above 0 and below 180, found 0"},
          {"/frames/0/camera/fovy_deg", "180", "expected a number above 0 and below 180, found 180"},
          {"/frames/0/camera/near", "0", "expected a number above 0, found 0"},
          {"/frames/0/camera/near", "200", "/frames/0/camera/far: expected a number above near, 200, found 200"},
          {"/frames/0/camera/far", "0.5", "expected a number above near, 1, found 0.5"},
          {"/frames/0/light/direction", "[0,0,0]", "expected a vector with a length, found none or an infinite one"},
          {"/frames/1/view", "[1,2,3]", "expected an array of 16 numbers, found an array of 3"},
          {"/frames/1/projection/15", "\"\"", "expected a number, found \"\""},
          {"/frames/0/view", "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]",
           "/frames/0: expected either \"camera\", or \"view\" and \"projection\", found both"},
          {"/frames/0/draws/1/mesh", "\"c\"", "expected the name of a mesh in /meshes, found \"c\""},
          {"/frames/0/draws/0/transform", "[1]", "expected an array of 16 numbers, found an array of 1"},
          {"/frames/0/draws/0/cull", "\"backs\"", "expected one of \"none\", \"back\", \"front\", found \"backs\""},
          {"/colour", "1", "expected one of the keys \"beampipe_trace\", \"meshes\", \"frames\", found \"colour\""},
          {"/frames/0/a~1b", "1",
           "expected one of the keys \"width\", \"height\", \"background\", \"camera\", \"view\", \"projection\", "
           "\"light\", \"draws\", found \"a/b\""},
      });
}

TEST_F(TraceReaderTest, NamesMissingKeys) {
  EXPECT_EQ(error_without("/frames/0", "camera"),
            "scene.json: /frames/0: expected either \"camera\", or \"view\" and \"projection\", found neither");
  EXPECT_EQ(error_without("/frames/0", "light"),
            "scene.json: /frames/0/draws/0/shading: expected a \"light\" in the frame, found none");
}

TEST_F(TraceReaderTest, FindsDuplicateKeysWhereverTheyAre) {
  std::string text = kValid;
  text.replace(text.find("\"height\": 180"), 0, "\"width\": 320, ");
  EXPECT_EQ(error_in(text), "scene.json: /frames/0/width: expected each key once, found \"width\" again");
  text = kValid;
  text.replace(text.find("\"a\": {"), 3, "\"b\"");
  EXPECT_EQ(error_in(text), "scene.json: /meshes/b: expected each key once, found \"b\" again");
  // The same key in two objects is no duplicate, and the valid trace has many such keys.
  EXPECT_EQ(error_in(kValid), "no error");
}

TEST_F(TraceReaderTest, NamesThePlaceOfBrokenJson) {
  EXPECT_EQ(error_in("{\"beampipe_trace\": 1,\n \"meshes\": }").substr(0, 67),
            "scene.json: byte 34: expected valid JSON, found line 2, column 12: ");
  EXPECT_NE(error_in("").find("scene.json: byte 1: expected valid JSON, found"), std::string::npos);
  EXPECT_NE(error_in(std::string(kValid) + " x").find("expected valid JSON"), std::string::npos);
  EXPECT_NE(error_in(std::string(kValid) + "{}").find("expected valid JSON"), std::string::npos);
  EXPECT_NE(error_in("{\"meshes\": NaN}").find("expected valid JSON"), std::string::npos);
  EXPECT_NE(error_in("{\"a\nb\": 1}").find("expected valid JSON"), std::string::npos);
  EXPECT_NE(error_in("\"\xff\"").find("expected valid JSON"), std::string::npos);
}

TEST_F(TraceReaderTest, NamesThePlaceOfNumbersThatOverflow) {
  std::string text = kValid;
  text.replace(text.find("\"fovy_deg\": 36"), 14, "\"fovy_deg\": 1e999");
  EXPECT_EQ(error_in(text),
            "scene.json: /frames/0/camera/fovy_deg: expected a finite number, found number overflow parsing '1e999'");
}

TEST_F(TraceReaderTest, EveryErrorIsOneLine) {
  for (const std::string& text : {std::string("{\"a\\nb\": 1}"), std::string("\n\n{\n\"x\"\n}\n"),
                                  std::string("{\"beampipe_trace\": \"\\u0007\\n\"}")}) {
    const std::string error = error_in(text);
    EXPECT_NE(error, "no error");
    for (char c : error) EXPECT_GE(c, ' ') << error;
  }
}

TEST_F(TraceReaderTest, RefusesDeepNesting) {
  const std::string nested = "expected at most 32 levels of arrays and objects, found more";
  EXPECT_EQ(error_in(std::string(200000, '[')), "scene.json: byte 33: " + nested);
  std::string objects = " ";
  for (int i = 0; i < 33; ++i) objects += "{\"[\": ";
  EXPECT_EQ(error_in(objects), "scene.json: byte " + std::to_string(objects.size() - 5) + ": " + nested);
  EXPECT_EQ(error_in(std::string(32, '[') + std::string(32, ']')),
            "scene.json: /: expected an object, found an array of 1");
}

TEST_F(TraceReaderTest, NamesFilesThatCannotBeRead) {
  EXPECT_EQ(error_of([&] { read_trace(path("missing.json")); }), "missing.json: expected a readable file, found none");
  const std::string long_name(5000, 'x');
  EXPECT_EQ(error_of([&] { read_trace(path(long_name)); }), long_name + ": expected a readable file, found none");
  std::filesystem::create_directory(path("folder"));
  EXPECT_EQ(error_of([&] { read_trace(path("folder")); }), "folder: expected a readable file, found a folder");
  EXPECT_EQ(error_of([&] { read_trace("/proc/self/mem"); }), "/proc/self/mem: expected a readable file, found none");
}

TEST_F(TraceReaderTest, RefusesPipesAndDevices) {
  const std::string expected = ": expected a regular file, found a pipe or a device";
  const auto load_obj = [](const std::filesystem::path& file) {
    Trace trace;
    NotRead not_read;
    read_obj(file, {}, trace, not_read);
  };
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0666), 0);
  EXPECT_EQ(error_of([&] { read_trace(path("pipe")); }), "pipe" + expected);
  EXPECT_EQ(error_of([&] { read_trace("/dev/zero"); }), "/dev/zero" + expected);
  EXPECT_EQ(error_of([&] { load_obj(path("pipe")); }), "pipe" + expected);
  write("mesh.obj", "mtllib pipe\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(error_of([&] { load_obj(path("mesh.obj")); }), "mesh.obj: pipe" + expected);
}

// A small file can ask for a lot of memory. It must be refused without taking that memory.
TEST_F(TraceReaderTest, RefusesMoreThanAFrameMayHave) {
  std::string indices, draws;
  for (int i = 0; i < 10'000; ++i) indices += i ? ",0,0,0" : "0,0,0";
  for (int i = 0; i < 100'001; ++i) draws += i ? ",{\"mesh\":\"m\"}" : "{\"mesh\":\"m\"}";
  const std::string matrix = "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]";
  const auto frame = [&](const std::string& width, const std::string& of_draws) {
    return "{\"beampipe_trace\": 1, \"meshes\": {\"m\": {\"positions\": [0,0,0], \"indices\": [" + indices +
           "]}}, \"frames\": [{\"width\": " + width + ", \"height\": 1, \"view\": " + matrix +
           ", \"projection\": " + matrix + ", \"draws\": [" + of_draws + "]}]}";
  };
  EXPECT_EQ(error_in(frame("1", draws)),
            "scene.json: /frames/0/draws/100000: expected at most 1000000000 triangles in a frame, found 1000010000");
  EXPECT_EQ(error_in(frame("1000000", "")), "scene.json: /frames/0/width: expected an integer 1..16384, found 1000000");
}

TEST_F(TraceReaderTest, ReadsTheSamples) {
  const std::filesystem::path samples = std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples";
  EXPECT_EQ(read_trace(samples / "triangle.json").meshes[0].triangles.size(), 1u);
  EXPECT_EQ(read_trace(samples / "two_quads.json").frames[0].draws.size(), 2u);
  EXPECT_EQ(read_trace(samples / "pan.json").frames.size(), 3u);
  const Mesh hut = read_trace(samples / "hut.json").meshes[0];
  EXPECT_EQ(hut.triangles.size(), 14u);
  EXPECT_EQ(hut.colors.front(), glm::vec3(0.8f, 0.7f, 0.5f));
  EXPECT_EQ(hut.colors.back(), glm::vec3(0.6f, 0.1f, 0.05f));
  const Frame captured = read_trace(samples / "captured_quads.json").frames[0];
  EXPECT_EQ(captured.draws.size(), 6u);
  EXPECT_EQ(captured.capture.pictures.depth.size(), 96u * 72);
}

}  // namespace beampipe::trace_reader_test
