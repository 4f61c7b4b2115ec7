// What shaders say of depth and coverage, where draws keep the API's order, against closed forms.
#include <functional>

#include "stages/geometry/draw_plan.h"
#include "tests/programs/program_traces.h"
#include "tools/evaluate/captured_check.h"
#include "tools/evaluate/draw_notes.h"

namespace beampipe::fragment_verdicts_test {

constexpr std::uint32_t kSide = 4;   // pixels
constexpr float kOfMasks = 0x1p-6f;  // what positions tell of a part of a triangle's area, in beam
const glm::vec3 kBlack(0.0f);

// Red, green, depth and alpha come from the vertices; blue is 0.
const std::string kColor = R"(
%red = OpCompositeExtract %float %va 0
%green = OpCompositeExtract %float %va 1
%alpha = OpCompositeExtract %float %va 3
%color = OpCompositeConstruct %v4 %red %green %f0 %alpha
OpStore %out %color
)";

ShaderParts with_modes(ShaderParts parts, const std::string& modes) {
  parts.modes += modes;
  return parts;
}
const std::string kEarly = "OpExecutionMode %main EarlyFragmentTests\n";

const ShaderParts kPlain{.body = kColor};

const ShaderParts kDepth{.body = kColor + R"(
%z = OpCompositeExtract %float %va 2
OpStore %depth %z
)",
                         .globals = R"(
%out_float = OpTypePointer Output %float
%depth = OpVariable %out_float Output
)",
                         .decorations = "OpDecorate %depth BuiltIn FragDepth\n",
                         .interface = "%depth",
                         .modes = "OpExecutionMode %main DepthReplacing\n"};

// Without pixels whose place is left of x = 5 / 2.
const ShaderParts kDiscard = discarding_left_of("2.5", kColor);

// The mask that it has, and the samples that the fragment covers.
ShaderParts masked(std::uint32_t mask) {
  return {.body = kColor + R"(
%from = OpAccessChain %in_int %covered %i0
%before = OpLoad %int %from
%samples = OpBitwiseAnd %int %before %wanted
%to = OpAccessChain %out_int %mask %i0
OpStore %to %samples
)",
          .globals = R"(
%mask_type = OpTypeArray %int %u1
%in_mask = OpTypePointer Input %mask_type
%in_int = OpTypePointer Input %int
%out_mask = OpTypePointer Output %mask_type
%out_int = OpTypePointer Output %int
%covered = OpVariable %in_mask Input
%mask = OpVariable %out_mask Output
%wanted = OpConstant %int )" +
                     std::to_string(static_cast<std::int32_t>(mask)) + "\n",
          .decorations =
              "OpDecorate %covered BuiltIn SampleMask\nOpDecorate %covered Flat\n"
              "OpDecorate %mask BuiltIn SampleMask\n",
          .interface = "%covered %mask"};
}

// Draws that fill the frame, over black.
struct Scene : ProgramTrace {
  Scene() : ProgramTrace(kSide, kSide, std::vector<std::uint32_t>{}) { trace.programs.clear(); }

  // `depth`: of the window. `from`, `to`: red, green, what kDepth takes as depth, and alpha, on the left and on the
  // right side of the frame.
  Draw& add(const ShaderParts& shader, float depth, const glm::vec4& from, const glm::vec4& to) {
    const float z = 2 * depth - 1;
    const auto numbers = [](const glm::vec4& v) { return std::vector<float>{v[0], v[1], v[2], v[3]}; };
    trace.programs.insert(trace.programs.begin(), {.name = "shader " + std::to_string(trace.programs.size()),
                                                   .spirv = assembled(shader_text(shader)),
                                                   .specialization = {},
                                                   .inputs = {}});
    for (Draw& draw : trace.frames[0].draws) ++draw.program->program;
    return add_quad({{{-1, 1, z, 1}, numbers(from)},
                     {{1, 1, z, 1}, numbers(to)},
                     {{-1, -1, z, 1}, numbers(from)},
                     {{1, -1, z, 1}, numbers(to)}});
  }
  Draw& add(const ShaderParts& shader, float depth, const glm::vec4& numbers) {
    return add(shader, depth, numbers, numbers);
  }

