// The scalar twins of shade and resolve: the work of one lane for a fragment, and the sum that makes a pixel of the
// picture.
#include "simd/position_mask.h"
#include "stages/picture/resolve.h"
#include "stages/samples/accumulate.h"
#include "tests/stages/beam_pixels.h"
#include "tests/stages/sample_pixels.h"
#include "tests/stages/scene_twins.h"

namespace beampipe::shading_twins_test {

using namespace twins;

const Sampling kSampling{CellGrid{}, standard_pattern(8)};

class ShadingTwins : public SceneTwins {
 protected:
  void SetUp() override {
    SceneTwins::SetUp();
    std::vector<Light>& lights = trace_.frames[0].lighting.lights;
    if (lights.empty()) lights.push_back({glm::vec3(0, -1, 0)});
    light_ = lights[0].direction;
    surfaces_.emplace(triangles_, trace_, trace_.frames[0], nullptr, ShadingRules{});
    colors_ = surfaces_->flat_colors();
  }

  std::array<Float, 3> vector(const glm::vec3& v) { return {real(v.x), real(v.y), real(v.z)}; }

  // kd max(0, -n . l), compared with the picture's colour.
  void lambert(std::uint32_t triangle) {
    const FlatAttributes& flat = triangles_.attributes[triangle];
    const auto kd = vector(flat.kd), n = vector(flat.normal), l = vector(light_);
    const Float zero(0.0f), cosine = greater(zero - (n[0] * l[0] + n[1] * l[1] + n[2] * l[2]), zero);
    for (std::size_t c = 0; c < 3; ++c) {
      const Float color = kd[c] * cosine;
      if (flat.lit) {
        EXPECT_FLOAT_EQ(color.value, colors_[triangle][static_cast<int>(c)]);
      }
    }
  }

  // Four lanes for each quad with a fragment of a lit triangle. Fragments of one quad are consecutive.
  template <class Items>
  std::uint64_t shade_quads(const Items& fragments) {
    std::uint64_t lanes = 0;
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      if (i > 0 && fragments[i].quad == fragments[i - 1].quad) continue;
      lanes += 4;
      if (!triangles_.attributes[fragments[i].triangle].lit) continue;
      for (int lane = 0; lane < 4; ++lane) lambert(fragments[i].triangle);
    }
    return lanes;
  }

  std::vector<Fragment> beam_fragments() {
    const PositionGrid grid(256);
    return fragments_of(triangles_, tile_, grid_options(grid, 0));
  }

  glm::vec3 light_;
  std::optional<SurfaceShader> surfaces_;
  std::vector<glm::vec3> colors_;
};

