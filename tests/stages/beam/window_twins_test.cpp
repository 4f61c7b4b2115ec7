// Everything that hides and orders pairs before fragments are made is counted as its scalar twins count it, pair by
// pair and on every procedural scene: depth bounds, closed depths and windows. The same holds for the composition of
// pixels that a single triangle covers.

#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/compose_beam.h"
#include "stages/beam/merge_sort.h"
#include "stages/beam/windows.h"
#include "stages/data/closed_depth.h"
#include "stages/data/fragment_geometry.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"
#include "stages/raster/sample_raster.h"
#include "stages/raster/traverse.h"
#include "tests/stages/scene_twins.h"

namespace beampipe::window_twins_test {

using namespace twins;

class WindowTwins : public SceneTwins {
 protected:
  WindowTwins() : SceneTwins(40) {}

  DepthBounds<Float> vertices_of(std::uint32_t index) {
    const float* const z = triangles_.triangles[index].vertex_z;
    const Float counted[3] = {real(z[0]), real(z[1]), real(z[2])};
    return vertex_bounds(counted);
  }

  DepthBounds<Float> bounds_of(const Pair& pair, const DepthBounds<Float>& vertices) {
    const ScreenDepth& depth = triangles_.triangles[pair.triangle].depth;
    const ScreenDepthOf<Real> counted = {real(depth.z), real(depth.dzdx), real(depth.dzdy), real(depth.anchor_x),
                                         real(depth.anchor_y)};
    const Float z = to_float(counted.at(real(pair.x + 0.5), real(pair.y + 0.5)));
    return pair_bounds<Float>({z, to_float(real(depth.dzdx)), to_float(real(depth.dzdy))}, vertices);
  }