  // expected(x): what the target stores in a column.
  void expect(const std::string& spec, const std::function<glm::vec3(std::uint32_t)>& expected,
              float tolerance = kRounding) const {
    const ProgramSet programs(trace);
    for (std::uint32_t i = 0; i < trace.programs.size(); ++i) ASSERT_EQ(programs.error(i), "");
    expect_picture(
        trace, spec, [&](auto x, auto) { return expected(x); }, tolerance);
  }
  void expect_all(const std::function<glm::vec3(std::uint32_t)>& expected) const {
    for (const char* spec : {"msaa:1", "msaa:4", "msaa:32", "reference", "beam"}) expect(spec, expected);
  }
  void expect_all(const glm::vec3& color) const {
    expect_all([&](auto) { return color; });
  }

  // What the target stores where kDiscard discards, left of the middle of column 2, and elsewhere. With one shading of
  // each pixel, at its centre, all of that column is elsewhere.
  void expect_sides(const glm::vec3& left, const glm::vec3& right) const {
    for (const char* spec : {"msaa:1", "msaa:4"}) expect(spec, [&](auto x) { return x < 2 ? left : right; });
    for (const char* spec : {"msaa:32", "reference", "beam"})
      expect(
          spec, [&](auto x) { return x < 2   ? left
                                     : x > 2 ? right
                                             : 0.5f * (left + right); }, kOfMasks);
  }
};

constexpr glm::vec4 kGreen(0, 1, 0, 1), kYellow(1, 1, 0, 1);
constexpr glm::vec3 kYellowColor(1, 1, 0), kGreenColor(0, 1, 0);

// ---- The check of captured depths ----

TEST(FragmentVerdicts, DepthsThatShadersWriteAreChecked) {
  Scene scene;
  scene.add(kDepth, 0.5f, {1, 0, 0.25f, 1});  // in place of 0.5, the depth of the window is 0.25
  scene.trace.frames[0].capture.pictures.depth.assign(kSide * kSide, 0.25f);
  const TextureSet textures(scene.trace);
  const SampledDepths found = sampled_depths(scene.trace, scene.trace.frames[0], &textures);
  EXPECT_EQ(check_captured(scene.trace.frames[0], found).equal_part(), 1.0);
}

// ---- Early and late tests ----

// Green, which is drawn last, lies behind what is discarded in the left part, up to the middle of column 2.
TEST(FragmentVerdicts, WhatIsDiscardedWritesDepthAfterEarlyTestsAlone) {
  for (const bool is_early : {false, true}) {
    Scene scene;
    scene.add(with_modes(kDiscard, is_early ? kEarly : ""), 0.25f, kYellow);
    scene.add(kPlain, 0.75f, kGreen);
    scene.expect_sides(is_early ? kBlack : kGreenColor, kYellowColor);
  }
}

// Green is drawn where the first draw has left its mark.
TEST(FragmentVerdicts, WhatIsDiscardedWritesStencilAfterEarlyTestsAlone) {
  for (const bool is_early : {false, true}) {
    Scene scene;
    scene.add(with_modes(kDiscard, is_early ? kEarly : ""), 0.25f, kYellow).state.stencil =
        Stencil{.reference = 1, .pass = StencilOperation::replace};
    DrawState& last = scene.add(kPlain, 0.75f, kGreen).state;
    last.depth.test = last.depth.write = false;
    last.stencil = Stencil{.function = Compare::equal, .reference = 1};
    scene.expect_sides(is_early ? kGreenColor : kBlack, kGreenColor);
  }
}

TEST(FragmentVerdicts, EarlyTestsCostNoShadingOfWhatIsHidden) {
  for (const bool is_early : {false, true}) {
    Scene scene;
    scene.add(kPlain, 0.25f, kGreen).state.stencil = Stencil{.function = Compare::equal};  // passes
    scene.add(with_modes(kDiscard, is_early ? kEarly : ""), 0.75f, kYellow);
    std::uint64_t tests = 0;
    for (const StageCounters& stage : rendered(scene.trace, "msaa:1").stages)
      if (stage.stage.id == StageId::alpha_test) tests += stage.lanes_used;
    // Two triangles share 16 pixels.
    EXPECT_EQ(tests, is_early ? 0u : 16u);
  }
}

