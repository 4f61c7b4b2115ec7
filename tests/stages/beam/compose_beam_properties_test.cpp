// Properties that an area-conserving aggregate has, whatever is composed into it, window by window. BEAMPIPE_THOROUGH=N
// tries N times as many cases.
#include <gtest/gtest.h>

#include <cstdio>

#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/compose_beam.h"
#include "stages/beam/windows.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"
#include "tests/stages/screen_triangles.h"
#include "tests/stages/search.h"

namespace beampipe::compose_beam_properties_test {

constexpr Tile kTile{0, 0, 12, 10};
constexpr float kRounding = 1e-5f;  // of a sum in float32 over the fragments of a pixel

template <std::size_t Words>
using Pixels = std::vector<StoredAggregate<Words, float>>;

// Compares each pixel after its windows with what it was earlier. The area is the sum of the old and the added area, at
// most 1, and exactly 1 if the mask has no gap. The mask is the union of the old mask and the added ones. A colour lies
// between the smallest and the largest added colour.
template <std::size_t Words>
void expect_kept(const Pixels<Words>& before, const Pixels<Words>& after, const std::vector<Fragment>& fragments,
                 const std::vector<float>& areas, float least, float greatest) {
  std::vector<WideMask> masks(before.size());
  std::vector<float> added(before.size());
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    ASSERT_LE(fragments[i].z_min, fragments[i].z_max);
    ASSERT_GE(areas[i], 0.0f);
    added[fragments[i].pixel] += areas[i];
    for (std::size_t w = 0; w < Words; ++w) masks[fragments[i].pixel].words[w] |= fragments[i].mask.words[w];
  }
  for (std::size_t p = 0; p < before.size(); ++p) {
    ASSERT_LE(before[p].area + added[p], 1.0f + kRounding);
    ASSERT_NEAR(after[p].area, is_closed(after[p]) ? 1.0f : before[p].area + added[p], kRounding);
    ASSERT_LE(after[p].area, 1.0f);
    for (std::size_t w = 0; w < Words; ++w)
      ASSERT_EQ(+after[p].mask[w], before[p].mask[w] | masks[p].words[w]) << "word " << w;
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_GE(+after[p].color[c], least * after[p].area - kRounding);
      ASSERT_LE(+after[p].color[c], greatest * after[p].area + kRounding);
    }
  }
}

// Composes random triangles. Returns the number of fragments.
template <std::size_t Words>
std::uint64_t compose_random(Random& random) {
  const PositionSet positions(cell_patterns(32 * Words));
  const PositionGrid grid(32 * Words);
  const BeamFragmentOptions options = grid_options(grid, conserving_fragment_bytes(32 * Words));
  const SetupTriangles triangles = random_triangles(random, random.int32(1, 80));
  constexpr float kLeast = 0.125f, kGreatest = 0.75f;
  std::vector<glm::vec3> colors;
  for (std::size_t i = 0; i < triangles.triangles.size(); ++i)
    colors.emplace_back(random.real32(kLeast, kGreatest), random.real32(kLeast, kGreatest),
                        random.real32(kLeast, kGreatest));
  StageCounters counters;
  std::vector<Pair> pairs, window, whole;
  ClosedDepth closed(kTile);
  conservative_raster(triangles, all_of(triangles), kTile, counters, pairs, {&closed});
  const ABuffer buffer = a_buffer(sort_records(pairs, kTile), kTile.pixels(), 0, kStoredPairBytes, counters);
  Windows windows(pairs, buffer, kStoredPairBytes);
  Pixels<Words> pixels(kTile.pixels());
  std::uint64_t merged = 0;
  while (windows.next([&](std::uint32_t pixel) { return !is_closed(pixels[pixel]); }, counters, window, whole)) {
    std::vector<Fragment> fragments;
    std::vector<float> areas;
    beam_fragment(triangles, window, kTile, options, counters, fragments);
    shade_visible(colors, fragments, counters);
    const Pixels<Words> before = pixels;
    compose_window(fragments, positions, counters, pixels, areas);
    expect_kept<Words>(before, pixels, fragments, areas, kLeast, kGreatest);
    if (testing::Test::HasFatalFailure()) return merged;
    compose_whole({whole, kTile, colors}, counters, pixels);
    merged += fragments.size();
  }
  return merged;
}

TEST(Properties, WindowsKeepAreaMaskAndColour) {
  std::uint64_t merged = 0;
  search(6'000'000, 50, [&](Random& random) {
    for (int i = 0; i < 4; ++i) merged += compose_random<8>(random);
  });
  std::printf("fragments composed: %llu\n", static_cast<unsigned long long>(merged));
}

}  // namespace beampipe::compose_beam_properties_test
