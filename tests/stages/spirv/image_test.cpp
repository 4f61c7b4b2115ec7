// Images through a reader that says what it was asked, and differences in groups of four lanes.
#include "tests/message_of.h"
#include "tests/stages/spirv/shader_text.h"

namespace beampipe {
namespace {

// Answers with its coordinates and notes what was asked.
struct Asked {
  ImageRequest request;
  std::array<std::array<LaneRow, 4>, 4> rows;  // coordinates, dx, dy, offset
  LaneRow lod, reference;
  std::uint64_t askers = 0;  // lanes
};
class Echo : public ImageReader {
 public:
  void read(const ImageRequest& request, const std::array<LaneRow*, 4>& texel) override {
    Asked one{request, {}, {}, {}};
    for (std::size_t lane = 0; lane < request.lanes; ++lane) one.askers |= std::uint64_t{request.asks(lane)} << lane;
    for (std::size_t i = 0; i < 4; ++i) {
      if (request.coordinates[i]) one.rows[0][i] = *request.coordinates[i];
      if (i == 3) continue;
      if (request.dx[i]) one.rows[1][i] = *request.dx[i];
      if (request.dy[i]) one.rows[2][i] = *request.dy[i];
      if (request.offset[i]) one.rows[3][i] = *request.offset[i];
    }
    if (request.lod) one.lod = *request.lod;
    if (request.reference) one.reference = *request.reference;
    asked.push_back(one);
    for (std::size_t lane = 0; lane < request.lanes; ++lane) {
      if (!request.asks(lane)) continue;
      for (std::uint32_t i = 0; i < 4; ++i)
        texel[i]->bits[lane] = request.coordinates[i] ? request.coordinates[i]->bits[lane] : 7 + i;
    }
  }
  std::vector<Asked> asked;
};

constexpr const char* kImages = R"(
%image2 = OpTypeImage %float 2D 0 0 0 1 Unknown
%sampled2 = OpTypeSampledImage %image2
%to_sampled2 = OpTypePointer UniformConstant %sampled2
%texture = OpVariable %to_sampled2 UniformConstant
%image_array = OpTypeImage %float 2D 1 1 0 1 Unknown
%to_image_array = OpTypePointer UniformConstant %image_array
%shadow = OpVariable %to_image_array UniformConstant
%sampler = OpTypeSampler
%to_sampler = OpTypePointer UniformConstant %sampler
%compare = OpVariable %to_sampler UniformConstant
%sampled_array = OpTypeSampledImage %image_array
%image_u = OpTypeImage %uint 3D 0 0 0 1 Unknown
%sampled_u = OpTypeSampledImage %image_u
%many = OpTypeArray %sampled_u %u4_
%to_many = OpTypePointer UniformConstant %many
%to_sampled_u = OpTypePointer UniformConstant %sampled_u
%volumes = OpVariable %to_many UniformConstant
)";
constexpr const char* kBindings = R"(
OpDecorate %texture DescriptorSet 0
OpDecorate %texture Binding 5
OpDecorate %shadow DescriptorSet 1
OpDecorate %shadow Binding 6
OpDecorate %compare DescriptorSet 1
OpDecorate %compare Binding 7
OpDecorate %volumes DescriptorSet 2
OpDecorate %volumes Binding 8
)";

struct ImageShader : TestShader {
  // `body`: what makes %r of floats, or %ints of integers, of the image %i_ and the place %uv or anything else.
  explicit ImageShader(const std::string& body, const std::string& globals = "")
      : TestShader(ShaderParts{.body = "%i_ = OpLoad %sampled2 %texture\n%uv = OpVectorShuffle %v2 %va %va 0 1\n" +
                                       body +
                                       (body.find("%r = ") != body.npos ? "OpStore %out %r" : "OpStore %iout %ints"),
                               .globals = kImages + globals,
                               .decorations = kBindings}) {
    resources.images = &echo;
  }
  Echo echo;
};

// Coordinates x + 3 y and x y, over quads of pixels.
void set_quads(TestShader& shader) {
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) {
    const float x = static_cast<float>(lane / 4 % 4 * 2 + lane % 2),
                y = static_cast<float>(lane / 16 * 2 + lane / 2 % 2);
    shader.set(0, 0, lane, x + 3 * y), shader.set(0, 1, lane, x * y), shader.set(0, 2, lane, 2);
  }
}