TEST_P(ShadingTwins, ShadeFragmentsInQuads) {
  std::vector<Fragment> fragments = beam_fragments();
  StageCounters counters;
  shade({*surfaces_, tile_}, fragments, counters);
  EXPECT_EQ(counters.lanes_issued, shade_quads(fragments));
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(ShadingTwins, ShadeSampleFragmentsInQuads) {
  const std::vector<SampleFragment> fragments = sample_fragments(triangles_, tile_, kSampling);
  StageCounters counters;
  shade({*surfaces_, tile_}, fragments, 16, counters);
  EXPECT_EQ(counters.bytes_written, 16 * fragments.size());
  EXPECT_EQ(counters.lanes_issued, shade_quads(fragments));
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(ShadingTwins, ResolveAggregates) {
  const glm::vec3 background(0.25f, 0.5f, 0.75f);
  std::vector<PixelColor> pixels(tile_.pixels(), PixelColor{0.0f, glm::vec3(0.0f)});
  for (const Fragment& fragment : beam_fragments())  // each pixel contains only its last fragment
    pixels[fragment.pixel] = {fragment.alpha, fragment.alpha * colors_[fragment.triangle]};
  StageCounters counters;
  const std::vector<glm::vec4> image = resolve(pixels, background, 42, counters);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Float rest = Float(1.0f) - real(pixels[i].alpha);
    for (int c = 0; c < 3; ++c) {
      const Float color = converted(real(pixels[i].color[c])) + real(background[c]) * rest;
      ASSERT_EQ(color.value, image[i][c]);
    }
  }
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(ShadingTwins, ResolveSamples) {
  const glm::vec3 background(0.25f, 0.5f, 0.75f);
  StageCounters counters;
  const SampleTile surface = tested_samples(triangles_, tile_, kSampling);
  const std::vector<glm::vec4> image = resolve(surface, tile_.pixels(), colors_, background, counters);
  for (std::size_t pixel = 0; pixel < tile_.pixels(); ++pixel) {
    for (int c = 0; c < 3; ++c) {
      Float sum(0.0f);
      for (std::size_t s = 0; s < 8; ++s) {
        const std::uint32_t owner = surface.triangle[8 * pixel + s];
        sum = sum + converted(real(owner == kNoTriangle ? background[c] : colors_[owner][c]));
      }
      const Float mean = sum * Float(1.0f / 8);
      ASSERT_NEAR(mean.value, image[pixel][c], 1e-6f + 1e-6f * mean.value);
    }
  }
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(counters.lanes_used, 8 * tile_.pixels());
  EXPECT_EQ(counters.lanes_issued, 8 * tile_.pixels());
}

// Per visible sample, one invocation converts Kd and the normal to integers, and a later one computes the cosine.
TEST_P(ShadingTwins, GBufferAndLight) {
  StageCounters gbuffer, lighting;
  write_gbuffer({*surfaces_, tile_}, list_, gbuffer);
  light({*surfaces_, tile_}, list_, lighting);
  for (const std::uint32_t triangle : list_) {
    const FlatAttributes& flat = triangles_.attributes[triangle];
    for (const Float& kd : vector(flat.kd)) to_integer(kd * Float(255.0f) + Float(0.5f));
    for (const Float& normal : vector(flat.normal)) to_integer(normal * Float(511.5f) + Float(512.0f));
  }
  EXPECT_EQ(gbuffer.ops, twin_);
  twin_ = {};
  for (const std::uint32_t triangle : list_) lambert(triangle);
  EXPECT_EQ(lighting.ops, twin_);
  EXPECT_EQ(lighting.lanes_used, list_.size());
  EXPECT_EQ(lighting.lanes_issued, list_.size());
}

// A sample takes only the first fragment.
TEST_P(ShadingTwins, StencilTest) {
  std::vector<SampleFragment> fragments = sample_fragments(triangles_, tile_, kSampling), twins = fragments;
  StageCounters counters;
  Accumulator accumulator(tile_, 8, AccumulatorFormat::fp16, DoubleCounting::stencil);
  stencil_test(tile_, counters, accumulator, fragments);
  std::vector<std::uint32_t> stencil(8 * tile_.pixels());
  std::uint64_t passed = 0;
  for (SampleFragment& fragment : twins) {
    for (std::size_t s = 0; s < 8; ++s) {
      if (!(fragment.mask >> s & 1)) continue;
      std::uint32_t& taken = stencil[8 * tile_.index(fragment.x, fragment.y) + s];
      if (bits(taken) == bits(0)) {
        taken = 1, ++passed;
      } else {
        fragment.mask &= ~(1u << s);
      }
    }
  }
  std::erase_if(twins, [](const SampleFragment& fragment) { return fragment.mask == 0; });
  ASSERT_EQ(fragments.size(), twins.size());
  for (std::size_t i = 0; i < twins.size(); ++i) ASSERT_EQ(fragments[i].mask, twins[i].mask);
  EXPECT_EQ(counters.items_out, passed);
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(counters.lanes_used, counters.items_in);
  EXPECT_EQ(counters.lanes_issued, counters.items_in);
}

BEAMPIPE_ON_EVERY_SCENE(ShadingTwins);

}  // namespace beampipe::shading_twins_test
