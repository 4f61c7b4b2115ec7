// Version 2 of the trace format: images, materials, vertex attributes and lights.
#include <sys/stat.h>

#include "tests/traces/broken_values.h"
#include "tests/traces/difference.h"
#include "tests/traces/image_samples.h"
#include "tests/traces/test_folder.h"
#include "traces/files/base64.h"
#include "traces/files/image_file.h"

namespace beampipe::surface_reader_test {

using Json = nlohmann::ordered_json;

// DATA stands for an image of 2 x 1 texels.
const char kValid[] = R"({ "beampipe_trace": 2,
  "images": { "wood": {"file": "art/wood.png"}, "bark": {"data": "DATA"} },
  "materials": {
    "plain": {},
    "rich": { "base_color": [0.1,0.2,3,0.4],
              "base_texture": {"image": "bark", "uv_set": 1, "wrap_u": "clamp", "wrap_v": "mirror",
                               "magnify": "nearest", "minify": "nearest", "mip": "nearest"},
              "metallic": 0.25, "roughness": 0.75, "metallic_roughness_texture": {"image": "wood", "mip": "none"},
              "normal_texture": {"image": "wood"}, "normal_scale": -0.5, "emissive": [4,5,6],
              "emissive_texture": {"image": "wood", "wrap_v": "clamp"}, "alpha_mode": "blend", "alpha_cutoff": 0.125,
              "double_sided": true, "unlit": true } },
  "meshes": {
    "b": { "positions": [0,0,0, 1,0,0, 0,1,0, 0,0,1], "indices": [0,1,2, 3,2,1, 1,2,0],
           "normals": [0,0,2, 0,1,0, 1,0,0, 0,-3,4], "tangents": [1,0,0,1, 0,2,0,-1, 0,0,1,1, 1,0,0,1],
           "uv0": [0,1, 2,3, 4,5, -6,0.5], "uv1": [0,0, 1,1, 2,2, 3,3],
           "vertex_colors": [1,2,3,1, 0,0,0,0, 1,1,1,0.5, 1,0,0,1],
           "materials": ["rich", null, "plain"], "material_of_triangle": [2,0,1] },
    "a": { "positions": [0,0,0, 1,0,0, 0,1,0], "indices": [0,1,2], "materials": ["plain"] } },
  "frames": [ { "width": 320, "height": 180,
                "camera": {"eye": [1,2,3], "target": [0,0,0], "up": [0,1,0], "fovy_deg": 36, "near": 1, "far": 200},
                "lights": [{"direction": [0,0,-2]}, {"direction": [1,0,0], "color": [1,0.5,0.25]}],
                "ambient": {"sky": [1,2,3], "ground": [0.5,0,0], "up": [0,0,5]},
                "draws": [ {"mesh": "b", "material": "rich"}, {"mesh": "a", "shading": "lambert"} ] } ] })";

class SurfaceReaderTest : public FolderTest {
 protected:
  SurfaceReaderTest() {
    write("art/wood.png", encode_png(wood_));
    valid_ = Json::parse(kValid);
    valid_["images"]["bark"]["data"] = to_base64(encode_png(bark_));
  }
  std::string error_without(const std::string& parent, const std::string& key) const {
    Json json = valid_;
    json.at(Json::json_pointer(parent)).erase(key);
    return error_in(json);
  }

  const TextureImage wood_{.name = "wood", .width = 1, .height = 2, .texels = {{1, 2, 3, 4}, {5, 6, 7, 8}}};
  const TextureImage bark_{.name = "bark", .width = 2, .height = 1, .texels = {{9, 8, 7, 6}, {5, 4, 3, 2}}};
  Json valid_;
};

TEST_F(SurfaceReaderTest, ReadsImages) {
  EXPECT_EQ(difference(read_json(valid_).images, std::vector{wood_, bark_}), "");
}

