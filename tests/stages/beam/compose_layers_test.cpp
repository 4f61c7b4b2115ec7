#include "stages/beam/compose_layers.h"

#include "tests/stages/beam_pixels.h"

namespace beampipe::compose_layers_test {

constexpr Tile kTile{0, 0, 4, 4};
const SamplePattern kPattern = hammersley_pattern();
const MergePositions kPositions(kPattern);

// Fragments of triangles in the tile, shaded in different colours, in primitive order.
std::vector<Fragment> random_fragments(Random& random, int triangles) {
  SetupTriangles setup;
  for (int i = 0; i < triangles; ++i) {
    const float z = random.real32(-0.95, -0.05);
    const auto point = [&] {
      return ScreenPoint{random.int32(-200, 1224), random.int32(-200, 1224), z + random.real32(-0.04, 0.04)};
    };
    add_triangle(setup, point(), point(), point());
  }
  BeamFragmentOptions options;
  options.mask = MaskSource::exact;
  options.positions = {kPattern};
  options.tiny_positions = 1;
  options.clipped_depth = true;
  std::vector<Fragment> fragments = fragments_of(setup, kTile, options);
  for (Fragment& fragment : fragments)
    fragment.color = fragment.alpha * glm::vec3(random.real32(0, 1), random.real32(0, 1), random.real32(0, 1));
  return fragments;
}

// The order of the A-buffer: within a pixel, near to far.
std::vector<Fragment> near_to_far(std::vector<Fragment> fragments) {
  std::stable_sort(fragments.begin(), fragments.end(),
                   [](const Fragment& a, const Fragment& b) { return a.z_min < b.z_min; });
  return fragments;
}

struct Composed {
  std::vector<Aggregate> pixels;
  std::vector<float> merges = std::vector<float>(kTile.pixels(), 0);
  StageCounters counters;
};

Composed composed(const std::vector<Fragment>& fragments, std::size_t layers,
                  CasavStorage storage = CasavStorage::slides, const MergeRules& rules = {}) {
  Composed found;
  AggregateLayers pixels(kTile.pixels(), layers, {kPositions, rules, storage});
  pixels.add(fragments, found.counters, found.merges);
  found.pixels = pixels.finish(found.counters);
  return found;
}

// The same fragments by the published rules with an A-buffer.
std::vector<Aggregate> by_lists(const std::vector<Fragment>& fragments, CasavStorage storage, StageCounters& counters) {
  StageCounters sorting;
  const ABuffer lists = a_buffer(sort_records(fragments, SortKey::nearest), kTile.pixels(), 42, 42, sorting);
  return compose(fragments, lists, {kPositions, {}, storage}, counters);
}

struct Tolerance {
  float of_numbers = 0, of_colors = 0;
};

// Of up to eight merges, each of which rounds colours to fp16.
constexpr Tolerance kMerges{1e-5f, 8 * 0x1p-12f};

void expect_same(const std::vector<Aggregate>& found, const std::vector<Aggregate>& expected,
                 const Tolerance& tolerance = {}) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].alpha, expected[i].alpha, tolerance.of_numbers) << i;
    EXPECT_EQ(found[i].mask, expected[i].mask) << i;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[i].color[c], expected[i].color[c], tolerance.of_colors) << i;
    EXPECT_NEAR(found[i].thickness, expected[i].thickness, tolerance.of_numbers) << i;
  }
}

// One aggregate, and fragments from near to far, are the published rules with an A-buffer, to the bit.
TEST(ComposeLayers, OneLayerNearToFarIsTheABuffer) {
  Random random(71);
  for (int i = 0; i < 20; ++i) {
    const std::vector<Fragment> fragments = random_fragments(random, 12);
    for (const CasavStorage storage : {CasavStorage::slides, CasavStorage::text}) {
      StageCounters of_lists;
      const std::vector<Aggregate> expected = by_lists(fragments, storage, of_lists);
      const Composed found = composed(near_to_far(fragments), 1, storage);
      expect_same(found.pixels, expected);
      EXPECT_EQ(found.counters.ops, of_lists.ops) << "a single layer needs no search";
    }
  }
}

// While there are at least as many layers as fragments, the order in which these come does not matter. Specks are left
// out: a stored aggregate does not say that it was one. The first fragment of a pixel is kept as it is, where the
// A-buffer merges it into an empty aggregate, which rounds. At equal depth the fragment that comes first lies in front.
TEST(ComposeLayers, EnoughLayersAreTheABufferInAnyOrder) {
  Random random(72);
  for (int i = 0; i < 40; ++i) {
    const bool twice = i % 2 == 0;  // each fragment, in another colour
    std::vector<Fragment> fragments = random_fragments(random, twice ? 3 : 8);
    std::erase_if(fragments, [](const Fragment& fragment) { return fragment.tiny; });
    for (std::size_t k = 0, count = fragments.size(); twice && k < count; ++k) {
      fragments.push_back(fragments[k]);
      fragments.back().color = fragments[k].alpha * glm::vec3(random.real32(0, 1), random.real32(0, 1), 0);
    }
    StageCounters ignored;
    const Composed found = composed(fragments, 8);
    expect_same(found.pixels, by_lists(fragments, CasavStorage::slides, ignored), kMerges);
    EXPECT_EQ(std::ranges::max(found.merges), 0);
  }
}

