// Materials through the techniques: what must not change, and what all of them must show.

#include "pipeline/technique_table.h"
#include "stages/surface/mip_chain.h"
#include "tests/pipeline/surface_traces.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/stages/surface_scene.h"
#include "traces/scenes.h"

namespace beampipe::surfaces_test {

FrameResult rendered(const std::string& spec, const Trace& trace) {
  return parse_technique(spec).render(trace, 0, {2});
}

glm::vec3 mean_color(const Image& image) {
  glm::dvec3 sum(0);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    sum += glm::dvec3(image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]);
  return sum / (static_cast<double>(image.rgba.size()) / 4);
}

// Each triangle's colour has codes of sRGB, which a G-buffer keeps.
Trace coded_trace() {
  Trace trace = random_trace(64, 48, 120, 11);
  for (glm::vec3& color : trace.meshes[0].colors)
    for (int c = 0; c < 3; ++c) color[c] = srgb_values()[srgb_code(color[c])];
  return trace;
}

// The same with a white texture times each triangle's colour.
Trace textured_twin(const Trace& flat) {
  Trace trace = flat;
  trace.images.push_back(filled_image(4, 4, {255, 255, 255, 255}));
  const Texture white{.image = 0, .magnify = Filter::nearest, .minify = Filter::nearest, .mip = MipFilter::nearest};
  Mesh& mesh = trace.meshes[0];
  for (const glm::vec3& color : mesh.colors) {
    mesh.materials.push_back(static_cast<std::uint32_t>(trace.materials.size()));
    Material& material = trace.materials.emplace_back();
    material.base_color = glm::vec4(color, 1.0f), material.base_texture = white;
    material.unlit = material.double_sided = true;
  }
  for (const glm::vec3& p : mesh.positions) mesh.uvs[0].emplace_back(0.1f * p.x, 0.3f * p.y);
  return trace;
}

TEST(Surfaces, AWhiteTextureTimesTheColorIsTheFlatPicture) {
  const Trace flat = coded_trace(), textured = textured_twin(flat);
  for (const std::string& spec : example_specs()) {
    const Image a = rendered(spec, flat).image, b = rendered(spec, textured).image;
    ASSERT_EQ(a.rgba.size(), b.rgba.size());
    float largest = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) largest = std::max(largest, std::abs(a.rgba[i] - b.rgba[i]));
    // Parts of an owner are added up again, which rounds, and then stored with 16 bits per channel. Samples are added
    // in another order.
    const bool in_parts =
        spec.find("at=quarters") != std::string::npos || spec.find("at=sixteenths") != std::string::npos;
    EXPECT_LE(largest, in_parts ? 0x1p-13f : 1e-6f) << spec;
    if ((spec.starts_with("beam") || spec.starts_with("casav")) && !in_parts) {
      EXPECT_EQ(a.rgba, b.rgba) << spec;
    }
  }
}

// Materials that nothing uses cost nothing, and neither do attributes of meshes without materials.
TEST(Surfaces, FramesWithoutMaterialsPayNothing) {
  Trace plain = random_trace(64, 48, 120, 12);
  plain.frames[0].draws[0].shading = Shading::lambert;
  plain.frames[0].lighting.lights = {{glm::vec3(0, 0, 1)}};
  Trace equipped = plain;
  equipped.images.push_back(filled_image(64, 64, {1, 2, 3, 4}));
  equipped.materials.resize(3);
  for (Material& material : equipped.materials) {
    material.base_texture = Texture{.image = 0};
    material.alpha_mode = AlphaMode::blend;
  }
  Mesh& mesh = equipped.meshes[0];
  mesh.normals.resize(mesh.positions.size(), glm::vec3(0, 0, 1));
  mesh.uvs[0].resize(mesh.positions.size());
  mesh.materials.assign(mesh.triangles.size(), kNoMaterial);
  for (const std::string& spec : example_specs()) {
    const FrameResult a = rendered(spec, plain);
    const FrameResult b = rendered(spec, equipped);
    EXPECT_EQ(a.image.rgba, b.image.rgba) << spec;
    for (const StageCounters& stage : a.stages) {
      EXPECT_EQ(stage.texture_bytes + stage.texture_sector_bytes, 0u) << spec;
      const auto same =
          std::find_if(b.stages.begin(), b.stages.end(), [&](const auto& s) { return s.stage == stage.stage; });
      ASSERT_NE(same, b.stages.end());
      if (stage.stage.id != StageId::vertex_setup) {
        EXPECT_EQ(*same, stage) << spec << ", " << stage.stage;
      }
    }
    EXPECT_EQ(a.stages.size(), b.stages.size());
    // A mesh without materials at all pays nothing either.
    Trace attributes = equipped;
    attributes.meshes[0].materials.clear();
    EXPECT_EQ(rendered(spec, attributes).stages, a.stages) << spec;
    EXPECT_EQ(rendered(spec, attributes).buffers, a.buffers) << spec;
  }
}

