// ACAA and MSAA give the same picture except for the precision of the accumulator and for equal depths.
#include "pipeline/techniques/acaa.h"

#include "pipeline/techniques/msaa.h"
#include "stages/data/sample_fragment.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::acaa_test {

// A triangle at a constant depth that covers a small frame entirely.
PixelSpaceTriangle everywhere(double z, const glm::vec3& color) {
  return {{{-1, -1, z}, {13, -2, z}, {-2, 12, z}}, color};
}

TEST(Acaa, OpaquePicturesAreThoseOfMsaa) {
  const Trace trace = random_trace(60, 40, 300, 5);
  for (const int samples : {1, 2, 4, 8, 16, 32, 64, 256}) {
    const std::string n = std::to_string(samples);
    const Image truth = render("msaa:" + n, trace).image;
    // The samples of MSAA are fp16, with errors of up to 2^-12 below 1. An fp32 accumulator adds only the rounding of
    // sums of up to `samples` terms.
    EXPECT_LT(worst_difference(render("acaa:" + n + ",color=fp32", trace).image, truth), 0x1p-12 + samples * 0x1p-24)
        << n;
    // Shares are multiples of 2^-8, which fp16 represents exactly up to 1, so alpha has no error. Sums of colours are
    // at most 1, and there is one per visible fragment. Each is rounded by at most half an fp16 step below 1, which is
    // 2^-12.
    const FrameResult fp16 = render("acaa:" + n + ",color=fp16", trace);
    const std::vector<float>& sums = fp16.pixel_counters.at("visible_fragments");
    for (std::size_t i = 0; i < truth.rgba.size(); ++i) {
      EXPECT_LE(std::abs(double{fp16.image.rgba[i]} - truth.rgba[i]), (sums[i / 4] + 1) * 0x1p-12 + samples * 0x1p-24)
          << n << " samples, pixel " << i / 4;
    }
  }
}

TEST(Acaa, EverySumIsRoundedToTheFormat) {
  // There is a single fragment in each pixel.
  const Trace trace = pixel_trace(4, 4, {{{{-1, -1, 0.5}, {3.3, -1, 0.5}, {-1, 9, 0.5}}, glm::vec3(0.3f, 0.6f, 0.9f)}});
  const Image exact = render("acaa:8,color=fp32", trace).image;
  const double fp16 = worst_difference(render("acaa:8,color=fp16", trace).image, exact);
  const double unorm8 = worst_difference(render("acaa:8,color=unorm8", trace).image, exact);
  EXPECT_GT(fp16, 0);
  EXPECT_LE(fp16, 0x1p-12);
  EXPECT_GT(unorm8, 0x1p-12);
  EXPECT_LE(unorm8, 0.5 / 255 + 1e-6);
  const Image coarse = render("acaa:8,color=unorm8", trace).image;
  for (std::size_t i = 0; i < coarse.rgba.size(); ++i) {
    if (i % 4 == 3) continue;
    EXPECT_NEAR(coarse.rgba[i] * 255, std::round(coarse.rgba[i] * 255), 1e-4);
  }
}

TEST(Acaa, ManySmallSharesLoseMorePrecisionInFewerBits) {
  const Trace trace = random_trace(40, 30, 4000, 8);
  const Image exact = render("acaa:64,color=fp32", trace).image;
  const double fp16 = rmse(render("acaa:64,color=fp16", trace).image, exact);
  const double unorm8 = rmse(render("acaa:64,color=unorm8", trace).image, exact);
  EXPECT_GT(fp16, 0);
  EXPECT_GT(unorm8, 4 * fp16);
  EXPECT_LT(unorm8, 0.05);
}

TEST(Acaa, CoincidentDepthsCountTwiceUnlessRemedied) {
  const Trace trace = pixel_trace(4, 4, {everywhere(0.5, {0.25f, 0, 0}), everywhere(0.5, {0, 0.5f, 0})});
  EXPECT_EQ(rgba_at(render("acaa:8", trace).image, 1, 1), glm::vec4(0.25f, 0.5f, 0, 1));
  // The colour of the first triangle alone, as in MSAA.
  for (const char* spec : {"acaa:8,double=stencil", "acaa:8,double=saturate", "acaa:32,double=stencil",
                           "acaa:32,double=saturate", "acaa:256,double=saturate", "msaa:8"})
    EXPECT_EQ(rgba_at(render(spec, trace).image, 1, 1), glm::vec4(0.25f, 0, 0, 1)) << spec;
}

