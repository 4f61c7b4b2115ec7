// Draws with fragment shaders of their own, by every technique, against closed forms.
#include <cstdlib>
#include <filesystem>

#include "tests/programs/program_traces.h"
#include "tools/evaluate/draw_notes.h"
#include "traces/files/trace_io.h"

namespace beampipe::program_draws_test {

const char* const kSpecs[] = {"msaa:1",         "msaa:4", "reference",  "beam",
                              "msaa:8,prepass", "casav",  "visibility", "deferred"};
const std::string kStoreA = "OpStore %out %va\n";
const ShaderParts kConstant{.body = "OpStore %out %color\n", .globals = R"(
%quarter = OpConstant %float 0.25
%half_ = OpConstant %float 0.5
%three_quarters = OpConstant %float 0.75
%color = OpConstantComposite %v4 %quarter %half_ %three_quarters %half_
)"};

TEST(ProgramDraws, ConstantColors) {
  ProgramTrace scene(9, 7, kConstant);
  scene.fill();
  for (const char* spec : kSpecs)
    expect_picture(scene.trace, spec, [](auto, auto) { return glm::vec3(0.25, 0.5, 0.75); });
  scene.trace.frames[0].target = ColorTarget::srgb;
  for (const char* spec : kSpecs)
    expect_picture(scene.trace, spec, [](auto, auto) { return glm::vec3(0.25, 0.5, 0.75); });
}

// w is 1 on the left and 3 on the right, and so s = t / (3 - 2 t) at a share t of the width.
TEST(ProgramDraws, InputsAreInPerspective) {
  constexpr std::uint32_t kSide = 16;
  ProgramTrace scene(kSide, kSide, ShaderParts{.body = kStoreA});
  scene.add_quad({{{-1, 1, 0, 1}, {0, 0, 1, 1}},
                  {{3, 3, 0, 3}, {1, 0, 1, 1}},
                  {{-1, -1, 0, 1}, {0, 1, 1, 1}},
                  {{3, -3, 0, 3}, {1, 1, 1, 1}}});
  const auto expected = [](auto x, auto y) {
    const float t = (static_cast<float>(x) + 0.5f) / kSide, down = (static_cast<float>(y) + 0.5f) / kSide;
    // In each triangle, v is the weight of its lower corners.
    const float v = t + down < 1 ? 3 * down / (3 - 2 * t) : 1 - (1 - down) / (3 - 2 * t);
    return glm::vec3(t / (3 - 2 * t), v, 1);
  };
  for (const char* spec : {"msaa:1", "msaa:4", "visibility"}) expect_picture(scene.trace, spec, expected);
  // Others mean over the pixel, or over its parts along the diagonal, where v has a kink.
  const auto off_diagonal = [&](auto x, auto y) {
    const glm::vec3 color = expected(x, y);
    return x + y == kSide - 1 ? glm::vec3(color.r, NAN, color.b) : color;
  };
  for (const char* spec : {"reference", "beam"}) expect_picture(scene.trace, spec, off_diagonal, 6e-3f);

  scene.trace.programs[0].inputs[0].interpolation = InputInterpolation::linear;
  expect_picture(scene.trace, "msaa:1", [](auto x, auto y) {
    return glm::vec3((static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide, 1);
  });
  // Of the first vertices of the two triangles, which the diagonal from the lower left to the upper right parts.
  scene.trace.programs[0].inputs[0].interpolation = InputInterpolation::flat;
  expect_picture(scene.trace, "msaa:1", [](auto x, auto y) { return glm::vec3(0, x + y < kSide - 1 ? 0 : 1, 1); });
}

// In clip space, of a place on the picture, in pixels and in 1/256 px beyond.
glm::vec4 in_clip_space(double side, double x, double y, double beyond_x, double beyond_y) {
  return {2 * (x + beyond_x / 256) / side - 1, 1 - 2 * (y + beyond_y / 256) / side, 0, 1};
}

// What the vertices carry is 1/2 + 16 (x - 8 1/2), where they are before they are snapped to 1/256 px. Of snapped ones
// the middle of column 8 would have 1/40 more.
TEST(ProgramDraws, InputsBelongToVerticesThatAreNotSnapped) {
  constexpr std::uint32_t kSide = 16;
  constexpr double kBeyond = 0.4;
  ProgramTrace scene(kSide, kSide, ShaderParts{.body = kStoreA});
  std::vector<ProgramVertex> corners;
  for (const double y : {-1.0, 17.0})
    for (const double x : {7.0, 10.0})
      corners.push_back({in_clip_space(kSide, x, y, kBeyond, kBeyond),
                         {static_cast<float>(0.5 + 16 * (x + kBeyond / 256 - 8.5)), 0, 0, 1}});
  scene.add_quad(corners);
  for (const char* spec : {"msaa:1", "visibility", "deferred"})
    expect_picture(scene.trace, spec, [](auto x, auto) { return x == 8 ? glm::vec3(0.5f, 0, 0) : glm::vec3(NAN); });
}

// Before they are snapped, the vertices lie on a line, where no plane goes through what they carry. Snapped ones have
// 1/4 + x / 16 between the first two, on which the middles of four pixels lie.
TEST(ProgramDraws, InputsOfATriangleThatOnlySnappingMakesWide) {
  constexpr std::uint32_t kSide = 16;
  ProgramTrace scene(kSide, kSide, ShaderParts{.body = kStoreA});
  scene.add_quad({{in_clip_space(kSide, 0, 8.5, 0, 0.2), {0.25f, 0, 0, 1}},
                  {in_clip_space(kSide, 4, 8.5, 0, 0.4), {0.5f, 0, 0, 1}},
                  {in_clip_space(kSide, 8, 8.5, 0, 0.6), {0.75f, 0, 0, 1}},
                  {in_clip_space(kSide, 8, 8.5, 0, 0.6), {0.75f, 0, 0, 1}}});
  expect_picture(scene.trace, "msaa:1", [](auto x, auto y) {
    return y == 8 && x < 4 ? glm::vec3(0.25f + (static_cast<float>(x) + 0.5f) / 16, 0, 0) : glm::vec3(NAN);
  });
}

const ShaderParts kTextured{.body = R"(
%i_ = OpLoad %sampled2 %texture
%uv = OpVectorShuffle %v2 %va %va 0 1
%r = OpImageSampleImplicitLod %v4 %i_ %uv
OpStore %out %r
)",
                            .globals = R"(
%image2 = OpTypeImage %float 2D 0 0 0 1 Unknown
%sampled2 = OpTypeSampledImage %image2
%to_sampled2 = OpTypePointer UniformConstant %sampled2
%texture = OpVariable %to_sampled2 UniformConstant
)",
                            .decorations = "OpDecorate %texture DescriptorSet 1\nOpDecorate %texture Binding 5\n"};

