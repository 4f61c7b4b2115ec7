// Cutouts and translucency of beams: how much area and which positions are left.
#include "stages/beam/alpha_mask.h"

#include "stages/surface/opacity.h"
#include "tests/stages/beam_pixels.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::alpha_mask_test {

struct Masked {
  std::vector<Fragment> before, after;
  StageCounters counters;
};

Masked masked(const ShadedScene& scene, int positions = 256, AlphaPlaces places = AlphaPlaces::all) {
  const std::vector<SamplePattern> patterns = cell_patterns(positions);
  const Tile tile = scene.frame_tile();
  BeamFragmentOptions options;
  options.mask = MaskSource::exact, options.positions = patterns;
  Masked result;
  result.before = fragments_of(scene.triangles, tile, options);
  result.after = result.before;
  alpha_mask({scene.shader, tile}, patterns, places, result.counters, result.after);
  return result;
}

constexpr AlphaPlaces kAllPlaces[] = {AlphaPlaces::one, AlphaPlaces::quarters, AlphaPlaces::sixteenths,
                                      AlphaPlaces::all};

double area(const std::vector<Fragment>& fragments) {
  double sum = 0;
  for (const Fragment& fragment : fragments) sum += fragment.alpha;
  return sum;
}

int positions(const std::vector<Fragment>& fragments) {
  int sum = 0;
  for (const Fragment& fragment : fragments) sum += fragment.mask.count();
  return sum;
}

TEST(AlphaMask, OpaqueFragmentsAreUntouched) {
  SurfaceTrace scene(4, 4);
  scene.add_rectangle(0.3, 0.4, 3.7, 3.1, 0.5, textured_material(scene.add_image(filled_image(2, 2, {9, 9, 9, 0}))));
  const Masked found = masked(ShadedScene(scene.trace));
  ASSERT_EQ(found.after.size(), found.before.size());
  for (std::size_t i = 0; i < found.after.size(); ++i) {
    EXPECT_EQ(found.after[i].alpha, found.before[i].alpha);
    EXPECT_EQ(found.after[i].mask, found.before[i].mask);
  }
  EXPECT_EQ(found.counters.items_in, 0u);
  EXPECT_EQ(found.counters.ops, OperationCounts{});
}

// The left half of the texture is opaque, and the border lies on a pixel's border.
TEST(AlphaMask, ACutoutLeavesWhereTheTextureIsOpaque) {
  SurfaceTrace scene = full_of({"halves", 2, 1, {{255, 255, 255, 255}, {255, 255, 255, 0}}}, AlphaMode::mask);
  scene.base_texture().wrap_u = Wrap::clamp;
  for (const AlphaPlaces places : kAllPlaces) {
    scene.trace.materials[0].alpha_cutoff = 0.5f;
    for (const Filter filter : {Filter::nearest, Filter::linear}) {
      scene.base_texture().magnify = filter;
      const Masked found = masked(ShadedScene(scene.trace), 256, places);
      EXPECT_NEAR(area(found.after), 32, 1e-4);
      EXPECT_EQ(positions(found.after), 32 * 256);
      for (const Fragment& fragment : found.after) EXPECT_LT(fragment.pixel % 8, 4u);
    }
    // The cutoff moves the border of the linear filter: alpha falls from 1 at u = 1/4 to 0 at u = 3/4.
    scene.trace.materials[0].alpha_cutoff = 0.75f;
    EXPECT_NEAR(area(masked(ShadedScene(scene.trace), 256, places).after), 8 * 8 * 0.375, 1e-4);
  }
}

// Texels of 1 to 3 pixels with any alphas: between four of them, alpha at a position is the same from every place,
// where these lie between the same texels.
TEST(AlphaMask, PlacesTellOfAllPositionsAroundThem) {
  Random random(3);
  for (const double pixels : {8.0, 24.0}) {
    SurfaceTrace scene(24, 24);
    scene.add_rectangle(0, 0, pixels, pixels, 0.5,
                        textured_material(scene.add_image(random_image(random, 8, 8)), AlphaMode::mask));
    const ShadedScene shaded(scene.trace);
    const Masked all = masked(shaded);
    const auto differing = [&](AlphaPlaces places) {
      const Masked some = masked(shaded, 256, places);
      std::map<std::pair<std::uint32_t, std::uint32_t>, WideMask> masks;
      for (const Fragment& fragment : some.after) masks[{fragment.pixel, fragment.triangle}] = fragment.mask;
      double sum = 0;
      for (const Fragment& fragment : all.after) {
        const WideMask& other = masks[{fragment.pixel, fragment.triangle}];
        sum += without(fragment.mask, other).count() + without(other, fragment.mask).count();
      }
      return sum / positions(all.after);
    };
    const double sixteenths = differing(AlphaPlaces::sixteenths), one = differing(AlphaPlaces::one);
    EXPECT_LT(sixteenths, 0.05) << pixels;
    EXPECT_LE(sixteenths, one) << pixels;
    EXPECT_LT(one, 0.4) << pixels;
  }
}