TEST(SpirvImages, ImplicitDetailHasTheDifferencesOfItsQuad) {
  ImageShader shader(R"(
%r = OpImageSampleImplicitLod %v4 %i_ %uv
)");
  set_quads(shader);
  shader.run();
  EXPECT_TRUE(shader.program.takes_differences);
  ASSERT_EQ(shader.program.images.size(), 1u);
  EXPECT_EQ(shader.program.images[0].binding, 5u);
  EXPECT_TRUE(shader.program.images[0].has_sampler);
  ASSERT_EQ(shader.echo.asked.size(), 1u);
  const Asked& asked = shader.echo.asked[0];
  EXPECT_EQ(asked.request.action, ImageAction::sample);
  EXPECT_EQ(asked.request.coordinates[2], nullptr);
  EXPECT_EQ(asked.request.lod, nullptr);
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) {
    const float x = static_cast<float>(lane / 4 % 4 * 2 + lane % 2),
                y = static_cast<float>(lane / 16 * 2 + lane / 2 % 2);
    EXPECT_EQ(asked.rows[1][0].number(lane), 1);
    EXPECT_EQ(asked.rows[2][0].number(lane), 3);
    // Of the quad's first row and column, not of the lane's own.
    EXPECT_EQ(asked.rows[1][1].number(lane), static_cast<float>(lane / 16 * 2));
    EXPECT_EQ(asked.rows[2][1].number(lane), static_cast<float>(lane / 4 % 4 * 2));
    EXPECT_EQ(shader.number(0, lane), x + 3 * y);
    EXPECT_EQ(shader.output(0, 2).bits[lane], 9u);
  }
  EXPECT_EQ(shader.counts.texture_requests, kShaderLanes);
  EXPECT_EQ(shader.counts.ops.total(), 0u);
}

constexpr std::uint64_t kFirsts = 0x1111111111111111;  // lanes: the first of each group

// The first image says where the second is read, and so how its place differs between neighbours. What it returns
// itself only matters to lanes that are kept.
TEST(SpirvImages, HelpersReadWhatDifferencesAreMadeFrom) {
  ImageShader shader(R"(
%place = OpImageSampleImplicitLod %v4 %i_ %uv
%there = OpVectorShuffle %v2 %place %place 1 0
%r = OpImageSampleImplicitLod %v4 %i_ %there
)");
  set_quads(shader);
  shader.executor.run(shader.resources, kShaderLanes, ~std::uint64_t{0}, ~kFirsts, shader.counts);
  ASSERT_EQ(shader.echo.asked.size(), 2u);
  EXPECT_EQ(shader.echo.asked[0].askers, ~std::uint64_t{0});
  EXPECT_EQ(shader.echo.asked[1].askers, kFirsts);
  for (std::uint32_t lane = 0; lane < kShaderLanes; lane += 4) {
    EXPECT_EQ(shader.echo.asked[1].rows[1][1].number(lane), 1) << "the differences of x + 3 y";
    EXPECT_EQ(shader.echo.asked[1].rows[2][1].number(lane), 3);
    EXPECT_EQ(shader.number(0, lane), shader.input(0, 1)->number(lane));
  }
  EXPECT_EQ(shader.counts.texture_requests, 2 * kShaderLanes) << "hardware reads them all";
}

// Where lanes go decides what they read next.
TEST(SpirvImages, HelpersReadWhatDecidesTheirWay) {
  ImageShader shader(R"(
%vu = OpVectorShuffle %v2 %va %va 1 0
%texel = OpImageSampleImplicitLod %v4 %i_ %uv
%red = OpCompositeExtract %float %texel 0
%is_low = OpFOrdLessThan %bool %red %f1
OpSelectionMerge %end None
OpBranchConditional %is_low %low %end
%low = OpLabel
OpBranch %end
%end = OpLabel
%where = OpPhi %v2 %uv %entry %vu %low
%r = OpImageSampleImplicitLod %v4 %i_ %where
)");
  set_quads(shader);
  shader.executor.run(shader.resources, kShaderLanes, ~std::uint64_t{0}, ~kFirsts, shader.counts);
  ASSERT_EQ(shader.echo.asked.size(), 2u);
  EXPECT_EQ(shader.echo.asked[0].askers, ~std::uint64_t{0});
  EXPECT_EQ(shader.echo.asked[1].askers, kFirsts);
}

