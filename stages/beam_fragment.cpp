#include "stages/beam_fragment.h"

#include <bit>
#include <cmath>

#include "simd/coverage.h"
#include "simd/sample_test.h"
#include "stages/counting.h"
#include "stages/fragment_geometry.h"
#include "stages/raster_cost.h"

namespace beampipe {
namespace {

CoverageInput<float> coverage_input(const SetupTriangle& triangle, const Edge (&edges)[3], std::int32_t x,
                                    std::int32_t y) {
  CoverageInput<float> in;
  std::int64_t vertex_x[3], vertex_y[3];
  EdgeAt<std::int64_t> at[3];
  for (int k = 0; k < 3; ++k) {
    vertex_x[k] = triangle.x[k], vertex_y[k] = triangle.y[k];
    at[k] = {edges[k].a, edges[k].b, edges[k].c};
    in.vertex_z[k] = triangle.vertex_z[k];
  }
  set_geometry<std::int64_t, float>(vertex_x, vertex_y, at, std::int64_t{x} * kSubpixelUnits,
                                    std::int64_t{y} * kSubpixelUnits, in);
  const DepthPlane<float> plane = pixel_plane(triangle, x, y);
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

// Of those that are not `taken`.
// One position on the way to the nearest: that of the least distance, if it is free.
template <class Float, class Index>
void keep_nearest(Float x, Float y, Float u, Float v, bool is_free, Index index, Float& least, Index& nearest) {
  const Float du = x - u, dv = y - v;
  const Float distance = du * du + dv * dv;
  const bool nearer = (distance < least) & is_free;
  least = select(nearer, distance, least);
  nearest = select(nearer, index, nearest);
}

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

// Of a (pixel, triangle): geometry, depth at the centre, coverage.
OperationCounts coverage_cost() {
  return count_operations([](OperationCounts& counts) {
    CoverageInput<CountedFloat> in;
    const CountedFloat one(1.0f, counts);
    const Counted<double> plane(1.0, counts);
    const CountedInt zero(0, counts), vertices[3] = {zero, zero, zero};
    const EdgeAt<CountedInt> edges[3] = {counted_edge(counts), counted_edge(counts), counted_edge(counts)};
    set_geometry(vertices, vertices, edges, zero, zero, in);
    in.z = to_float(plane_at(plane, plane, plane, plane, plane, plane, plane));
    in.dzdu = in.dzdv = in.vertex_z[0] = in.vertex_z[1] = in.vertex_z[2] = one;
    coverage_scalar(in);
  });
}

OperationCounts table_mask_cost(const MaskTable& table) {
  return count_operations([&](OperationCounts& counts) {
    const CountedInt zero(0, counts);
    TableTriangleOf<Counted<std::int32_t>, Counted<std::uint32_t>, CountedFloat> triangle;
    for (auto& edge : triangle.edges) {
      edge.angle = Counted<std::int32_t>(0, counts);
      edge.flip = Counted<std::uint32_t>(0u, counts);
      edge.distance = edge_distance(counted_edge(counts), zero, zero, Counted<double>(1.0, counts));
    }
    table_mask_scalar(triangle, table);
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
  return count_operations([&](OperationCounts& counts) {
    const CountedInt zero(0, counts), slopes[3] = {zero, zero, zero};
    CountedInt corner[3];
    for (CountedInt& value : corner) value = owned_edge(counted_edge(counts), zero, zero, zero);
    for (const SamplePattern& pattern : positions) sample_mask_scalar(slopes, slopes, corner, pattern);
  });
}

}  // namespace

void beam_fragment(const SetupTriangles& triangles, const std::vector<PixelTriangle>& in, const Tile& tile,
                   const BeamFragmentOptions& options, StageCounters& counters, std::vector<Fragment>& out) {
  const bool use_table = options.mask == MaskSource::table, use_tests = options.mask == MaskSource::exact;
  std::vector<CoverageInput<float>> inputs(in.size());
  std::vector<TableTriangle> lookups(use_table ? in.size() : 0);
  std::vector<CellEdges> cells(use_tests ? in.size() : 0);
  Edge edges[3] = {};
  EdgeDirection directions[3] = {};
  for (std::size_t i = 0; i < in.size(); ++i) {
    const SetupTriangle& triangle = triangles.triangles[in[i].triangle];
    if (i == 0 || in[i].triangle != in[i - 1].triangle) {
      for (int k = 0; k < 3; ++k) {
        edges[k] = edge_of(triangle, k);
        if (use_table) directions[k] = edge_direction(edges[k]);
      }
    }
    inputs[i] = coverage_input(triangle, edges, in[i].x, in[i].y);
    if (use_table) {
      lookups[i] = table_edges(edges, directions, in[i].x, in[i].y);
    } else if (use_tests) {
      cells[i] = exact_edges(edges, in[i].x, in[i].y);
    }
  }
  std::vector<Coverage<float>> covered(in.size());
  std::vector<WideMask> masks(in.size());
  std::vector<std::uint32_t> words(in.size());
  coverage(inputs.data(), in.size(), covered.data());
  for (std::size_t word = 0; word < options.positions.size(); ++word) {
    if (use_table) {
      table_masks(lookups.data(), in.size(), *options.table, words.data());
    } else {
      sample_masks(cells.data(), in.size(), options.positions[word], words.data());
    }
    for (std::size_t i = 0; i < in.size(); ++i) masks[i].words[word] = in[i].full ? ~0u : words[i];
  }

  const std::size_t before = out.size();
  std::uint64_t located = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Coverage<float>& c = covered[i];
    if (!in[i].full && c.alpha <= kZeroArea) continue;
    Fragment fragment{};
    fragment.triangle = in[i].triangle;
    fragment.quad = in[i].quad;
    fragment.pixel = static_cast<std::uint32_t>((in[i].y - tile.y0) * tile.width() + in[i].x - tile.x0);
    fragment.front = triangles.triangles[in[i].triangle].front;
    fragment.centroid_u = in[i].full ? 0.5f : c.centroid_u;
    fragment.centroid_v = in[i].full ? 0.5f : c.centroid_v;
    fragment.alpha = in[i].full ? 1.0f : c.alpha;
    fragment.mask = masks[i];
    fragment.plane = {inputs[i].z, inputs[i].dzdu, inputs[i].dzdv};
    fragment.z_min = c.z_min, fragment.z_max = c.z_max;
    fragment.centroid_z = depth_at(fragment.plane, fragment.centroid_u - 0.5f, fragment.centroid_v - 0.5f);
    fragment.centroid_z = lesser(greater(fragment.centroid_z, c.z_min), c.z_max);
    fragment.tiny = options.mask != MaskSource::none && fragment.mask.none();
    if (fragment.tiny) {
      const auto positions = static_cast<float>(options.positions.size() * kMaxMaskSamples);
      for (int k = 0; k < options.tiny_positions && static_cast<float>(k) < fragment.alpha * positions; ++k) {
        fragment.mask.set(nearest_position(options.positions, fragment.centroid_u, fragment.centroid_v, fragment.mask));
        ++located;
      }
    }
    out.push_back(fragment);
  }

  counters.items_in += in.size();
  counters.items_out += out.size() - before;
  counters.ops += coverage_cost() * in.size();
  if (use_table) counters.ops += table_mask_cost(*options.table) * in.size();
  if (use_tests) counters.ops += exact_mask_cost(options.positions) * in.size();
  counters.ops += nearest_cost() * (located * options.positions.size() * kMaxMaskSamples);
  counters.bytes_read += in.size() * kPixelTriangleBytes;
  counters.bytes_written += (out.size() - before) * options.fragment_bytes;
  counters.lanes_used += out.size() - before;
  counters.lanes_issued += in.size();
}

}  // namespace beampipe