// Red and green above blue and white.
ProgramTrace textured_scene(const ShaderParts& shader = kTextured) {
  ProgramTrace scene(8, 8, shader);
  scene.trace.program_images.push_back(
      {.name = "texels",
       .shape = ImageShape::d2,
       .format = TexelFormat::R8G8B8A8_UNORM,
       .width = 2,
       .height = 2,
       .texels = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}});
  scene.trace.program_samplers.push_back({.mag = Filter::nearest, .min = Filter::nearest});
  Draw& draw = scene.fill({{0, 0}, {1, 0}, {0, 1}, {1, 1}});
  draw.program->images = {{.set = 1, .binding = 5, .image = 0, .sampler = 0}};
  return scene;
}

glm::vec3 texel_at(std::uint32_t x, std::uint32_t y) {
  const glm::vec3 upper = x < 4 ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0),
                  lower = x < 4 ? glm::vec3(0, 0, 1) : glm::vec3(1, 1, 1);
  return y < 4 ? upper : lower;
}

TEST(ProgramDraws, TexturesAreRead) {
  ProgramTrace scene = textured_scene();
  for (const char* spec : kSpecs) expect_picture(scene.trace, spec, texel_at);
  // Channels change places.
  scene.trace.frames[0].draws[0].program->images[0].swizzle = "gr01";
  expect_picture(scene.trace, "msaa:1", [](auto x, auto y) {
    const glm::vec3 texel = texel_at(x, y);
    return glm::vec3(texel.g, texel.r, 0);
  });
}