  // Rasterizes one triangle with nothing that hides it. Only the traversal is counted.
  std::vector<Pair> touched(std::uint32_t index) {
    std::vector<Pair> pairs;
    StageCounters traversal;
    conservative_raster(triangles_, {index}, tile_, traversal, pairs, {.depths = PairDepths::none});
    twin_ += traversal.ops;
    return pairs;
  }
};

TEST_P(WindowTwins, DepthBounds) {
  StageCounters counters;
  std::vector<Pair> pairs;
  conservative_raster(triangles_, list_, tile_, counters, pairs);
  std::size_t next = 0;
  for (const std::uint32_t index : list_) {
    const DepthBounds<Float> vertices = vertices_of(index);
    for (const Pair& pair : touched(index)) {
      const DepthBounds<Float> bounds = bounds_of(pair, vertices);
      ASSERT_EQ(bounds.nearest.value, pairs[next].nearest);
      ASSERT_EQ(bounds.farthest.value, pairs[next].farthest);
      ++next;
    }
  }
  EXPECT_EQ(next, pairs.size());
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(counters.bytes_written, pairs.size() * (8 + 8));
}

// Two lists one after the other, as in the passes of streaming order.
TEST_P(WindowTwins, ClosedDepth) {
  const TriangleList halves[2] = {{list_.begin(), list_.begin() + static_cast<std::ptrdiff_t>(list_.size() / 2)},
                                  {list_.begin() + static_cast<std::ptrdiff_t>(list_.size() / 2), list_.end()}};
  ClosedDepth closed(tile_);
  std::vector<Float> depth(tile_.pixels(), Float(1.0f));
  Float farthest(1.0f);
  std::size_t changes = 0;  // pixels nearer than the farthest one
  for (const TriangleList& list : halves) {
    StageCounters counters;
    std::vector<Pair> pairs, found;
    const std::size_t waited = conservative_raster(triangles_, list, tile_, counters, pairs, {&closed});
    twin_ = {};
    std::uint64_t read = 0, written = 0;
    const auto hidden = [&](const Pair& pair, const Float& nearest) {
      read += 4;
      return nearest > depth[tile_.index(pair.x, pair.y)];
    };
    for (const std::uint32_t index : list) {
      const DepthBounds<Float> vertices = vertices_of(index);
      if (vertices.nearest > farthest) continue;
      for (Pair pair : touched(index)) {
        const DepthBounds<Float> bounds = bounds_of(pair, vertices);
        if (hidden(pair, bounds.nearest)) continue;
        pair.nearest = bounds.nearest.value, pair.farthest = bounds.farthest.value;
        found.push_back(pair);
        if (!pair.full) continue;
        Float& stored = depth[tile_.index(pair.x, pair.y)];
        read += 4;
        if (bounds.farthest >= stored) continue;
        changes += real(stored.value) == farthest;
        stored = bounds.farthest;
        written += 4;
      }
      if (changes < depth.size()) continue;
      changes = 0, farthest = real(-10.0f);
      for (const Float& pixel : depth) {
        read += 4;
        if (real(pixel.value) > farthest) farthest = real(pixel.value);
      }
      for (const Float& pixel : depth) {
        read += 4;
        changes += real(pixel.value) < farthest;
      }
    }
    EXPECT_EQ(waited, found.size());
    read += found.size() * 16;
    std::erase_if(found, [&](const Pair& pair) { return hidden(pair, real(pair.nearest)); });
    ASSERT_EQ(found.size(), pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) ASSERT_EQ(found[i].triangle, pairs[i].triangle);
    EXPECT_EQ(counters.ops, twin_);
    EXPECT_EQ(counters.bytes_read, read);
    EXPECT_EQ(counters.bytes_written, written + pairs.size() * 16);
  }
}

// Techniques that test samples use closed depths for cells. A triangle does not hide itself, so all its cells are
// added.
TEST_P(WindowTwins, ClosedCells) {
  const Sampling sampling{CellGrid{2, 2}, standard_pattern(8, 128, 128)};
  for (const std::uint32_t index : list_) {
    const SetupTriangle& triangle = triangles_.triangles[index];
    ClosedDepth closed(cells_of(tile_, sampling.grid));
    StageCounters with, without;
    std::vector<SampleFragment> fragments, all;
    sample_raster({triangles_, tile_, sampling}, {index}, with, fragments, &closed);
    sample_raster({triangles_, tile_, sampling}, {index}, without, all);
    ASSERT_EQ(fragments.size(), all.size());
    twin_ = without.ops;
    const DepthBounds<Float> bounds =
        sample_bounds(vertices_of(index), real(triangle.depth.dzdx), real(triangle.depth.dzdy));
    const Float open = real(1.0f);
    ASSERT_FALSE(bounds.nearest > open);
    std::uint64_t tests = 0, closings = 0;
    Traversal traversal{tile_, sampling.grid, FullMeans::samples};
    traverse_quads(triangle, EdgeSet(triangle), traversal, [&](std::int32_t, std::int32_t, const QuadRow& cells) {
      for (std::uint64_t left = cells.touched; left != 0; left &= left - 1) {
        ++tests;
        ASSERT_FALSE(bounds.nearest > open);
        if ((cells.full & left & ~(left - 1)) == 0) continue;
        ++closings;
        ASSERT_FALSE(bounds.farthest >= open);
        ASSERT_TRUE(open == Float(1.0f));
      }
    });
    const std::uint64_t cells = 4 * tile_.pixels(), refreshed = closings == cells ? 2 * cells : 0;
    twin_.add += refreshed;
    ASSERT_EQ(with.ops, twin_);
    ASSERT_EQ(with.bytes_read - without.bytes_read, 4 * (tests + closings + refreshed));
    ASSERT_EQ(with.bytes_written - without.bytes_written, 4 * closings);
  }
}

TEST_P(WindowTwins, Windows) {
  constexpr std::size_t kWords = 8;
  const PositionSet positions(cell_patterns(32 * kWords));
  const PositionGrid grid(32 * kWords);
  StageCounters ignored, counters, whole_pixels;
  std::vector<Pair> pairs, window, whole;
  std::vector<StoredAggregate<kWords>> pixels(tile_.pixels());
  const std::vector<glm::vec3> colors(list_.size(), glm::vec3(0.5f));
  conservative_raster(triangles_, list_, tile_, ignored, pairs);
  const ABuffer buffer = a_buffer(sort_records(pairs, tile_), tile_.pixels(), 16, 12, ignored);
  Windows windows(pairs, buffer, 12);
  std::vector<std::uint32_t> next(tile_.pixels()), scratch;
  std::uint64_t read = 0, taken = 0, made = 0, shown_whole = 0;
  while (windows.next([&](std::uint32_t pixel) { return !is_closed(pixels[pixel]); }, counters, window, whole)) {
    std::vector<Fragment> fragments;
    std::vector<float> areas;
    std::size_t in_window = 0, in_whole = 0;
    for (std::uint32_t pixel = 0; pixel < tile_.pixels(); ++pixel) {
      const std::uint32_t* const list = buffer.records.data() + buffer.first[pixel];
      const std::uint32_t depth = buffer.record_count(pixel), first = next[pixel];
      if (first == depth || is_closed(pixels[pixel])) continue;
      Float farthest = real(pairs[list[first]].farthest);
      read += first == 0 ? 16 : 0;
      std::vector<std::uint32_t> members = {list[first]};
      while (++next[pixel] < depth) {
        const Pair& pair = pairs[list[next[pixel]]];
        read += 16;
        if (!overlaps(real(pair.nearest), farthest)) break;
        farthest = greater(farthest, real(pair.farthest));
        members.push_back(list[next[pixel]]);
      }
      ++made, taken += members.size();
      if (first == 0 && members.size() == 1 && pairs[members[0]].full) {
        ASSERT_EQ(whole.at(in_whole++).triangle, pairs[members[0]].triangle);
        continue;
      }
      merge_sort(members.data(), members.size(), scratch,
                 [&](std::uint32_t index) { return Counted<std::uint32_t>(index, twin_); });
      for (const std::uint32_t index : members) ASSERT_EQ(window.at(in_window++).triangle, pairs[index].triangle);
    }
    ASSERT_EQ(in_window, window.size());
    ASSERT_EQ(in_whole, whole.size());
    beam_fragment(triangles_, window, tile_, grid_options(grid, 0), ignored, fragments);
    shade_visible(colors, fragments, ignored);
    compose_window(fragments, positions, ignored, pixels, areas);
    compose_whole({whole, tile_, colors}, whole_pixels, pixels);
    shown_whole += whole.size();
  }
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(counters.items_in, taken);
  EXPECT_EQ(counters.items_out, made);
  EXPECT_EQ(counters.bytes_read, read);
  EXPECT_EQ(counters.bytes_written, taken * 16);
  OperationCounts halves;
  for (std::uint64_t channel = 0; channel < 3 * shown_whole; ++channel) converted(Float(0.5f, halves));
  EXPECT_EQ(whole_pixels.ops, halves);
}

BEAMPIPE_ON_EVERY_SCENE(WindowTwins);

}  // namespace beampipe::window_twins_test