TEST(Surfaces, EveryPictureIsFiniteAndNotNegative) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const Trace trace = random_surfaces(48, 32, 150, seed);
    for (const std::string& spec : example_specs())
      for (const float value : rendered(spec, trace).image.rgba)
        ASSERT_TRUE(std::isfinite(value) && value >= -1e-6f) << spec << ": " << value;
  }
}

// ---- Cutouts

// A half-transparent texture cut out of a rectangle over everything: red as far as the texture is there.
Trace half_cutout(std::uint32_t texels) {
  SurfaceTrace scene(32, 32);
  TextureImage image = filled_image(texels, texels, {255, 0, 0, 255});
  for (std::size_t i = 0; i < image.texels.size(); ++i)
    if ((i % texels / 2 + i / texels / 2) % 2) image.texels[i].a = 0;
  // Nothing in it is aligned with pixels: where alpha is just the cutoff, a tie would decide for a whole row.
  scene.add_rectangle(-1.37, -1.21, 33.5, 34.1, 0.5, textured_material(scene.add_image(image), AlphaMode::mask));
  return scene.trace;
}

TEST(Surfaces, CutoutsOfBeamHaveTheReferencesMean) {
  for (const std::uint32_t texels : {16u, 64u, 256u}) {
    const Trace trace = half_cutout(texels);
    const float expected = mean_color(rendered("reference", trace).image).r;
    for (const char* spec : {"beam", "beam:order=sorted", "beam:order=stream", "msaa:256"})
      EXPECT_NEAR(mean_color(rendered(spec, trace).image).r, expected, 0.01) << spec << ", " << texels;
  }
}

// ---- Translucency

struct Sheet {
  glm::dvec4 color;
  double depth;
};

// Sheets over the whole picture as draws in this order.
Trace sheets(const std::vector<Sheet>& in_order, std::uint32_t size = 32) {
  SurfaceTrace scene(size, size);
  scene.frame().background = glm::vec3(0.25f, 0.5f, 0.75f);
  for (const Sheet& sheet : in_order)
    scene.add_rectangle(-1, -1, size + 1.0, size + 1.0, sheet.depth, unlit_material(sheet.color, AlphaMode::blend));
  return scene.trace;
}

glm::dvec3 composed(std::vector<Sheet> stack) {
  std::sort(stack.begin(), stack.end(), [](const Sheet& a, const Sheet& b) { return a.depth < b.depth; });
  glm::dvec3 sum(0);
  double light = 1;
  for (const Sheet& sheet : stack) sum += light * sheet.color.a * glm::dvec3(sheet.color), light *= 1 - sheet.color.a;
  return sum + light * glm::dvec3(0.25, 0.5, 0.75);
}

const std::vector<Sheet> kStack = {
    {{1, 0, 0, 0.5}, 0.2}, {{0, 1, 0, 0.25}, 0.4}, {{0, 0, 1, 0.75}, 0.6}, {{1, 1, 0, 0.375}, 0.8}};

// Of `beam` each sheet's part is a whole number of 256 positions, at random: the mean over 1024 pixels is much closer.
// From far to near msaa blends exactly but for rounding to fp16.
TEST(Surfaces, SheetsAreComposedInAnyOrderOfDraws) {
  const glm::dvec3 expected = composed(kStack);
  std::vector<Sheet> stack = kStack;
  const auto by_alpha = [](const Sheet& a, const Sheet& b) { return a.color.a < b.color.a; };
  std::sort(stack.begin(), stack.end(), by_alpha);
  double worst_in_order = 0;
  do {
    const Trace trace = sheets(stack);
    for (const char* spec : {"beam", "beam:order=sorted", "beam:order=stream"})
      expect_near(mean_color(rendered(spec, trace).image), expected, 0.004);
    expect_near(mean_color(rendered("reference", sheets(stack, 2)).image), expected, 0.004);
    for (const char* spec : {"msaa:4,blend=sorted", "msaa:32,blend=sorted", "msaa:4,prepass,blend=sorted"})
      expect_near(mean_color(rendered(spec, trace).image), expected, 2e-3);
    const glm::dvec3 in_order(mean_color(rendered("msaa:4", trace).image));
    worst_in_order = std::max(worst_in_order, glm::distance(in_order, expected));
  } while (std::next_permutation(stack.begin(), stack.end(), by_alpha));
  EXPECT_GT(worst_in_order, 0.1);
}