TEST_F(SurfaceReaderTest, ReadsMaterials) {
  const std::vector<Material> materials = read_json(valid_).materials;
  ASSERT_EQ(materials.size(), 2u);
  const Material plain{"plain", glm::vec4(1),      {},   0,     1,    {}, {}, 1, glm::vec3(0),
                       {},      AlphaMode::opaque, 0.5f, false, false};
  const auto texture = [](Wrap wrap_v, MipFilter mip) {
    return Texture{0, 0, Wrap::repeat, wrap_v, Filter::linear, Filter::linear, mip};
  };
  const Material rich{
      .name = "rich",
      .base_color = {0.1f, 0.2f, 3.0f, 0.4f},
      .base_texture = {{1, 1, Wrap::clamp, Wrap::mirror, Filter::nearest, Filter::nearest, MipFilter::nearest}},
      .metallic = 0.25f,
      .roughness = 0.75f,
      .metallic_roughness_texture = texture(Wrap::repeat, MipFilter::none),
      .normal_texture = texture(Wrap::repeat, MipFilter::linear),
      .normal_scale = -0.5f,
      .emissive = {4, 5, 6},
      .emissive_texture = texture(Wrap::clamp, MipFilter::linear),
      .alpha_mode = AlphaMode::blend,
      .alpha_cutoff = 0.125f,
      .double_sided = true,
      .unlit = true};
  EXPECT_EQ(difference(materials, std::vector{plain, rich}), "");
}

TEST_F(SurfaceReaderTest, ReadsAttributes) {
  const Trace trace = read_json(valid_);
  const Mesh& mesh = trace.meshes[0];
  EXPECT_EQ(mesh.colors, std::vector<glm::vec3>(3, glm::vec3(0.8f)));
  EXPECT_EQ(mesh.normals, (std::vector<glm::vec3>{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, -0.6f, 0.8f}}));
  EXPECT_EQ(mesh.tangents, (std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 1, 0, -1}, {0, 0, 1, 1}, {1, 0, 0, 1}}));
  EXPECT_EQ(mesh.uvs[0], (std::vector<glm::vec2>{{0, 1}, {2, 3}, {4, 5}, {-6, 0.5f}}));
  EXPECT_EQ(mesh.uvs[1], (std::vector<glm::vec2>{{0, 0}, {1, 1}, {2, 2}, {3, 3}}));
  EXPECT_EQ(mesh.vertex_colors, (std::vector<glm::vec4>{{1, 2, 3, 1}, {0, 0, 0, 0}, {1, 1, 1, 0.5f}, {1, 0, 0, 1}}));
  EXPECT_EQ(mesh.materials, (std::vector<std::uint32_t>{0, 1, kNoMaterial}));
  EXPECT_EQ(trace.meshes[1].materials, (std::vector<std::uint32_t>{0}));
  EXPECT_TRUE(trace.meshes[1].normals.empty());
  EXPECT_EQ(trace.frames[0].draws[0].material, 1u);
  EXPECT_FALSE(trace.frames[0].draws[1].material);
}

TEST_F(SurfaceReaderTest, ReadsLights) {
  const Lighting lighting = read_json(valid_).frames[0].lighting;
  const std::vector<Light> lights = {{{0, 0, -1}, glm::vec3(1.0f)}, {{1, 0, 0}, {1, 0.5f, 0.25f}}};
  EXPECT_EQ(difference(lighting.lights, lights), "");
  EXPECT_EQ(difference(lighting.ambient.value(), Ambient{{1, 2, 3}, {0.5f, 0, 0}, {0, 0, 1}}), "");
  // Ambient light is enough for lambert shading.
  Json json = valid_;
  json["frames"][0].erase("lights");
  json["frames"][0]["ambient"].erase("up");
  EXPECT_EQ(read_json(json).frames[0].lighting.ambient->up, glm::vec3(0, 1, 0));
}

