// Programs' shaders, images and samplers, and what draws bind of them.
#include "tests/traces/broken_values.h"
#include "tests/traces/test_folder.h"

namespace beampipe::program_reader_test {

using Json = nlohmann::ordered_json;

const char kPrograms[] = R"({ "beampipe_trace": 2,
  "buffers": {"b": {"file": "b.bin", "bytes": 48}},
  "programs": [ {"name": "p", "spirv": {"buffer": "b", "offset": 0, "count": 2, "type": "uint32"},
                 "inputs": [{"location": 3, "component": 1, "count": 2}, {"location": 4, "count": 1}]} ],
  "program_images": [ {"name": "i", "shape": "cube", "format": "R8_UNORM", "width": 2, "height": 2, "layers": 6,
                       "texels": {"buffer": "b", "offset": 0, "count": 24, "type": "uint8"}} ],
  "program_samplers": [{}],
  "meshes": { "m": {"positions": [0,0,0, 1,0,0, 0,1,0], "indices": [0,1,2],
                    "varyings": {"buffer": "b", "offset": 8, "count": 9, "type": "uint32"}} },
  "frames": [{"width": 2, "height": 2, "draws": [
    {"mesh": "m", "program": {"program": 0, "push_constants": "AQL/",
                              "images": [{"set": 0, "binding": 0, "image": 0, "sampler": 0}]}}]}] })";

class ProgramReaderTest : public FolderTest {
 protected:
  ProgramReaderTest() {
    std::string bytes;
    for (int i = 0; i < 48; ++i) bytes += static_cast<char>(i % 5 == 4 ? 0xff : i);
    write("b.bin", bytes);
  }
  const Json programs_ = Json::parse(kPrograms);
};

TEST_F(ProgramReaderTest, ReadsEveryStorage) {
  const Trace trace = read_json(programs_);
  EXPECT_EQ(trace.programs[0].spirv, (std::vector<std::uint32_t>{0x03020100, 0x070605ff}));
  EXPECT_EQ(trace.program_images[0].texels[4], 0xff);
  EXPECT_EQ(trace.meshes[0].varyings[0], 0x0b0a'ff08u);
  EXPECT_EQ(trace.frames[0].draws[0].program->push_constants, (std::vector<std::uint8_t>{1, 2, 255}));

  Json text = programs_;
  text["programs"][0]["spirv"] = "AAECA/8FBgc=";
  EXPECT_EQ(read_json(text).programs[0].spirv, trace.programs[0].spirv);
  text["programs"][0]["spirv"] = {0x03020100u, 0x070605ffu};
  EXPECT_EQ(read_json(text).programs[0].spirv, trace.programs[0].spirv);
  text["meshes"]["m"]["varyings"] = {1, -2.5, 0, 0, 0, 0, 0, 0, 1e-45};
  const std::vector<std::uint32_t> varyings = read_json(text).meshes[0].varyings;
  EXPECT_EQ(varyings[0], 0x3f800000u);
  EXPECT_EQ(varyings[1], 0xc0200000u);
  EXPECT_EQ(varyings[8], 1u);
}

TEST_F(ProgramReaderTest, SaysWhereAndWhatIsWrong) {
  expect_errors(
      programs_, [&](const Json& json) { return error_in(json); },
      {{"/programs/0/spirv", "\"AAA=\"", "expected base64 text of whole words of 4 bytes, found 2 bytes"},
       {"/programs/0/spirv", "\"%\"", "expected base64 text, found \"%\""},
       {"/programs/0/spirv", "3", "expected an array, base64 text or a view of a buffer, found 3"},
       {"/programs/0/spirv/type", "\"float32\"", "expected \"uint32\" or \"uint16\", found \"float32\""},
       {"/programs/0/inputs/0/count", "4", "expected at most 3 components from component 1 on, found 4"},
       {"/programs/0/inputs/1/count", "2",
        "/frames/0/draws/0/program: expected a mesh with 12 varyings, 4 for each vertex, found 9 in mesh \"m\""},
       {"/program_images/0/texels/type", "\"srgb8\"", "expected \"uint8\", found \"srgb8\""},
       {"/program_images/0/texels/count", "23", "/program_images/0/texels: expected 24 bytes, found 23"},
       {"/program_images/0/width", "3", "/program_images/0/height: expected the width of the cube, 3, found 2"},
       {"/program_images/0/layers", "5",
        "/program_images/0: expected six layers for each cube, and one cube where it is no array, found 5"},
       {"/program_images/0/levels", "3", "expected at most 2 levels, found 3"},
       {"/program_images/0/format", "\"R8_SNORM\"",
        "expected one of \"R8_UNORM\", \"R8G8_UNORM\", \"R8G8B8A8_UNORM\", \"R8G8B8A8_SRGB\", "
        "\"B8G8R8A8_UNORM\", \"B8G8R8A8_SRGB\", \"R16_SFLOAT\", \"R16G16_SFLOAT\", \"R16G16B16A16_SFLOAT\", "
        "\"R16G16B16A16_UNORM\", \"R32_SFLOAT\", \"R32G32B32A32_SFLOAT\", \"R32G32B32A32_UINT\", "
        "\"R32G32B32A32_SINT\", \"D32_SFLOAT\", found \"R8_SNORM\""},
       {"/program_samplers/0/wrap", "[\"repeat\"]", "expected an array of 3, found an array of 1"},
       {"/frames/0/draws/0/program/program", "1", "expected 0, found 1"},
       {"/frames/0/draws/0/program/images/0/base_level", "1", "expected one of the image's 1, found 1"},
       {"/frames/0/draws/0/program/images/0/layers", "7", "expected at most those of the image's 6, found 7"},
       {"/frames/0/draws/0/program/images/0/swizzle", "\"rgbx\"",
        "expected four letters of \"rgba01\", found \"rgbx\""},
       {"/frames/0/draws/0/kd", "[1,1,1]",
        "/frames/0/draws/0: expected \"program\" without \"kd\" and \"material\", found both"},
       {"/programs", "[]",
        "/frames/0/draws/0/program/program: expected an index into /programs, which has none, found 0"}});
}

// A few bytes may not ask for much memory.
TEST_F(ProgramReaderTest, LargeImagesNeedTheirBytes) {
  Json json = programs_;
  json["program_images"][0] = {{"name", "i"},    {"shape", "2d"},   {"format", "R32G32B32A32_SFLOAT"},
                               {"width", 16384}, {"height", 16384}, {"layers", 12288},
                               {"array", true},  {"texels", "AAAA"}};
  EXPECT_EQ(error_in(json), "scene.json: /program_images/0/texels: expected 52776558133248 bytes, found 3");
}

}  // namespace beampipe::program_reader_test
