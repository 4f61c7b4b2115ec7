// The stages count the same for whole batches as their scalar twins count item by item, on numbers that count and with
// the real data of every procedural scene.
#include "simd/depth_compare.h"
#include "stages/beam/merge_sort.h"
#include "stages/data/fragment_geometry.h"
#include "stages/samples/accumulate.h"
#include "tests/stages/beam_pixels.h"
#include "tests/stages/sample_pixels.h"
#include "tests/stages/scene_twins.h"

namespace beampipe::twin_counts_test {

using namespace twins;

class TwinCounts : public SceneTwins {};

TEST_P(TwinCounts, Sort) {
  StageCounters sorting;
  BeamFragmentOptions options;
  options.mask = MaskSource::exact;
  options.positions = {hammersley_pattern()};
  const std::vector<Fragment> fragments = fragments_of(triangles_, tile_, options);
  const ABuffer buffer = a_buffer(sort_records(fragments, SortKey::centroid), tile_.pixels(), 42, 42, sorting);

  std::vector<std::vector<std::uint32_t>> arrived(tile_.pixels());
  for (std::uint32_t i = 0; i < fragments.size(); ++i) arrived[fragments[i].pixel].push_back(i);
  std::vector<std::uint32_t> scratch;
  for (std::size_t pixel = 0; pixel < tile_.pixels(); ++pixel) {
    merge_sort(arrived[pixel].data(), arrived[pixel].size(), scratch,
               [&](std::uint32_t i) { return real(fragments[i].centroid_z); });
    ASSERT_TRUE(std::equal(arrived[pixel].begin(), arrived[pixel].end(), buffer.records.begin() + buffer.first[pixel]));
  }
  EXPECT_EQ(sorting.ops, twin_);
}

TEST_P(TwinCounts, DepthTest) {
  const Sampling sampling{CellGrid{}, standard_pattern(8)};
  StageCounters counters;
  const std::vector<SampleFragment> fragments = sample_fragments(triangles_, tile_, sampling);
  std::vector<SampleAccess> accesses;
  SampleTile surface(tile_, sampling), stored(tile_, sampling);
  depth_test({triangles_, tile_, sampling}, fragments, counters, surface, accesses);
  for (const SampleFragment& fragment : fragments) {
    const ScreenDepth& plane = triangles_.triangles[fragment.triangle].depth;
    const ScreenDepthOf<Real> counted = {real(plane.z), real(plane.dzdx), real(plane.dzdy), real(plane.anchor_x),
                                         real(plane.anchor_y)};
    const auto in_cell =
        cell_plane(counted, real(static_cast<double>(fragment.x)), real(static_cast<double>(fragment.y)));
    const auto first = static_cast<std::size_t>(fragment.y * tile_.width() + fragment.x) * 8;
    for (std::size_t s = 0; s < 8; ++s) {
      if (!(fragment.mask >> s & 1)) continue;
      Float depth;
      const bool passes =
          depth_test_scalar(in_cell, real(static_cast<float>(sampling.pattern.x[s])),
                            real(static_cast<float>(sampling.pattern.y[s])), real(stored.depth[first + s]), depth);
      if (passes) stored.depth[first + s] = depth.value;
    }
  }
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(surface.depth, stored.depth);
  EXPECT_EQ(counters.lanes_used, counters.items_in);
  EXPECT_EQ(counters.lanes_issued, fragments.size() * 8);
}

TEST_P(TwinCounts, Accumulate) {
  const std::vector<SampleFragment> fragments = sample_fragments(triangles_, tile_, {CellGrid{}, standard_pattern(8)});
  const std::vector<glm::vec3> colors(triangles_.triangles.size(), glm::vec3(0.5f));
  for (const DoubleCounting counting : {DoubleCounting::none, DoubleCounting::saturate}) {
    StageCounters counters;
    Accumulator accumulator(tile_, 8, AccumulatorFormat::fp16, counting);
    accumulate(fragments, colors, {}, tile_, counters, accumulator);
    twin_ = {};
    for (const SampleFragment& fragment : fragments) {
      Float share = bit_count(Bits(fragment.mask, twin_)) * real(1.0f / 8);
      if (counting == DoubleCounting::saturate) share = greater(lesser(share, real(1.0f) - real(0.0f)), real(0.0f));
      for (int channel = 0; channel < 4; ++channel) converted(converted(real(0.0f)) + real(0.5f) * share);
    }
    EXPECT_EQ(counters.lanes_used, fragments.size());
    EXPECT_EQ(counters.lanes_issued, fragments.size());
    EXPECT_EQ(counters.ops, twin_);
  }
}

BEAMPIPE_ON_EVERY_SCENE(TwinCounts);

}  // namespace beampipe::twin_counts_test
