// Version 2 of the trace format: images, materials, vertex attributes and lights.
#include <sys/stat.h>

#include <nlohmann/json.hpp>

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
    const TextureImage wood{.name = "", .width = 1, .height = 2, .texels = {{1, 2, 3, 4}, {5, 6, 7, 8}}};
    const TextureImage bark{.name = "", .width = 2, .height = 1, .texels = {{9, 8, 7, 6}, {5, 4, 3, 2}}};
    write("art/wood.png", encode_png(wood));
    valid_ = Json::parse(kValid);
    valid_["images"]["bark"]["data"] = to_base64(encode_png(bark));
  }

  Trace read_json(const Json& json) const { return read_trace(write("scene.json", json.dump())); }
  std::string error_in(const Json& json) const {
    return error_of([&] { read_json(json); });
  }
  // The error for the valid trace with the value at `pointer` replaced by `value`.
  std::string error_with(const std::string& pointer, const std::string& value) const {
    Json json = valid_;
    json[Json::json_pointer(pointer)] = Json::parse(value);
    return error_in(json);
  }
  std::string error_without(const std::string& parent, const std::string& key) const {
    Json json = valid_;
    json.at(Json::json_pointer(parent)).erase(key);
    return error_in(json);
  }

  Json valid_;
};

TEST_F(SurfaceReaderTest, ReadsImages) {
  const Trace trace = read_json(valid_);
  ASSERT_EQ(trace.images.size(), 2u);
  EXPECT_EQ(trace.images[0].name, "wood");
  EXPECT_EQ(trace.images[0].width, 1u);
  EXPECT_EQ(trace.images[0].height, 2u);
  EXPECT_EQ(trace.images[0].texels, (std::vector<glm::u8vec4>{{1, 2, 3, 4}, {5, 6, 7, 8}}));
  EXPECT_EQ(trace.images[1].name, "bark");
  EXPECT_EQ(trace.images[1].width, 2u);
  EXPECT_EQ(trace.images[1].height, 1u);
  EXPECT_EQ(trace.images[1].texels, (std::vector<glm::u8vec4>{{9, 8, 7, 6}, {5, 4, 3, 2}}));
}