// Half of the pixels lie in texels that pass, and half in others: a look-up of four texels for each pixel and triangle.
TEST(AlphaMask, PixelsThatAreKnownAsAWholeAreLookedUpOnce) {
  SurfaceTrace scene =
      full_of(image_with_alphas(64, 64, [](std::size_t i) { return i % 64 < 32 ? 255 : 0; }), AlphaMode::mask, 64);
  scene.base_texture().wrap_u = Wrap::clamp;
  const ShadedScene shaded(scene.trace);
  const Masked found = masked(shaded);
  EXPECT_NEAR(area(found.after), 32 * 64, 1e-3);
  TexelRequests texels(nullptr);
  StageCounters counters;
  std::vector<Fragment> fragments = found.before;
  std::erase_if(fragments,
                [](const Fragment& fragment) { return std::abs(static_cast<int>(fragment.pixel % 64) - 32) < 4; });
  alpha_mask({shaded.shader, shaded.frame_tile()}, cell_patterns(256), AlphaPlaces::all, counters, fragments, &texels);
  EXPECT_EQ(texels.texels(), 4 * counters.items_in);
}

// Texels far smaller than the distance of positions, every other one opaque: half of everything is left.
TEST(AlphaMask, FineTexelsLeaveTheirMean) {
  const SurfaceTrace scene = full_of(
      image_with_alphas(1024, 1024, [](std::size_t i) { return (i + i / 1024) % 2 ? 255 : 0; }), AlphaMode::mask);
  for (const AlphaPlaces places : kAllPlaces) {
    const Masked found = masked(ShadedScene(scene.trace), 256, places);
    EXPECT_NEAR(area(found.after), 32, 0.15);                // 128 of 255 codes, and filtered borders
    EXPECT_NEAR(positions(found.after), 32 * 256, 64 + 32);  // one position per pixel, and the same
    for (const Fragment& fragment : found.after) {
      if (fragment.pixel % 9 != 0) {  // the triangle covers the whole pixel
        EXPECT_NEAR(fragment.alpha, fragment.mask.count() / 256.0, 0.01);
      }
    }
  }
}

// A pixel has 8 x 8 texels, of which the left half pass: all of two of its quarters, and nothing of the others.
TEST(AlphaMask, APixelThatPassesInPartIsLookedUpInQuarters) {
  const SurfaceTrace scene =
      full_of(image_with_alphas(64, 64, [](std::size_t i) { return i % 8 < 4 ? 255 : 0; }), AlphaMode::mask);
  const std::vector<SamplePattern> patterns = cell_patterns(256);
  const Masked found = masked(ShadedScene(scene.trace), 256, AlphaPlaces::one);
  EXPECT_EQ(positions(found.after), 64 * 128);
  for (const Fragment& fragment : found.after)
    for (std::size_t s = 0; s < 256; ++s) EXPECT_FALSE(fragment.mask.test(s) && patterns[s / 32].x[s % 32] >= 128) << s;
}

// Of a cutout without mixed positions, the area shrinks by the positions' share.
TEST(AlphaMask, AreaShrinksByThePositionsShare) {
  SurfaceTrace scene(8, 8);
  Random random(1);
  const TextureImage image = image_with_alphas(8, 8, [&](std::size_t) { return random.one_in(2) ? 255 : 0; });
  Material material = textured_material(scene.add_image(image), AlphaMode::mask);
  material.base_texture->magnify = Filter::nearest;
  scene.add_rectangle(0.3, 0.6, 7.2, 7.9, 0.5, material);
  const Masked found = masked(ShadedScene(scene.trace));
  std::size_t next = 0;
  double sum = 0;
  for (const Fragment& before : found.before) {
    if (before.mask.none()) continue;
    while (next < found.after.size() && found.after[next].mask.none()) ++next;
    if (next == found.after.size() || found.after[next].pixel != before.pixel ||
        found.after[next].triangle != before.triangle)
      continue;  // dropped
    const Fragment& after = found.after[next++];
    const double share = static_cast<double>(after.mask.count()) / before.mask.count();
    EXPECT_NEAR(after.alpha, before.alpha * share, 1e-6);
    EXPECT_EQ(without(after.mask, before.mask), WideMask{});
    sum += share;
  }
  EXPECT_GT(sum, 5);
}