TEST(SpirvImages, ProjectionsDivide) {
  ImageShader shader(R"(
%uvq = OpVectorShuffle %v3 %va %va 0 1 2
%r = OpImageSampleProjImplicitLod %v4 %i_ %uvq Bias|ConstOffset %f2 %offset
)",
                     "%offset = OpConstantComposite %i2 %i1 %i2_\n");
  set_quads(shader);
  shader.run();
  const Asked& asked = shader.echo.asked.at(0);
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) {
    const float x = static_cast<float>(lane / 4 % 4 * 2 + lane % 2),
                y = static_cast<float>(lane / 16 * 2 + lane / 2 % 2);
    EXPECT_EQ(asked.rows[0][0].number(lane), (x + 3 * y) / 2);
    EXPECT_EQ(asked.rows[1][0].number(lane), 0.5f);
    EXPECT_EQ(asked.rows[3][1].bits[lane], 2u);
  }
  EXPECT_NE(asked.request.bias, nullptr);
  EXPECT_EQ(shader.counts.ops.special, 2 * kShaderLanes);
}

TEST(SpirvImages, ComparisonsWithASamplerOfTheirOwn) {
  ImageShader shader(R"(
%shadow_ = OpLoad %image_array %shadow
%s_ = OpLoad %sampler %compare
%both = OpSampledImage %sampled_array %shadow_ %s_
%uvl = OpVectorShuffle %v3 %va %va 0 1 2
%x = OpImageSampleDrefExplicitLod %float %both %uvl %f1 Lod %f2
%g = OpImageDrefGather %v4 %both %uvl %f2
%y = OpCompositeExtract %float %g 1
%r = OpCompositeConstruct %v4 %x %y %f0 %f0
)");
  set_quads(shader);
  shader.run();
  EXPECT_FALSE(shader.program.takes_differences);
  ASSERT_EQ(shader.program.samplers.size(), 1u);
  EXPECT_EQ(shader.program.samplers[0].binding, 7u);
  EXPECT_TRUE(shader.program.images[0].depth);
  EXPECT_TRUE(shader.program.images[0].arrayed);
  ASSERT_EQ(shader.echo.asked.size(), 2u);
  EXPECT_EQ(shader.echo.asked[0].request.sampler, 0u);
  EXPECT_EQ(shader.echo.asked[0].lod.number(3), 2);
  EXPECT_EQ(shader.echo.asked[0].reference.number(3), 1);
  EXPECT_EQ(shader.echo.asked[0].rows[0][2].number(3), 2);  // the layer
  EXPECT_EQ(shader.echo.asked[1].request.action, ImageAction::gather);
  EXPECT_EQ(shader.echo.asked[1].reference.number(3), 2);
  EXPECT_EQ(shader.number(0, 9), shader.echo.asked[0].rows[0][0].number(9));
}

TEST(SpirvImages, ComparisonsThatProject) {
  ImageShader shader(R"(
%uvq = OpVectorShuffle %v3 %va %va 0 1 2
%x = OpImageSampleDrefImplicitLod %float %i_ %uv %f1
%y = OpImageSampleProjDrefImplicitLod %float %i_ %uvq %f1
%z = OpImageSampleProjDrefExplicitLod %float %i_ %uvq %f1 Lod %f2
%r = OpCompositeConstruct %v4 %x %y %z %f0
)");
  set_quads(shader);
  shader.run();
  EXPECT_TRUE(shader.program.takes_differences);
  ASSERT_EQ(shader.echo.asked.size(), 3u);
  const Asked &plain = shader.echo.asked[0], &projected = shader.echo.asked[1], &explicit_lod = shader.echo.asked[2];
  for (const Asked* const asked : {&plain, &projected, &explicit_lod})
    EXPECT_EQ(asked->request.action, ImageAction::sample);
  EXPECT_EQ(plain.reference.number(3), 1);
  // The place and the reference are divided by the third part of %uvq, which is 2.
  for (const Asked* const asked : {&projected, &explicit_lod}) {
    EXPECT_EQ(asked->reference.number(3), 0.5f);
    EXPECT_EQ(asked->rows[0][0].number(3), plain.rows[0][0].number(3) / 2);
  }
  EXPECT_EQ(explicit_lod.lod.number(3), 2);
}

