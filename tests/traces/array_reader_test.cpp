// Views of binary files: what they give, and what is refused.

#include "tests/traces/broken_values.h"
#include "tests/traces/test_folder.h"

namespace beampipe::array_reader_test {

using Json = nlohmann::ordered_json;

template <class Number>
std::string bytes_of(std::initializer_list<Number> numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), std::data(numbers), bytes.size());
  return bytes;
}

// One triangle in each of two meshes that share a buffer.
const char kViews[] = R"({ "beampipe_trace": 2,
  "buffers": {"b": {"file": "b.bin", "bytes": 84}},
  "meshes": {
    "a": {"positions": {"buffer": "b", "offset": 0, "count": 9, "type": "float32"},
          "indices": {"buffer": "b", "offset": 36, "count": 3, "type": "uint32"},
          "colors": {"buffer": "b", "offset": 54, "count": 3, "type": "srgb8"}},
    "b": {"positions": {"buffer": "b", "offset": 0, "count": 9, "type": "float32"},
          "indices": {"buffer": "b", "offset": 48, "count": 3, "type": "uint16"},
          "vertex_colors": {"buffer": "b", "offset": 57, "count": 12, "type": "srgb8"},
          "uv0": {"buffer": "b", "offset": 12, "count": 6, "type": "float32"}} },
  "frames": [{"width": 2, "height": 2, "draws": []}] })";

class ArrayReaderTest : public FolderTest {
 protected:
  ArrayReaderTest()
      : bytes_(bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, -0.5f}) + bytes_of<std::uint32_t>({2, 1, 0}) +
               bytes_of<std::uint16_t>({0, 1, 2}) + bytes_of<std::uint8_t>({0, 128, 255}) +
               bytes_of<std::uint8_t>({0, 10, 11, 255, 255, 255, 255, 128, 1, 2, 3, 0}) + std::string(15, '\0')) {
    write("b.bin", bytes_);
  }
  // With four bytes of the buffer replaced.
  std::string error_with_bytes(std::size_t at, const std::string& replacement) const {
    write("b.bin", std::string(bytes_).replace(at, replacement.size(), replacement));
    return error_in(views_);
  }

  const Json views_ = Json::parse(kViews);

 private:
  std::string bytes_;
};

float linear(int code) {
  const double encoded = code / 255.0;
  return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
}

TEST_F(ArrayReaderTest, ReadsEveryType) {
  const Trace trace = read_json(views_);
  const Mesh &a = trace.meshes[0], &b = trace.meshes[1];
  EXPECT_EQ(a.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, -0.5f}}));
  EXPECT_EQ(a.triangles, (std::vector<glm::uvec3>{{2, 1, 0}}));
  EXPECT_EQ(a.colors, (std::vector<glm::vec3>{{0, linear(128), 1}}));
  EXPECT_EQ(b.positions, a.positions);
  EXPECT_EQ(b.triangles, (std::vector<glm::uvec3>{{0, 1, 2}}));
  EXPECT_EQ(b.uvs[0], (std::vector<glm::vec2>{{1, 0}, {0, 0}, {1, -0.5f}}));
  EXPECT_EQ(b.vertex_colors,
            (std::vector<glm::vec4>{
                {0, linear(10), linear(11), 1}, {1, 1, 1, 128.0f / 255.0f}, {linear(1), linear(2), linear(3), 0}}));
  EXPECT_EQ(trace.frames[0].view, glm::dmat4(1.0));
}

TEST_F(ArrayReaderTest, SaysWhereAndWhatIsWrong) {
  const char* const ends = "expected numbers that end in a buffer of 84 bytes, 3 for each item, found ";
  expect_errors(
      views_, [&](const Json& json) { return error_in(json); },
      {{"/buffers/b/bytes", "83", R"(expected the size of "b.bin", 84, found 83)"},
       {"/buffers/b/file", R"("../b.bin")",
        R"(expected a path that stays in the trace's folder (--allow-outside allows others), found "../b.bin")"},
       {"/buffers/b/file", R"("none.bin")", R"(expected an existing file, found "none.bin")"},
       {"/meshes/a/positions/buffer", R"("c")", R"(expected the name of a buffer in /buffers, found "c")"},
       {"/meshes/a/positions/offset", "2", "expected a multiple of 4 in a buffer of 84 bytes, found 2"},
       {"/meshes/a/positions/offset", "-4", "expected a multiple of 4 in a buffer of 84 bytes, found -4"},
       {"/meshes/a/positions/offset", "88", "expected a multiple of 4 in a buffer of 84 bytes, found 88"},
       {"/meshes/a/positions/count", "8", ends + std::string("8")},
       {"/meshes/a/positions/count", "24", ends + std::string("24")},
       {"/meshes/a/positions/count", "1e300", ends + std::string("1e+300")},
       {"/meshes/a/positions/type", R"("uint32")", R"(expected "float32", found "uint32")"},
       {"/meshes/a/positions/type", R"("int8")",
        R"(expected one of "float32", "uint32", "uint16", "uint8", "srgb8", found "int8")"},
       {"/meshes/a/indices/type", R"("float32")", R"(expected "uint32" or "uint16", found "float32")"},
       {"/meshes/a/colors/type", R"("uint16")", R"(expected "float32" or "srgb8", found "uint16")"},
       {"/meshes/a/positions/stride", "12",
        R"(expected one of the keys "buffer", "offset", "count", "type", found "stride")"},
       {"/meshes/a/positions", R"("b")", R"(expected an array of numbers, three for each item, found "b")"}});
}