TEST_F(SurfaceReaderTest, ReadsMaterials) {
  const std::vector<Material> materials = read_json(valid_).materials;
  ASSERT_EQ(materials.size(), 2u);
  const Material &plain = materials[0], &rich = materials[1];
  EXPECT_EQ(plain.name, "plain");
  EXPECT_EQ(plain.base_color, glm::vec4(1.0f));
  EXPECT_EQ(plain.metallic, 0.0f);
  EXPECT_EQ(plain.roughness, 1.0f);
  EXPECT_EQ(plain.normal_scale, 1.0f);
  EXPECT_EQ(plain.emissive, glm::vec3(0.0f));
  EXPECT_EQ(plain.alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(plain.alpha_cutoff, 0.5f);
  EXPECT_FALSE(plain.double_sided || plain.unlit);
  EXPECT_FALSE(plain.base_texture || plain.metallic_roughness_texture || plain.normal_texture ||
               plain.emissive_texture);

  EXPECT_EQ(rich.name, "rich");
  EXPECT_EQ(rich.base_color, glm::vec4(0.1f, 0.2f, 3.0f, 0.4f));
  EXPECT_EQ(rich.base_texture, (Texture{.image = 1,
                                        .uv_set = 1,
                                        .wrap_u = Wrap::clamp,
                                        .wrap_v = Wrap::mirror,
                                        .magnify = Filter::nearest,
                                        .minify = Filter::nearest,
                                        .mip = MipFilter::nearest}));
  EXPECT_EQ(rich.metallic, 0.25f);
  EXPECT_EQ(rich.roughness, 0.75f);
  EXPECT_EQ(rich.metallic_roughness_texture, (Texture{.image = 0,
                                                      .uv_set = 0,
                                                      .wrap_u = Wrap::repeat,
                                                      .wrap_v = Wrap::repeat,
                                                      .magnify = Filter::linear,
                                                      .minify = Filter::linear,
                                                      .mip = MipFilter::none}));
  EXPECT_EQ(rich.normal_texture, (Texture{.image = 0,
                                          .uv_set = 0,
                                          .wrap_u = Wrap::repeat,
                                          .wrap_v = Wrap::repeat,
                                          .magnify = Filter::linear,
                                          .minify = Filter::linear,
                                          .mip = MipFilter::linear}));
  EXPECT_EQ(rich.normal_scale, -0.5f);
  EXPECT_EQ(rich.emissive, glm::vec3(4, 5, 6));
  EXPECT_EQ(rich.emissive_texture, (Texture{.image = 0,
                                            .uv_set = 0,
                                            .wrap_u = Wrap::repeat,
                                            .wrap_v = Wrap::clamp,
                                            .magnify = Filter::linear,
                                            .minify = Filter::linear,
                                            .mip = MipFilter::linear}));
  EXPECT_EQ(rich.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(rich.alpha_cutoff, 0.125f);
  EXPECT_TRUE(rich.double_sided);
  EXPECT_TRUE(rich.unlit);
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
  ASSERT_EQ(lighting.lights.size(), 2u);
  EXPECT_EQ(lighting.lights[0].direction, glm::vec3(0, 0, -1));
  EXPECT_EQ(lighting.lights[0].color, glm::vec3(1.0f));
  EXPECT_EQ(lighting.lights[1].direction, glm::vec3(1, 0, 0));
  EXPECT_EQ(lighting.lights[1].color, glm::vec3(1, 0.5f, 0.25f));
  ASSERT_TRUE(lighting.ambient);
  EXPECT_EQ(lighting.ambient->sky, glm::vec3(1, 2, 3));
  EXPECT_EQ(lighting.ambient->ground, glm::vec3(0.5f, 0, 0));
  EXPECT_EQ(lighting.ambient->up, glm::vec3(0, 0, 1));
  // Ambient light is enough for lambert shading.
  Json json = valid_;
  json["frames"][0].erase("lights");
  json["frames"][0]["ambient"].erase("up");
  EXPECT_EQ(read_json(json).frames[0].lighting.ambient->up, glm::vec3(0, 1, 0));
}

struct Case {
  const char *pointer, *value, *message;
};

TEST_F(SurfaceReaderTest, SaysWhereAndWhatIsWrong) {
  const Case cases[] = {
      {"/images", "[]", "/images: expected an object, found an array of 0"},
      {"/images/wood", "{}", "/images/wood: expected the key \"file\" or \"data\", found none"},
      {"/images/wood/data", "\"\"", "/images/wood/file: expected one of the keys \"data\", found \"file\""},
      {"/images/wood/file", "7", "/images/wood/file: expected a string, found 7"},
      {"/images/bark/data", "[]", "/images/bark/data: expected a string, found an array of 0"},
      {"/images/bark/data", "\"a+b\"", "/images/bark/data: expected base64 text, found \"a+b\""},
      {"/images/bark/data", "\"\"", "/images/bark/data: expected a PNG or JPEG file, found no bytes"},
      {"/images/bark/data", "\"iVBORw0KGgo=\"",
       "/images/bark/data: expected a sound PNG file, found \"the file ends early\""},
      {"/materials", "3", "/materials: expected an object, found 3"},
      {"/materials/rich", "null", "/materials/rich: expected an object, found null"},
      {"/materials/rich/base_color", "[1,1,1]",
       "/materials/rich/base_color: expected an array of 4 numbers, found an array of 3"},
      {"/materials/rich/base_color/1", "-1",
       "/materials/rich/base_color/1: expected a number from 0 to 65504, found -1"},
      {"/materials/rich/base_color/3", "1.5", "/materials/rich/base_color/3: expected a number 0..1, found 1.5"},
      {"/materials/rich/base_color/0", "null",
       "/materials/rich/base_color/0: expected a number from 0 to 65504, found null"},
      {"/materials/rich/metallic", "-0.1", "/materials/rich/metallic: expected a number 0..1, found -0.1"},
      {"/materials/rich/roughness", "1.01", "/materials/rich/roughness: expected a number 0..1, found 1.01"},
      {"/materials/rich/normal_scale", "1e39",
       "/materials/rich/normal_scale: expected a number from -1000 to 1000, found 1e+39"},
      {"/materials/rich/normal_scale", "-1000.1",
       "/materials/rich/normal_scale: expected a number from -1000 to 1000, found -1000.1"},
      {"/materials/rich/normal_scale", "1000", "no error"},
      {"/materials/rich/emissive/0", "65504", "no error"},
      {"/materials/rich/emissive/0", "1e30",
       "/materials/rich/emissive/0: expected a number from 0 to 65504, found 1e+30"},
      {"/materials/rich/base_color/2", "65505",
       "/materials/rich/base_color/2: expected a number from 0 to 65504, found 65505"},
      {"/materials/rich/base_color/3", "null",
       "/materials/rich/base_color/3: expected a number from 0 to 65504, found null"},
      {"/meshes/b/vertex_colors/6", "1e38",
       "/meshes/b/vertex_colors/6: expected a number from 0 to 65504, found 1e+38"},
      {"/frames/0/lights/1/color/0", "3e38",
       "/frames/0/lights/1/color/0: expected a number from 0 to 65504, found 3e+38"},
      {"/frames/0/ambient/ground/0", "65505",
       "/frames/0/ambient/ground/0: expected a number from 0 to 65504, found 65505"},
      {"/materials/rich/emissive/2", "-1", "/materials/rich/emissive/2: expected a number from 0 to 65504, found -1"},
      {"/materials/rich/alpha_mode", "\"masked\"",
       "/materials/rich/alpha_mode: expected one of \"opaque\", \"mask\", \"blend\", found \"masked\""},
      {"/materials/rich/alpha_cutoff", "2", "/materials/rich/alpha_cutoff: expected a number 0..1, found 2"},
      {"/materials/rich/alpha_cutoff", "\"0.5\"",
       "/materials/rich/alpha_cutoff: expected a number 0..1, found \"0.5\""},
      {"/materials/rich/double_sided", "1", "/materials/rich/double_sided: expected true or false, found 1"},
      {"/materials/rich/unlit", "\"yes\"", "/materials/rich/unlit: expected true or false, found \"yes\""},
      {"/materials/rich/base_texture", "\"wood\"", "/materials/rich/base_texture: expected an object, found \"wood\""},
      {"/materials/rich/base_texture/image", "\"iron\"",
       "/materials/rich/base_texture/image: expected the name of an image in /images, found \"iron\""},
      {"/materials/rich/base_texture/uv_set", "2",
       "/materials/rich/base_texture/uv_set: expected an integer 0..1, found 2"},
      {"/materials/rich/base_texture/wrap_u", "\"border\"",
       "/materials/rich/base_texture/wrap_u: expected one of \"repeat\", \"clamp\", \"mirror\", found \"border\""},
      {"/materials/rich/base_texture/magnify", "\"none\"",
       "/materials/rich/base_texture/magnify: expected one of \"nearest\", \"linear\", found \"none\""},
      {"/materials/rich/base_texture/mip", "true",
       "/materials/rich/base_texture/mip: expected one of \"none\", \"nearest\", \"linear\", found true"},
      {"/meshes/b/normals", "[0,0,1]",
       "/meshes/b/normals: expected an array of 12 numbers, 3 for each position, found an array of 3"},
      {"/meshes/b/normals", "[0,0]",
       "/meshes/b/normals: expected an array of numbers, three for each item, found an array of 2"},
      {"/meshes/b/normals/2", "null", "/meshes/b/normals/2: expected a number in a float's range, found null"},
      {"/meshes/b/normals/2", "0", "/meshes/b/normals: expected vectors with a length, found none at position 0"},
      {"/meshes/b/tangents/8", "1e-50", "no error"},
      {"/meshes/b/tangents/10", "0", "/meshes/b/tangents: expected vectors with a length, found none at position 2"},
      {"/meshes/b/tangents/11", "0.5", "/meshes/b/tangents: expected w of 1 or -1, found another at position 2"},
      {"/meshes/b/tangents", "[1,0,0]",
       "/meshes/b/tangents: expected an array of numbers, four for each item, found an array of 3"},
      {"/meshes/b/uv0", "[1,0]",
       "/meshes/b/uv0: expected an array of 8 numbers, 2 for each position, found an array of 2"},
      {"/meshes/b/uv1/3", "-1e39", "/meshes/b/uv1/3: expected a number in a float's range, found -1e+39"},
      {"/meshes/b/vertex_colors/7", "1.5", "/meshes/b/vertex_colors/7: expected a number 0..1, found 1.5"},
      {"/meshes/b/vertex_colors/5", "-1", "/meshes/b/vertex_colors/5: expected a number from 0 to 65504, found -1"},
      {"/meshes/b/vertex_colors", "[]",
       "/meshes/b/vertex_colors: expected an array of 16 numbers, 4 for each position, found an array of 0"},
      {"/meshes/b/materials", "\"rich\"", "/meshes/b/materials: expected an array, found \"rich\""},
      {"/meshes/b/materials", "[]",
       "/meshes/b/materials: expected one material, or \"material_of_triangle\" beside several, found an array of 0"},
      {"/meshes/b/materials/2", "\"gold\"",
       "/meshes/b/materials/2: expected the name of a material in /materials, found \"gold\""},
      {"/meshes/b/materials/2", "1", "/meshes/b/materials/2: expected a string, found 1"},
      {"/meshes/b/material_of_triangle", "[0,1]",
       "/meshes/b/material_of_triangle: expected an array of 3 numbers, one for each triangle, found an array of 2"},
      {"/meshes/b/material_of_triangle/1", "3", "/meshes/b/material_of_triangle/1: expected an integer 0..2, found 3"},
      {"/meshes/b/material_of_triangle/1", "-1",
       "/meshes/b/material_of_triangle/1: expected an integer 0..2, found -1"},
      {"/meshes/a/material_of_triangle", "0", "/meshes/a/material_of_triangle: expected an array, found 0"},
      {"/meshes/a/materials/0", "\"rich\"",
       "/meshes/a/materials/0: expected \"uv1\" in mesh \"a\", for the base_texture of material \"rich\", found none"},
      {"/frames/0/lights", "{}", "/frames/0/lights: expected an array, found an object"},
      {"/frames/0/lights/0/direction", "[0,0,0]",
       "/frames/0/lights/0/direction: expected a vector with a length, found none or an infinite one"},
      {"/frames/0/lights/1/color", "[1,1]",
       "/frames/0/lights/1/color: expected an array of 3 numbers, found an array of 2"},
      {"/frames/0/lights/1/color/0", "-1", "/frames/0/lights/1/color/0: expected a number from 0 to 65504, found -1"},
      {"/frames/0/ambient/sky", "1", "/frames/0/ambient/sky: expected an array of 3 numbers, found 1"},
      {"/frames/0/ambient/up", "[0,0,0]",
       "/frames/0/ambient/up: expected a vector with a length, found none or an infinite one"},
      {"/frames/0/draws/0/material", "\"gold\"",
       "/frames/0/draws/0/material: expected the name of a material in /materials, found \"gold\""},
      {"/frames/0/draws/0/kd", "[1,1,1]", "/frames/0/draws/0: expected either \"kd\" or \"material\", found both"},
      {"/frames/0/draws/1/material", "\"rich\"",
       "/frames/0/draws/1/material: expected \"uv1\" in mesh \"a\", for the base_texture of material \"rich\", found "
       "none"},
  };
  for (const Case& c : cases) {
    const std::string message(c.message);
    EXPECT_EQ(error_with(c.pointer, c.value), message == "no error" ? message : "scene.json: " + message)
        << c.pointer << " = " << c.value;
  }
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
  EXPECT_EQ(error_without("/frames/0/ambient", "sky"),
            "scene.json: /frames/0/ambient: expected the key \"sky\", found none");
  EXPECT_EQ(error_without("/frames/0/lights/0", "direction"),
            "scene.json: /frames/0/lights/0: expected the key \"direction\", found none");
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

TEST_F(SurfaceReaderTest, EachVersionHasItsOwnKeys) {
  Json json = valid_;
  json["beampipe_trace"] = 1;
  EXPECT_EQ(
      error_in(json),
      "scene.json: /images: expected one of the keys \"beampipe_trace\", \"meshes\", \"frames\", found \"images\"");
  json.erase("images");
  json.erase("materials");
  EXPECT_EQ(error_in(json),
            "scene.json: /meshes/b/normals: expected one of the keys \"positions\", \"indices\", \"colors\", found "
            "\"normals\"");
  EXPECT_EQ(error_with("/frames/0/light", "{\"direction\": [0,0,1]}").substr(0, 63),
            "scene.json: /frames/0/light: expected one of the keys \"width\", ");
}

TEST_F(SurfaceReaderTest, ImagesStayInTheFolderAsMeshesDo) {
  write("in/wood.png", read("art/wood.png"));
  write("wood.png", read("art/wood.png"));
  const auto error = [&](const std::string& file, bool allow_outside) {
    Json json = valid_;
    json["images"]["wood"]["file"] = file;
    return error_of([&] { read_trace(write("in/scene.json", json.dump()), {.allow_outside = allow_outside}); });
  };
  const std::string at = "in/scene.json: /images/wood/file: ";
  EXPECT_EQ(error("wood.png", false), "no error");
  EXPECT_EQ(error("../wood.png", false),
            at + "expected a path that stays in the trace's folder, found \"../wood.png\"");
  EXPECT_EQ(error("../wood.png", true), "no error");
  std::filesystem::create_symlink(path("wood.png"), path("in/link.png"));
  EXPECT_EQ(error("link.png", false), at + "expected a path that stays in the trace's folder, found \"link.png\"");
  EXPECT_EQ(error("missing.png", false), at + "expected an existing file, found \"missing.png\"");
  EXPECT_EQ(error(".", false), at + "expected a regular file, found \".\"");
  ASSERT_EQ(mkfifo(path("in/pipe.png").c_str(), 0666), 0);
  EXPECT_EQ(error("pipe.png", false), at + "expected a regular file, found \"pipe.png\"");
  EXPECT_EQ(error("/dev/zero", true), at + "expected a regular file, found \"/dev/zero\"");
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
