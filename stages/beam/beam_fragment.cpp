#include "stages/beam/beam_fragment.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "simd/coverage.h"
#include "simd/sample_mask.h"
#include "stages/beam/fragment_geometry.h"
#include "stages/cost/counting.h"
#include "stages/cost/plane_cost.h"

namespace beampipe {
namespace {

TriangleInPixel seen_from(const SetupTriangle& triangle, const PixelTriangle& pair) {
  return in_pixel(triangle.x, triangle.y, pair.x * kSubpixelUnits, pair.y * kSubpixelUnits);
}

DepthRangeInput<float> depth_range_input(const SetupTriangle& triangle, const TriangleInPixel& narrow,
                                         const DepthPlane<float>& plane) {
  DepthRangeInput<float> in;
  PixelTriangleOf<std::int64_t> wide;
  for (int k = 0; k < 3; ++k) {
    wide.x[k] = narrow.x[k], wide.y[k] = narrow.y[k];
    in.vertex_z[k] = triangle.vertex_z[k];
  }
  set_geometry(wide, in);
  in.z = plane.z, in.dzdu = plane.dzdu, in.dzdv = plane.dzdv;
  return in;
}

CellEdges exact_edges(const Edge (&edges)[3], std::int32_t x, std::int32_t y) {
  CellEdges cell;
  for (int k = 0; k < 3; ++k) {
    cell.a[k] = edges[k].a, cell.b[k] = edges[k].b;
    cell.c[k] = owned_edge<std::int64_t>({edges[k].a, edges[k].b, edges[k].c}, std::int64_t{x} * kSubpixelUnits,
                                         std::int64_t{y} * kSubpixelUnits, edges[k].owns ? 0 : 1);
  }
  return cell;
}

// The part of a table edge that is the same at every pixel.
struct EdgeDirection {
  std::int32_t angle;
  bool flip;
  double per_unit;  // 1 / length of the normal, signed so that the distance is the unflipped edge's, in pixels
};

EdgeDirection edge_direction(const Edge& edge) {
  EdgeDirection direction;
  direction.angle = table_angle(edge.a, edge.b, direction.flip);
  const double length = std::sqrt(double(edge.a) * edge.a + double(edge.b) * edge.b);
  direction.per_unit = (direction.flip ? -1.0 : 1.0) / (length * kSubpixelUnits);
  return direction;
}

TableTriangle table_edges(const Edge (&edges)[3], const EdgeDirection (&directions)[3], std::int32_t x,
                          std::int32_t y) {
  const std::int64_t center_x = std::int64_t{x} * kSubpixelUnits + kSubpixelUnits / 2;
  const std::int64_t center_y = std::int64_t{y} * kSubpixelUnits + kSubpixelUnits / 2;
  TableTriangle triangle;
  for (int k = 0; k < 3; ++k) {
    const float distance = edge_distance<std::int64_t, double>({edges[k].a, edges[k].b, edges[k].c}, center_x, center_y,
                                                               directions[k].per_unit);
    triangle.edges[k] = {directions[k].angle, directions[k].flip ? ~0u : 0u, distance};
  }
  return triangle;
}

// One position on the way to the nearest: that of the least distance, if it is free.
template <class Float, class Index>
void keep_nearest(Float x, Float y, Float u, Float v, bool is_free, Index index, Float& least, Index& nearest) {
  const Float du = x - u, dv = y - v;
  const Float distance = du * du + dv * dv;
  const bool nearer = (distance < least) & is_free;
  least = select(nearer, distance, least);
  nearest = select(nearer, index, nearest);
}

// Of those that are not `taken`.
std::size_t nearest_position(const std::vector<SamplePattern>& positions, float u, float v, const WideMask& taken) {
  std::uint32_t nearest = 0;
  float least = 4.0f;  // more than the pixel's diagonal, squared
  for (std::uint32_t i = 0; i < positions.size() * kMaxMaskSamples; ++i) {
    const SamplePattern& pattern = positions[i / kMaxMaskSamples];
    const std::size_t s = i % kMaxMaskSamples;
    keep_nearest(static_cast<float>(pattern.x[s]) * kUnit, static_cast<float>(pattern.y[s]) * kUnit, u, v,
                 !taken.test(i), i, least, nearest);
  }
  return nearest;
}

// ---- What the twins cost ----

using CountedInt = Counted<std::int64_t>;
using CountedFloat = Counted<float>;

EdgeAt<CountedInt> counted_edge(OperationCounts& counts) {
  const CountedInt one(1, counts);
  return {one, one, one};
}

PixelTriangleOf<CountedInt> counted_triangle(OperationCounts& counts) {
  const CountedInt zero(0, counts), vertices[3] = {zero, zero, zero};
  return in_pixel(vertices, vertices, zero, zero);
}

PixelTriangleOf<CountedInt> vertices_at_hand(OperationCounts& counts) {
  PixelTriangleOf<CountedInt> triangle;
  for (int k = 0; k < 3; ++k) triangle.x[k] = triangle.y[k] = CountedInt(0, counts);
  return triangle;
}

// Of a (pixel, triangle): geometry and coverage.
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

OperationCounts grid_mask_cost(const PositionGrid& grid) {
  const auto count_for = [](int positions) {
    return count_operations(
        [&](OperationCounts& counts) { position_mask_scalar(vertices_at_hand(counts), PositionGrid(positions)); });
  };
  static const std::array<UnitCost, 4> costs{count_for(32), count_for(64), count_for(128), count_for(256)};
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

// Of a triangle, while its pairs follow each other: its edges, and which of them have the samples on them;
OperationCounts exact_edges_cost() {
  return count_operations([](OperationCounts& counts) {
    for (int k = 0; k < 3; ++k) {
      const EdgeInPixel<CountedInt> edge = edge_in_pixel(vertices_at_hand(counts), k);
      owns_its_samples(edge.a, edge.b);
    }
  });
}

// or its edges, where they stand in the table, and the inverse of their lengths.
OperationCounts table_edges_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> zero(0.0), one(1.0, counts);
    for (int k = 0; k < 3; ++k) {
      const EdgeInPixel<CountedInt> edge = edge_in_pixel(vertices_at_hand(counts), k);
      const Counted<double> a = to_double(edge.a), b = to_double(edge.b);
      const bool flip = (b < zero) | ((b == zero) & (a < zero));
      const Counted<double> theta = select(flip, zero - b, b) / select(flip, zero - a, a);  // an arc tangent
      lesser(converted(theta * one), one);
      select(flip, one, one) / (square_root(a * a + b * b) * one);
    }
  });
}

