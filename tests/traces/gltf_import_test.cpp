#include <glm/gtc/matrix_transform.hpp>

#include "tests/traces/broken_values.h"
#include "tests/traces/difference.h"
#include "tests/traces/gltf_builder.h"
#include "tests/traces/test_folder.h"
#include "tests/traces/test_images.h"
#include "traces/files/model_import.h"
#include "traces/files/trace_images.h"

namespace beampipe::gltf_import_test {

using Json = nlohmann::json;
using Triangles = std::vector<glm::uvec3>;
using Vectors = std::vector<glm::vec3>;

class GltfImportTest : public FolderTest {
 protected:
  ImportedModel load(const GltfBuilder& gltf, const GltfOptions& options = {}) const {
    return read_gltf(write("model.gltf", gltf.text()), options);
  }
  // `frames` frames of the first animation.
  ImportedModel animate(const GltfBuilder& gltf, std::uint32_t frames) const {
    return load(gltf, {.frames = frames, .animation_if_any = true});
  }
  Mesh mesh(const GltfBuilder& gltf) const {
    const ImportedModel model = load(gltf);
    EXPECT_EQ(model.trace.meshes.size(), 1u);
    return model.trace.meshes.at(0);
  }
  std::string error(const GltfBuilder& gltf, const GltfOptions& options = {}) const {
    return error_of([&] { load(gltf, options); });
  }
  std::string error(const std::string& text) const {
    return error_of([&] { read_gltf(write("model.gltf", text), {}); });
  }
  // Each change to a sound file gives one line that names the place.
  void expect_broken(const GltfBuilder& sound, const std::vector<BrokenValue>& values) const {
    const auto error_in = [&](const Json& json) {
      GltfBuilder gltf = sound;
      gltf.json = json;
      return error(gltf);
    };
    expect_errors(sound.json, error_in, values, "model.gltf: ");
  }
};

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double distance = 1e-6) {
  EXPECT_LE(glm::distance(a, b), distance)
      << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

glm::vec3 first_position(const ImportedModel& model, std::size_t frame, std::size_t vertex = 0) {
  const Draw& draw = model.trace.frames.at(frame).draws.at(0);
  return glm::vec3(draw.transform * glm::dvec4(model.trace.meshes[draw.mesh].positions[vertex], 1.0));
}

TEST_F(GltfImportTest, ReadsATriangle) {
  const ImportedModel model = load(GltfBuilder());
  ASSERT_EQ(model.trace.meshes.size(), 1u);
  const Mesh& mesh = model.trace.meshes[0];
  EXPECT_EQ(mesh.positions, (Vectors{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}}));
  EXPECT_EQ(mesh.colors, (Vectors{{1, 1, 1}}));
  EXPECT_TRUE(mesh.normals.empty() && mesh.uvs[0].empty() && mesh.tangents.empty());
  ASSERT_EQ(model.trace.frames.size(), 1u);
  ASSERT_EQ(model.trace.frames[0].draws.size(), 1u);
  EXPECT_EQ(model.trace.frames[0].draws[0].transform, glm::dmat4(1.0));
  EXPECT_EQ(model.trace.frames[0].draws[0].cull, Cull::back);
  ASSERT_EQ(model.trace.materials.size(), 1u);  // glTF's default material
  EXPECT_EQ(model.trace.materials[0].metallic, 1.0f);
  EXPECT_EQ(model.trace.materials[0].roughness, 1.0f);
  EXPECT_EQ(mesh.materials, (std::vector<std::uint32_t>{0}));
  EXPECT_FALSE(model.has_camera);
  EXPECT_TRUE(model.not_read.empty());
}

TEST_F(GltfImportTest, ReadsBinaryFiles) {
  const GltfBuilder gltf;
  const std::string bytes = gltf.binary();
  EXPECT_EQ(read_gltf(write("model.glb", bytes), {}).trace.meshes[0].positions[1], glm::vec3(1, 0, 0));
  const std::size_t second = bytes.size() - gltf.buffer.size() - 8;
  const auto changed = [&](std::size_t at, std::size_t value) {
    std::string other = bytes;
    other.replace(at, 4, GltfBuilder::number(value));
    return error(other);
  };
  EXPECT_EQ(changed(4, 1), "model.gltf: expected version 2 of binary glTF, found version 1");
  const std::string longer = "model.gltf: expected chunks that fit into the file, found one that is longer";
  EXPECT_EQ(changed(second, gltf.buffer.size() + 4), longer);
  EXPECT_EQ(changed(second, 0xFFFFFFFF), longer);
  EXPECT_EQ(changed(12, 0xFFFFFFFC), longer);
  EXPECT_EQ(changed(8, bytes.size() + 4), longer);
  EXPECT_EQ(changed(16, 0), "model.gltf: expected a chunk of JSON first, found another one");
  EXPECT_EQ(changed(8, 12), "model.gltf: expected a chunk of JSON first, found none");
  EXPECT_EQ(error("glTF"), "model.gltf: expected a binary glTF file, found one that ends early");
}

TEST_F(GltfImportTest, ReadsIndicesOfAllTypes) {
  const std::vector<std::uint32_t> order = {2, 0, 1};
  for (int type : {5121, 5123, 5125}) {
    GltfBuilder gltf;
    const int index = type == 5121   ? gltf.add("SCALAR", type, std::vector<std::uint8_t>(order.begin(), order.end()))
                      : type == 5123 ? gltf.add("SCALAR", type, std::vector<std::uint16_t>(order.begin(), order.end()))
                                     : gltf.add("SCALAR", type, order);
    gltf.primitive()["indices"] = index;
    EXPECT_EQ(mesh(gltf).triangles, (Triangles{{2, 0, 1}})) << type;
  }
}

