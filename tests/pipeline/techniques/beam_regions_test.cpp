// beam in the API's order: random streams of draws against the reference, and frames at the edge of what there is.

#include "pipeline/error_causes.h"
#include "stages/geometry/draw_plan.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/stages/surface_scene.h"
#include "tests/thorough.h"

namespace beampipe::beam_regions_test {

constexpr std::uint32_t kSize = 16;  // pixels

Trace empty_trace() {
  Trace trace = pixel_trace(kSize, kSize, {});
  trace.meshes.clear();
  trace.frames[0].draws.clear();
  trace.frames[0].background = {0.25f, 0.5f, 0.125f};
  return trace;
}

// Adds a draw of one colour.
void add_draw(Trace& trace, const DrawState& state, const glm::vec4& color, const std::vector<glm::vec3>& corners) {
  Material material;
  material.unlit = material.double_sided = true;
  material.alpha_mode = state.blend ? AlphaMode::blend : AlphaMode::opaque;
  material.base_color = color;
  Draw draw;
  draw.mesh = static_cast<std::uint32_t>(trace.meshes.size());
  draw.material = draw.mesh;
  draw.state = state;
  Mesh mesh;
  material.name = mesh.name = "m" + std::to_string(draw.mesh);
  for (std::uint32_t i = 0; i < corners.size(); ++i) mesh.positions.emplace_back(corners[i]);
  for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3) mesh.triangles.emplace_back(i, i + 1, i + 2);
  mesh.colors.assign(mesh.triangles.size(), glm::vec3(1));
  trace.materials.push_back(material);
  trace.meshes.push_back(mesh);
  trace.frames[0].draws.push_back(draw);
}

Blend blend_of(BlendFactor source, BlendFactor destination) {
  return {BlendEquation{source, destination, BlendOperation::add}, {}, {}};
}

// What programs do: surfaces, glass, light that adds up, shadows that multiply, and windows of stencil. Depth is mixed.
DrawState random_state(Random& random) {
  using enum BlendFactor;
  DrawState state;
  state.depth.test = !random.one_in(3);
  state.depth.function = random.one_in(3) ? Compare::less_equal : Compare::less;
  switch (random.int32(0, 4)) {
    case 0:
      state.blend = blend_of(source_alpha, one_minus_source_alpha);
      break;
    case 1:
      state.blend = blend_of(source_alpha, one);
      break;
    case 2:
      state.blend = blend_of(destination_color, zero);
      break;
    default:
      break;
  }
  state.depth.write = !state.blend;
  if (random.one_in(3)) {
    state.stencil = Stencil{};
    state.stencil->function = random.one_in(2) ? Compare::always : Compare::equal;
    state.stencil->reference = static_cast<std::uint32_t>(random.int32(0, 1));
    state.stencil->pass = random.one_in(2) ? StencilOperation::increment : StencilOperation::keep;
  }
  if (random.one_in(8)) state.depth.cleared_before = true;
  return state;
}

Trace random_stream(std::uint64_t seed, bool is_gray = false) {
  Random random(seed);
  Trace trace = empty_trace();
  if (is_gray) trace.frames[0].background = glm::vec3(0.25f);
  for (int d = random.int32(3, 12); d-- > 0;) {
    std::vector<glm::vec3> corners;
    for (int i = 3 * random.int32(1, 4); i-- > 0;)
      corners.emplace_back(random.real32(-2, kSize + 2), random.real32(-2, kSize + 2), random.real32(0, 1));
    const auto channel = [&] { return random.real32(0, 1); };
    glm::vec4 color{channel(), channel(), channel(), channel()};
    if (is_gray) color.g = color.b = color.r;
    add_draw(trace, random_state(random), color, corners);
  }
  return trace;
}

// Every pixel of these frames has edges, half of them where planes cross.
TEST(BeamRegions, RandomStreamsAreAsGoodAsManySamples) {
  double of_beam = 0, of_msaa = 0, of_small = 0, of_few = 0;
  int in_order = 0;
  for (unsigned seed = 0; seed < 40u * static_cast<unsigned>(thoroughness()); ++seed) {
    const Trace trace = random_stream(seed);
    if (!needs_api_order(trace, trace.frames[0])) continue;
    ++in_order;
    const Image reference = render_unmodelled("reference", trace).image;
    const auto squares = [&](const char* spec) {
      return std::pow(rmse(render_unmodelled(spec, trace).image, reference), 2);
    };
    of_beam += squares("beam");
    of_msaa += squares("msaa:128");
    of_small += squares("beam:bits=32,pool=16");
    of_few += squares("msaa:16");
  }
  EXPECT_GT(in_order, 30);
  EXPECT_LT(of_beam, of_msaa);
  EXPECT_LT(of_small, of_few);
}

TEST(BeamRegions, ThreadsChangeNothing) {
  const Trace trace = random_stream(3);
  ASSERT_TRUE(needs_api_order(trace, trace.frames[0]));
  const Technique beam = parse_technique("beam:bin=8");
  const FrameResult one = beam.render(trace, 0, {1}), four = beam.render(trace, 0, {4});
  expect_same(one, four, "four threads");
}