// ---- Depth ----

// The first triangles lie in front, and their shader says that they lie behind.
TEST(FragmentVerdicts, DepthOfShadersReversesTwoSurfaces) {
  for (const bool first_is_green : {false, true}) {
    Scene scene;
    const auto add = [&](bool is_green) {
      scene.add(kDepth, is_green ? 0.75f : 0.25f, is_green ? glm::vec4(0, 1, 0.25f, 1) : glm::vec4(1, 1, 0.75f, 1));
    };
    add(first_is_green), add(!first_is_green);
    scene.expect_all(kGreenColor);
  }
}

// From 0 on the left to 1 on the right: 1/8, 3/8, 5/8 and 7/8 in the middles of pixels.
TEST(FragmentVerdicts, DepthOfShadersIsTestedInEachPixel) {
  Scene scene;
  scene.add(kPlain, 0.5f, kGreen);
  scene.add(kDepth, 0.25f, {1, 1, 0, 1}, {1, 1, 1, 1});
  scene.expect_all([](auto x) { return x < 2 ? kYellowColor : kGreenColor; });
}

TEST(FragmentVerdicts, DepthOfShadersIsStored) {
  Scene scene;
  scene.add(kDepth, 0.75f, {1, 1, 0.25f, 1});
  scene.add(kPlain, 0.5f, kGreen);
  scene.expect_all(kYellowColor);
}

// 2 is as far as what was cleared, and -1 as near as can be.
TEST(FragmentVerdicts, DepthOfShadersIsLimited) {
  Scene far;
  far.add(kDepth, 0.5f, {1, 1, 2, 1}).state.depth.function = Compare::equal;
  far.expect_all(kYellowColor);
  Scene near;
  near.add(kDepth, 0.5f, {1, 1, -1, 1});
  near.add(kPlain, 0, kGreen).state.depth.function = Compare::equal;
  near.expect_all(kGreenColor);
}

// With alpha to coverage, what the shader says is asked for.
TEST(FragmentVerdicts, EarlyTestsIgnoreTheDepthOfShaders) {
  for (const bool has_coverage : {false, true}) {
    Scene scene;
    scene.add(kPlain, 0.5f, kGreen);
    scene.add(with_modes(kDepth, kEarly), 0.25f, {1, 1, 0.75f, 1}).state.alpha_to_coverage = has_coverage;
    scene.add(kPlain, 0.375f, kGreen);  // behind what is stored
    scene.expect_all(kYellowColor);
  }
}

// ---- Samples ----

constexpr std::uint32_t kEven = 0x55555555, kOdd = 0xaaaaaaaa;

TEST(FragmentVerdicts, MasksTakeTheirShareOfAPixel) {
  for (const std::uint32_t mask : {kEven, kOdd}) {
    Scene scene;
    scene.add(masked(mask), 0.25f, kYellow);
    scene.expect("msaa:1", [&](auto) { return mask == kEven ? kYellowColor : kBlack; });
    for (const char* spec : {"msaa:4", "msaa:8", "msaa:32", "reference", "beam"})
      scene.expect(spec, [](auto) { return 0.5f * kYellowColor; });
  }
}

// What lies behind is seen through the other half; after early tests it is hidden there, too.
TEST(FragmentVerdicts, MasksLimitDepthUnlessTestsAreEarly) {
  for (const bool is_early : {false, true}) {
    Scene scene;
    scene.add(with_modes(masked(kEven), is_early ? kEarly : ""), 0.25f, kYellow);
    scene.add(kPlain, 0.75f, kGreen);
    for (const char* spec : {"msaa:4", "msaa:32", "reference", "beam"})
      scene.expect(spec, [&](auto) { return 0.5f * kYellowColor + (is_early ? kBlack : 0.5f * kGreenColor); });
  }
}

