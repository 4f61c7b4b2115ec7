// Views of binary files: what they give, and what is refused.
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

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

  Trace read_json(const Json& json) const { return read_trace(write("scene.json", json.dump())); }
  std::string error_with(const std::string& pointer, const Json& value) const {
    Json json = Json::parse(kViews);
    json[Json::json_pointer(pointer)] = value;
    return error_of([&] { read_json(json); });
  }
  // With four bytes of the buffer replaced.
  std::string error_with_bytes(std::size_t at, const std::string& replacement) const {
    write("b.bin", std::string(bytes_).replace(at, replacement.size(), replacement));
    return error_of([&] { read_json(Json::parse(kViews)); });
  }

 private:
  std::string bytes_;
};

float linear(int code) {
  const double encoded = code / 255.0;
  return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
}

TEST_F(ArrayReaderTest, ReadsEveryType) {
  const Trace trace = read_json(Json::parse(kViews));
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
  const std::tuple<const char*, Json, const char*> cases[] = {
      {"/buffers/b/bytes", 83, R"(/buffers/b/bytes: expected the size of "b.bin", 84, found 83)"},
      {"/buffers/b/file", "../b.bin", "/buffers/b/file: expected a path that stays in the trace's folder"},
      {"/buffers/b/file", "none.bin", "/buffers/b/file: expected an existing file"},
      {"/meshes/a/positions/buffer", "c", "/meshes/a/positions/buffer: expected the name of a buffer in /buffers"},
      {"/meshes/a/positions/offset", 2, "/meshes/a/positions/offset: expected a multiple of 4 in a buffer of 84 bytes"},
      {"/meshes/a/positions/offset", -4, "/meshes/a/positions/offset: expected a multiple of 4"},
      {"/meshes/a/positions/offset", 88, "/meshes/a/positions/offset: expected a multiple of 4"},
      {"/meshes/a/positions/count", 8,
       "/meshes/a/positions/count: expected numbers that end in a buffer of 84 bytes, 3 for each item, found 8"},
      {"/meshes/a/positions/count", 24, "/meshes/a/positions/count: expected numbers that end in a buffer of 84"},
      {"/meshes/a/positions/count", 1e300, "/meshes/a/positions/count: expected numbers that end in a buffer of 84"},
      {"/meshes/a/positions/count", nullptr, "/meshes/a/positions/count: expected a number"},
      {"/meshes/a/positions/type", "uint32", R"(/meshes/a/positions/type: expected "float32", found "uint32")"},
      {"/meshes/a/positions/type", "int8", R"(/meshes/a/positions/type: expected one of "float32", "uint32")"},
      {"/meshes/a/indices/type", "float32", R"(/meshes/a/indices/type: expected "uint32" or "uint16")"},
      {"/meshes/a/colors/type", "uint16", R"(/meshes/a/colors/type: expected "float32" or "srgb8")"},
      {"/meshes/a/positions/stride", 12, "/meshes/a/positions/stride: expected one of the keys"},
      {"/meshes/a/positions", "b", "/meshes/a/positions: expected an array"},
  };
  for (const auto& [pointer, value, message] : cases) {
    const std::string error = error_with(pointer, value);
    EXPECT_EQ(error.substr(0, error.find(message) + std::strlen(message)), std::string("scene.json: ") + message);
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
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
  Json json = Json::parse(kViews);
  json["meshes"]["a"]["colors"] = {{"buffer", "b"}, {"offset", 24}, {"count", 3}, {"type", "float32"}};
  EXPECT_EQ(error_of([&] { read_json(json); }),
            "scene.json: /meshes/a/colors: expected a number from 0 to 65504, found -0.500000 as number 2 of the view");
  json = Json::parse(kViews);
  write("c.bin", bytes_of<float>({1, 1, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0}));
  json["buffers"]["c"] = {{"file", "c.bin"}, {"bytes", 48}};
  json["meshes"]["b"]["vertex_colors"] = {{"buffer", "c"}, {"offset", 0}, {"count", 12}, {"type", "float32"}};
  EXPECT_EQ(error_of([&] { read_json(json); }),
            "scene.json: /meshes/b/vertex_colors: expected a number 0..1, found 2.000000 as number 3 of the view");
}

TEST_F(ArrayReaderTest, ASmallFileStaysASmallTrace) {
  Json json = Json::parse(kViews);
  json["meshes"] = Json::object();
  for (int i = 0; i < 7; ++i) {
    json["meshes"][std::to_string(i)] = {
        {"positions", {{"buffer", "b"}, {"offset", 0}, {"count", 12}, {"type", "float32"}}},
        {"indices", Json::array()}};
  }
  EXPECT_EQ(read_json(json).meshes.size(), 7u);  // 336 bytes: four times the buffer
  json["meshes"]["7"] = json["meshes"]["0"];
  EXPECT_EQ(
      error_of([&] { read_json(json); }),
      "scene.json: /meshes/7/positions: expected views of at most 4 times the bytes of all buffers together, found "
      "384 bytes");
}

TEST_F(ArrayReaderTest, CapturedPicturesHaveTheFramesSize) {
  Json json = Json::parse(kViews);
  json["frames"][0]["captured"] = {{"depth", {0.5, 0.5, 1}}};
  EXPECT_EQ(error_of([&] { read_json(json); }),
            "scene.json: /frames/0/captured/depth: expected a depth for each pixel of 2 x 2, found 3");
  json["frames"][0]["captured"]["depth"] = {0.5, 0.5, 1, 1.5};
  EXPECT_EQ(error_of([&] { read_json(json); }),
            "scene.json: /frames/0/captured/depth: expected depths 0..1, found 1.500000");
  json["frames"][0]["captured"] = {{"depth", {{"buffer", "b"}, {"offset", 0}, {"count", 4}, {"type", "float32"}}}};
  EXPECT_EQ(read_json(json).frames[0].capture.pictures.depth, (std::vector<float>{0, 0, 0, 1}));
}

TEST_F(ArrayReaderTest, SaysWhatIsWrongWithDrawState) {
  Json json = Json::parse(kViews);
  const auto error = [&](const char* text) {
    json["frames"][0]["draws"] = Json::array({{{"mesh", "a"}, {"state", Json::parse(text)}}});
    return error_of([&] { read_json(json); });
  };
  const std::string start = "scene.json: /frames/0/draws/0/state";
  EXPECT_EQ(error(R"({"viewport": [0, 0, 0, 1]})"),
            start + "/viewport: expected a width above 0 and a height other than 0, found an array of 4");
  EXPECT_EQ(error(R"({"viewport": [0, 0, 1]})"),
            start + "/viewport: expected an array of 4 numbers, found an array of 3");
  EXPECT_EQ(error(R"({"viewport": [0, 1e9, 1, 1]})"),
            start + "/viewport/1: expected a number from -1048576 to 1048576, found 1000000000.0");
  EXPECT_EQ(error(R"({"scissor": [0, 0.5, 1, 1]})"), start + "/scissor: expected whole pixels, found an array of 4");
  EXPECT_EQ(error(R"({"scissor": [0, 0, -1, 1]})"),
            start + "/scissor: expected a width and a height of 0 and up, found an array of 4");
  EXPECT_EQ(error(R"({"depth_range": [0, 2]})"), start + "/depth_range/1: expected a number 0..1, found 2");
  EXPECT_EQ(error(R"({"color_mask": "rr"})"),
            start + "/color_mask: expected letters of \"rgba\", each at most once, found \"rr\"");
  EXPECT_EQ(error(R"({"stencil": {"reference": 256}})"),
            start + "/stencil/reference: expected an integer 0..255, found 256");
  EXPECT_EQ(error(R"({"blend": {"source": "one"}})"), start + "/blend: expected the key \"destination\", found none");
}

}  // namespace beampipe::array_reader_test
