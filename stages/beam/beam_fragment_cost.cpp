#include "stages/beam/beam_fragment_cost.h"

#include <array>
#include <bit>

#include "simd/coverage.h"
#include "simd/sample_mask.h"
#include "stages/beam/specks.h"
#include "stages/cost/counting.h"
#include "stages/cost/plane_cost.h"
#include "stages/data/fragment_geometry.h"

namespace beampipe {
namespace {

using CountedInt = Counted<std::int64_t>;
using CountedFloat = Counted<float>;

EdgeAt<CountedInt> counted_edge(OperationCounts& counts) {
  const CountedInt one(1, counts);
  return {one, one, one};
}

// A triangle whose vertices are yet to be made relative to the pixel.
TriangleInPixelOf<CountedInt> counted_triangle(OperationCounts& counts) {
  const CountedInt zero(0, counts), vertices[3] = {zero, zero, zero};
  return in_pixel(vertices, vertices, zero, zero);
}

// A triangle whose vertices are already relative to the pixel.
TriangleInPixelOf<CountedInt> vertices_at_hand(OperationCounts& counts) {
  TriangleInPixelOf<CountedInt> triangle;
  for (int k = 0; k < 3; ++k) triangle.x[k] = triangle.y[k] = CountedInt(0, counts);
  return triangle;
}

// Per pair: the vertices relative to the pixel, and the coverage.
OperationCounts coverage_cost() {
  return count_operations(
      [](OperationCounts& counts) { coverage_formula<CountedInt, CountedFloat>(counted_triangle(counts)); });
}

OperationCounts centroid_depth_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts), half(0.5f);
    lesser(greater(depth_at(DepthPlane<CountedFloat>{one, one, one}, one - half, one - half), one), one);
  });
}

OperationCounts clipped_depth_cost() {
  return count_operations([](OperationCounts& counts) {
    DepthRangeInput<CountedFloat> in;
    set_geometry(vertices_at_hand(counts), in);
    in.z = in.dzdu = in.dzdv = in.vertex_z[0] = in.vertex_z[1] = in.vertex_z[2] = CountedFloat(1.0f, counts);
    depth_range_formula(in);
  });
}

// Per pair, for `grid`: its edges, and whether they have the whole pixel inside.
OperationCounts grid_edges_cost() {
  return count_operations([](OperationCounts& counts) {
    const TriangleInPixelOf<CountedInt> triangle = vertices_at_hand(counts);
    for (int k = 0; k < 3; ++k) is_pixel_inside(edge_for_positions(triangle, k));
  });
}

// Per edge that is tested at so many positions.
struct EdgeCosts {
  UnitCost narrow, wide;
};
EdgeCosts edge_costs(int positions) {
  const auto cut = [&](auto&& edge_of) {
    return count_operations([&](OperationCounts& counts) {
      const CountedInt one(1, counts);
      const EdgeInPixel<CountedInt> edge{one, one, one};
      has_small_slopes(edge);
      Counted<std::uint32_t> words[kMaxMaskWords];
      cut_mask(edge_of(edge), PositionGrid(positions), words);
    });
  };
  return {cut([](const auto& edge) { return narrowed(edge); }), cut([](const auto& edge) { return edge; })};
}

const EdgeCosts& grid_edge_costs(const PositionGrid& grid) {
  static const std::array<EdgeCosts, 4> costs{edge_costs(32), edge_costs(64), edge_costs(128), edge_costs(256)};
  return costs[static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(grid.count() / 32)))];
}

OperationCounts table_mask_cost(const MaskTable& table) {
  static const UnitCost cost = count_operations([&](OperationCounts& counts) {
    const CountedInt zero(0, counts);
    TableTriangleOf<Counted<std::int32_t>, Counted<std::uint32_t>, CountedFloat> triangle;
    for (auto& edge : triangle.edges) {
      edge.angle = Counted<std::int32_t>(0, counts);
      edge.flip = Counted<std::uint32_t>(0u, counts);
      edge.distance = edge_distance(counted_edge(counts), zero, zero, Counted<double>(1.0, counts));
    }
    table_mask_formula(triangle, table);
  });
  return cost;
}

OperationCounts exact_mask_cost(const std::vector<SamplePattern>& positions) {
  static const UnitCost of_edges = count_operations([](OperationCounts& counts) {
    const CountedInt zero(0, counts);
    for (int k = 0; k < 3; ++k) owned_edge(counted_edge(counts), zero, zero, zero);
  });
  static const UnitCost of_position = count_operations([](OperationCounts& counts) {
    const CountedInt zero(0, counts), edges[3] = {zero, zero, zero};
    sample_mask_scalar(edges, edges, edges, standard_pattern(1));
  });
  OperationCounts cost = of_edges;
  for (const SamplePattern& pattern : positions) cost += of_position * static_cast<std::uint64_t>(pattern.count);
  return cost;
}