TEST(Acaa, SaturationStopsAtWhatGeometryCovers) {
  // Two equal triangles cover the same half of the frame. Together they may add up to the covered samples and no more.
  const PixelSpaceTriangle left{{{-1, -9, 0.5}, {1.5, -9, 0.5}, {1.5, 30, 0.5}}, glm::vec3(0, 1, 0)};
  PixelSpaceTriangle again = left;
  again.color = glm::vec3(1, 0, 0);
  const Trace trace = pixel_trace(4, 4, {left, again}, glm::vec3(0, 0, 1));
  for (const char* spec : {"acaa:4,double=saturate,color=fp32", "acaa:64,double=saturate,color=fp32",
                           "acaa:4,double=stencil,color=fp32"}) {
    const Image image = render(spec, trace).image;
    EXPECT_NEAR(rgba_at(image, 1, 1).g + rgba_at(image, 1, 1).b, 1, 1e-6) << spec;
    EXPECT_EQ(rgba_at(image, 1, 1).r, 0) << spec;
  }
  EXPECT_NEAR(rgba_at(render("acaa:4,color=fp32", trace).image, 1, 1).r, 0.5, 1e-6);
  EXPECT_NEAR(rgba_at(render("acaa:4,double=saturate,color=fp32", trace).image, 1, 1).a, 0.5, 1e-6);
}

TEST(Acaa, HiddenFragmentsAreNotShaded) {
  const auto layers = [](double first, double second, double third) {
    return pixel_trace(
        4, 4, {everywhere(first, glm::vec3(1)), everywhere(second, glm::vec3(1)), everywhere(third, glm::vec3(1))});
  };
  Trace trace = layers(0.7, 0.5, 0.3);  // far to near
  const auto shaded = [&](const char* spec) {
    for (const StageCounters& stage : render(spec, trace).stages)
      if (stage.stage == StageId::shade) return stage.lanes_used;
    return std::uint64_t{0};
  };
  EXPECT_EQ(shaded("msaa:8"), 3u * 16);
  EXPECT_EQ(shaded("msaa:8,prepass"), 16u);
  EXPECT_EQ(shaded("acaa:8"), 16u);
  EXPECT_EQ(shaded("acaa:64"), 4 * 16u);  // once in each of four rounds
  trace = layers(0.3, 0.7, 0.5);
  EXPECT_EQ(shaded("msaa:8"), 16u) << "behind closed cells";
}

TEST(Acaa, ReadsDepthTwiceAndOneColor) {
  const FrameResult msaa = parse_technique("msaa:8").render(half_square(), 0, {1});
  const FrameResult acaa = parse_technique("acaa:8").render(half_square(), 0, {1});
  const std::uint64_t samples = stage_of(msaa, "depth_test").items_in;
  EXPECT_EQ(both_passes(acaa, "depth_test").items_in, 2 * samples);
  EXPECT_EQ(both_passes(acaa, "depth_test").bytes_written, samples * 4);
  const std::uint64_t fragment_bytes = kSampleFragmentBytes + 6;  // including the shaded colour
  EXPECT_EQ(stage_of(acaa, "accumulate").items_in, 10u);
  EXPECT_EQ(stage_of(acaa, "accumulate").items_out, 10u);
  EXPECT_EQ(stage_of(acaa, "accumulate").bytes_read, 10 * (fragment_bytes + 8));
  EXPECT_EQ(stage_of(acaa, "accumulate").bytes_written, 10u * 8);
  // Saturation first adds the background to each pixel that is not full. Only pixel (2, 3) is full.
  const FrameResult saturated = parse_technique("acaa:8,double=saturate").render(half_square(), 0, {1});
  EXPECT_EQ(stage_of(saturated, "accumulate").items_in, 10u + 64 - 1);
  EXPECT_EQ(stage_of(saturated, "accumulate").bytes_read, 10 * fragment_bytes + (10 + 64 - 1) * 8 + 64 * 8 * 4);
  const StageCounters stencil =
      stage_of(parse_technique("acaa:8,double=stencil").render(half_square(), 0, {1}), "stencil_test");
  EXPECT_EQ(stencil.items_in, samples);
  EXPECT_EQ(stencil.items_out, samples);
  EXPECT_EQ(stencil.bytes_read, samples) << "one byte each";
  EXPECT_EQ(stencil.bytes_written, samples);
  EXPECT_EQ(stage_of(acaa, "resolve").bytes_read, 64u * 8);
  EXPECT_EQ(stage_of(msaa, "resolve").bytes_read, 64u * 8 * 6);
}