TEST(SpirvImages, FetchesAndQueriesOfAnElement) {
  ImageShader shader(R"(
%n = OpCompositeExtract %uint %vi 3
%p = OpAccessChain %to_sampled_u %volumes %n
%both = OpLoad %sampled_u %p
%image = OpImage %image_u %both
%xyz = OpVectorShuffle %u3 %vi %vi 0 1 2
%texel = OpImageFetch %u4 %image %xyz Lod %u1
%size = OpImageQuerySizeLod %u3 %image %u2_
%levels = OpImageQueryLevels %uint %image
%a0 = OpCompositeExtract %uint %texel 0
%a1 = OpCompositeExtract %uint %texel 3
%a2 = OpCompositeExtract %uint %size 2
%ints = OpCompositeConstruct %u4 %a0 %a1 %a2 %levels
)",
                     "%u3 = OpTypeVector %uint 3\n");
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane)
    for (std::uint32_t i = 0; i < 4; ++i) shader.set_integer(3, i, lane, lane * 10 + i);
  shader.run();
  ASSERT_EQ(shader.echo.asked.size(), 3u);
  EXPECT_EQ(shader.program.images.at(0).count, 4u);
  EXPECT_EQ(shader.program.images.at(0).texels, TexelKind::unsigned_integers);
  EXPECT_EQ(shader.program.images.at(0).dim, spv::Dim3D);
  EXPECT_EQ(shader.integer(0, 5), 50u);
  EXPECT_EQ(shader.integer(1, 5), 10u);
  EXPECT_EQ(shader.integer(2, 5), 9u);
  EXPECT_EQ(shader.integer(3, 5), 7u);
  EXPECT_EQ(shader.echo.asked[1].lod.bits[0], 2u);
  EXPECT_EQ(shader.counts.texture_requests, kShaderLanes);  // queries read no texels
}

TEST(SpirvImages, ImagesWithSeveralSamplesAndStorageImagesAreRefused) {
  // `type`: the operands of OpTypeImage after a texel's type. `read`: what makes a texel of %image_ at %place.
  const auto error_of = [](const std::string& type, const std::string& read) {
    const ShaderParts parts{.body = "%image_ = OpLoad %image %kept\n%place = OpVectorShuffle %u2 %vi %vi 0 1\n" +
                                    ("%texel = " + read) + "\nOpStore %out %texel\n",
                            .globals = "%image = OpTypeImage %float " + type + R"(
%to_image = OpTypePointer UniformConstant %image
%kept = OpVariable %to_image UniformConstant
)"};
    return message_of<ShaderError>([&] { load_fragment_shader(assembled(shader_text(parts))); });
  };
  EXPECT_EQ(error_of("2D 0 0 1 1 Unknown", "OpImageFetch %v4 %image_ %place Sample %u1"),
            "images with several samples are not supported");
  EXPECT_EQ(error_of("2D 0 0 0 2 Rgba8", "OpImageRead %v4 %image_ %place"), "storage images are not supported");
}

// Only lanes that run the instruction ask, and only they get an answer.
TEST(SpirvImages, InBranches) {
  ImageShader shader(R"(
%odd = OpIEqual %bool %vi0 %u1
OpSelectionMerge %end None
OpBranchConditional %odd %read %end
%read = OpLabel
%texel = OpImageSampleExplicitLod %v4 %i_ %uv Lod %f0
OpBranch %end
%end = OpLabel
%r = OpPhi %v4 %f1111 %entry %texel %read
)");
  set_quads(shader);
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) shader.set_integer(3, 0, lane, lane % 2);
  shader.run();
  EXPECT_EQ(shader.counts.texture_requests, kShaderLanes / 2);
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane)
    EXPECT_EQ(shader.number(0, lane), lane % 2 ? shader.input(0, 0)->number(lane) : 1.0f);
}

