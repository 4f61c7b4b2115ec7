// Runs the stages of the beam pipeline one after the other, as far as a test needs them.
#pragma once

#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/compose_beam.h"
#include "stages/beam/compose_casav.h"
#include "stages/beam/windows.h"
#include "stages/data/casav_aggregate.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"
#include "tests/stages/screen_triangles.h"

namespace beampipe {

inline std::vector<Pair> pairs_of(const SetupTriangles& triangles, const Tile& tile) {
  std::vector<Pair> pairs;
  StageCounters ignored;
  conservative_raster(triangles, all_of(triangles), tile, ignored, pairs);
  return pairs;
}

inline std::vector<Fragment> fragments_of(const SetupTriangles& triangles, const Tile& tile,
                                          const BeamFragmentOptions& options) {
  std::vector<Fragment> fragments;
  StageCounters ignored;
  beam_fragment(triangles, pairs_of(triangles, tile), tile, options, ignored, fragments);
  return fragments;
}

// Composes the pixels of a tile by the area-conserving rules. Calls each(fragments, areas, pixels as they were, pixels)
// for each window, before what fills pixels is added. Returns the largest windows too.
template <std::size_t Words, class Each>
auto compose_windows(const SetupTriangles& triangles, const std::vector<glm::vec3>& colors, const Tile& tile,
                     Each&& each) {
  const PositionSet positions(cell_patterns(32 * Words));
  const PositionGrid grid(32 * Words);
  const BeamFragmentOptions options = grid_options(grid, conserving_fragment_bytes(32 * Words));
  StageCounters counters;
  std::vector<Pair> pairs, window, whole;
  std::vector<StoredAggregate<Words>> pixels(tile.pixels());
  ClosedDepth closed(tile);
  conservative_raster(triangles, all_of(triangles), tile, counters, pairs, {&closed});
  const ABuffer buffer = a_buffer(sort_records(pairs, tile), tile.pixels(), 0, kStoredPairBytes, counters);
  Windows windows(pairs, buffer, kStoredPairBytes);
  while (windows.next([&](std::uint32_t pixel) { return !is_closed(pixels[pixel]); }, counters, window, whole)) {
    std::vector<Fragment> fragments;
    std::vector<float> areas;
    beam_fragment(triangles, window, tile, options, counters, fragments);
    shade_visible(colors, fragments, counters);
    const std::vector<StoredAggregate<Words>> before = pixels;
    compose_window(fragments, positions, counters, pixels, areas);
    each(fragments, areas, before, pixels);
    if (testing::Test::HasFatalFailure()) break;
    compose_whole({whole, tile, colors}, counters, pixels);
  }
  return std::pair(pixels, windows.largest);
}

struct Fragments {
  std::vector<Fragment> list;
  StageCounters counters;
};

inline Fragments beam_fragments(const SetupTriangles& triangles, const Tile& tile, MaskSource mask,
                                int tiny_positions = 1) {
  static const SamplePattern pattern = hammersley_pattern();
  static const MaskTable table(pattern);
  Fragments fragments;
  beam_fragment(triangles, pairs_of(triangles, tile), tile,
                {.mask = mask,
                 .positions = {pattern},
                 .table = &table,
                 .fragment_bytes = sizeof(SlidesAggregate),
                 .tiny_positions = tiny_positions},
                fragments.counters, fragments.list);
  return fragments;
}

inline ABuffer sorted(const Fragments& fragments, std::size_t pixels) {
  StageCounters counters;
  return a_buffer(sort_records(fragments.list, SortKey::centroid), pixels, 0, sizeof(SlidesAggregate), counters);
}

// Returns the composed pixels of a tile. `colors`: one per triangle.
inline std::vector<Aggregate> beam_pixels(const SetupTriangles& triangles, const std::vector<glm::vec3>& colors,
                                          const Tile& tile, MaskSource mask, const MergeRules& rules = {}) {
  Fragments fragments = beam_fragments(triangles, tile, mask);
  StageCounters counters;
  shade(colors, fragments.list, counters);
  const MergePositions positions(hammersley_pattern());
  return compose(fragments.list, sorted(fragments, tile.pixels()), {positions, rules}, counters);
}

}  // namespace beampipe