TEST_F(SurfaceReaderTest, SaysWhereAndWhatIsWrong) {
  expect_errors(
      valid_, [&](const Json& json) { return error_in(json); },
      {
          {"/images", "[]", "expected an object, found an array of 0"},
          {"/images/wood", "{}", "expected the key \"file\" or \"data\", found none"},
          {"/images/wood/data", "\"\"", "/images/wood/file: expected one of the keys \"data\", found \"file\""},
          {"/images/bark/data", "\"a+b\"", "expected base64 text, found \"a+b\""},
          {"/images/bark/data", "\"\"", "expected a PNG or JPEG file, found no bytes"},
          {"/images/bark/data", "\"iVBORw0KGgo=\"", "expected a sound PNG file, found \"the file ends early\""},
          {"/materials", "3", "expected an object, found 3"},
          {"/materials/rich/base_color", "[1,1,1]", "expected an array of 4 numbers, found an array of 3"},
          {"/materials/rich/base_color/1", "-1", "expected a number from 0 to 65504, found -1"},
          {"/materials/rich/base_color/3", "1.5", "expected a number 0..1, found 1.5"},
          {"/materials/rich/base_color/0", "null", "expected a number from 0 to 65504, found null"},
          {"/materials/rich/metallic", "-0.1", "expected a number 0..1, found -0.1"},
          {"/materials/rich/roughness", "1.01", "expected a number 0..1, found 1.01"},
          {"/materials/rich/normal_scale", "1e39", "expected a number from -1000 to 1000, found 1e+39"},
          {"/materials/rich/normal_scale", "-1000.1", "expected a number from -1000 to 1000, found -1000.1"},
          {"/materials/rich/normal_scale", "1000", "no error"},
          {"/materials/rich/emissive/0", "65504", "no error"},
          {"/materials/rich/emissive/0", "1e30", "expected a number from 0 to 65504, found 1e+30"},
          {"/materials/rich/base_color/2", "65505", "expected a number from 0 to 65504, found 65505"},
          {"/materials/rich/base_color/3", "null", "expected a number from 0 to 65504, found null"},
          {"/meshes/b/vertex_colors/6", "1e38", "expected a number from 0 to 65504, found 1e+38"},
          {"/frames/0/lights/1/color/0", "3e38", "expected a number from 0 to 65504, found 3e+38"},
          {"/frames/0/ambient/ground/0", "65505", "expected a number from 0 to 65504, found 65505"},
          {"/materials/rich/emissive/2", "-1", "expected a number from 0 to 65504, found -1"},
          {"/materials/rich/alpha_mode", "\"masked\"",
           "expected one of \"opaque\", \"mask\", \"blend\", found \"masked\""},
          {"/materials/rich/alpha_cutoff", "2", "expected a number 0..1, found 2"},
          {"/materials/rich/base_texture/image", "\"iron\"",
           "expected the name of an image in /images, found \"iron\""},
          {"/materials/rich/base_texture/uv_set", "2", "expected an integer 0..1, found 2"},
          {"/materials/rich/base_texture/wrap_u", "\"border\"",
           "expected one of \"repeat\", \"clamp\", \"mirror\", found \"border\""},
          {"/materials/rich/base_texture/magnify", "\"none\"",
           "expected one of \"nearest\", \"linear\", found \"none\""},
          {"/meshes/b/normals", "[0,0,1]", "expected an array of 12 numbers, 3 for each position, found an array of 3"},
          {"/meshes/b/normals", "[0,0]", "expected an array of numbers, three for each item, found an array of 2"},
          {"/meshes/b/normals/2", "null", "expected a number in a float's range, found null"},
          {"/meshes/b/normals/2", "0", "/meshes/b/normals: expected vectors with a length, found none at position 0"},
          {"/meshes/b/tangents/8", "1e-50", "no error"},
          {"/meshes/b/tangents/10", "0",
           "/meshes/b/tangents: expected vectors with a length, found none at position 2"},
          {"/meshes/b/tangents/11", "0.5", "/meshes/b/tangents: expected w of 1 or -1, found another at position 2"},
          {"/meshes/b/tangents", "[1,0,0]", "expected an array of numbers, four for each item, found an array of 3"},
          {"/meshes/b/uv0", "[1,0]", "expected an array of 8 numbers, 2 for each position, found an array of 2"},
          {"/meshes/b/uv1/3", "-1e39", "expected a number in a float's range, found -1e+39"},
          {"/meshes/b/vertex_colors/7", "1.5", "expected a number 0..1, found 1.5"},
          {"/meshes/b/vertex_colors/5", "-1", "expected a number from 0 to 65504, found -1"},
          {"/meshes/b/vertex_colors", "[]",
           "expected an array of 16 numbers, 4 for each position, found an array of 0"},
          {"/meshes/b/materials", "[]",
           "expected one material, or \"material_of_triangle\" beside several, found an array of 0"},
          {"/meshes/b/materials/2", "\"gold\"", "expected the name of a material in /materials, found \"gold\""},
          {"/meshes/b/materials/2", "1", "expected a string, found 1"},
          {"/meshes/b/material_of_triangle", "[0,1]",
           "expected an array of 3 numbers, one for each triangle, found an array of 2"},
          {"/meshes/b/material_of_triangle/1", "3", "expected an integer 0..2, found 3"},
          {"/meshes/b/material_of_triangle/1", "-1", "expected an integer 0..2, found -1"},
          {"/meshes/a/materials/0", "\"rich\"",
           "expected \"uv1\" in mesh \"a\", for the base_texture of material \"rich\", found none"},
          {"/frames/0/lights/0/direction", "[0,0,0]", "expected a vector with a length, found none or an infinite one"},
          {"/frames/0/lights/1/color", "[1,1]", "expected an array of 3 numbers, found an array of 2"},
          {"/frames/0/lights/1/color/0", "-1", "expected a number from 0 to 65504, found -1"},
          {"/frames/0/ambient/up", "[0,0,0]", "expected a vector with a length, found none or an infinite one"},
          {"/frames/0/draws/0/material", "\"gold\"", "expected the name of a material in /materials, found \"gold\""},
          {"/frames/0/draws/0/kd", "[1,1,1]", "/frames/0/draws/0: expected either \"kd\" or \"material\", found both"},
          {"/frames/0/draws/1/material", "\"rich\"",
           "expected \"uv1\" in mesh \"a\", for the base_texture of material \"rich\", found none"},
      });
}