TEST(SpirvImages, DifferencesWithMissingNeighbours) {
  TestShader shader(ShaderParts{.body = R"(
%x = OpCompositeExtract %float %va 0
%dx = OpDPdx %float %x
%dy = OpDPdy %float %x
%cx = OpDPdxCoarse %float %x
%cy = OpDPdyCoarse %float %x
)",
                                .floats = "%dx %dy %cx %cy"});
  // Values of a quad: 1 10 / 100 1000.
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane)
    shader.set(0, 0, lane, std::array{1.0f, 10.0f, 100.0f, 1000.0f}[lane % 4]);
  const auto run = [&](std::uint64_t active) { shader.executor.run(shader.resources, 4, active, 0, shader.counts); };
  const auto expect = [&](std::size_t lane, float dx, float dy, float coarse_x, float coarse_y) {
    EXPECT_EQ(shader.number(0, lane), dx) << lane;
    EXPECT_EQ(shader.number(1, lane), dy) << lane;
    EXPECT_EQ(shader.number(2, lane), coarse_x) << lane;
    EXPECT_EQ(shader.number(3, lane), coarse_y) << lane;
  };
  run(0xf);
  expect(0, 9, 99, 9, 99), expect(1, 9, 990, 9, 99), expect(2, 900, 99, 9, 99), expect(3, 900, 990, 9, 99);
  run(0x7);  // a place, that to its right and that below
  expect(0, 9, 99, 9, 99), expect(1, 9, 99, 9, 99), expect(2, 9, 99, 9, 99);
  run(0xe);
  expect(1, 900, 990, 900, 990), expect(3, 900, 990, 900, 990);
  run(0x1);
  expect(0, 0, 0, 0, 0);
}

// Texels that become 16-bit floats are rounded towards zero.
TEST(SpirvImages, HalvesOfTexels) {
  ImageShader shader(R"(
%shadow_ = OpLoad %image_array %shadow
%s_ = OpLoad %sampler %compare
%both = OpSampledImage %sampled_array %shadow_ %s_
%uvl = OpVectorShuffle %v3 %va %va 0 1 2
%texel = OpImageSampleExplicitLod %v4 %both %uvl Lod %f0
%bits = OpBitcast %u4 %texel
%again = OpBitcast %v4 %bits
%h = OpFConvert %h4 %again
%r = OpFConvert %v4 %h
)");
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNumbers[][2] = {{1 + 0x1p-11f + 0x1p-12f, 1},
                                   {-1 - 0x1p-11f - 0x1p-12f, -1},
                                   {1 + 0x1p-10f, 1 + 0x1p-10f},
                                   {70000, 65504},
                                   {-65519, -65504},
                                   {kInfinity, kInfinity},
                                   {0x1.fp-25f, 0},
                                   {0x1.cp-24f, 0x1p-24f},
                                   {-0x1.ffcp-15f, -0x1.ff8p-15f},
                                   {0x1.fffp-15f, 0x1.ff8p-15f}};
  for (std::size_t lane = 0; lane < std::size(kNumbers); ++lane) shader.set(0, 0, lane, kNumbers[lane][0]);
  shader.run();
  for (std::size_t lane = 0; lane < std::size(kNumbers); ++lane)
    EXPECT_EQ(shader.number(0, lane), kNumbers[lane][1]) << lane;
}

TEST(SpirvImages, WidthsAreSumsOfDifferences) {
  TestShader shader(ShaderParts{.body = R"(
%x = OpCompositeExtract %float %va 0
%any = OpFwidth %float %x
%fine = OpFwidthFine %float %x
%coarse = OpFwidthCoarse %float %x
)",
                                .floats = "%any %fine %coarse %f0"});
  EXPECT_TRUE(shader.program.takes_differences);
  // Values of a quad: 1 -10 / 100 1000.
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane)
    shader.set(0, 0, lane, std::array{1.0f, -10.0f, 100.0f, 1000.0f}[lane % 4]);
  shader.run(4);
  constexpr float kFine[] = {11 + 99, 11 + 1010, 900 + 99, 900 + 1010};
  for (std::uint32_t lane = 0; lane < 4; ++lane) {
    EXPECT_EQ(shader.number(0, lane), kFine[lane]);
    EXPECT_EQ(shader.number(1, lane), kFine[lane]);
    EXPECT_EQ(shader.number(2, lane), 11 + 99);
  }
}

}  // namespace
}  // namespace beampipe