// Before or after an opaque surface in the middle.
TEST(Surfaces, SortedMsaaComposesSheetsAroundASurface) {
  SurfaceTrace scene(16, 16);
  scene.add_rectangle(-1, -1, 17, 17, 0.2, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
  scene.add_rectangle(-1, -1, 17, 17, 0.8, unlit_material({0, 0, 1, 0.5f}, AlphaMode::blend));
  scene.add_rectangle(-1, -1, 17, 17, 0.5, unlit_material({0, 1, 0, 1}));
  const glm::vec3 found = mean_color(rendered("msaa:4,blend=sorted", scene.trace).image);
  expect_near(found, {0.5, 0.5, 0}, 1e-3);
}

// Sheets in front of each other in one draw are as independent as those of several draws.
TEST(Surfaces, BeamComposesTheSheetsOfOneDraw) {
  for (const double alpha : {0.25, 0.5, 0.75}) {
    SurfaceTrace scene(32, 32);
    scene.add_rectangle(-1, -1, 33, 33, 0.3, unlit_material({1, 1, 1, alpha}, AlphaMode::blend));
    scene.add_to_draw(0.6);
    scene.trace.frames[0].background = glm::vec3(0.0f);
    const double expected = 1 - (1 - alpha) * (1 - alpha);
    for (const char* spec : {"reference", "beam", "beam:order=sorted", "beam:order=stream"})
      EXPECT_NEAR(mean_color(rendered(spec, scene.trace).image).r, expected, 0.01) << spec << ", " << alpha;
  }
}

// Two layers of which each lets half of the light through, over black.
void expect_two_layers(const Trace& trace, const std::vector<std::string>& specs) {
  for (const std::string& spec : specs) {
    const Image image = rendered(spec, trace).image;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) EXPECT_NEAR(image.rgba[i], 0.75, 0.01) << spec;
  }
}

// The same triangle twice is two layers, not two parts of one.
TEST(Surfaces, TheSameTriangleTwiceIsTwoLayers) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(-1, -1, 20, 20, 0.5, unlit_material({1, 1, 1, 0.5f}, AlphaMode::blend));
  scene.mesh().triangles = {{0, 1, 3}, {0, 1, 3}};
  scene.frame().background = glm::vec3(0.0f);
  expect_two_layers(scene.trace, {"beam", "beam:order=sorted", "beam:order=stream", "z3"});
}

// Sheets are numbered only for techniques with mask positions: the setup of others costs what it does for triangles
// that are opaque.
TEST(Surfaces, TechniquesWithoutMaskPositionsDoNotNumberSheets) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(-1, -1, 20, 20, 0.5, unlit_material({1, 1, 1, 0.5f}, AlphaMode::blend));
  scene.mesh().vertex_colors.resize(4, glm::vec4(1.0f));  // so that the material is not flat when it is opaque
  Trace opaque = scene.trace;
  opaque.materials[0].alpha_mode = AlphaMode::opaque;
  for (const std::string& spec : example_specs()) {
    const StageCounters a = rendered(spec, scene.trace).stages[0], b = rendered(spec, opaque).stages[0];
    const bool has_positions = parse_technique(spec).positions > 0;
    EXPECT_EQ(a.ops.total() > b.ops.total(), has_positions) << spec;
    EXPECT_EQ(a.bytes_written > b.bytes_written, has_positions) << spec;
  }
}

// Layers of one mesh that meet in a vertex lie on each other like any others, in each pixel.
TEST(Surfaces, LayersThatShareAVertexDoNotHideEachOther) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(0, 0, 8, 8, 0, unlit_material({1, 1, 1, 0.5f}, AlphaMode::blend));
  Mesh& mesh = scene.mesh();
  mesh.positions = {{-1, -1, 0}, {20, -1, 0.25f}, {-1, 20, 0.25f}, {20, -1, 0.5f}, {-1, 20, 0.5f}};
  mesh.uvs[0].resize(5);
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  scene.frame().background = glm::vec3(0.0f);
  expect_two_layers(scene.trace, {"reference", "beam", "beam:order=sorted", "beam:order=stream", "z3", "msaa:8"});
}