// Between the texels' middles, which are at 2 and 6, a linear filter gives a share of each.
TEST(ProgramDraws, TexturesAreFiltered) {
  ProgramTrace scene = textured_scene();
  scene.trace.program_samplers[0].mag = Filter::linear;
  scene.trace.program_samplers[0].wrap.fill(SamplerWrap::clamp_to_edge);
  expect_picture(scene.trace, "msaa:1", [](auto x, auto y) {
    const auto share = [](auto place) { return std::clamp((static_cast<float>(place) + 0.5f - 2) / 4, 0.0f, 1.0f); };
    const float u = share(x), v = share(y);
    return glm::vec3((1 - u) * (1 - v) + u * v, u, v);
  });
}

StageCounters shade_of(const Trace& trace, const std::string& spec) {
  const FrameResult result = rendered(trace, spec);
  for (const StageCounters& stage : result.stages)
    if (stage.stage.id == StageId::shade) return stage;
  throw std::logic_error("no shade stage");
}

TEST(ProgramDraws, TexelsAndOperationsAreCharged) {
  const ProgramTrace scene = textured_scene();
  // 16 quads, of which the diagonal parts 4: 20 quads. Helpers read texels, too: one for each of 80 invocations.
  const StageCounters quads = shade_of(scene.trace, "msaa:1");
  EXPECT_EQ(quads.lanes_issued, 80u);
  EXPECT_EQ(quads.texture_bytes, 80u * 4);
  EXPECT_EQ(quads.ops.fetch, 80u);
  // Of 64 pixels the diagonal parts 8. Each fragment takes two more places for its derivatives.
  const StageCounters one_by_one = shade_of(scene.trace, "beam");
  EXPECT_EQ(one_by_one.lanes_used, 72u);
  EXPECT_EQ(one_by_one.lanes_issued, 3 * 72u);
  EXPECT_EQ(one_by_one.ops.fetch, 3 * 72u);
  EXPECT_EQ(one_by_one.texture_bytes, 72u * 4);
  // All texels lie in one sector, for which each quad or pixel asks once, L1 asks once, and L2 asks once.
  EXPECT_EQ(quads.texture_sector_bytes, 20u * 32);
  EXPECT_EQ(one_by_one.texture_sector_bytes, 72u * 32);
  for (const StageCounters& stage : {quads, one_by_one}) {
    EXPECT_EQ(stage.texture_l2_bytes, 32u);
    EXPECT_EQ(stage.texture_dram_bytes, 32u);
  }
}

// Shaders that take no differences run for several fragments at once, but each asks for its texels alone.
TEST(ProgramDraws, FragmentsThatAreShadedOneByOneAreRequestsOfTheirOwn) {
  ShaderParts parts = kTextured;
  parts.globals += "%level = OpConstant %float 0\n";
  parts.body.replace(parts.body.find("%r ="), std::string::npos,
                     "%r = OpImageSampleExplicitLod %v4 %i_ %uv Lod %level\nOpStore %out %r\n");
  const ProgramTrace scene = textured_scene(parts);
  for (const char* spec : {"beam:order=sorted", "beam:order=sorted,window=one", "dvm"}) {
    const StageCounters shade = shade_of(scene.trace, spec);
    EXPECT_EQ(shade.texture_sector_bytes, 32 * shade.lanes_used) << spec;
    EXPECT_GE(shade.lanes_used, 64u) << spec;
  }
}