// Near to far, so that hierarchical depth leaves out the two hidden layers where depth is tested.
TEST(Acaa, AShaderThatTestsDepthIsLaunchedForHiddenFragments) {
  const Trace trace =
      pixel_trace(4, 4, {everywhere(0.3, glm::vec3(1)), everywhere(0.5, glm::vec3(1)), everywhere(0.7, glm::vec3(1))});
  const FrameResult post_z = render("acaa:8", trace), shader = render("acaa:8,coverage=shader", trace);
  EXPECT_EQ(post_z.image.rgba, shader.image.rgba);
  EXPECT_EQ(stage_of(post_z, "sample_raster").items_out, 16u);
  EXPECT_EQ(stage_of(shader, "sample_raster").items_out, 3u * 16);
  EXPECT_EQ(stage_of(shader, "prepass_depth_test"), stage_of(post_z, "prepass_depth_test"));
  EXPECT_THROW(stage_of(shader, "depth_test"), std::runtime_error) << "there is no such stage";
  const StageCounters shade = stage_of(shader, "shade"), without_test = stage_of(post_z, "shade");
  EXPECT_EQ(shade.items_in, 16u);
  EXPECT_EQ(shade.lanes_used, 16u);
  EXPECT_EQ(shade.lanes_issued, 3u * 16);
  EXPECT_EQ(shade.bytes_read - without_test.bytes_read, 3u * 16 * 8 * 4) << "8 depths in each of three layers";
  // Each of 48 invocations computes a plane, once, and 8 depths. As the depth test does for its 16 fragments.
  EXPECT_EQ((shade.ops.total() - without_test.ops.total()), 3 * stage_of(post_z, "depth_test").ops.total());
  EXPECT_EQ(stage_of(shader, "accumulate"), stage_of(post_z, "accumulate"));
  EXPECT_EQ(parse_technique("acaa:8,coverage=shader").framebuffer_bytes_per_pixel(), 40u);
}

TEST(Acaa, PicturesDoNotDependOnWhatTestsDepth) {
  const Trace trace = random_trace(60, 40, 300, 5);
  for (const std::string spec : {"acaa:8", "acaa:32", "acaa:4,double=saturate"})
    EXPECT_EQ(render(spec + ",coverage=shader", trace).image.rgba, render(spec, trace).image.rgba) << spec;
  EXPECT_THROW(parse_technique("acaa:8,double=stencil,coverage=shader"), SpecError);
}