// All but beams blend in the order of draws: from far to near that is the truth, from near to far it is not.
TEST(Surfaces, SamplesBlendInTheOrderOfDraws) {
  const glm::dvec3 truth = composed(kStack);
  std::vector<Sheet> far_to_near(kStack.rbegin(), kStack.rend());
  for (const char* spec : {"msaa:8", "msaa:32", "msaa:8,prepass", "acaa:8", "acaa:32", "deferred", "visibility",
                           "visibility:4", "taa:8", "taa:8,shading=forward", "taa:8,shading=deferred", "dvm"}) {
    const glm::vec3 right = mean_color(rendered(spec, sheets(far_to_near)).image);
    const glm::vec3 wrong = mean_color(rendered(spec, sheets(kStack)).image);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(right[c], truth[c], 0.001) << spec;  // colours are fp16
    EXPECT_GT(glm::length(wrong - glm::vec3(truth)), 0.1f) << spec;
    // From near to far, the last draw lies on top.
    std::vector<Sheet> swapped = kStack;
    for (std::size_t i = 0; i < swapped.size(); ++i) swapped[i].depth = 1 - swapped[i].depth;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(wrong[c], composed(swapped)[c], 0.001) << spec;
  }
}

TEST(Surfaces, WhatIsDrawnLaterInFrontHidesSheets) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(-1, -1, 9, 9, 0.5, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
  scene.add_rectangle(-1, -1, 9, 9, 0.25, unlit_material({0, 1, 0, 1}));
  for (const std::string& spec : example_specs()) {
    if (spec.starts_with("casav") || spec == "alpha") continue;  // approximate order, over
    const glm::vec3 found = mean_color(rendered(spec, scene.trace).image);
    EXPECT_NEAR(found.r, 0, 0.01) << spec;
    EXPECT_NEAR(found.g, 1, 0.01) << spec;
  }
}