TEST(ProgramDraws, DerivativesArePerPixelOrCell) {
  ProgramTrace scene(8, 8, ShaderParts{.body = R"(
%x = OpDPdx %v4 %va
%y = OpDPdy %v4 %va
%sum = OpFAdd %v4 %x %y
OpStore %out %sum
)"});
  // 0.125 and 0.25 a pixel in x, -0.125 in y.
  scene.fill({{0, 0, 1, 1}, {1, 2, 1, 1}, {0, 0, 0, 1}, {1, 2, 0, 1}});
  const auto expect = [&](const char* spec, float side) {
    expect_picture(scene.trace, spec, [side](auto, auto) { return side * glm::vec3(0.125f, 0.25f, 0); });
  };
  for (const char* spec : kSpecs)
    if (spec != std::string("reference")) expect(spec, 1);
  expect("reference", 1.0f / 16);
  expect("msaa:32", 1.0f / 2);
  expect("msaa:64", 1.0f / 2);  // of 4 x 2 cells, whose longer side counts
  expect("msaa:128", 1.0f / 4);
}

TEST(ProgramDraws, FragCoordIsThePlaceAndDepth) {
  ProgramTrace scene(16, 8,
                     ShaderParts{.body = R"(
%at = OpLoad %v4 %coord
%color = OpFMul %v4 %at %scale
OpStore %out %color
)",
                                 .globals = kFragCoord + R"(
%scale_xy = OpConstant %float 0.0625
%scale = OpConstantComposite %v4 %scale_xy %scale_xy %f1 %f1
)",
                                 .decorations = kFragCoordDecoration,
                                 .interface = "%coord"});
  scene.fill();
  const auto expected = [](auto x, auto y) {
    return glm::vec3((static_cast<float>(x) + 0.5f) / 16, (static_cast<float>(y) + 0.5f) / 16, 0.5);
  };
  for (const char* spec : kSpecs)
    expect_picture(scene.trace, spec, expected, std::string(spec) == "msaa:1" ? kRounding : 0.02f);
}

// The vertices of both triangles turn clockwise on screen. No fragment that is drawn helps others.
TEST(ProgramDraws, BuiltInsSayWhichTriangleItIs) {
  ProgramTrace scene(8, 8,
                     ShaderParts{.body = R"(
%is_front = OpLoad %bool %facing
%red = OpSelect %float %is_front %f1 %f0
%number = OpLoad %int %primitive
%green = OpConvertSToF %float %number
%place = OpLoad %v2 %point
%x = OpCompositeExtract %float %place 0
%helps = OpLoad %bool %helper
%blue = OpSelect %float %helps %f1 %x
%color = OpCompositeConstruct %v4 %red %green %blue %f1
OpStore %out %color
)",
                                 .globals = R"(
%in_bool = OpTypePointer Input %bool
%in_int = OpTypePointer Input %int
%in_v2 = OpTypePointer Input %v2
%facing = OpVariable %in_bool Input
%helper = OpVariable %in_bool Input
%primitive = OpVariable %in_int Input
%point = OpVariable %in_v2 Input
)",
                                 .decorations = "OpDecorate %facing BuiltIn FrontFacing\n"
                                                "OpDecorate %helper BuiltIn HelperInvocation\n"
                                                "OpDecorate %primitive BuiltIn PrimitiveId\n"
                                                "OpDecorate %primitive Flat\n"
                                                "OpDecorate %point BuiltIn PointCoord\n",
                                 .capabilities = "OpCapability Geometry\n",
                                 .interface = "%facing %helper %primitive %point"});
  Draw& draw = scene.fill();
  for (const bool is_front : {false, true}) {
    draw.state.front_is_clockwise = is_front;
    for (const char* spec : kSpecs)
      expect_picture(scene.trace, spec, [&](auto x, auto y) {
        const auto along = static_cast<int>(x + y);
        if (along == 7) return glm::vec3(std::numeric_limits<float>::quiet_NaN());  // both triangles
        return glm::vec3(is_front ? 1 : 0, along > 7 ? 1 : 0, 0.5f);
      });
  }
}