TEST_F(ArrayReaderTest, ChecksEveryNumber) {
  EXPECT_EQ(error_with_bytes(8, bytes_of<float>({NAN})),
            "scene.json: /meshes/a/positions: expected a number in a float's range, found one that is not finite as "
            "number 2 of the view");
  EXPECT_EQ(error_with_bytes(40, bytes_of<std::uint32_t>({3})),
            "scene.json: /meshes/a/indices: expected integers below 3, found 3 as number 1 of the view");
  EXPECT_EQ(error_with_bytes(52, bytes_of<std::uint16_t>({0xffff})),
            "scene.json: /meshes/b/indices: expected integers below 3, found 65535 as number 2 of the view");
}

TEST_F(ArrayReaderTest, RefusesColorsBelowZeroAndOpacityAboveOne) {
  Json json = views_;
  json["meshes"]["a"]["colors"] = {{"buffer", "b"}, {"offset", 24}, {"count", 3}, {"type", "float32"}};
  EXPECT_EQ(error_in(json),
            "scene.json: /meshes/a/colors: expected a number from 0 to 65504, found -0.500000 as number 2 of the view");
  json = views_;
  write("c.bin", bytes_of<float>({1, 1, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0}));
  json["buffers"]["c"] = {{"file", "c.bin"}, {"bytes", 48}};
  json["meshes"]["b"]["vertex_colors"] = {{"buffer", "c"}, {"offset", 0}, {"count", 12}, {"type", "float32"}};
  EXPECT_EQ(error_in(json),
            "scene.json: /meshes/b/vertex_colors: expected a number 0..1, found 2.000000 as number 3 of the view");
}

TEST_F(ArrayReaderTest, ASmallFileStaysASmallTrace) {
  Json json = views_;
  json["meshes"] = Json::object();
  for (int i = 0; i < 7; ++i) {
    json["meshes"][std::to_string(i)] = {
        {"positions", {{"buffer", "b"}, {"offset", 0}, {"count", 12}, {"type", "float32"}}},
        {"indices", Json::array()}};
  }
  EXPECT_EQ(read_json(json).meshes.size(), 7u);  // 336 bytes: four times the buffer
  json["meshes"]["7"] = json["meshes"]["0"];
  EXPECT_EQ(
      error_in(json),
      "scene.json: /meshes/7/positions: expected views of at most 4 times the bytes of all buffers together, found "
      "384 bytes");
}

TEST_F(ArrayReaderTest, CapturedPicturesHaveTheFramesSize) {
  expect_errors(views_, [&](const Json& json) { return error_in(json); },
                {{"/frames/0/captured/depth", "[0.5, 0.5, 1]", "expected a depth for each pixel of 2 x 2, found 3"},
                 {"/frames/0/captured/depth", "[0.5, 0.5, 1, 1.5]", "expected depths 0..1, found 1.500000"}});
  Json json = views_;
  json["frames"][0]["captured"] = {{"depth", {{"buffer", "b"}, {"offset", 0}, {"count", 4}, {"type", "float32"}}}};
  EXPECT_EQ(read_json(json).frames[0].capture.pictures.depth, (std::vector<float>{0, 0, 0, 1}));
}

TEST_F(ArrayReaderTest, SaysWhatIsWrongWithDrawState) {
  const auto error_with = [&](const Json& state) {
    Json json = views_;
    json["frames"][0]["draws"] = Json::array({{{"mesh", "a"}, {"state", state}}});
    return error_in(json);
  };
  expect_errors(
      Json::object(), error_with,
      {{"/viewport", "[0, 0, 0, 1]", "expected a width above 0 and a height other than 0, found an array of 4"},
       {"/viewport", "[0, 0, 1]", "expected an array of 4 numbers, found an array of 3"},
       {"/viewport", "[0, 1e9, 1, 1]", "/viewport/1: expected a number from -1048576 to 1048576, found 1000000000.0"},
       {"/scissor", "[0, 0.5, 1, 1]", "expected whole pixels, found an array of 4"},
       {"/scissor", "[0, 0, -1, 1]", "expected a width and a height of 0 and up, found an array of 4"},
       {"/depth_range", "[0, 2]", "/depth_range/1: expected a number 0..1, found 2"},
       {"/color_mask", R"("rr")", R"(expected letters of "rgba", each at most once, found "rr")"},
       {"/stencil/reference", "256", "expected an integer 0..255, found 256"},
       {"/blend/source", R"("one")", "/blend: expected the key \"destination\", found none"}},
      "scene.json: /frames/0/draws/0/state");
}

}  // namespace beampipe::array_reader_test