TEST(Surfaces, WhatLiesBehindASheetShowsThrough) {
  for (const bool sheet_first : {false, true}) {
    SurfaceTrace scene(32, 32);
    const auto add_sheet = [&] {
      scene.add_rectangle(-1, -1, 33, 33, 0.25, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
    };
    if (sheet_first) add_sheet();
    scene.add_rectangle(-1, -1, 33, 33, 0.5, unlit_material({0, 1, 0, 1}));
    if (!sheet_first) add_sheet();
    for (const char* spec : {"reference", "beam", "beam:order=sorted", "beam:order=stream", "msaa:8,prepass", "acaa:8",
                             "acaa:32", "deferred", "visibility", "taa:8", "dvm"}) {
      const glm::vec3 found = mean_color(rendered(spec, scene.trace).image);
      EXPECT_NEAR(found.r, 0.5, 0.005) << spec;
      EXPECT_NEAR(found.g, 0.5, 0.005) << spec;
    }
    const glm::vec3 found = mean_color(rendered("msaa:8", scene.trace).image);
    EXPECT_NEAR(found.r, sheet_first ? 0 : 0.5, 1e-3);  // no depth was written, so the later draw replaces it
  }
}

// Two translucent triangles that meet, in front of a surface that covers the left half of a pixel column and hides what
// lies behind it: no seam where they meet, and each sample's depth counts.
TEST(Surfaces, TranslucentTrianglesBlendSampleBySample) {
  SurfaceTrace scene(16, 16);
  scene.frame().background = glm::vec3(0.0f);
  scene.add_rectangle(-1, -1, 7.5, 17, 0.25, unlit_material({0, 1, 0, 1}));
  scene.add_rectangle(-3, -2, 19, 18, 0.5, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
  for (const char* spec : {"msaa:8", "visibility:8", "dvm"}) {
    const Image image = rendered(spec, scene.trace).image;
    for (std::size_t y = 0; y < 16; ++y)
      for (std::size_t x = 0; x < 16; ++x)
        EXPECT_NEAR(image.rgba[4 * (16 * y + x)],
                    x < 7   ? 0
                    : x > 7 ? 0.5
                            : 0.25,
                    x == 7 ? 0.07 : 0.001)
            << spec << ": " << x << ", " << y;
  }
}

// Techniques that draw translucent triangles last do not draw them earlier too: each fragment is counted once.
TEST(Surfaces, TranslucentTrianglesAreDrawnOnce) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(0, 0, 8, 8, 0.5, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
  for (const char* spec : {"acaa:8", "deferred", "visibility", "taa:8", "dvm"}) {
    const FrameResult found = rendered(spec, scene.trace);
    const StageCounters& stage = stage_of(found, "sample_raster");
    EXPECT_GE(stage.items_out, 64u) << spec;
    EXPECT_LE(stage.items_out, 64u + 8u) << spec;  // pixels of the diagonal have a fragment of each half
  }
}

double squared_error(const Image& a, const Image& b) { return std::pow(rmse(a, b), 2); }

// Whether once is enough is asked in the shader, where fixed functions take time too.
TEST(Surfaces, TheShaderPaysForItsDecisions) {
  const Trace trace = make_scene("bumps", {.triangles = 1000, .width = 48, .height = 27});
  const FrameResult asked = rendered("beam:tolerance=1000", trace), once = rendered("beam:at=visible", trace);
  EXPECT_EQ(stage_of(asked, "shade").items_in, stage_of(once, "shade").items_in);
  EXPECT_GT(stage_of(asked, "shade").ops.total(), 15 * stage_of(once, "shade").ops.total() / 10);
  EXPECT_LE(stage_of(asked, "compose").ops.total(), stage_of(once, "compose").ops.total());
}

// Ropes with highlights narrower than a pixel.
TEST(Surfaces, AdaptiveShadingIsNearlyAsGoodAsSixteenPointsEverywhere) {
  const Trace trace = make_scene("rigging", {.triangles = 3000, .width = 96, .height = 54});
  const Image truth = rendered("reference", trace).image;
  const auto error = [&](const std::string& spec) { return squared_error(rendered(spec, trace).image, truth); };
  const double once = error("beam:at=visible"), all = error("beam:at=sixteenths");
  EXPECT_LT(error("beam"), once);
  EXPECT_LT(error("beam:tolerance=0.01"), all + 0.2 * (once - all));
}

TEST(Surfaces, AdaptiveShadingIsCountedInEachPixel) {
  const Trace trace = make_scene("rigging", {.triangles = 3000, .width = 96, .height = 54});
  double before = 1e30;
  for (const char* tolerance : {"0", "0.02", "0.2", "1000"}) {
    const FrameResult found = rendered(std::string("beam:tolerance=") + tolerance, trace);
    const double shadings = sum_of(found, "shadings");
    const StageCounters& shade = stage_of(found, "shade");
    EXPECT_LE(shadings, static_cast<double>(shade.items_in));  // which has flat triangles too
    EXPECT_GT(shadings, 0.5 * static_cast<double>(shade.items_in));
    EXPECT_LT(shadings, before) << tolerance;
    before = shadings;
  }
  EXPECT_EQ(before, sum_of(rendered("beam:at=visible", trace), "shadings"));
}

// A checker at an angle, of which a pixel shows parts of several squares. (`taa` and `dvm` shade at one sample of many
// frames, each of which is another part of the pixel.)
TEST(Surfaces, EveryTechniqueFiltersFootprints) {
  SurfaceTrace scene(32, 32);
  TextureImage image = filled_image(128, 128, {255, 255, 255, 255});
  for (std::size_t i = 0; i < image.texels.size(); ++i)
    if ((i / 16 + i / 128 / 16) % 2 == 0) image.texels[i] = {0, 0, 0, 255};
  scene.add_rectangle(-1, -1, 33, 33, 0.5, textured_material(scene.add_image(image)));
  for (glm::vec2& uv : scene.mesh().uvs[0]) uv = {0.9f * uv.x + 0.3f * uv.y, 1.7f * uv.y};
  const Image truth = rendered("reference", scene.trace).image;
  for (const char* spec : {"beam", "beam:order=stream", "beam:order=sorted", "casav", "alpha", "z3", "msaa:4", "acaa:4",
                           "deferred", "visibility"}) {
    const auto error = [&](const char* filter) {
      const std::string name(spec);
      return squared_error(rendered(name + (name.find(':') == name.npos ? ':' : ',') + filter, scene.trace).image,
                           truth);
    };
    EXPECT_LT(error("filter=16"), 0.7 * error("filter=sampler")) << spec;
  }
}

}  // namespace beampipe::surfaces_test