TEST_F(GltfImportTest, ReadsStripsAndFans) {
  GltfBuilder gltf;
  gltf.attributes()["POSITION"] = gltf.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
  gltf.primitive()["mode"] = 5;
  EXPECT_EQ(mesh(gltf).triangles, (Triangles{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  gltf.primitive()["mode"] = 6;
  EXPECT_EQ(mesh(gltf).triangles, (Triangles{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
  gltf.primitive()["mode"] = 4;  // two vertices are left over, and no triangle uses them
  EXPECT_EQ(mesh(gltf).positions.size(), 3u);
}

TEST_F(GltfImportTest, NamesWhatMakesNoTriangles) {
  GltfBuilder gltf;
  const Json points = {{"attributes", {{"POSITION", 0}}}, {"mode", 0}};
  const Json lines = {{"attributes", {{"POSITION", 0}}}, {"mode", 3}};
  for (const Json& other : {points, lines, lines}) gltf.json["meshes"][0]["primitives"].push_back(other);
  EXPECT_EQ(load(gltf).not_read, (NotRead{{"primitive of lines", 2}, {"primitive of points", 1}}));
  gltf.json["meshes"][0]["primitives"].erase(0);
  EXPECT_EQ(error(gltf),
            "model.gltf: expected at least one triangle in the scene, found none, but primitive of lines, primitive of "
            "points");
}

TEST_F(GltfImportTest, ReadsAttributesOfAllTypes) {
  GltfBuilder gltf;
  gltf.attributes()["NORMAL"] =
      gltf.add<std::int8_t>("VEC3", 5120, {0, 0, 127, 127, 0, 0, 0, -128, 0}, true);  // -128 is -1, too
  gltf.attributes()["TEXCOORD_0"] = gltf.add<std::uint8_t>("VEC2", 5121, {0, 255, 51, 102, 255, 0}, true);
  gltf.attributes()["TEXCOORD_1"] = gltf.add<std::uint16_t>("VEC2", 5123, {0, 65535, 13107, 0, 0, 0}, true);
  gltf.attributes()["COLOR_0"] = gltf.add<std::uint8_t>("VEC3", 5121, {255, 0, 51, 0, 255, 0, 0, 0, 255}, true);
  gltf.attributes()["TANGENT"] = gltf.floats("VEC4", {2, 0, 0, 1, 0, 1, 0, -1, 0, 0, 1, 1});
  const Mesh read = mesh(gltf);
  EXPECT_EQ(read.normals, (Vectors{{0, 0, 1}, {1, 0, 0}, {0, -1, 0}}));
  EXPECT_EQ(read.uvs[0], (std::vector<glm::vec2>{{0, 1}, {0.2f, 0.4f}, {1, 0}}));
  EXPECT_EQ(read.uvs[1], (std::vector<glm::vec2>{{0, 1}, {0.2f, 0}, {0, 0}}));
  EXPECT_EQ(read.vertex_colors, (std::vector<glm::vec4>{{1, 0, 0.2f, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}}));
  EXPECT_EQ(read.tangents, (std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 1, 0, -1}, {0, 0, 1, 1}}));
}

TEST_F(GltfImportTest, ReadsQuantizedAndInterleavedPositions) {
  GltfBuilder gltf;
  gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  gltf.attributes()["POSITION"] =
      gltf.add<std::int16_t>("VEC3", 5122, {9, 9, 9, 9, 1, 2, 3, 9, 4, 5, 6, 9, 7, 8, -9, 9});
  gltf.json["bufferViews"][1]["byteStride"] = 8;
  gltf.json["accessors"][1].update({{"byteOffset", 8}, {"count", 3}});
  EXPECT_EQ(mesh(gltf).positions, (Vectors{{1, 2, 3}, {4, 5, 6}, {7, 8, -9}}));
}

TEST_F(GltfImportTest, ReadsSparseAccessors) {
  GltfBuilder gltf;
  const int indices = gltf.add_view(std::string("\0\2", 2));
  const float values[] = {5, 6, 7, 8, 9, 10};
  const int view = gltf.add_view({reinterpret_cast<const char*>(values), sizeof values});
  const Json sparse = {{"count", 2},
                       {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                       {"values", {{"bufferView", view}}}};
  gltf.json["accessors"][0]["sparse"] = sparse;
  EXPECT_EQ(mesh(gltf).positions, (Vectors{{5, 6, 7}, {1, 0, 0}, {8, 9, 10}}));
  gltf.json["accessors"][0].erase("bufferView");
  EXPECT_EQ(mesh(gltf).positions, (Vectors{{5, 6, 7}, {0, 0, 0}, {8, 9, 10}}));
  gltf.buffer[gltf.json["bufferViews"][1]["byteOffset"].get<std::size_t>() + 1] = 3;
  EXPECT_EQ(error(gltf),
            "model.gltf: /accessors/0/sparse/indices: expected indices below 3 in ascending order, found 3 at 1");
  gltf.buffer[gltf.json["bufferViews"][1]["byteOffset"].get<std::size_t>() + 1] = 0;
  EXPECT_EQ(error(gltf),
            "model.gltf: /accessors/0/sparse/indices: expected indices below 3 in ascending order, found 0 at 1");
}

TEST_F(GltfImportTest, MendsNormalsWithoutALength) {
  GltfBuilder gltf;
  gltf.attributes()["NORMAL"] = gltf.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 0, 0});
  const ImportedModel model = load(gltf);
  EXPECT_EQ(model.trace.meshes[0].normals, (Vectors{{0, 0, 1}, {1, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(model.not_read, (NotRead{{"normal without a length", 2}}));
}

TEST_F(GltfImportTest, ReadsMaterials) {
  GltfBuilder gltf;
  gltf.attributes()["TEXCOORD_0"] = gltf.floats("VEC2", {0, 0, 1, 0, 0, 1});
  gltf.json["images"] = {{{"uri", "data:image/png;base64," + to_base64(kColors)}, {"name", "colours"}},
                         {{"bufferView", gltf.add_view(kHeights)}, {"mimeType", "image/png"}},
                         {{"uri", "sub/a%20b.png"}}};
  write("sub/a b.png", std::string(kGlass));
  gltf.json["samplers"] = {{{"magFilter", 9728}, {"minFilter", 9985}, {"wrapS", 33071}, {"wrapT", 33648}}};
  gltf.json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 1}}, {{"source", 2}}};
  gltf.json["materials"] = {
      {{"name", "paint"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.25, 0.5, 0.75, 0.125}},
         {"baseColorTexture", {{"index", 0}}},
         {"metallicFactor", 0.5},
         {"roughnessFactor", 0.25},
         {"metallicRoughnessTexture", {{"index", 1}, {"texCoord", 1}}}}},
       {"normalTexture", {{"index", 2}, {"scale", -2}}},
       {"occlusionTexture", {{"index", 0}}},
       {"emissiveFactor", {1, 0.5, 0}},
       {"emissiveTexture", {{"index", 0}}},
       {"extensions",
        {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}, {"KHR_materials_unlit", Json::object()}}},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.75},
       {"doubleSided", true}},
      {{"name", "not used"}}};
  gltf.primitive()["material"] = 0;
  const ImportedModel model = load(gltf);
  const Texture colours{.image = 0,
                        .wrap_u = Wrap::clamp,
                        .wrap_v = Wrap::mirror,
                        .magnify = Filter::nearest,
                        .minify = Filter::linear,
                        .mip = MipFilter::nearest};
  const Material expected{.name = "paint",
                          .base_color = {0.25f, 0.5f, 0.75f, 0.125f},
                          .base_texture = colours,
                          .metallic = 0.5f,
                          .roughness = 0.25f,
                          .metallic_roughness_texture = Texture{.image = 1, .uv_set = 1},
                          .normal_texture = Texture{.image = 2},
                          .normal_scale = -2.0f,
                          .emissive = {4, 2, 0},
                          .emissive_texture = colours,
                          .alpha_mode = AlphaMode::mask,
                          .alpha_cutoff = 0.75f,
                          .double_sided = true,
                          .unlit = true};
  EXPECT_EQ(difference(model.trace.materials, std::vector{expected}), "");
  ASSERT_EQ(model.trace.images.size(), 3u);
  EXPECT_EQ(model.trace.images[0].name, "colours");
  EXPECT_EQ(model.trace.images[0].texels,
            (std::vector<glm::u8vec4>{{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}}));
  EXPECT_EQ(model.trace.images[1].texels[2], glm::u8vec4(102, 102, 102, 255));
  EXPECT_EQ(model.trace.images[2].texels[0], glm::u8vec4(255, 255, 255, 10));
  const Mesh& read = model.trace.meshes[0];
  EXPECT_EQ(read.colors, (Vectors{{0.25f, 0.5f, 0.75f}}));
  EXPECT_EQ(read.uvs[1], std::vector<glm::vec2>(3, {0, 0}));  // the material uses coordinates that there are not
  EXPECT_EQ(model.trace.frames[0].draws[0].cull, Cull::none);
  EXPECT_EQ(model.not_read,
            (NotRead{{"occlusionTexture", 1}, {"texture on a primitive without texture coordinates", 1}}));
  // u runs along x and v along y, so that normal x tangent points towards larger v, which is down in the image.
  EXPECT_EQ(read.normals, Vectors(3, {0, 0, 1}));
  EXPECT_EQ(read.tangents, std::vector<glm::vec4>(3, {1, 0, 0, -1}));
}