OperationCounts nearest_cost() {  // per position
  return count_operations([](OperationCounts& counts) {
    const CountedFloat x(0.0f), u(1.0f, counts);  // where positions are is known
    CountedFloat least(4.0f, counts);
    Counted<std::uint32_t> nearest(0u, counts);
    keep_nearest(x, x, u, u, true, nearest, least, nearest);
    counts.bit += 1;  // is it free?
  });
}

OperationCounts exact_mask_cost(const std::vector<SamplePattern>& positions) {
  static const UnitCost per_edges = count_operations([](OperationCounts& counts) {
    const CountedInt zero(0, counts);
    for (int k = 0; k < 3; ++k) owned_edge(counted_edge(counts), zero, zero, zero);
  });
  static const UnitCost per_position = count_operations([](OperationCounts& counts) {
    const CountedInt zero(0, counts), edges[3] = {zero, zero, zero};
    sample_mask_scalar(edges, edges, edges, standard_pattern(1));
  });
  OperationCounts cost = per_edges;
  for (const SamplePattern& pattern : positions) cost += per_position * static_cast<std::uint64_t>(pattern.count);
  return cost;
}

// What the kernels made of the pairs that are not full, in their order.
struct Covered {
  std::vector<Coverage<float>> coverage;
  std::vector<WideMask> masks;
  std::vector<DepthRange<float>> depth;  // when it is that of the clipped triangle
  std::uint64_t triangles = 0;           // whose edges were prepared
};

