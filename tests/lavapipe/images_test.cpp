// Reads of images against Mesa's lavapipe, on random texels and places: formats, filters, wraps, levels, comparisons,
// gathers, fetches and questions.
#include "stages/data/half_bits.h"
#include "tests/lavapipe/lavapipe_test.h"

namespace beampipe {
namespace {

// How shaders declare an image: OpTypeImage's operands after the type of a texel, and how many coordinates it needs.
struct Declared {
  ImageShape shape;
  bool array;
  const char* type;
  std::uint32_t coordinates;
};
constexpr Declared k1D{ImageShape::d1, false, "1D 0 0 0 1 Unknown", 1};
constexpr Declared k2D{ImageShape::d2, false, "2D 0 0 0 1 Unknown", 2};
constexpr Declared k3D{ImageShape::d3, false, "3D 0 0 0 1 Unknown", 3};
constexpr Declared kCube{ImageShape::cube, false, "Cube 0 0 0 1 Unknown", 3};
constexpr Declared k1DArray{ImageShape::d1, true, "1D 0 1 0 1 Unknown", 2};
constexpr Declared k2DArray{ImageShape::d2, true, "2D 0 1 0 1 Unknown", 3};
constexpr Declared kCubeArray{ImageShape::cube, true, "Cube 0 1 0 1 Unknown", 4};
constexpr Declared kBuffer{ImageShape::d1, false, "Buffer 0 0 0 1 Unknown", 1};

constexpr Declared kSampled[] = {k1D, k2D, k3D, kCube, k1DArray, k2DArray, kCubeArray};
constexpr TexelFormat kNumbers[] = {
    TexelFormat::R8_UNORM,          TexelFormat::R8G8_UNORM,          TexelFormat::R8G8B8A8_UNORM,
    TexelFormat::R8G8B8A8_SRGB,     TexelFormat::B8G8R8A8_UNORM,      TexelFormat::B8G8R8A8_SRGB,
    TexelFormat::R16_SFLOAT,        TexelFormat::R16G16_SFLOAT,       TexelFormat::R16G16B16A16_SFLOAT,
    TexelFormat::R32_SFLOAT,        TexelFormat::R32G32B32A32_SFLOAT, TexelFormat::D32_SFLOAT,
    TexelFormat::R16G16B16A16_UNORM};

class LavapipeImages : public LavapipeTest {
 protected:
  ProgramImage image(const Declared& declared, TexelFormat format = TexelFormat::R8G8B8A8_UNORM) {
    ProgramImage made{.shape = declared.shape, .format = format, .width = 13, .array = declared.array};
    if (declared.shape == ImageShape::d2 || declared.shape == ImageShape::d3) made.height = 7;
    if (declared.shape == ImageShape::d3) made.depth = 5;
    if (declared.shape == ImageShape::cube) made.width = made.height = 8, made.layers = 6;
    if (declared.array) made.layers *= 3;
    made.levels = 4;
    fill(made);
    return made;
  }
  void fill(ProgramImage& made) {
    made.texels.resize(level_start(made, made.levels));
    const auto put = [&](std::size_t at, auto word) { std::memcpy(made.texels.data() + at, &word, sizeof word); };
    for (std::size_t i = 0; i < made.texels.size(); i += 4) {
      switch (made.format) {
        case TexelFormat::R16_SFLOAT:
        case TexelFormat::R16G16_SFLOAT:
        case TexelFormat::R16G16B16A16_SFLOAT:
          for (std::size_t k = i; k < i + 4 && k < made.texels.size(); k += 2) put(k, half_of(uniform(-2, 2)));
          break;
        case TexelFormat::R32_SFLOAT:
        case TexelFormat::R32G32B32A32_SFLOAT:
          put(i, uniform(-2, 2));
          break;
        case TexelFormat::D32_SFLOAT:
          put(i, uniform(0, 1));
          break;
        default:
          for (std::size_t k = i; k < i + 4 && k < made.texels.size(); ++k)
            made.texels[k] = static_cast<std::uint8_t>(random_());
      }
    }
  }