GltfBuilder textured() {
  GltfBuilder gltf;
  gltf.attributes()["TEXCOORD_0"] = gltf.floats("VEC2", {0, 0, 1, 0, 0, 1});
  gltf.json["images"] = {{{"uri", "data:image/png;base64," + to_base64(kColors)}}};
  gltf.json["textures"] = {{{"source", 0}}};
  return gltf;
}

// Source of the first transform and of what it shows: the example of KHR_texture_transform.
TEST_F(GltfImportTest, TransformsTextureCoordinates) {
  GltfBuilder gltf = textured();
  gltf.attributes()["TEXCOORD_1"] = gltf.floats("VEC2", {0.5, 0.25, 0, 0, 0, 0});
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {"KHR_texture_transform"};
  const auto moved = [](const Json& transform, int set = 0) {
    return Json{{"index", 0}, {"texCoord", set}, {"extensions", {{"KHR_texture_transform", transform}}}};
  };
  const Json quadrant = {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}};
  gltf.primitive()["material"] = 0;
  Json& material = gltf.json["materials"][0];
  material["pbrMetallicRoughness"]["baseColorTexture"] = moved(quadrant);
  material["emissiveTexture"] = moved(quadrant);
  ImportedModel model = load(gltf);
  EXPECT_EQ(model.not_read, NotRead{});
  EXPECT_EQ(model.trace.materials[0].base_texture->uv_set, 0u);
  EXPECT_EQ(model.trace.materials[0].emissive_texture->uv_set, 0u);
  const auto expect_uvs = [&](std::size_t set, const std::vector<glm::dvec2>& expected) {
    const std::vector<glm::vec2>& found = model.trace.meshes[0].uvs[set];
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      for (int c = 0; c < 2; ++c) EXPECT_NEAR(found[i][c], expected[i][c], 1e-6) << set << ' ' << i << ' ' << c;
  };
  // The lower left quadrant of the image, turned clockwise: u runs up.
  expect_uvs(0, {{0, 1}, {0, 0.5}, {0.5, 1}});
  expect_uvs(1, {{0.5, 0.25}, {0, 0}, {0, 0}});

  // A texture without a transform keeps the set; the transform moves to the other one, whose set it reads.
  material["normalTexture"] = {{"index", 0}, {"texCoord", 0}};
  material["pbrMetallicRoughness"]["baseColorTexture"] = moved({{"scale", {2, -4}}, {"texCoord", 1}});
  material["emissiveTexture"] = moved({{"scale", {2, -4}}}, 1);
  model = load(gltf);
  EXPECT_EQ(model.not_read, NotRead{});
  EXPECT_EQ(model.trace.materials[0].normal_texture->uv_set, 0u);
  EXPECT_EQ(model.trace.materials[0].base_texture->uv_set, 1u);
  expect_uvs(0, {{0, 0}, {1, 0}, {0, 1}});
  expect_uvs(1, {{1, -1}, {0, 0}, {0, 0}});
  material["pbrMetallicRoughness"]["baseColorTexture"] = moved({{"offset", {3, 5}}});
  material.erase("emissiveTexture");
  model = load(gltf);
  EXPECT_EQ(model.trace.materials[0].base_texture->uv_set, 1u);
  expect_uvs(1, {{3, 5}, {4, 5}, {3, 6}});

  // There are no more than two sets.
  material["emissiveTexture"] = moved(quadrant);
  EXPECT_EQ(load(gltf).not_read, (NotRead{{"KHR_texture_transform beside two others", 1}}));
  const std::string place = "model.gltf: /materials/0/emissiveTexture/extensions/KHR_texture_transform";
  material["emissiveTexture"] = moved({{"scale", 2}});
  EXPECT_EQ(error(gltf), place + "/scale: expected two numbers, found another value");
  material["emissiveTexture"] = moved({{"rotation", 1e300}});
  EXPECT_EQ(error(gltf), place + "/rotation: expected a number from -1e9 to 1e9, found another value");
  material["emissiveTexture"] = moved({{"texCoord", 2}});
  EXPECT_EQ(load(gltf).not_read, (NotRead{{"texture with texCoord above 1", 1}}));
}