Covered cover(const SetupTriangles& triangles, const std::vector<PixelTriangle>& in,
              const BeamFragmentOptions& options) {
  std::vector<TriangleInPixel> partial;
  std::vector<DepthRangeInput<float>> ranges;
  std::vector<TableTriangle> lookups;
  std::vector<CellEdges> cells;
  Edge edges[3] = {};
  EdgeDirection directions[3] = {};
  const SetupTriangle* last = nullptr;
  std::uint64_t prepared = 0;
  partial.reserve(in.size());
  for (const PixelTriangle& pair : in) {
    if (pair.full && !options.clipped_depth) continue;
    const SetupTriangle& triangle = triangles.triangles[pair.triangle];
    partial.push_back(seen_from(triangle, pair));
    if (options.clipped_depth)
      ranges.push_back(depth_range_input(triangle, partial.back(), pixel_plane(triangle, pair.x, pair.y)));
    if (options.mask != MaskSource::table && options.mask != MaskSource::exact) continue;
    for (int k = 0; k < 3 && last != &triangle; ++k) {
      edges[k] = edge_of(triangle, k);
      if (options.mask == MaskSource::table) directions[k] = edge_direction(edges[k]);
    }
    prepared += last != &triangle;
    last = &triangle;
    if (options.mask == MaskSource::table) {
      lookups.push_back(table_edges(edges, directions, pair.x, pair.y));
    } else {
      cells.push_back(exact_edges(edges, pair.x, pair.y));
    }
  }
  Covered covered{std::vector<Coverage<float>>(partial.size()), std::vector<WideMask>(partial.size()),
                  std::vector<DepthRange<float>>(ranges.size()), prepared};
  coverage(partial.data(), partial.size(), covered.coverage.data());
  depth_range(ranges.data(), ranges.size(), covered.depth.data());
  if (options.mask == MaskSource::grid)
    position_masks(partial.data(), partial.size(), *options.grid, covered.masks.data());
  std::vector<std::uint32_t> words(partial.size());
  for (std::size_t word = 0; word < options.positions.size(); ++word) {
    if (options.mask == MaskSource::table) table_masks(lookups.data(), lookups.size(), *options.table, words.data());
    if (options.mask == MaskSource::exact)
      sample_masks(cells.data(), cells.size(), options.positions[word], words.data());
    for (std::size_t i = 0; i < words.size(); ++i) covered.masks[i].words[word] = words[i];
  }
  return covered;
}

std::size_t mask_words(const BeamFragmentOptions& options) {
  return options.grid ? static_cast<std::size_t>(options.grid->count() / kMaxMaskSamples) : options.positions.size();
}

// Gives fragments that cover no position the nearest ones.
struct Locator {
  const BeamFragmentOptions& options;
  std::uint64_t fragments = 0, comparisons = 0, given = 0;

  void locate(Fragment& fragment) {
    if (options.tiny_positions == 0) return;
    const float filled = fragment.alpha * static_cast<float>(options.positions.size() * kMaxMaskSamples);
    ++fragments;
    for (int k = 0; k < options.tiny_positions; ++k) {
      ++comparisons;
      if (static_cast<float>(k) >= filled) return;
      fragment.mask.set(nearest_position(options.positions, fragment.centroid_u, fragment.centroid_v, fragment.mask));
      ++given;
    }
  }

  OperationCounts cost() const {
    OperationCounts counts = nearest_cost() * (given * options.positions.size() * kMaxMaskSamples);
    counts.mul_add += fragments, counts.add += comparisons, counts.bit += given;
    return counts;
  }
};

}  // namespace