  // Instructions that make %r of four numbers from the image %image_ (with its sampler) at %place, of so many
  // coordinates. `texel`: the type of a texel, and of the results.
  struct Reading {
    Declared declared;
    std::string body;
    ProgramSampler sampler{};
    std::string texel = "float";
    std::string globals{};
  };
  ShaderCase bound(const Reading& reading, const ProgramImage& texels, bool is_triangle, float least = -1.5f,
                   float most = 1.5f) {
    const bool is_float = reading.texel == "float";
    const std::string result = is_float ? "OpStore %out %r\nOpStore %iout %u0000"
                                        : "%bits = OpBitcast %u4 %r\nOpStore %iout %bits\nOpStore %out %f0000";
    const ShaderParts parts{
        .body = "%image_ = OpLoad %sampled %texture\n" + place_of(reading.declared.coordinates) + reading.body + "\n" +
                result,
        .globals = "%image = OpTypeImage %" + reading.texel + " " + reading.declared.type +
                   "\n%sampled = OpTypeSampledImage %image\n%to_sampled = OpTypePointer UniformConstant %sampled\n"
                   "%texture = OpVariable %to_sampled UniformConstant\n" +
                   reading.globals,
        .decorations = "OpDecorate %texture DescriptorSet 0\nOpDecorate %texture Binding 2",
        .capabilities = "OpCapability SampledCubeArray\nOpCapability ImageGatherExtended"};
    ShaderCase made = is_triangle ? triangle(parts) : points(parts, least, most);
    made.images = {texels}, made.samplers = {reading.sampler};
    made.use.images.push_back({.set = 0, .binding = 2, .image = 0, .sampler = 0});
    return made;
  }
  static std::string place_of(std::uint32_t coordinates) {
    if (coordinates == 1) return "%place = OpCompositeExtract %float %va 0\n";
    if (coordinates == 4) return "%place = OpCopyObject %v4 %va\n";
    std::string text = "%place = OpVectorShuffle %v" + std::to_string(coordinates) + " %va %va";
    for (std::uint32_t i = 0; i < coordinates; ++i) text += " " + std::to_string(i);
    return text + "\n";
  }
};

TEST_F(LavapipeImages, ShapesAndFilters) {
  for (const Declared& declared : kSampled)
    for (const Filter filter : {Filter::nearest, Filter::linear}) {
      const Reading reading{.declared = declared,
                            .body =
                                "%b0 = OpCompositeExtract %float %vb 0\n%lod = OpFAdd %float %b0 %f2\n"
                                "%r = OpImageSampleExplicitLod %v4 %image_ %place Lod %lod",
                            .sampler = {.mag = filter, .min = filter, .mip = filter}};
      expect_near(bound(reading, image(declared), false),
                  std::string(declared.type) + (filter == Filter::linear ? " linear" : ""));
    }
}

TEST_F(LavapipeImages, Formats) {
  for (const TexelFormat format : kNumbers) {
    // The driver's polynomial for sRGB is so far from its definition.
    const bool is_srgb = format == TexelFormat::R8G8B8A8_SRGB || format == TexelFormat::B8G8R8A8_SRGB;
    expect_near(bound({.declared = k2D, .body = "%r = OpImageSampleExplicitLod %v4 %image_ %place Lod %f0"},
                      image(k2D, format), false),
                "format " + std::to_string(static_cast<int>(format)), is_srgb ? 2e-3 : 1e-5);
  }
  for (const auto& [format, type] :
       {std::pair(TexelFormat::R32G32B32A32_UINT, "u"), std::pair(TexelFormat::R32G32B32A32_SINT, "i")})
    expect_near(bound({.declared = k2D,
                       .body = std::string("%r = OpImageSampleExplicitLod %") + type + "4 %image_ %place Lod %f1",
                       .sampler = {.mag = Filter::nearest, .min = Filter::nearest, .mip = Filter::nearest},
                       .texel = type == std::string("u") ? "uint" : "int"},
                      image(k2D, format), false),
                type);
}

TEST_F(LavapipeImages, Wraps) {
  for (const SamplerWrap wrap : {SamplerWrap::repeat, SamplerWrap::mirror, SamplerWrap::clamp_to_edge,
                                 SamplerWrap::clamp_to_border, SamplerWrap::mirror_clamp})
    for (const Filter filter : {Filter::nearest, Filter::linear})
      expect_near(
          bound({.declared = k2D,
                 .body = "%r = OpImageSampleExplicitLod %v4 %image_ %place Lod %f0",
                 .sampler =
                     {.mag = filter, .min = filter, .wrap = {wrap, wrap, wrap}, .border = {0.25f, 0.5f, 0.75f, 1}}},
                image(k2D), false, -3, 3),
          std::to_string(static_cast<int>(wrap)));
}

TEST_F(LavapipeImages, LevelsOfThePixelsFootprint) {
  for (const Declared& declared : {k1D, k2D, k3D, k2DArray})
    expect_near(bound({.declared = declared, .body = "%r = OpImageSampleImplicitLod %v4 %image_ %place"},
                      image(declared), true),
                declared.type);
  expect_near(
      bound(
          {.declared = k2D,
           .body = "%b0 = OpCompositeExtract %float %vb 0\n%r = OpImageSampleImplicitLod %v4 %image_ %place Bias %b0"},
          image(k2D), true),
      "bias");
  expect_near(bound({.declared = k2D,
                     .body = "%b0 = OpVectorShuffle %v2 %vb %vb 0 1\n%dx = OpVectorTimesScalar %v2 %b0 %small\n"
                             "%b1 = OpVectorShuffle %v2 %vb %vb 2 3\n%dy = OpVectorTimesScalar %v2 %b1 %small\n"
                             "%r = OpImageSampleExplicitLod %v4 %image_ %place Grad %dx %dy",
                     .globals = "%small = OpConstant %float 0.25"},
                    image(k2D), false),
              "slopes");
  expect_near(bound({.declared = k2D,
                     .body = "%r = OpImageSampleImplicitLod %v4 %image_ %place",
                     .sampler = {.lod_bias = 0.5f, .least_lod = 0.75f, .most_lod = 1.5f}},
                    image(k2D), true),
              "bounds");
  expect_near(bound({.declared = k2D,
                     .body = "%q = OpImageQueryLod %v2 %image_ %place\n%r = OpVectorShuffle %v4 %q %q 0 1 0 1"},
                    image(k2D), true),
              "levels themselves");
}

TEST_F(LavapipeImages, ProjectionsAndOffsets) {
  expect_near(bound({.declared = k2D,
                     .body = "%x = OpVectorShuffle %v3 %va %va 0 1 2\n%y = OpExtInst %v3 %glsl FAbs %x\n%ones = "
                             "OpCompositeConstruct %v3 %f0 %f0 %f1\n"
                             "%p = OpFAdd %v3 %y %ones\n%r = OpImageSampleProjExplicitLod %v4 %image_ %p Lod %f0"},
                    image(k2D), false),
              "projection");
  expect_near(bound({.declared = k2D,
                     .body = "%r = OpImageSampleExplicitLod %v4 %image_ %place Lod|ConstOffset %f1 %offset",
                     .globals = "%minus = OpConstant %int -3\n%offset = OpConstantComposite %i2 %i2_ %minus"},
                    image(k2D), false),
              "offset");
}

TEST_F(LavapipeImages, Comparisons) {
  for (const Compare compare : {Compare::never, Compare::less, Compare::equal, Compare::less_equal, Compare::greater,
                                Compare::not_equal, Compare::greater_equal, Compare::always})
    expect_near(bound({.declared = {ImageShape::d2, false, "2D 1 0 0 1 Unknown", 2},
                       .body = "%b0 = OpCompositeExtract %float %vb 0\n"
                               "%x = OpImageSampleDrefExplicitLod %float %image_ %place %b0 Lod %f0\n"
                               "%r = OpCompositeConstruct %v4 %x %x %x %x",
                       .sampler = {.compare = compare}},
                      image(k2D, TexelFormat::D32_SFLOAT), false),
                std::to_string(static_cast<int>(compare)));
}

TEST_F(LavapipeImages, Gathers) {
  for (const std::string component : {"%i0", "%i1", "%i3_"})
    expect_near(
        bound({.declared = k2D, .body = "%r = OpImageGather %v4 %image_ %place " + component}, image(k2D), false),
        component);
  expect_near(bound({.declared = {ImageShape::d2, false, "2D 1 0 0 1 Unknown", 2},
                     .body = "%b0 = OpCompositeExtract %float %vb 0\n%r = OpImageDrefGather %v4 %image_ %place %b0",
                     .sampler = {.compare = Compare::less}},
                    image(k2D, TexelFormat::D32_SFLOAT), false),
              "comparison");
}

TEST_F(LavapipeImages, FetchesAndQuestions) {
  const std::string load = "%alone = OpImage %image %image_\n";
  for (const Declared& declared : {k2D, k3D, k2DArray}) {
    const std::string count = std::to_string(declared.coordinates), type = "%i" + count;
    std::string at =
        "%n = OpBitwiseAnd %u4 %vi %three\n%m = OpBitcast %i4 %n\n%at = OpVectorShuffle " + type + " %m %m";
    for (std::uint32_t i = 0; i < declared.coordinates; ++i) at += " " + std::to_string(i);
    // At level 1, whose depth is 2, and of three layers: outside as well as inside.
    expect_near(bound({.declared = declared,
                       .body = load + at + "\n%r = OpImageFetch %v4 %alone %at Lod %i1",
                       .globals = "%three = OpConstantComposite %u4 %u3_ %u3_ %u1 %u1"},
                      image(declared), false),
                std::string("fetch ") + declared.type);
    expect_near(bound({.declared = declared,
                       .body = load +
                               "%k0 = OpCompositeExtract %uint %vi 0\n%k1 = OpBitwiseAnd %uint %k0 %u3_\n%size = "
                               "OpImageQuerySizeLod " +
                               type + " %alone %k1\n%z = OpCompositeConstruct %i4 " +
                               (declared.coordinates == 2 ? "%size %i0 %i0" : "%size %i0") +
                               "\n%l = OpImageQueryLevels %int %alone\n%s = OpCompositeInsert %i4 %l %z 3\n%r = "
                               "OpConvertSToF %v4 %s"},
                      image(declared), false),
                std::string("size ") + declared.type);
  }
  ProgramImage texels{.shape = ImageShape::d1, .format = TexelFormat::R32G32B32A32_SFLOAT, .width = 40};
  fill(texels);
  expect_near(
      bound({.declared = kBuffer,
             .body = load +
                     "%k0 = OpCompositeExtract %uint %vi 0\n%k1 = OpUMod %uint %k0 %forty\n%k2 = OpBitcast %int %k1\n"
                     "%r = OpImageFetch %v4 %alone %k2",
             .globals = "%forty = OpConstant %uint 40"},
            texels, false),
      "buffer");
}

// A part of the levels and layers, with channels in another order.
TEST_F(LavapipeImages, Views) {
  ShaderCase shader = bound({.declared = k2DArray, .body = "%r = OpImageSampleExplicitLod %v4 %image_ %place Lod %f1"},
                            image(k2DArray), false, -1, 3);
  shader.use.images[0].base_level = 1, shader.use.images[0].levels = 2;
  shader.use.images[0].base_layer = 1, shader.use.images[0].layers = 2;
  shader.use.images[0].swizzle = "b1gr";
  expect_near(shader, "a view");
}

}  // namespace
}  // namespace beampipe