TEST_F(SurfaceReaderTest, SaysWhatIsMissing) {
  EXPECT_EQ(error_without("/meshes/b", "materials"),
            "scene.json: /meshes/b/material_of_triangle: expected \"materials\" beside it, found none");
  EXPECT_EQ(error_without("/meshes/b", "material_of_triangle"),
            "scene.json: /meshes/b/materials: expected one material, or \"material_of_triangle\" beside several, found "
            "an array of 3");
  EXPECT_EQ(error_without("/meshes/b", "uv0"),
            "scene.json: /meshes/b/materials/0: expected \"uv0\" in mesh \"b\", for the metallic_roughness_texture of "
            "material \"rich\", found none");
  EXPECT_EQ(error_without("", "images"),
            "scene.json: /materials/rich/base_texture/image: expected the name of an image in /images, found \"bark\"");
  EXPECT_EQ(error_without("", "materials"),
            "scene.json: /meshes/b/materials/0: expected the name of a material in /materials, found \"rich\"");
  Json dark = valid_;
  dark["frames"][0].erase("lights");
  dark["frames"][0].erase("ambient");
  EXPECT_EQ(error_in(dark),
            "scene.json: /frames/0/draws/1/shading: expected \"lights\" or \"ambient\" in the frame, found none");
  Json bright = valid_;
  for (int i = 0; i < 15; ++i) bright["frames"][0]["lights"].push_back({{"direction", {0, 1, 0}}});
  EXPECT_EQ(error_in(bright), "scene.json: /frames/0/lights: expected at most 16 lights, found an array of 17");
  bright["frames"][0]["lights"].erase(16);
  EXPECT_EQ(error_in(bright), "no error");
}