// Fewer layers merge on the way. Every merge is counted, masks are joined, and no colour or area leaves its range.
TEST(ComposeLayers, FewerLayersMergeTheClosest) {
  Random random(73);
  for (int i = 0; i < 20; ++i) {
    const std::vector<Fragment> fragments = random_fragments(random, 30);
    for (const std::size_t layers : {2u, 3u, 4u}) {
      const auto [found, merges, counters] = composed(fragments, layers);
      std::vector<std::size_t> counts(kTile.pixels());
      std::vector<std::uint32_t> masks(kTile.pixels());
      for (const Fragment& fragment : fragments) {
        ++counts[fragment.pixel];
        masks[fragment.pixel] |= fragment.mask.words[0];
      }
      for (std::size_t pixel = 0; pixel < found.size(); ++pixel) {
        EXPECT_EQ(merges[pixel], counts[pixel] > layers ? static_cast<float>(counts[pixel] - layers) : 0.0f);
        EXPECT_EQ(found[pixel].mask, masks[pixel]);
        EXPECT_GE(found[pixel].alpha, 0.0f);
        EXPECT_LE(found[pixel].alpha, 1.0f);
        for (const float channel : found[pixel].color) {
          EXPECT_GE(channel, 0.0f);
          EXPECT_LE(channel, found[pixel].alpha * 1.00001f);
        }
      }
      EXPECT_EQ(counters.items_in, fragments.size());
    }
  }
}

// A surface at one depth, of which all that is seen is `color`.
Fragment flat(float z, std::uint32_t mask, float alpha, const glm::vec3& color) {
  Fragment fragment{};
  fragment.alpha = alpha;
  fragment.mask.words[0] = mask;
  fragment.plane = {z, 0, 0};
  fragment.z_min = fragment.z_max = z;
  fragment.color = alpha * color;
  return fragment;
}

// Two layers, which merge twice.
Aggregate in_two_layers(const std::vector<Fragment>& fragments, const MergeRules& rules = {}) {
  const Composed found = composed(fragments, 2, CasavStorage::slides, rules);
  EXPECT_EQ(found.merges[0], 2);
  return found.pixels[0];
}

void expect_color(const Aggregate& found, const glm::vec3& expected) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.color[c], expected[c], 1e-5f);
}

// Of three surfaces in two layers, the two that are close become one: so the fourth, just in front of the last, hides
// it. If the last two were one, the fourth would lie within their slab, and be mixed with them.
TEST(ComposeLayers, TheClosestTwoBecomeOne) {
  const Fragment red = flat(-0.9f, 0x000000ff, 0.25f, {1, 0, 0}), green = flat(-0.89f, 0x0000ff00, 0.25f, {0, 1, 0}),
                 blue = flat(-0.2f, 0xffff0000, 0.5f, {0, 0, 1}), white = flat(-0.25f, 0xffff0000, 0.5f, {1, 1, 1});
  for (const std::vector<Fragment>& order : {std::vector{red, green, blue, white}, {blue, green, red, white}})
    expect_color(in_two_layers(order), {0.75f, 0.75f, 0.5f});
}

// The same where the last two are close: the first hides the fourth, which lies just behind it. If the first two were
// one, the fourth would lie within their slab.
TEST(ComposeLayers, TheClosestTwoMayBeTheLast) {
  const Fragment red = flat(-0.9f, 0x000000ff, 0.25f, {1, 0, 0}), green = flat(-0.21f, 0x0000ff00, 0.25f, {0, 1, 0}),
                 blue = flat(-0.2f, 0xffff0000, 0.5f, {0, 0, 1}), white = flat(-0.85f, 0x000000ff, 0.25f, {1, 1, 1});
  expect_color(in_two_layers({red, green, blue, white}), {0.25f, 0.25f, 0.5f});
}

// Green and blue become a slab because white is far behind them; then red, in front, is merged with the slab, whose
// plane is near but which reaches far. White is hidden and changes nothing, because only what is visible makes slabs
// thicker here.
TEST(ComposeLayers, ASurfaceBeforeASlabKeepsTheSlabsThickness) {
  const Fragment green = flat(-0.8f, 0x0000ffff, 0.5f, {0, 1, 0}), blue = flat(-0.2f, 0x00010000, 1 / 32.0f, {0, 0, 1}),
                 white = flat(0.9f, 0x000000ff, 0.25f, {1, 1, 1}), red = flat(-0.81f, 0xff000000, 0.25f, {1, 0, 0});
  MergeRules rules;
  rules.slab = MergeRules::Slab::visible;
  EXPECT_NEAR(in_two_layers({green, blue, white, red}, rules).thickness, 2 * 0.6f, 0.1f);
}

TEST(ComposeLayers, CountsBytes) {
  Random random(74);
  const std::vector<Fragment> fragments = random_fragments(random, 10);
  StageCounters counters;
  AggregateLayers pixels(kTile.pixels(), 3, {kPositions, {}, CasavStorage::slides});
  std::vector<float> merges(kTile.pixels());
  pixels.add(fragments, counters, merges);
  EXPECT_EQ(pixels.bytes_per_pixel(), 3u * 42);
  EXPECT_EQ(counters.bytes_read, fragments.size() * (42 + 3 * 42));
  EXPECT_EQ(counters.bytes_written, fragments.size() * 3 * 42);
}

}  // namespace beampipe::compose_layers_test