TEST(FragmentVerdicts, MasksHaveABitForEachSampleOfTheCapturedPicture) {
  Scene scene;
  scene.add(masked(0x7), 0.25f, kYellow);
  scene.trace.images.push_back({"captured", kSide, kSide, std::vector<glm::u8vec4>(kSide * kSide)});
  scene.trace.frames[0].capture.pictures.color = 0;
  scene.trace.frames[0].capture.pictures.samples = 4;
  for (const char* spec : {"msaa:4", "msaa:8", "reference", "beam"})
    scene.expect(spec, [](auto) { return 0.75f * kYellowColor; });
}

// ---- Alpha to coverage ----

// A shader with this alpha, in a draw whose alpha is coverage.
Draw& add_covering(Scene& scene, float alpha, float depth, glm::vec4 numbers) {
  numbers.a = alpha;
  Draw& draw = scene.add(kPlain, depth, numbers);
  draw.state.alpha_to_coverage = true;
  return draw;
}

TEST(FragmentVerdicts, AlphaIsThePartOfAPixelThatIsCovered) {
  for (const float alpha : {0.0f, 0.25f, 0.5f, 0.75f, 1.0f}) {
    Scene scene;
    add_covering(scene, alpha, 0.25f, kYellow);
    for (const char* spec : {"msaa:4", "msaa:8", "msaa:32", "reference", "beam"})
      scene.expect(spec, [&](auto) { return alpha * kYellowColor; });
  }
}

// All surfaces cover the same samples. What is farther away is seen between them, and hidden where they are.
TEST(FragmentVerdicts, CoveragesOfTheSameAlphaLieOnEachOther) {
  Scene scene;
  add_covering(scene, 0.5f, 0.25f, kYellow);
  add_covering(scene, 0.5f, 0.5f, kGreen);
  for (const char* spec : {"msaa:4", "msaa:8", "reference", "beam"})
    scene.expect(spec, [](auto) { return 0.5f * kYellowColor; });
  scene.add(kPlain, 0.75f, kGreen);
  for (const char* spec : {"msaa:4", "msaa:8", "reference", "beam"})
    scene.expect(spec, [](auto) { return 0.5f * kYellowColor + 0.5f * kGreenColor; });
}

// Two triangles share a pixel on the diagonal, and each covers half of its part.
TEST(FragmentVerdicts, EarlyTestsHideWhatAlphaDoesNotCover) {
  for (const bool is_early : {false, true}) {
    Scene scene;
    scene.add(with_modes(kPlain, is_early ? kEarly : ""), 0.25f, {1, 1, 0, 0.5f}).state.alpha_to_coverage = true;
    scene.add(kPlain, 0.75f, kGreen);
    for (const char* spec : {"msaa:4", "reference", "beam"})
      scene.expect(
          spec, [&](auto) { return 0.5f * kYellowColor + (is_early ? kBlack : 0.5f * kGreenColor); }, kOfMasks);
  }
}

// Of a cutout, what is left covers its alpha's part; a material that is blended is blended there.
TEST(FragmentVerdicts, AlphaOfMaterialsCovers) {
  const auto picture_of = [](AlphaMode mode, float alpha, const std::string& spec) {
    Scene scene;
    Draw& draw = scene.add(kPlain, 0.25f, kYellow);
    draw.program.reset();
    draw.material = 0;
    draw.state.alpha_to_coverage = true;
    Material material;
    material.name = "paint";
    material.unlit = material.double_sided = true;
    material.alpha_mode = mode;
    material.alpha_cutoff = 0.375f;
    material.base_color = {1, 1, 1, alpha};
    scene.trace.materials.push_back(material);
    scene.trace.meshes[0].varyings.clear();
    return stored_picture(rendered(scene.trace, spec))[5].r;
  };
  for (const char* spec : {"msaa:4", "reference", "beam"}) {
    SCOPED_TRACE(spec);
    EXPECT_NEAR(picture_of(AlphaMode::mask, 0.5f, spec), 0.5f, kRounding);
    EXPECT_NEAR(picture_of(AlphaMode::mask, 0.25f, spec), 0, kRounding);
    EXPECT_NEAR(picture_of(AlphaMode::opaque, 0.5f, spec), 1, kRounding);
    EXPECT_NEAR(picture_of(AlphaMode::blend, 0.5f, spec), 0.25f, kRounding);
  }
}

// ---- Targets of floats ----