// glTF sets no limit to some factors; a trace does.
TEST_F(GltfImportTest, LimitsWhatATraceLimits) {
  GltfBuilder gltf = textured();
  gltf.json["materials"] = {{{"emissiveFactor", {1, 0.5, 0}},
                             {"normalTexture", {{"index", 0}, {"scale", -1e20}}},
                             {"alphaMode", "MASK"},
                             {"alphaCutoff", 1.5},
                             {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 100000}}}}}}};
  gltf.primitive()["material"] = 0;
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"color", {1, 0.5, 0}}, {"intensity", 1e6}}};
  gltf.json["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  gltf.json["scenes"][0]["nodes"] = {0, 1};
  const ImportedModel model = load(gltf);
  const Material& material = model.trace.materials[0];
  EXPECT_EQ(material.emissive, glm::vec3(kMostColor, 50000, 0));
  EXPECT_EQ(material.normal_scale, -kMostNormalScale);
  EXPECT_EQ(material.alpha_cutoff, 1.0f);  // nothing is visible, as alpha is nowhere as high as the cutoff of 1.5
  EXPECT_EQ(material.base_color.a, 0.0f);
  EXPECT_EQ(model.trace.frames[0].lighting.lights.at(0).color, glm::vec3(kMostColor, kMostColor, 0));
  EXPECT_EQ(model.not_read, (NotRead{{"light above 65504", 2}, {"normalTexture scale beyond 1000", 1}}));
  // The trace can be written and read again.
  write_trace(model.trace, path("limited.json"));
  EXPECT_EQ(read_trace(path("limited.json")).materials[0].normal_scale, -kMostNormalScale);
}

TEST_F(GltfImportTest, ReadsTheNodeHierarchy) {
  GltfBuilder gltf;
  const double half = std::sqrt(0.5);
  gltf.json["nodes"] = {{{"children", {1, 2}}, {"translation", {10, 0, 0}}, {"scale", {2, 2, 2}}},
                        {{"mesh", 0}, {"rotation", {0, 0, half, half}}},
                        {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 3, 0, 1}}},
                        {{"mesh", 0}}};  // not in the scene
  const ImportedModel model = load(gltf);
  EXPECT_EQ(model.trace.meshes.size(), 1u);  // shown twice, stored once
  const std::vector<Draw>& draws = model.trace.frames[0].draws;
  ASSERT_EQ(draws.size(), 2u);
  const auto place = [&](std::size_t draw, glm::dvec3 point) {
    return glm::dvec3(draws[draw].transform * glm::dvec4(point, 1.0));
  };
  expect_near(place(0, {1, 0, 0}), {10, 2, 0});
  expect_near(place(0, {0, 1, 0}), {8, 0, 0});
  expect_near(place(1, {1, 0, 0}), {8, 6, 0});
  EXPECT_EQ(draws[0].cull, Cull::back);
  EXPECT_EQ(draws[1].cull, Cull::front);  // mirrored: front faces are clockwise
}

TEST_F(GltfImportTest, ReadsCameras) {
  GltfBuilder gltf;
  const double half = std::sqrt(0.5);
  gltf.json["nodes"].push_back({{"camera", 0}, {"translation", {5, 1, 2}}, {"rotation", {0, half, 0, half}}});
  gltf.json["scenes"][0]["nodes"] = {0, 1};
  gltf.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}, {"zfar", 40}}}}};
  ImportedModel model = load(gltf, {.width = 200, .height = 100});
  EXPECT_TRUE(model.has_camera);
  const Frame& frame = model.trace.frames[0];
  ASSERT_TRUE(frame.camera);
  EXPECT_EQ(frame.camera->near, 0.25);
  EXPECT_EQ(frame.camera->far, 40);
  EXPECT_NEAR(frame.camera->fovy_deg, 0.5 * 180 / 3.14159265358979, 1e-9);
  EXPECT_EQ(frame.camera->eye, glm::dvec3(5, 1, 2));
  expect_near(glm::normalize(frame.camera->target - frame.camera->eye), {-1, 0, 0});  // -z, turned by 90 degrees
  expect_near(frame.camera->up, {0, 1, 0});
  EXPECT_NEAR(frame.projection[1][1], 1 / std::tan(0.25), 1e-9);
  EXPECT_NEAR(frame.projection[0][0], 0.5 / std::tan(0.25), 1e-9);

  gltf.json["cameras"][0]["perspective"].erase("zfar");  // to infinity; the model ends 5 away
  EXPECT_NEAR(load(gltf).trace.frames[0].camera->far, 5.05, 1e-9);

  gltf.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 9}, {"ymag", 2}, {"znear", 1}, {"zfar", 11}}}}};
  model = load(gltf, {.width = 200, .height = 100});
  const glm::dmat4 whole = model.trace.frames[0].projection * model.trace.frames[0].view;
  EXPECT_FALSE(model.trace.frames[0].camera);
  expect_near(glm::dvec3(whole * glm::dvec4(4, 3, 2, 1)), {0, 1, -1});   // at znear, on the upper edge
  expect_near(glm::dvec3(whole * glm::dvec4(-6, 1, -2, 1)), {1, 0, 1});  // at zfar, on the right edge: 200 / 100 * ymag

  expect_broken(gltf,
                {{"/cameras/0", R"({"type": "perspective", "perspective": {"yfov": 4, "znear": 0.25, "zfar": 40}})",
                  "expected yfov between 0 and pi, and znear above 0, found others"},
                 {"/cameras/0", R"({"type": "perspective", "perspective": {"yfov": 1, "znear": 4, "zfar": 4}})",
                  "expected znear of 0 and up, and zfar above it, found others"}});
}

