// Pictures of the glTF models of tests/traces/gltf_models.h, in the view that `make` chooses.

#include "pipeline/technique.h"
#include "tests/test.h"
#include "tests/traces/gltf_models.h"
#include "tools/cli/framing.h"
#include "traces/files/model_import.h"
#include "traces/files/trace_io.h"

namespace beampipe::model_pictures_test {

constexpr std::uint32_t kSize = 32;  // of the pictures, in pixels

// A model as `make` shows it, with light from all around. Nothing if it cannot be read or has no triangles.
std::optional<Trace> shown(const std::filesystem::path& file) {
  try {
    ImportedModel model = read_gltf(file, {.width = kSize, .height = kSize, .animation_if_any = true});
    Trace& trace = model.trace;
    if (!model.has_camera) set_camera(trace.frames.at(0), frame_model(trace, kSize, kSize, {}));
    trace.frames[0].lighting.ambient = Ambient{glm::vec3(1.0f), glm::vec3(0.5f)};
    return std::move(trace);
  } catch (const TraceError&) {
    return {};
  } catch (const std::invalid_argument&) {
    return {};
  }
}

TEST(ModelPictures, AreFiniteAndShowTheModel) {
  if (!std::filesystem::exists(kModels)) GTEST_SKIP() << "Debian's package assimp-testmodels is not installed";
  FrameInput options;
  options.memory.modelled = false;
  const Technique techniques[] = {parse_technique("beam"), parse_technique("msaa:1")};
  int models = 0;
  for (const std::filesystem::path& file : models_in(kModels)) {
    const std::optional<Trace> trace = shown(file);
    if (!trace) continue;
    ++models;
    for (const Technique& technique : techniques) {
      const std::vector<float> rgba = technique.render(*trace, 0, options).image.rgba;
      EXPECT_TRUE(std::ranges::all_of(rgba, [](float value) { return std::isfinite(value); }))
          << file << ", " << technique.spec;
      double covered = 0;
      for (std::size_t i = 3; i < rgba.size(); i += 4) covered += rgba[i];
      EXPECT_GT(covered, 1) << file << ", " << technique.spec;
    }
  }
  EXPECT_GE(models, 24);
}

}  // namespace beampipe::model_pictures_test