TEST(ProgramDraws, DiscardedFragmentsAreNotThere) {
  ProgramTrace scene(8, 8, discarding_left_of("5", "OpStore %out %f1111\n"));
  scene.fill();
  scene.trace.frames[0].background = glm::vec3(0.25f);
  const float background = static_cast<float>(encoded_as_srgb(0.25));
  for (const char* spec : kSpecs)
    expect_picture(scene.trace, spec, [&](auto x, auto) { return glm::vec3(x < 5 ? background : 1); });
}

// The middle of each pixel is discarded, and the surface around it is white.
TEST(ProgramDraws, HolesInTheMiddleOfAPixelHideNoColor) {
  ProgramTrace scene(4, 4,
                     ShaderParts{.body = discarding(R"(
%at = OpLoad %v4 %coord
%in_pixel = OpExtInst %v4 %glsl Fract %at
%from = OpFSub %v4 %in_pixel %middle
%far = OpExtInst %v4 %glsl FAbs %from
%x = OpCompositeExtract %float %far 0
%y = OpCompositeExtract %float %far 1
%most = OpExtInst %float %glsl FMax %x %y
%is_discarded = OpFOrdLessThan %bool %most %eighth
)",
                                                    "OpStore %out %f1111\n"),
                                 .globals = kFragCoord + R"(
%eighth = OpConstant %float 0.125
%half_ = OpConstant %float 0.5
%middle = OpConstantComposite %v4 %half_ %half_ %f0 %f0
)",
                                 .decorations = kFragCoordDecoration,
                                 .interface = "%coord"});
  scene.fill();
  // A sixteenth is missing, which 16 places of a pixel do not see.
  for (const char* spec : {"reference", "beam:alpha=256", "beam:at=covered,alpha=256"})
    expect_picture(
        scene.trace, spec, [](auto, auto) { return glm::vec3(15.0f / 16); }, 0.01f);
}

// Half a pixel of white over black is 1/2, as a target of 8 bits has it.
TEST(ProgramDraws, StoredNumbersAreAveraged) {
  ProgramTrace scene(4, 4, ShaderParts{.body = "OpStore %out %f1111\n"});
  scene.add_quad({{{-0.25f, 1, 0, 1}}, {{1, 1, 0, 1}}, {{-0.25f, -1, 0, 1}}, {{1, -1, 0, 1}}});
  for (const char* spec : {"msaa:4", "reference", "beam", "casav"})
    expect_picture(scene.trace, spec, [](auto x, auto) { return glm::vec3(x < 1 ? 0 : x > 1 ? 1 : 0.5); });
}

TEST(ProgramDraws, AlphaBlendsStoredNumbers) {
  ProgramTrace scene(4, 4, kConstant);
  Draw& draw = scene.fill();
  draw.state.blend = Blend{};
  draw.state.depth.write = false;
  scene.trace.frames[0].background = glm::vec3(1);
  // Half of the colour and half of white. Positions of a pixel take alpha up to rounding.
  for (const char* spec : {"msaa:1", "msaa:4", "reference", "beam"})
    expect_picture(
        scene.trace, spec, [](auto, auto) { return glm::vec3(0.625, 0.75, 0.875); }, 6e-3f);
}