// A mesh without triangles has no use for coordinates.
TEST_F(SurfaceReaderTest, EmptyMeshesNeedNoCoordinates) {
  Json json = valid_;
  json["meshes"]["a"] = {{"positions", Json::array()}, {"indices", Json::array()}, {"materials", {"rich"}}};
  EXPECT_EQ(error_in(json), "no error");
  EXPECT_TRUE(read_json(json).meshes[1].materials.empty());
}

// By the rule of mesh_path_test.cpp. A pipe is not waited for.
TEST_F(SurfaceReaderTest, ImagesStayInTheFolderAsMeshesDo) {
  write("in/wood.png", read("art/wood.png"));
  write("wood.png", read("art/wood.png"));
  ASSERT_EQ(mkfifo(path("in/pipe.png").c_str(), 0666), 0);
  const auto error = [&](const std::string& file, bool allow_outside = false) {
    Json json = valid_;
    json["images"]["wood"]["file"] = file;
    return error_of([&] { read_trace(write("in/scene.json", json.dump()), {.allow_outside = allow_outside}); });
  };
  const std::string at = "in/scene.json: /images/wood/file: expected a ";
  EXPECT_EQ(error("wood.png"), "no error");
  EXPECT_EQ(error("../wood.png"),
            at + "path that stays in the trace's folder (--allow-outside allows others), found \"../wood.png\"");
  EXPECT_EQ(error("../wood.png", true), "no error");
  EXPECT_EQ(error("pipe.png"), at + "regular file, found \"pipe.png\"");
}

TEST_F(SurfaceReaderTest, ErrorsInAnImageNameBothFiles) {
  write("art/wood.png", "BM");
  EXPECT_EQ(error_in(valid_),
            "scene.json: /images/wood/file: art/wood.png: expected a PNG or JPEG file, found one that starts with "
            "\"BM\"");
  std::filesystem::resize_file(write("art/wood.png", ""), (std::uintmax_t{1} << 30) + 1);  // takes no room on the disk
  EXPECT_EQ(error_in(valid_),
            "scene.json: /images/wood/file: art/wood.png: expected at most 1 GiB, found 1073741825 bytes");
}

// 2^28 texels in one image may be read, but not when there are others.
TEST_F(SurfaceReaderTest, LimitsTheTexelsOfAllImages) {
  write("art/wood.png", png_that_claims(16384, 16384, png_chunk("IDAT")));
  EXPECT_EQ(error_in(valid_),
            "scene.json: /images/wood/file: art/wood.png: expected at least 976128 bytes for 16384 x 16384 texels, "
            "found 45");
  valid_["images"]["last"] = {{"file", "art/wood.png"}};
  valid_["images"]["wood"] = valid_["images"]["bark"];
  EXPECT_EQ(error_in(valid_),
            "scene.json: /images/last/file: art/wood.png: expected at most 268435456 texels in all images together, "
            "found 16384 x 16384 in this one");
}

TEST_F(SurfaceReaderTest, ReadsAMillionMaterials) {
  std::string text = R"({"beampipe_trace": 2, "materials": {)";
  for (int i = 0; i < 1'000'000; ++i) text += (i ? ",\"m" : "\"m") + std::to_string(i) + "\":{\"unlit\":true}";
  text += R"(}, "meshes": {"m": {"positions": [0,0,0], "indices": [0,0,0], "materials": ["m999999"]}},
    "frames": [{"width": 1, "height": 1, "draws": [{"mesh": "m"}], "view": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],
    "projection": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]})";
  const Trace trace = read_trace(write("scene.json", text));
  EXPECT_EQ(trace.materials.size(), 1'000'000u);
  EXPECT_EQ(trace.meshes[0].materials, (std::vector<std::uint32_t>{999'999}));
}

// The error is one line, whatever stands in the file.
TEST_F(SurfaceReaderTest, ErrorsHaveNoControlCharacters) {
  Json json = valid_;
  json["images"]["two\nlines"] = {{"file", "art/none.png"}};
  EXPECT_NE(error_in(json).find("two?lines"), std::string::npos) << error_in(json);
  EXPECT_EQ(error_in(json).find('\n'), std::string::npos);
}

}  // namespace beampipe::surface_reader_test