TEST_F(GltfImportTest, ReadsDirectionalLights) {
  GltfBuilder gltf;
  const double half = std::sqrt(0.5);
  const auto light = [](int index) { return Json{{"KHR_lights_punctual", {{"light", index}}}}; };
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"color", {1, 0.5, 0}}, {"intensity", 2}}, {{"type", "point"}}};
  gltf.json["nodes"].push_back({{"rotation", {-half, 0, 0, half}}, {"extensions", light(0)}});
  gltf.json["nodes"].push_back({{"extensions", light(1)}});
  gltf.json["scenes"][0]["nodes"] = {0, 1, 2};
  const ImportedModel model = load(gltf);
  const std::vector<Light>& lights = model.trace.frames[0].lighting.lights;
  ASSERT_EQ(lights.size(), 1u);
  expect_near(lights[0].direction, {0, -1, 0});
  expect_near(lights[0].color, glm::dvec3(2, 1, 0) / 3.14159265358979);
  EXPECT_FALSE(model.trace.frames[0].lighting.ambient);
  EXPECT_EQ(model.not_read, (NotRead{{"point light", 1}}));
  gltf.json["nodes"][2]["extensions"] = light(2);
  EXPECT_EQ(error(gltf), "model.gltf: /nodes/2/extensions/KHR_lights_punctual: expected one of the 2 lights, found 2");
}

// A file whose node 0 is animated over 4 seconds: `path` is `values` with this interpolation.
GltfBuilder animated(const std::string& path, const std::string& type, const std::string& interpolation,
                     const std::vector<float>& times, const std::vector<float>& values) {
  GltfBuilder gltf;
  const int input = gltf.floats("SCALAR", times), output = gltf.floats(type, values);
  gltf.json["animations"] = {
      {{"name", "walk"},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}},
       {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}}}};
  return gltf;
}

TEST_F(GltfImportTest, PlaysAnimations) {
  const std::vector<float> positions = {1, 0, 0, 5, 8, 0};
  const GltfBuilder linear = animated("translation", "VEC3", "LINEAR", {0, 4}, positions);
  const ImportedModel model = animate(linear, 4);  // at 0, 1, 2 and 3 of 4 seconds
  ASSERT_EQ(model.trace.frames.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) expect_near(first_position(model, i), {1.0 + i, 2.0 * i, 0});
  EXPECT_EQ(model.trace.meshes.size(), 1u);
  EXPECT_EQ(load(linear).trace.frames.size(), 1u);
  expect_near(first_position(load(linear), 0), {0, 0, 0});  // at rest

  const ImportedModel step = animate(animated("translation", "VEC3", "STEP", {1, 4}, positions), 2);
  expect_near(first_position(step, 0), {1, 0, 0});  // before the first key
  expect_near(first_position(step, 1), {1, 0, 0});

  // Hermite's spline from 0 to 8 over 4 seconds with the slopes 2 and 0: at 1/2 it is 4 + 4 * 2 / 8.
  const std::vector<float> spline = {9, 9, 9, 0, 0, 0, 2, 0, 0, 0, 0, 0, 8, 0, 0, 9, 9, 9};
  const ImportedModel cubic = animate(animated("translation", "VEC3", "CUBICSPLINE", {0, 4}, spline), 2);
  expect_near(first_position(cubic, 0), {0, 0, 0});
  expect_near(first_position(cubic, 1), {5, 0, 0});

  // From 0 to 90 degrees about z, of which the second key names the long way round.
  const float half = std::sqrt(0.5f);
  const ImportedModel turn =
      animate(animated("rotation", "VEC4", "LINEAR", {0, 4}, {0, 0, 0, 1, 0, 0, -half, -half}), 2);
  expect_near(first_position(turn, 1, 1), {half, half, 0});
  const ImportedModel scale = animate(animated("scale", "VEC3", "LINEAR", {0, 4}, {1, 1, 1, 3, 1, 1}), 2);
  expect_near(first_position(scale, 1, 1), {2, 0, 0});
}

TEST_F(GltfImportTest, ChoosesAnimationsByNameAndNumber) {
  GltfBuilder gltf = animated("translation", "VEC3", "STEP", {0}, {1, 0, 0});
  gltf.json["animations"].push_back(gltf.json["animations"][0]);
  gltf.json["animations"][1]["name"] = "run";
  gltf.json["animations"][1]["samplers"][0]["output"] = gltf.floats("VEC3", {7, 0, 0});
  for (const auto& [name, x] : std::map<std::string, double>{{"walk", 1}, {"0", 1}, {"run", 7}, {"1", 7}})
    expect_near(first_position(load(gltf, {.animation = name}), 0), {x, 0, 0});
  EXPECT_EQ(error(gltf, {.animation = "fly"}),
            "model.gltf: expected the name of one of the 2 animations, or its number from 0, found \"fly\"");
  EXPECT_EQ(error(GltfBuilder(), {.animation = "fly"}), "model.gltf: expected an animation, found none");
}

TEST_F(GltfImportTest, RefusesBrokenAnimations) {
  const std::vector<float> two = {0, 0, 0, 1, 0, 0};
  GltfBuilder matrix = animated("translation", "VEC3", "LINEAR", {0, 1}, two);
  matrix.node()["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const std::pair<GltfBuilder, const char*> cases[] = {
      {animated("translation", "VEC3", "LINEAR", {0, 0}, two),
       "/accessors/1: expected times of 0 and up in ascending order, found another one in element 1"},
      {animated("translation", "VEC3", "LINEAR", {0, 1, 2}, two),
       "/accessors/2: expected 1 elements for each of 3 keys, found 2"},
      {animated("translation", "VEC3", "CUBICSPLINE", {0, 1}, two),
       "/accessors/2: expected 3 elements for each of 2 keys, found 2"},
      {animated("rotation", "VEC4", "LINEAR", {0}, {0, 0, 0, 0}),
       "/accessors/2: expected a rotation, found a quaternion without a length"},
      {animated("weights", "SCALAR", "LINEAR", {0}, {1}),
       "/nodes/0: expected morph targets, because weights are animated, found none"},
      {animated("translation", "VEC3", "SPLINE", {0, 1}, two),
       "/animations/0/samplers/0/interpolation: expected LINEAR, STEP or CUBICSPLINE, found \"SPLINE\""},
      {matrix, "/nodes/0: expected no matrix, because it is animated, found one"}};
  for (const auto& [gltf, expected] : cases)
    EXPECT_EQ(error(gltf, {.animation = "0"}), std::string("model.gltf: ") + expected);
}