TEST(ProgramDraws, BuffersArePassed) {
  ProgramTrace scene(4, 4,
                     ShaderParts{.body = R"(
%p = OpAccessChain %to_v4 %block %i0
%factors = OpLoad %v4 %p
%q = OpAccessChain %to_push %push %i0
%factor = OpLoad %float %q
%scaled = OpVectorTimesScalar %v4 %factors %factor
OpStore %out %scaled
)",
                                 .globals = R"(
%block_type = OpTypeStruct %v4
%to_block = OpTypePointer Uniform %block_type
%block = OpVariable %to_block Uniform
%to_v4 = OpTypePointer Uniform %v4
%push_type = OpTypeStruct %float
%to_push_type = OpTypePointer PushConstant %push_type
%push = OpVariable %to_push_type PushConstant
%to_push = OpTypePointer PushConstant %float
)",
                                 .decorations = R"(
OpDecorate %block DescriptorSet 2
OpDecorate %block Binding 3
OpDecorate %block_type Block
OpMemberDecorate %block_type 0 Offset 0
OpDecorate %push_type Block
OpMemberDecorate %push_type 0 Offset 4
)"});
  Draw& draw = scene.fill();
  const auto bytes_of = [](const std::vector<float>& numbers) {
    std::vector<std::uint8_t> bytes(numbers.size() * sizeof(float));
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
  };
  draw.program->buffers = {{.set = 2, .binding = 3, .bytes = bytes_of({1, 0.5f, 0.25f, 1})},
                           {.set = 3, .binding = 3, .bytes = bytes_of({0, 0, 0, 0})},
                           {.set = 2, .binding = 4, .bytes = bytes_of({0, 0, 0, 0})},
                           {.set = 2, .binding = 3, .element = 1, .bytes = bytes_of({0, 0, 0, 0})}};
  draw.program->push_constants = bytes_of({9, 0.5f});
  ASSERT_EQ(ProgramSet(scene.trace).error(0), "");
  expect_picture(scene.trace, "msaa:1", [](auto, auto) { return glm::vec3(0.5, 0.25, 0.125); });
}

TEST(ProgramDraws, ShadersThatCannotRunAreGreyAndNoted) {
  ProgramTrace scene(4, 4, std::vector<std::uint32_t>{1, 2, 3});
  scene.fill();
  for (const char* spec : {"msaa:1", "reference", "beam"})
    expect_picture(scene.trace, spec, [](auto, auto) { return glm::vec3(static_cast<float>(encoded_as_srgb(0.5))); });
  const std::vector<DrawNote> notes = notes_of(scene.trace, {0}, ProgramSet(scene.trace), "");
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].reason.substr(0, 43), "in one grey, as shader \"shader\" cannot run:");
  EXPECT_EQ(notes[0].reason.find('\n'), std::string::npos);
  EXPECT_EQ(notes[0].draws, 1u);
  EXPECT_EQ(notes[0].triangles, 2u);
  EXPECT_FALSE(notes[0].left_out);
}

// Counts a number down from 2000 times the first input, and without end where the second input is 1, not 0.
const ShaderParts kCountdown{.body = R"(
%x = OpCompositeExtract %float %va 0
%y = OpCompositeExtract %float %va 1
%product = OpFMul %float %x %thousands
OpBranch %header
%header = OpLabel
%left = OpPhi %float %product %entry %less %again
%is_positive = OpFOrdGreaterThan %bool %left %f0
%is_endless = OpFOrdGreaterThan %bool %y %half_
%goes_on = OpLogicalOr %bool %is_positive %is_endless
OpLoopMerge %after %again None
OpBranchConditional %goes_on %again %after
%again = OpLabel
%less = OpFSub %float %left %f1
OpBranch %header
%after = OpLabel
%white = OpSelect %float %is_positive %f0 %f1
%r = OpCompositeConstruct %v4 %white %white %white %f1
OpStore %out %r
)",
                             .globals = "%thousands = OpConstant %float 2000\n%half_ = OpConstant %float 0.5\n"};