// Surfaces over glass over surfaces, with edges at quarters of pixels: all areas are known.
TEST(BeamRegions, QuartersOfPixelsAreExact) {
  Trace trace = empty_trace();
  DrawState state;
  const auto strip = [](float x0, float x1, float z) {
    return std::vector<glm::vec3>{{x0, 0, z}, {x1, 0, z}, {x1, kSize, z}, {x0, 0, z}, {x1, kSize, z}, {x0, kSize, z}};
  };
  add_draw(trace, state, {1, 0, 0, 1}, strip(0.25f, 10.5f, 0.5f));
  state.blend = blend_of(BlendFactor::source_alpha, BlendFactor::one_minus_source_alpha);
  state.depth.write = false;
  add_draw(trace, state, {0, 0, 1, 0.5f}, strip(5.75f, 12.25f, 0.25f));
  const Image image = picture("beam", trace);
  const auto expect = [&](std::uint32_t x, const glm::vec3& color) {
    for (std::uint32_t y = 0; y < kSize; ++y)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel(image, x, y)[c], color[c], 1e-3) << x << ", " << y;
  };
  const glm::vec3 red{1, 0, 0}, clear = trace.frames[0].background, blue{0, 0, 1};
  expect(0, 0.25f * clear + 0.75f * red);
  expect(3, red);
  expect(5, 0.75f * red + 0.25f * (0.5f * red + 0.5f * blue));
  expect(7, 0.5f * red + 0.5f * blue);
  expect(10, 0.25f * red + 0.25f * clear + 0.5f * blue);
  expect(12, 0.25f * (0.5f * clear + 0.5f * blue) + 0.75f * clear);
  expect(14, clear);
}

// Two triangles cover an eighth of pixel (4, 4) each. Where a pixel is 12 texels wide, that is a square whose side is
// sqrt(1/8) x 12 = 4.2 texels. In the level of 4 x 4 texels, black and white squares of 2 x 2 are grey; in finer ones
// they are not. Only the corner that is seen has them: the level for a whole pixel is darker.
TEST(BeamRegions, TexelsAreAsSmallAsTheFragment) {
  SurfaceTrace scene(kSize, kSize);
  TextureImage squares = filled_image(16, 16, {255, 255, 255, 255});
  for (std::size_t i = 0; i < squares.texels.size(); ++i)
    if ((i % 16 / 2 + i / 32) % 2 == 0 || i % 16 >= 8 || i / 16 >= 8) squares.texels[i] = {0, 0, 0, 255};
  Material material = textured_material(scene.add_image(squares), AlphaMode::blend);
  material.base_texture->minify = Filter::nearest, material.base_texture->mip = MipFilter::nearest;
  scene.add_rectangle(4, 4, 4.5, 4.5, 0.5, material);
  scene.mesh().uvs[0] = {{0, 0}, {0.375f, 0}, {0.375f, 0.375f}, {0, 0.375f}};
  scene.frame().draws[0].state.blend = blend_of(BlendFactor::one, BlendFactor::one);
  ASSERT_TRUE(needs_api_order(scene.trace, scene.frame()));
  const Image image = picture("beam:filter=sampler", scene.trace);
  EXPECT_NEAR(pixel(image, 4, 4).r, scene.frame().background.r + 0.25 * 0.5, 1e-3);
}

TEST(BeamRegions, FramesWithoutAreaHaveTheClearedColour) {
  Trace trace = empty_trace();
  DrawState state;
  state.blend = blend_of(BlendFactor::one, BlendFactor::one);
  state.depth.cleared_before = true;
  state.stencil_cleared_to = 3;
  add_draw(trace, state, glm::vec4(1), {{1, 1, 0}, {1, 1, 0}, {1, 1, 0}, {2, 2, 0}, {9, 9, 0}, {4, 4, 0}});
  ASSERT_TRUE(needs_api_order(trace, trace.frames[0]));
  const Image image = picture("beam", trace);
  for (std::uint32_t i = 0; i < kSize; ++i) EXPECT_EQ(pixel(image, i, i), trace.frames[0].background);
}

// The terms of a pixel add up to its colour, where factors are the same for all channels.
TEST(BeamRegions, HistoriesExplainPixels) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const Trace trace = random_stream(seed, true);
    std::vector<PixelAddress> at;
    for (std::uint32_t i = 0; i < kSize; ++i) at.push_back({i, (7 * i) % kSize});
    std::vector<PixelHistory> histories(at.size());
    FrameInput run{1};
    run.pixels = &at;
    FrameSinks sinks;
    sinks.histories = &histories;
    const Image image = parse_technique("beam").render(trace, 0, run, sinks).image;
    for (const PixelHistory& history : histories) {
      glm::dvec3 sum(0.0);
      for (const HistoryTerm& term : history.terms) sum += term.weight * term.color;
      const glm::vec3 found = pixel(image, history.at.x, history.at.y);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], found[c], 0.02) << seed << ": " << history.at.x;
    }
  }
}

TEST(BeamRegions, NoWeightsExplainErrorsInTheApisOrder) {
  const Trace trace = random_stream(4);
  ASSERT_TRUE(needs_api_order(trace, trace.frames[0]));
  std::vector<PixelWeights> weights;
  FrameInput run{1};
  FrameSinks sinks;
  sinks.weights = &weights;
  const Image image = parse_technique("beam").render(trace, 0, run, sinks).image, truth = picture("reference", trace);
  for (const auto& [cause, values] : error_causes({trace, trace.frames[0], run, {}}, weights, image, truth)) {
    for (std::uint32_t i = 0; i < kSize * kSize; ++i) {
      const glm::dvec3 error =
          glm::dvec3(pixel(image, i % kSize, i / kSize)) - glm::dvec3(pixel(truth, i % kSize, i / kSize));
      EXPECT_NEAR(values[i], cause == "rounding" ? glm::length(error) / std::sqrt(3.0) : 0, 1e-6) << cause;
    }
  }
}

}  // namespace beampipe::beam_regions_test