// Constant alpha decides for the whole surface, whatever the fragment's size. The rectangles: pixels, and slivers that
// miss all positions.
TEST(AlphaMask, ConstantAlphaOfACutoutIsAllOrNothing) {
  for (const bool textured : {false, true})
    for (const float alpha : {0.3f, 0.7f})
      for (const double height : {3.0, 0.004}) {
        SurfaceTrace scene(8, 8);
        Material material = unlit_material({1, 1, 1, alpha}, AlphaMode::mask);
        if (textured) {
          const auto code = static_cast<std::uint8_t>(alpha * 255);
          material = textured_material(scene.add_image(filled_image(2, 2, {255, 255, 255, code})), AlphaMode::mask);
        }
        scene.add_rectangle(0, 2.002, 8, 2.002 + height, 0.5, material);
        const Masked found = masked(ShadedScene(scene.trace));
        ASSERT_FALSE(found.before.empty());
        EXPECT_NEAR(area(found.after), alpha > 0.5f ? area(found.before) : 0.0, 1e-6)
            << alpha << ", " << height << (textured ? ", textured" : "");
      }
}

// The same where texels are far smaller than the distance of positions, with any mip filter.
TEST(AlphaMask, ConstantAlphaOfFineTexelsIsAllOrNothing) {
  for (const MipFilter mip : {MipFilter::none, MipFilter::nearest, MipFilter::linear})
    for (const std::uint8_t code : {std::uint8_t{76}, std::uint8_t{179}}) {
      SurfaceTrace scene = full_of(filled_image(4, 4, {255, 255, 255, code}), AlphaMode::mask);
      scene.base_texture().mip = mip;
      for (glm::vec2& uv : scene.mesh().uvs[0]) uv *= 1000.0f;
      const Masked found = masked(ShadedScene(scene.trace));
      EXPECT_NEAR(area(found.after), code > 127 ? 64 : 0, 1e-4);
      EXPECT_EQ(positions(found.after), code > 127 ? 64 * 256 : 0);
    }
}

// Alpha rises evenly from 0 to 1 and falls again, many times in the distance of positions: what is left is the part of
// it that reaches the cutoff, where alphas of the material and of vertices scale the texture's.
TEST(AlphaMask, OfFineTexelsThePartThatPassesTheTestIsLeft) {
  const TextureImage image = image_with_alphas(64, 1, [](std::size_t i) { return 4 * i + 2; });
  for (const Filter filter : {Filter::nearest, Filter::linear})
    for (const MipFilter mip : {MipFilter::none, MipFilter::linear})
      for (const float base : {1.0f, 0.75f})
        for (const float of_vertices : {1.0f, 0.9f, 0.6f})
          for (const float cutoff : {0.125f, 0.375f, 0.5f}) {
            SurfaceTrace scene = full_of(image, AlphaMode::mask);
            Material& material = scene.trace.materials[0];
            material.base_texture->wrap_u = Wrap::mirror, material.base_texture->mip = mip;
            material.base_texture->magnify = filter;
            material.base_color.a = base, material.alpha_cutoff = cutoff;
            for (glm::vec2& uv : scene.mesh().uvs[0]) uv *= glm::vec2(128, 1);
            if (of_vertices < 1) scene.mesh().vertex_colors.assign(4, glm::vec4(1, 1, 1, of_vertices));
            const double expected = std::max(0.0, 1 - double{cutoff} / (base * of_vertices));
            const Masked found = masked(ShadedScene(scene.trace));
            EXPECT_NEAR(area(found.after) / 64, expected, 0.02) << base << " x " << of_vertices << ", " << cutoff;
            EXPECT_NEAR(positions(found.after) / (64 * 256.0), expected, 0.02);
          }
}

TEST(AlphaMask, TranslucencyTakesItsPartOfAreaAndPositions) {
  for (const int count : {32, 64, 128, 256})
    for (const float opacity : {0.0f, 0.125f, 0.3f, 0.5f, 0.99f, 1.0f}) {
      SurfaceTrace scene(6, 6);
      scene.add_rectangle(0, 0, 6, 6, 0.5, unlit_material({1, 1, 1, opacity}, AlphaMode::blend));
      const Masked found = masked(ShadedScene(scene.trace), count);
      EXPECT_NEAR(area(found.after), 36 * opacity, 1e-4);
      std::vector<int> of_pixel(36);
      for (const Fragment& fragment : found.after) of_pixel[fragment.pixel] += fragment.mask.count();
      for (const int taken : of_pixel) EXPECT_LE(std::abs(taken - opacity * static_cast<float>(count)), 1.0f);
    }
}

TEST(AlphaMask, AFragmentWithoutPositionsIsASpeck) {
  SurfaceTrace scene(64, 64);
  scene.add_rectangle(0, 0, 64, 64, 0.5, unlit_material({1, 1, 1, 0.002f}, AlphaMode::blend));
  std::size_t specks = 0;
  for (const Fragment& fragment : masked(ShadedScene(scene.trace)).after) {
    EXPECT_EQ(fragment.tiny, fragment.mask.none());
    specks += fragment.tiny;
  }
  EXPECT_GT(specks, 1000u);
}