// The left and the right half of the picture, each with its inputs. Nothing is where invocations are stopped.
ProgramTrace countdown_scene(const std::vector<float>& left, const std::vector<float>& right) {
  ProgramTrace scene(8, 8, kCountdown);
  for (const float side : {-1.0f, 0.0f}) {
    const std::vector<float>& inputs = side < 0 ? left : right;
    scene.add_quad({{{side, 1, 0, 1}, inputs},
                    {{side + 1, 1, 0, 1}, inputs},
                    {{side, -1, 0, 1}, inputs},
                    {{side + 1, -1, 0, 1}, inputs}});
  }
  scene.trace.frames[0].background = glm::vec3(0);
  return scene;
}

TEST(ProgramDraws, InvocationsWithoutEndAreStoppedAndCounted) {
  ProgramTrace scene = countdown_scene({1, 0}, {0, 1});
  for (const char* spec : kSpecs)
    expect_picture(scene.trace, spec, [](auto x, auto) { return glm::vec3(x < 4 ? 1 : 0); });
  const auto stopped = [&](const char* spec, int threads) { return rendered(scene.trace, spec, threads).stopped; };
  EXPECT_EQ(stopped("msaa:1", 1), (std::vector<StoppedDraw>{{1, 32}}));  // 4 by 8 pixels
  for (const char* spec : {"beam", "msaa:4", "reference"}) {
    const std::vector<StoppedDraw> one = stopped(spec, 1);
    ASSERT_EQ(one.size(), 1u) << spec;
    EXPECT_EQ(one[0].draw, 1u);
    EXPECT_GE(one[0].invocations, 32u);
    EXPECT_EQ(stopped(spec, 4), one) << spec;
  }
  std::vector<DrawNote> notes;
  add_stopped(scene.trace, 0, "msaa:1", stopped("msaa:1", 1), notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(text_of(notes[0]),
            "1 draw (2 triangles) is drawn in the nearest way: shader \"shader\" is stopped where it takes too many "
            "steps (msaa:1): 32 invocations");
  EXPECT_EQ(notes_form().write(notes).at(0).at("invocations"), 32);
}

// 2000 turns of a loop are allowed, unless invocations of the same draw have no end.
TEST(ProgramDraws, DrawsWithoutEndAreStoppedSooner) {
  ProgramTrace scene = countdown_scene({1, 0}, {0.01f, 0});
  EXPECT_TRUE(rendered(scene.trace, "msaa:1").stopped.empty());
  // The second triangle of the left half has no end.
  Mesh& mesh = scene.trace.meshes[0];
  mesh.positions.insert(mesh.positions.end(), {mesh.positions[2], mesh.positions[1], mesh.positions[3]});
  mesh.ws.insert(mesh.ws.end(), 3, 1.0f);
  for (int i = 0; i < 3; ++i)
    for (const float number : {1.0f, 1.0f}) mesh.varyings.push_back(std::bit_cast<std::uint32_t>(number));
  mesh.triangles[1] = {4, 5, 6};
  EXPECT_EQ(rendered(scene.trace, "msaa:1").stopped, (std::vector<StoppedDraw>{{0, 32}}));
}

TEST(ProgramDraws, ThreadsChangeNothing) {
  const ProgramTrace scene = textured_scene();
  for (const char* spec : {"msaa:4", "beam"}) {
    const FrameResult one = rendered(scene.trace, spec, 1), four = rendered(scene.trace, spec, 4);
    EXPECT_EQ(one.image.rgba, four.image.rgba);
    for (std::size_t i = 0; i < one.stages.size(); ++i) EXPECT_EQ(one.stages[i].ops, four.stages[i].ops);
  }
}

// BEAMPIPE_WRITE_SAMPLES=1 writes the sample again.
TEST(ProgramDraws, TheSampleIsTheTexturedScene) {
  const std::filesystem::path sample =
      std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples/program_quad.json";
  const Trace trace = textured_scene().trace;
  if (std::getenv("BEAMPIPE_WRITE_SAMPLES")) write_trace(trace, sample);
  EXPECT_EQ(rendered(read_trace(sample), "msaa:1").image.rgba, rendered(trace, "msaa:1").image.rgba);
}

}  // namespace beampipe::program_draws_test