TEST_F(GltfImportTest, MorphsMeshes) {
  GltfBuilder gltf = animated("weights", "SCALAR", "LINEAR", {0, 4}, {0, 0, 1, 0.5f});
  gltf.attributes()["NORMAL"] = gltf.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int up = gltf.floats("VEC3", {0, 0, 2, 0, 0, 0, 0, 0, 0}),
            right = gltf.floats("VEC3", {4, 0, 0, 0, 0, 0, 0, 0, 0});
  const int bend = gltf.floats("VEC3", {2, 0, -1, 0, 0, 0, 0, 0, 0});
  gltf.primitive()["targets"] = {{{"POSITION", up}, {"NORMAL", bend}}, {{"POSITION", right}}};
  const ImportedModel model = animate(gltf, 4);
  ASSERT_EQ(model.trace.frames.size(), 4u);
  EXPECT_EQ(model.trace.meshes.size(), 4u);
  EXPECT_EQ(first_position(model, 0), glm::vec3(0));
  EXPECT_EQ(first_position(model, 2), glm::vec3(1, 0, 1));  // half of `up` and a quarter of `right`
  expect_near(model.trace.meshes[model.trace.frames[2].draws[0].mesh].normals[0],
              glm::normalize(glm::dvec3(1, 0, 0.5)));

  gltf.json["meshes"][0]["weights"] = {0.0, 0.5};  // at rest
  EXPECT_EQ(first_position(load(gltf), 0), glm::vec3(2, 0, 0));
  gltf.node()["weights"] = {1.0, 0.0};
  EXPECT_EQ(first_position(load(gltf), 0), glm::vec3(0, 0, 2));
  gltf.node()["weights"] = {1.0};
  EXPECT_EQ(error(gltf), "model.gltf: /nodes/0/weights: expected 2 finite numbers, found others");
  gltf.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}});
  gltf.node().erase("weights");
  EXPECT_EQ(error(gltf),
            "model.gltf: /meshes/0/primitives/1: expected 2 morph targets, as the first primitive has, found 0");
}