// Per triangle, while consecutive pairs belong to it, for `exact`: its edges, and whether they own the samples on them.
OperationCounts exact_edges_cost() {
  return count_operations([](OperationCounts& counts) {
    for (int k = 0; k < 3; ++k) {
      const EdgeInPixel<CountedInt> edge = edge_in_pixel(vertices_at_hand(counts), k);
      owns_its_samples(edge.a, edge.b);
    }
  });
}

// The same for `table`: its edges, their angles in the table, and the inverse of their lengths.
OperationCounts table_edges_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> zero(0.0), one(1.0, counts);
    for (int k = 0; k < 3; ++k) {
      const EdgeInPixel<CountedInt> edge = edge_in_pixel(vertices_at_hand(counts), k);
      const Counted<double> a = to_double(edge.a), b = to_double(edge.b);
      const bool flip = (b < zero) | ((b == zero) & (a < zero));
      const Counted<double> theta = select(flip, zero - b, b) / select(flip, zero - a, a);  // counts as an arc tangent
      select(converted(theta * one + one) < one, one, zero);  // the nearest angle; half a turn is 0, flipped
      select(flip, one, one) / (square_root(a * a + b * b) * one);
    }
  });
}

// Per position, when a speck's nearest free position is searched.
OperationCounts nearest_position_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFloat x(0.0f), u(1.0f, counts), least(4.0f, counts);  // the positions are constants
    const Counted<std::uint32_t> index(0u, counts);
    NearestPosition<CountedFloat, Counted<std::uint32_t>> search{u, u, least, index};
    search.look_at(x, x, true, index);
    counts.bit += 1;  // the test whether the position is free
  });
}

}  // namespace

void charge(const BeamFragmentWork& work, const BeamFragmentOptions& options, StageCounters& counters) {
  static const UnitCost of_area = coverage_cost(), of_range = clipped_depth_cost(), of_plane = plane_cost(),
                        of_centroid = centroid_depth_cost(), of_exact_edges = exact_edges_cost(),
                        of_table_edges = table_edges_cost(), of_grid_edges = grid_edges_cost(),
                        of_nearest = nearest_position_cost();
  OperationCounts of_pair = of_area;
  if (options.clipped_depth) of_pair += of_range;
  if (options.mask == MaskSource::table) of_pair += table_mask_cost(*options.table);
  if (options.mask == MaskSource::exact) of_pair += exact_mask_cost(options.positions);
  if (options.mask == MaskSource::grid) {
    of_pair += of_grid_edges;
    counters.ops += grid_edge_costs(*options.grid).narrow * work.edges.narrow;
    counters.ops += grid_edge_costs(*options.grid).wide * work.edges.wide;
  }
  counters.items_in += work.pairs;
  counters.items_out += work.fragments;
  counters.ops += of_pair * work.computed;
  counters.ops.add += work.partial;  // the comparison with an area of 0
  counters.ops += of_plane * (options.clipped_depth ? work.pairs : work.fragments);
  counters.ops += of_centroid * work.centroid_depths;
  if (options.mask == MaskSource::table) counters.ops += of_table_edges * work.triangles;
  if (options.mask == MaskSource::exact) counters.ops += of_exact_edges * work.triangles;
  counters.ops += of_nearest * (work.given * options.positions.size() * kMaxMaskSamples);
  counters.ops += {.mul_add = work.specks, .add = work.speck_comparisons, .bit = work.given};
  std::uint64_t positions = 0;
  if (options.mask == MaskSource::table) positions = kMaxMaskSamples;
  if (options.mask == MaskSource::exact) positions = options.positions.size() * kMaxMaskSamples;
  counters.position_tests += 3 * positions * work.computed;
  if (options.mask == MaskSource::grid)
    counters.position_tests +=
        static_cast<std::uint64_t>(options.grid->count()) * (work.edges.narrow + work.edges.wide);
  const std::uint32_t pair_bytes = options.clipped_depth ? kPairBytes : kPairWithDepthBytes;
  counters.bytes_read += work.pairs * (pair_bytes + sizeof(SetupTriangle));
  const std::uint64_t whole = options.whole_fragment_bytes > 0 ? work.whole : 0;
  counters.bytes_written += (work.fragments - whole) * options.fragment_bytes + whole * options.whole_fragment_bytes;
  counters.lanes_used += work.fragments;
  counters.lanes_issued += work.pairs;
}

}  // namespace beampipe