void beam_fragment(const SetupTriangles& triangles, const std::vector<PixelTriangle>& in, const Tile& tile,
                   const BeamFragmentOptions& options, StageCounters& counters, std::vector<Fragment>& out) {
  const Covered covered = cover(triangles, in, options);
  WideMask whole;
  std::fill_n(whole.words.begin(), mask_words(options), ~0u);
  const std::size_t before = out.size();
  Locator locator{options};
  std::uint64_t partial = 0, centroids = 0;  // pairs that are not full; fragments with a depth at the centroid
  std::size_t next = 0;
  out.reserve(before + in.size());
  for (const PixelTriangle& pair : in) {
    const std::size_t i = next;
    next += !pair.full || options.clipped_depth;
    partial += !pair.full;
    if (!pair.full && covered.coverage[i].alpha <= kZeroArea) continue;
    const SetupTriangle& triangle = triangles.triangles[pair.triangle];
    Fragment fragment;
    fragment.triangle = pair.triangle;
    fragment.quad = pair.quad;
    fragment.color = glm::vec3(0.0f);
    fragment.pixel = static_cast<std::uint32_t>(tile.index(pair.x, pair.y));
    fragment.front = triangle.front;
    fragment.plane = pixel_plane(triangle, pair.x, pair.y);
    if (pair.full) {
      fragment.alpha = 1.0f, fragment.centroid_u = fragment.centroid_v = 0.5f;
      fragment.mask = whole;
    } else {
      const Coverage<float>& c = covered.coverage[i];
      fragment.alpha = c.alpha, fragment.centroid_u = c.centroid_u, fragment.centroid_v = c.centroid_v;
      fragment.mask = covered.masks[i];
    }
    fragment.z_min = options.clipped_depth ? covered.depth[i].z_min : pair.nearest;
    fragment.z_max = options.clipped_depth ? covered.depth[i].z_max : pair.farthest;
    fragment.tiny = options.mask != MaskSource::none && fragment.mask.none();
    fragment.centroid_z = 0;
    if (options.clipped_depth || fragment.tiny) {
      const float z = depth_at(fragment.plane, fragment.centroid_u - 0.5f, fragment.centroid_v - 0.5f);
      fragment.centroid_z = lesser(greater(z, fragment.z_min), fragment.z_max);
      ++centroids;
    }
    if (fragment.tiny) locator.locate(fragment);
    out.push_back(fragment);
  }

  static const UnitCost area_cost = coverage_cost(), range_cost = clipped_depth_cost(), depth_cost = plane_cost(),
                        centroid_cost = centroid_depth_cost(), exact_cost = exact_edges_cost(),
                        table_cost = table_edges_cost();
  const std::size_t made = out.size() - before;
  counters.items_in += in.size();
  counters.items_out += made;
  OperationCounts cost = area_cost;
  if (options.clipped_depth) cost += range_cost;
  if (options.mask == MaskSource::table) cost += table_mask_cost(*options.table);
  if (options.mask == MaskSource::exact) cost += exact_mask_cost(options.positions);
  if (options.mask == MaskSource::grid) cost += grid_mask_cost(*options.grid);
  counters.ops += cost * covered.coverage.size();
  counters.ops.add += partial;  // is there any area?
  counters.ops += depth_cost * (options.clipped_depth ? in.size() : made);
  counters.ops += centroid_cost * centroids;
  if (options.mask == MaskSource::table) counters.ops += table_cost * covered.triangles;
  if (options.mask == MaskSource::exact) counters.ops += exact_cost * covered.triangles;
  counters.ops += locator.cost();
  const std::uint32_t pair_bytes = options.clipped_depth ? kPixelTriangleBytes : kPairWithDepthBytes;
  counters.bytes_read += in.size() * (pair_bytes + sizeof(SetupTriangle));
  counters.bytes_written += made * options.fragment_bytes;
  counters.lanes_used += made;
  counters.lanes_issued += in.size();
}

}  // namespace beampipe