TEST(Acaa, RoundsAreTheSamplesOfMsaa) {
  for (const int samples : {1, 4, 16, 32, 64, 128, 256}) {
    std::vector<std::pair<int, int>> positions;
    for (const Sampling& round : acaa_rounds(samples)) {
      EXPECT_LE(round.pattern.count, 16);
      for (std::size_t s = 0; s < static_cast<std::size_t>(round.pattern.count); ++s)
        positions.emplace_back(round.pattern.x[s], round.pattern.y[s]);
    }
    const Sampling all = msaa_sampling(samples);
    std::vector<std::pair<int, int>> expected;
    for (int row = 0; row < all.grid.rows; ++row)
      for (int column = 0; column < all.grid.columns; ++column)
        for (std::size_t s = 0; s < static_cast<std::size_t>(all.pattern.count); ++s)
          expected.emplace_back(column * all.grid.cell_width() + all.pattern.x[s],
                                row * all.grid.cell_height() + all.pattern.y[s]);
    std::sort(positions.begin(), positions.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(positions, expected) << samples;
  }
}

TEST(Acaa, TheLastRoundHasTheSampleNearestToTheCentre) {
  for (const int samples : {1, 8, 32, 64, 128, 256}) {
    std::vector<int> least;  // of each round: the squared distance of its nearest sample, in 1/256 px
    for (const Sampling& round : acaa_rounds(samples)) {
      least.push_back(2 * 256 * 256);
      for (std::size_t s = 0; s < static_cast<std::size_t>(round.pattern.count); ++s) {
        const int x = round.pattern.x[s] - 128, y = round.pattern.y[s] - 128;
        least.back() = std::min(least.back(), x * x + y * y);
      }
    }
    EXPECT_EQ(least.back(), *std::min_element(least.begin(), least.end())) << samples;
  }
}

// Opaque green covers the frame up to the middle of pixel column 7, and 4 of the 8 samples there. A blue sheet lies
// behind it and a red one in front; they hide half of what is behind them. Sample 0 is the nearest to the centre, at
// 9/16 of the pixel's width: in column 7 opaque green does not cover it; in column 11 only the red sheet does.
Trace sheets_around_opaque() {
  SurfaceTrace scene(16, 16);
  scene.frame().background = glm::vec3(0.0f);
  scene.add_rectangle(-1, -1, 7.5, 17, 0.5, unlit_material({0, 1, 0, 1}));
  scene.add_rectangle(-3, -2, 11.5, 18, 0.75, unlit_material({0, 0, 1, 0.5f}, AlphaMode::blend));
  scene.add_rectangle(-3, -2, 11.6, 18, 0.25, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
  return scene.trace;
}

TEST(Acaa, TranslucentTrianglesAreDrawnAtOneSample) {
  const Trace trace = sheets_around_opaque();
  for (const char* spec : {"acaa:8", "acaa:8,double=stencil", "acaa:8,double=saturate", "acaa:8,color=fp32"}) {
    const Image image = render(spec, trace).image;
    for (std::uint32_t y = 0; y < 16; ++y) {
      for (std::uint32_t x = 0; x < 7; ++x) EXPECT_EQ(rgba_at(image, x, y), glm::vec4(0.5f, 0.5f, 0, 1)) << spec;
      // Green is 1/2, so green, blue, red and the background show 1/8, 1/4, 1/2 and 1/8.
      EXPECT_EQ(rgba_at(image, 7, y), glm::vec4(0.5f, 0.125f, 0.25f, 0.875f)) << spec;
      for (std::uint32_t x = 8; x < 11; ++x) EXPECT_EQ(rgba_at(image, x, y), glm::vec4(0.5f, 0, 0.25f, 0.75f)) << spec;
      EXPECT_EQ(rgba_at(image, 11, y), glm::vec4(0.5f, 0, 0, 0.5f)) << spec;
      EXPECT_EQ(rgba_at(image, 12, y), glm::vec4(0)) << spec;
    }
  }
}

// Where the sample lies 1/16 of a pixel from the centre at most, sheets that end 1/8 before the centre, or after it.
TEST(Acaa, TranslucentTrianglesOfManyRoundsAreDrawnNearTheCentre) {
  for (const char* spec : {"acaa:32", "acaa:128", "acaa:256"}) {
    for (const double end : {4.375, 4.625}) {
      SurfaceTrace scene(8, 8);
      scene.frame().background = glm::vec3(0.0f);
      scene.add_rectangle(-1, -1, end, 9, 0.25, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
      EXPECT_EQ(pixel(render(spec, scene.trace).image, 4, 4), glm::vec3(end > 4.5 ? 0.5f : 0.0f, 0, 0)) << spec;
    }
  }
}

// The blue sheet covers the sample in 11 columns, and passes in 4 of them; the red one in 12, and passes in all.
TEST(Acaa, TranslucentTrianglesNeedNoMemoryOfTheirOwn) {
  constexpr std::uint64_t kTested = 16 * (11 + 12), kPassed = 16 * (4 + 12);
  const FrameResult found = render("acaa:8", sheets_around_opaque());
  for (const Buffer& buffer : found.buffers) EXPECT_NE(buffer.name, kTranslucentLayer);
  const StageCounters& blend = stage_of(found, "blend");
  EXPECT_EQ(blend.items_in, kTested);
  EXPECT_EQ(blend.items_out, kPassed);
  EXPECT_EQ(blend.bytes_read, kTested * (4 + kSampleFragmentBytes) + kPassed * 8);
  EXPECT_EQ(blend.bytes_written, kPassed * 8);
  // In column 9 each sheet reads a depth, and reads and writes the accumulator. In column 3 the one behind does not
  // pass, and before that green has read 8 depths twice and written them, and was added to the accumulator.
  const std::vector<float>& bytes = found.pixel_counters.at("bytes");
  EXPECT_EQ(bytes[16 * 2 + 9], 2 * (4 + 2 * 8));
  EXPECT_EQ(bytes[16 * 2 + 3], 3 * 8 * 4 + 2 * 8 + 2 * 4 + 2 * 8);
}

}  // namespace beampipe::acaa_test