// Alpha is 0 in one of the four texels that are looked up.
SurfaceTrace one_pixel(AlphaMode mode) {
  SurfaceTrace scene(1, 1);
  const TextureImage image = image_with_alphas(2, 2, [](std::size_t i) { return i == 0 ? 0 : 200; });
  scene.add_rectangle(-20, -1, 2, 2, 0.5, textured_material(scene.add_image(image), mode));
  return scene;
}

// One pixel of a translucent rectangle with a texture: an alpha and 256 ranks. One of a cutout: a look-up of the whole
// pixel, and 256 alphas and ranks.
TEST(AlphaMask, CountsItsWork) {
  for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
    const ShadedScene shaded(one_pixel(mode).trace);
    const Masked found = masked(shaded);
    ASSERT_EQ(found.before.size(), 1u);
    const std::uint64_t alphas = mode == AlphaMode::mask ? 1 + 256 : 1;
    EXPECT_EQ(found.counters.items_in, 1u);
    EXPECT_EQ(found.counters.items_out, 1u);
    EXPECT_EQ(found.counters.bytes_read, 4 * 8 + 2u + 4);  // the mask, the area as fp16, and the number of the sheet
    EXPECT_EQ(found.counters.bytes_written, 4 * 8 + 2u);
    EXPECT_EQ(found.counters.lanes_used, 256u);
    EXPECT_EQ(found.counters.lanes_issued, 256u);
    EXPECT_EQ(found.counters.ops.fetch, alphas + 256 + 1);  // alphas, ranks, and the sheet's order
    // An alpha: weights in perspective (8 products, 10 sums and comparisons, a division); their slopes (10, 6, 1); two
    // texture coordinates (2, 4 each) and four slopes of them (2, 3 each); the factor.
    // Besides: eight products and four sums that make the pixel's flip, and two products; the area's factor.
    EXPECT_EQ(found.counters.ops.mul_add, alphas * (8 + 10 + 2 * 2 + 4 * 2 + 1) + 8 + 2 + 1);
    // A rank is moved and compared; in a cutout alpha is compared and selected, and added, and the four texels of the
    // pixel are compared with 0 and 1.
    EXPECT_EQ(found.counters.ops.add,
              alphas * (10 + 6 + 2 * 4 + 4 * 3) + 4 + (mode == AlphaMode::mask ? 256 * 5 + 2 : 256 * 2));
    EXPECT_EQ(found.counters.ops.special, alphas * 2 + (mode == AlphaMode::mask));
  }
}

// No position is ranked, so the number of the sheet is not read.
TEST(AlphaMask, SpecksReadNoSheet) {
  for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
    SurfaceTrace scene(1, 1);
    scene.add_rectangle(0.5, 0.5, 0.51, 0.51, 0.5,
                        textured_material(scene.add_image(filled_image(2, 2, {9, 9, 9, 200})), mode));
    const Masked found = masked(ShadedScene(scene.trace));
    ASSERT_FALSE(found.before.empty());
    ASSERT_EQ(positions(found.before), 0);
    EXPECT_EQ(found.counters.bytes_read, found.before.size() * (4 * 8 + 2));
  }
}

// Where texels are smaller than the part of a pixel that a position stands for, a side of 1/16, each position also
// takes the quotient of cutoff and alpha, and two of four shares. The rectangle has 2/3 of a texel to a pixel, times
// `scale`.
TEST(AlphaMask, CountsTheWorkOfSmallTexels) {
  const auto counters = [](float scale) {
    SurfaceTrace scene = one_pixel(AlphaMode::mask);
    for (glm::vec2& uv : scene.mesh().uvs[0]) uv *= scale;
    const Masked found = masked(ShadedScene(scene.trace));
    EXPECT_EQ(found.after.size(), 1u);
    return found.counters;
  };
  const StageCounters large = counters(1.0f);
  EXPECT_EQ(counters(18.0f).ops, large.ops) << "12 texels to a pixel";
  OperationCounts expected = large.ops;
  // Two comparisons, a difference and a limit; a whole number and its limit; the rest, and one less it.
  expected += OperationCounts{.mul_add = 2, .add = 7, .special = 2, .convert = 2} * 256;
  for (const float scale : {30.0f, 1000.0f}) {  // 20 texels to a pixel, and more
    const StageCounters small = counters(scale);
    EXPECT_EQ(small.ops, expected);
    EXPECT_EQ(small.bytes_read, large.bytes_read);
  }
}

}  // namespace beampipe::alpha_mask_test