Blend adds(BlendOperation operation) { return {{BlendFactor::one, BlendFactor::one, operation}, {}, {}}; }

TEST(FragmentVerdicts, FloatsKeepColorsOfAnySize) {
  for (const ColorTarget target : {ColorTarget::floats, ColorTarget::unorm}) {
    const bool is_float = target == ColorTarget::floats;
    Scene scene;
    scene.trace.frames[0].target = target;
    scene.add(kPlain, 0.25f, {3, 0.25f, 0, 1});
    for (const char* spec : {"msaa:1", "msaa:4", "reference", "beam", "casav", "visibility"})
      scene.expect(spec, [&](auto) { return glm::vec3(is_float ? 3 : 1, 0.25f, 0); });
    // Half of it stays: 5 / 2 + 3 / 2 and 1 / 4 of green. Of what 0..1 holds, 1 stays 1.
    Draw& blended = scene.add(kPlain, 0.125f, {5, 0.25f, 0, 0.5f});
    blended.state.blend = Blend{};
    for (const char* spec : {"msaa:1", "msaa:4", "reference", "beam"})
      scene.expect(spec, [&](auto) { return glm::vec3(is_float ? 4 : 1, 0.25f, 0); });
  }
}

// 5 taken from 3 is -2, and 2.5 more is 1/2. Limited to 0..1, it is 0 and then 1.
TEST(FragmentVerdicts, FloatsAreNotLimitedBetweenDraws) {
  for (const ColorTarget target : {ColorTarget::floats, ColorTarget::unorm}) {
    Scene scene;
    scene.trace.frames[0].target = target;
    scene.add(kPlain, 0.75f, {3, 0, 0, 1});
    scene.add(kPlain, 0.5f, {5, 0, 0, 1}).state.blend = adds(BlendOperation::reverse_subtract);
    scene.add(kPlain, 0.25f, {2.5f, 0, 0, 1}).state.blend = adds(BlendOperation::add);
    scene.expect_all(glm::vec3(target == ColorTarget::floats ? 0.5f : 1.0f, 0, 0));
  }
}

// Factors are alphas as they are: 2 times 1/4, and -1 times the 3 that was there.
TEST(FragmentVerdicts, AlphaOfFloatsIsNotLimited) {
  Scene scene;
  scene.trace.frames[0].target = ColorTarget::floats;
  scene.add(kPlain, 0.75f, {3, 4, 0, 1});
  scene.add(kPlain, 0.5f, {0.25f, 8, 0, 2}).state.blend = Blend{};
  scene.expect_all(glm::vec3(-2.5f, 12, 0));
}

// ---- Notes ----

TEST(FragmentVerdicts, OtherTechniquesHaveNotes) {
  const auto notes = [](const ShaderParts& shader, bool has_alpha_to_coverage = false) {
    Scene scene;
    scene.add(shader, 0.25f, kYellow).state.alpha_to_coverage = has_alpha_to_coverage;
    const std::vector<DrawNote> found = notes_of(scene.trace, {0}, ProgramSet(scene.trace), "acaa:8");
    EXPECT_EQ(needs_api_order(scene.trace, scene.trace.frames[0]), !found.empty());
    EXPECT_EQ(notes_of(scene.trace, {0}, ProgramSet(scene.trace), ""), std::vector<DrawNote>{});
    return found;
  };
  const auto note = [](const std::string& reason) {
    return std::vector<DrawNote>{{reason + " (acaa:8)", false, 1, 2}};
  };
  EXPECT_EQ(notes(kDepth), note("depth that shaders write"));
  EXPECT_EQ(notes(masked(1)), note("sample masks that shaders write"));
  EXPECT_EQ(notes(with_modes(kDiscard, kEarly)), note("early tests of fragments that are discarded"));
  EXPECT_EQ(notes(kPlain, true), note("alpha to coverage"));
  EXPECT_EQ(notes(with_modes(kPlain, kEarly)), std::vector<DrawNote>{});
  EXPECT_EQ(notes(with_modes(kDepth, kEarly)), std::vector<DrawNote>{});
  EXPECT_EQ(notes(kDiscard), std::vector<DrawNote>{});
}

}  // namespace beampipe::fragment_verdicts_test