// Two joints at the origin, of which the second turns by 90 degrees about z. The mesh's own node does not count.
GltfBuilder skinned() {
  GltfBuilder gltf;
  const float half = std::sqrt(0.5f);
  gltf.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 100, 100}}},
                        {{"children", {2}}, {"translation", {0, 0, 5}}},
                        {{"rotation", {0, 0, half, half}}}};
  gltf.json["scenes"][0]["nodes"] = {0, 1};
  gltf.json["skins"] = {{{"joints", {1, 2}}}};
  gltf.attributes()["POSITION"] = gltf.floats("VEC3", {1, 0, 0, 1, 0, 0, 1, 0, 0});
  gltf.attributes()["NORMAL"] = gltf.floats("VEC3", {1, 0, 0, 1, 0, 0, 1, 0, 0});
  gltf.attributes()["JOINTS_0"] = gltf.add<std::uint8_t>("VEC4", 5121, {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
  gltf.attributes()["WEIGHTS_0"] =
      gltf.add<std::uint8_t>("VEC4", 5121, {255, 0, 0, 0, 255, 0, 0, 0, 51, 51, 0, 0}, true);
  return gltf;
}

TEST_F(GltfImportTest, SkinsMeshes) {
  GltfBuilder gltf = skinned();
  const ImportedModel model = load(gltf);
  EXPECT_EQ(model.trace.frames[0].draws[0].transform, glm::dmat4(1.0));
  expect_near(first_position(model, 0, 0), {1, 0, 5});
  expect_near(first_position(model, 0, 1), {0, 1, 5});
  expect_near(first_position(model, 0, 2), {0.5, 0.5, 5});  // weights of 0.2 are made ones of 0.5
  expect_near(model.trace.meshes[0].normals[1], {0, 1, 0});
  expect_near(model.trace.meshes[0].normals[2], glm::normalize(glm::dvec3(1, 1, 0)));

  std::vector<float> matrices(32, 0.0f);  // the second joint was at (1, 0, 0) when it was bound
  for (std::size_t i : {0u, 5u, 10u, 15u}) matrices[i] = matrices[16 + i] = 1;
  matrices[16 + 12] = -1;
  gltf.json["skins"][0]["inverseBindMatrices"] = gltf.floats("MAT4", matrices);
  expect_near(first_position(load(gltf), 0, 1), {0, 0, 5});
  gltf.json["skins"][0]["joints"] = {1, 2, 1};
  EXPECT_NE(error(gltf).find("expected a matrix for each joint, found 2"), std::string::npos);
}

TEST_F(GltfImportTest, RefusesBrokenSkins) {
  GltfBuilder gltf = skinned();
  expect_broken(gltf, {{"/skins/0/joints", "[1]",
                        "/meshes/0/primitives/0: expected vertices with one of 1 joints, found joint 1"},
                       {"/skins/0/joints", "[1, 9]", "expected one of the 3 nodes, found 9"},
                       {"/nodes/0/skin", "1", "expected one of the 1 skins, found 1"}});
  gltf.attributes().erase("WEIGHTS_0");
  EXPECT_EQ(error(gltf),
            "model.gltf: /meshes/0/primitives/0/attributes: expected WEIGHTS_0 beside JOINTS_0, found none");
  gltf = skinned();
  gltf.attributes()["WEIGHTS_0"] = gltf.floats("VEC4", std::vector<float>(12, 0.0f));
  EXPECT_EQ(error(gltf),
            "model.gltf: /meshes/0/primitives/0: expected vertices with weights above 0, found one without");
}

TEST_F(GltfImportTest, NamesExtensionsThatAreNotRead) {
  GltfBuilder gltf;
  gltf.json["extensionsUsed"] = {"KHR_materials_unlit", "KHR_materials_clearcoat"};
  EXPECT_EQ(load(gltf).not_read, (NotRead{{"extension KHR_materials_clearcoat", 1}}));
  gltf.json["extensionsRequired"] = {"KHR_materials_clearcoat"};
  EXPECT_EQ(error(gltf),
            "model.gltf: /extensionsRequired: expected only extensions that beampipe reads, found "
            "\"KHR_materials_clearcoat\"");
}

// tinygltf repeats texts of the file in its messages, and this one looks like its own about a file.
TEST_F(GltfImportTest, TextsInTheFileAreNotTakenForErrors) {
  GltfBuilder gltf;
  gltf.json["accessors"][0]["type"] = "File read error";
  EXPECT_EQ(error(gltf).find("model.gltf: expected a glTF 2.0 file, found one that tinygltf refuses: "), 0u)
      << error(gltf);
}

TEST_F(GltfImportTest, FilesStayInTheFolder) {
  GltfBuilder gltf;
  const std::string bytes(36, '\0');
  write("outside.bin", bytes);
  write("sub/inside.bin", bytes);
  const auto error_with = [&](const std::string& uri, std::size_t size = 36) {
    gltf.json["buffers"] = {{{"byteLength", size}, {"uri", uri}}};
    write("sub/model.gltf", gltf.text());
    return error_of([&] { read_gltf(path("sub/model.gltf"), {}); });
  };
  EXPECT_EQ(error_with("inside.bin"), "no error");
  const std::string start = "sub/model.gltf: expected a file in the model's folder, found ";
  EXPECT_EQ(error_with("../outside.bin"), start + "\"../outside.bin\"");
  EXPECT_EQ(error_with("..%2Foutside.bin"), start + "\"../outside.bin\"");
  EXPECT_EQ(error_with("."), "sub/model.gltf: .: expected a readable file, found a folder");
  EXPECT_EQ(
      error_with("inside.bin", 99).find("sub/model.gltf: expected a glTF 2.0 file, found one that tinygltf refuses"),
      0u);
  std::filesystem::create_symlink(path("outside.bin"), path("sub/link.bin"));
  EXPECT_NE(error_with("link.bin"), "no error");
  EXPECT_EQ(error_of([&] { read_gltf(path("sub/model.gltf"), {.follow_links = true}); }), "no error");
  EXPECT_EQ(error_with("data:application/octet-stream;base64,!!!").find('\n'), std::string::npos);
}

TEST_F(GltfImportTest, NamesImagesThatCannotBeRead) {
  GltfBuilder gltf;
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  const auto error_with = [&](const Json& image) {
    gltf.json["images"] = {image};
    return error(gltf);
  };
  EXPECT_EQ(error_with({{"uri", "none.png"}}), "no error");  // no triangle uses the material
  gltf.primitive()["material"] = 0;
  EXPECT_EQ(error_with({{"uri", "none.png"}}), "model.gltf: /images/0: none.png: expected a readable file, found none");
  EXPECT_EQ(error_with({{"uri", "../none.png"}}),
            "model.gltf: /images/0: expected a file in the model's folder, found \"../none.png\"");
  EXPECT_EQ(error_with({{"bufferView", 9}}).find('\n'), std::string::npos);
  const int view = gltf.add_view("no image");
  EXPECT_EQ(error_with({{"bufferView", view}, {"mimeType", "image/png"}}).find("model.gltf: /images/0: expected a"),
            0u);
  gltf.json["bufferViews"][static_cast<std::size_t>(view)]["byteOffset"] = 1 << 30;
  EXPECT_EQ(error_with({{"bufferView", view}, {"mimeType", "image/png"}}).find("model.gltf: /bufferViews/1: expected"),
            0u);
  gltf.json["textures"] = {{{"source", 1}}};
  EXPECT_EQ(error_with({{"uri", "none.png"}}), "model.gltf: /textures/0: expected one of the 1 images, found 1");
  gltf.json["textures"] = Json::array();
  EXPECT_EQ(error_with({{"uri", "none.png"}}),
            "model.gltf: /materials/0/pbrMetallicRoughness/baseColorTexture: expected one of the 0 textures, found 0");
}

TEST_F(GltfImportTest, SaysWhatIsWrong) {
  GltfBuilder gltf;
  expect_broken(
      gltf,
      {{"/asset/version", "\"1.0\"", "expected glTF of version 2, found \"1.0\""},
       {"/scene", "1", "expected one of the 1 scenes, found 1"},
       {"/scenes/0/nodes", "[7]", "expected one of the 1 nodes, found 7"},
       {"/nodes", R"([{"mesh": 0}, {"children": [0]}])",
        "/scenes/0/nodes: expected nodes without a parent, found node 0"},
       {"/nodes", R"([{"children": [1]}, {"children": [0]}])",
        "expected a hierarchy, found nodes that are in themselves"},
       {"/nodes/0/children", "[0]", "/nodes: expected a hierarchy, found nodes that are in themselves"},
       {"/nodes", R"([{"children": [1, 1]}, {"name": "child"}])",
        "/nodes/0/children: expected nodes without another parent, found node 1"},
       {"/nodes/0/children", "[4]", "expected one of the 1 nodes, found 4"},
       {"/nodes/0/mesh", "3", "expected one of the 1 meshes, found 3"},
       {"/nodes/0/mesh", "\"0\"", "expected an integer from 0 to 2147483647, found \"0\""},
       {"/nodes/0/mesh", "4294967296", "expected an integer from 0 to 2147483647, found 4294967296"},
       {"/nodes/0/translation", "[1, 2]", "expected an array of 3 numbers, found an array of 2"},
       {"/nodes/0/translation", R"([1, 2, "3"])", "expected an array of 3 numbers, found an array of 3"},
       {"/nodes/0/scale", "[1, 1e300, 1]", "expected 3 finite numbers, found others"},
       {"/nodes/0/rotation", "[0, 0, 0, 0]", "expected a rotation, found a quaternion without a length"},
       {"/nodes/0/matrix", "[1, 2, 3]", "expected an array of 16 numbers, found an array of 3"},
       {"/meshes/0/primitives/0", "{}", "/meshes/0/primitives: expected objects with \"attributes\", found others"},
       {"/meshes/0/primitives/0/mode", "7", "expected a mode from 0 to 6, found 7"},
       {"/meshes/0/primitives/0/attributes/POSITION", "5", "expected one of the 1 accessors, found 5"},
       {"/meshes/0/primitives/0/material", "0", "expected one of the 0 materials, found 0"},
       {"/accessors/0/count", "-1", "expected an integer of 0 and up, found -1"},
       {"/accessors/0/count", "0", "/accessors/0: expected at least one element, found none"},
       {"/accessors/0/count", "4",
        "/accessors/0: expected elements in their bufferView of 36 bytes, found 4 of 12 bytes from byte 0"},
       {"/accessors/0/count", "18446744073709551615",
        "/accessors/0: expected elements in their bufferView of 36 bytes, found 18446744073709551615 of 12 bytes "
        "from byte 0"},
       {"/accessors/0/byteOffset", "18446744073709551612",
        "/accessors/0: expected elements in their bufferView of 36 bytes, found 3 of 12 bytes from byte "
        "18446744073709551612"},
       {"/accessors/0", R"({"componentType": 5126, "count": 99999999999, "type": "VEC3"})",
        "expected at most 67108864 elements without a bufferView, found 99999999999"},
       {"/accessors/0/bufferView", "2", "/accessors/0: expected one of the 1 bufferViews, found 2"},
       {"/bufferViews/0/byteLength", "37", "/bufferViews/0: expected bytes in its buffer of 36, found others"},
       {"/bufferViews/0/byteOffset", "18446744073709551615",
        "/bufferViews/0: expected bytes in its buffer of 36, found others"},
       {"/bufferViews/0/buffer", "1", "/bufferViews/0: expected one of the 1 buffers, found 1"},
       {"/bufferViews/0/byteStride", "4", "/bufferViews/0: expected a byteStride of at least 12, found 4"}});
  gltf.json["materials"] = {Json::object()};
  gltf.primitive()["material"] = 0;
  expect_broken(gltf, {{"/materials/0/pbrMetallicRoughness/baseColorFactor", "[1, 1, 1]",
                        "expected an array of 4 numbers, found an array of 3"},
                       {"/materials/0/pbrMetallicRoughness/metallicFactor", "2",
                        "expected a number from 0 to 1, found another one"},
                       {"/materials/0/alphaMode", "\"GLASS\"", "expected OPAQUE, MASK or BLEND, found \"GLASS\""}});

  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::tuple<const char*, const char*, std::vector<float>, const char*> accessors[] = {
      {"/attributes/TEXCOORD_0", "VEC2", {0, 0, 1, 1}, "3 elements, as POSITION has, found 2"},
      {"/attributes/TEXCOORD_0", "VEC3", std::vector<float>(9), "the type VEC2, found VEC3"},
      {"/attributes/POSITION", "VEC3", {0, 0, 0, 1, 0, 0, 0, nan, 0}, "finite numbers, found another one in element 2"},
      {"/attributes/NORMAL", "VEC3", {nan, 0, 0, 1, 0, 0, 0, 1, 0}, "finite numbers, found another one in element 0"},
      {"/indices", "SCALAR", {0, 1, 2}, "unsigned integers, found others"}};
  for (const auto& [place, type, numbers, expected] : accessors) {
    gltf = GltfBuilder();
    gltf.primitive()[Json::json_pointer(place)] = gltf.floats(type, numbers);
    EXPECT_EQ(error(gltf), std::string("model.gltf: /accessors/1: expected ") + expected);
  }
  gltf = GltfBuilder();
  gltf.primitive()["indices"] = gltf.add<std::uint8_t>("SCALAR", 5121, {0, 3, 1});
  EXPECT_EQ(error(gltf), "model.gltf: /accessors/1: expected indices of 3 vertices, found 3 in element 1");
  gltf = GltfBuilder();
  gltf.primitive()["targets"] = {
      {{"POSITION", gltf.floats("VEC3", std::vector<float>(9, std::numeric_limits<float>::max()))}}};
  gltf.node()["weights"] = {2};
  EXPECT_EQ(error(gltf),
            "model.gltf: /meshes/0/primitives/0: expected finite positions after skinning and morphing, found others");
  gltf = GltfBuilder();
  const Json scale = {1e38, 1e38, 1e38};
  for (int i = 1; i < 20; ++i) gltf.json["nodes"].push_back({{"scale", scale}, {"children", {(i + 1) % 20}}});
  gltf.json["scenes"][0]["nodes"] = {1};  // overflows somewhere down the chain
  EXPECT_NE(error(gltf).find("expected a finite transform, found another one"), std::string::npos) << error(gltf);
  gltf.json.erase("asset");
  EXPECT_EQ(error(gltf), "model.gltf: /asset/version: expected glTF of version 2, found none");

  EXPECT_EQ(error("{").find("model.gltf: byte "), 0u);
  EXPECT_EQ(error(std::string(100000, '[')).find('\n'), std::string::npos);
  EXPECT_NE(error(R"({"asset": {"version": "2.0", "extras": )" + std::string(100000, '[') + "}}"), "no error");
  EXPECT_EQ(error("").find("model.gltf: byte 1: expected valid JSON"), 0u);
}

TEST_F(GltfImportTest, ImagesHaveALimitTogether) {
  Trace trace;
  TextureImage image;
  image.width = 16384;
  image.height = 8192;  // without its texels, which would take half a GiB
  EXPECT_EQ(add_image(trace, image, "here"), 0u);
  EXPECT_EQ(add_image(trace, image, "here"), 1u);
  image.width = image.height = 1;
  EXPECT_EQ(error_of([&] { add_image(trace, image, "here"); }),
            "here: expected images of at most 268435456 texels together, found 268435457");
}

TEST_F(GltfImportTest, SmallFilesDoNotTakeLargeMemory) {
  GltfBuilder gltf;
  gltf.json["accessors"][0] = {{"componentType", 5126}, {"count", 60'000'000}, {"type", "VEC3"}};
  for (int i = 0; i < 10; ++i) gltf.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}});
  gltf.primitive()["indices"] = gltf.add<std::uint32_t>("SCALAR", 5125, {59'999'999, 3, 5});
  for (int i = 1; i <= 10; ++i) gltf.primitive(static_cast<std::size_t>(i))["indices"] = 1;
  const ImportedModel model = load(gltf);
  EXPECT_EQ(model.trace.meshes[0].positions.size(), 3u);  // of the vertices in use
  GltfBuilder frames = animated("translation", "VEC3", "LINEAR", {0, 4}, {0, 0, 0, 1, 1, 1});
  for (int i = 0; i < 200; ++i) frames.json["meshes"][0]["primitives"].push_back(frames.primitive());
  EXPECT_EQ(error_of([&] { animate(frames, 100000); }),
            "model.gltf: expected at most 10000000 draws, over all frames, found more");
}

}  // namespace beampipe::gltf_import_test
