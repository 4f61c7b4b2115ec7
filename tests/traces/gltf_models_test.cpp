// Reads glTF models that other programs wrote (tests/traces/gltf_models.h). Prints a table of what came of them.
#include "tests/traces/gltf_models.h"

#include <chrono>
#include <cstdio>

#include "tests/traces/test_folder.h"
#include "traces/files/model_import.h"

namespace beampipe::gltf_models_test {

void expect_sound(const Trace& trace, const std::string& name) {
  EXPECT_FALSE(trace.frames.empty()) << name;
  for (const Mesh& mesh : trace.meshes) {
    const std::size_t vertices = mesh.positions.size();
    EXPECT_EQ(mesh.colors.size(), mesh.triangles.size()) << name;
    EXPECT_EQ(mesh.materials.size(), mesh.triangles.size()) << name;
    EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == vertices) << name;
    for (const glm::uvec3& t : mesh.triangles) EXPECT_LT(std::max({t.x, t.y, t.z}), vertices) << name;
    for (std::uint32_t material : mesh.materials) ASSERT_LT(material, trace.materials.size()) << name;
    for (std::uint32_t material : mesh.materials) {
      const auto& base = trace.materials[material].base_texture;
      if (base) {
        EXPECT_EQ(mesh.uvs[base->uv_set].size(), vertices) << name;
      }
    }
  }
}

TEST(GltfModelsTest, EachModelIsReadOrGivesOneLine) {
  if (!std::filesystem::exists(kModels)) GTEST_SKIP() << "Debian's package assimp-testmodels is not installed";
  std::size_t read = 0, refused = 0;
  std::printf("%-52s %9s %9s %6s %6s %7s  result\n", "model", "triangles", "materials", "images", "frames", "seconds");
  for (const std::filesystem::path& file : models_in(kModels)) {
    const std::string name = file.lexically_relative(kModels).string();
    ImportedModel model;
    std::string result = "read";
    const auto start = std::chrono::steady_clock::now();
    try {
      model = read_gltf(file, {.frames = 8, .animation_if_any = true});
      ++read;
      for (const auto& [what, count] : model.not_read) result += (result == "read" ? ", without " : ", ") + what;
      expect_sound(model.trace, name);
    } catch (const TraceError& error) {
      ++refused;
      result = error.what();
      EXPECT_EQ(result.find(file.string() + ": "), 0u) << result;
      EXPECT_NE(result.find("expected"), std::string::npos) << result;
      EXPECT_EQ(result.find('\n'), std::string::npos) << result;
      result.erase(0, file.string().size() + 2);
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::size_t triangles = 0;
    if (!model.trace.frames.empty()) {
      for (const Draw& draw : model.trace.frames[0].draws) triangles += model.trace.meshes[draw.mesh].triangles.size();
    }
    std::printf("%-52.52s %9zu %9zu %6zu %6zu %7.3f  %s\n", name.c_str(), triangles, model.trace.materials.size(),
                model.trace.images.size(), model.trace.frames.size(), seconds.count(), result.c_str());
  }
  std::printf("%zu models are read, %zu refused\n", read, refused);
  EXPECT_GE(read, 24u);
}

// What the models' makers say is in them.
TEST(GltfModelsTest, KnownModelsHaveWhatTheyShould) {
  if (!std::filesystem::exists(kModels)) GTEST_SKIP() << "Debian's package assimp-testmodels is not installed";
  const ImportedModel box = read_gltf(kModels / "BoxTextured-glTF-Binary/BoxTextured.glb", {});
  ASSERT_EQ(box.trace.images.size(), 1u);
  EXPECT_EQ(box.trace.images[0].width, 211u);
  EXPECT_EQ(box.trace.meshes.at(0).triangles.size(), 12u);
  const ImportedModel skin =
      read_gltf(kModels / "simple_skin/simple_skin.gltf", {.frames = 4, .animation_if_any = true});
  // The Khronos tutorial's strip from y = 0 to 2, which its joints move by -0.5 along x. It bends to both sides in 5.5
  // seconds.
  ASSERT_EQ(skin.trace.frames.size(), 4u);
  const auto top = [&](std::size_t frame) {
    return skin.trace.meshes[skin.trace.frames[frame].draws[0].mesh].positions.at(8);
  };
  EXPECT_EQ(top(0), glm::vec3(-0.5f, 2, 0));
  EXPECT_LT(top(1).x, -0.75f);
  EXPECT_GT(top(3).x, 0.5f);
  const ImportedModel cube = read_gltf(kModels / "glTF-Sample-Models/AnimatedMorphCube-glTF/AnimatedMorphCube.gltf",
                                       {.frames = 3, .animation_if_any = true});
  EXPECT_EQ(cube.trace.meshes.size(), 3u);
}

}  // namespace beampipe::gltf_models_test
