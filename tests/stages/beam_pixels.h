// Runs the stages of the beam pipeline one after the other, as far as a test needs them.
#pragma once

#include <vector>

#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/compose_casav.h"
#include "stages/data/casav_aggregate.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"
#include "tests/stages/screen_triangles.h"

namespace beampipe {

struct Fragments {
  std::vector<Fragment> list;
  StageCounters counters;
};

inline Fragments beam_fragments(const SetupTriangles& triangles, const Tile& tile, MaskSource mask,
                                int tiny_positions = 1) {
  static const SamplePattern pattern = hammersley_pattern();
  static const MaskTable table(pattern);
  std::vector<Pair> pairs;
  StageCounters raster;
  conservative_raster(triangles, all_of(triangles), tile, raster, pairs);
  Fragments fragments;
  beam_fragment(triangles, pairs, tile,
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
