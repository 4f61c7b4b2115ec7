#include "stages/beam_fragment.h"

#include <bit>
#include <cmath>

#include "simd/coverage.h"
#include "simd/sample_test.h"
#include "stages/counting.h"
#include "stages/raster_cost.h"

namespace beampipe {
namespace {

constexpr float kUnit = 1.0f / kSubpixelUnits;  // px

CoverageInput<float> coverage_input(const SetupTriangle& triangle, const Edge (&edges)[3], std::int32_t x,
                                    std::int32_t y) {
  const std::int32_t left = x * kSubpixelUnits, top = y * kSubpixelUnits;
  CoverageInput<float> in;
  for (int k = 0; k < 3; ++k) {
    in.u[k] = static_cast<float>(triangle.x[k] - left) * kUnit;
    in.v[k] = static_cast<float>(triangle.y[k] - top) * kUnit;
    in.a[k] = static_cast<float>(edges[k].a) * kUnit;
    in.b[k] = static_cast<float>(edges[k].b) * kUnit;
    for (int corner = 0; corner < 4; ++corner) {
      const std::int32_t right = (corner & 1) * kSubpixelUnits, down = (corner >> 1) * kSubpixelUnits;
      in.corner[k][corner] = static_cast<float>(edges[k].at(left + right, top + down)) * (kUnit * kUnit);
    }
    in.vertex_z[k] = triangle.vertex_z[k];
  }
  const DepthPlane<float> plane = pixel_plane(triangle, x, y);
  in.z = plane.z, in.dzdu = plane.dzdu, in.dzdv = plane.dzdv;
  return in;
}

CellEdges exact_edges(const Edge (&edges)[3], std::int32_t x, std::int32_t y) {
  CellEdges cell;
  for (int k = 0; k < 3; ++k) {
    cell.a[k] = edges[k].a, cell.b[k] = edges[k].b;
    cell.c[k] =
        edges[k].at(std::int64_t{x} * kSubpixelUnits, std::int64_t{y} * kSubpixelUnits) - (edges[k].owns ? 0 : 1);
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
    const auto distance = static_cast<double>(edges[k].at(center_x, center_y)) * directions[k].per_unit;
    triangle.edges[k] = {directions[k].angle, directions[k].flip ? ~0u : 0u, static_cast<float>(distance)};
  }
  return triangle;
}

// Of those that are not `taken`.
std::size_t nearest_position(const std::vector<SamplePattern>& positions, float u, float v, const WideMask& taken) {
  std::size_t nearest = 0;
  float least = 4.0f;  // more than the pixel's diagonal, squared
  for (std::size_t i = 0; i < positions.size() * kMaxMaskSamples; ++i) {
    const SamplePattern& pattern = positions[i / kMaxMaskSamples];
    const std::size_t s = i % kMaxMaskSamples;
    const float du = static_cast<float>(pattern.x[s]) * kUnit - u, dv = static_cast<float>(pattern.y[s]) * kUnit - v;
    const float distance = du * du + dv * dv;
    if (distance < least && !taken.test(i)) {
      least = distance;
      nearest = i;
    }
  }
  return nearest;
}

OperationCounts coverage_cost() {
  return count_operations([](OperationCounts& counts) {
    CoverageInput<Counted<float>> in;
    const Counted<float> one(1.0f, counts);
    for (int k = 0; k < 3; ++k) {
      in.u[k] = in.v[k] = in.a[k] = in.b[k] = in.vertex_z[k] = one;
      for (Counted<float>& corner : in.corner[k]) corner = one;
    }
    in.z = in.dzdu = in.dzdv = one;
    coverage_scalar(in);
  });
}

// Per edge: distance scaled and clamped (a multiply-add, a multiply, two comparisons), converted, fetched, two selects
// for beyond the table, and the AND.
constexpr OperationCounts kTableMaskCost{6, 18, 3, 3, 0, 3};
constexpr OperationCounts kNearestCost{2, 4, 0, 0, 0, 0};  // per position: a squared distance and its comparison

OperationCounts exact_mask_cost(const SamplePattern& pattern) {  // per pattern
  return count_operations([&](OperationCounts& counts) {
    using Int = Counted<std::int64_t>;
    const Int zero(0, counts), edges[3] = {zero, zero, zero};
    sample_mask_scalar(edges, edges, edges, pattern);
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
  for (const SamplePattern& pattern : options.positions)
    counters.ops += (use_table ? kTableMaskCost : exact_mask_cost(pattern)) * in.size();
  counters.ops += kNearestCost * (located * options.positions.size() * kMaxMaskSamples);
  counters.bytes_read += in.size() * kPixelTriangleBytes;
  counters.bytes_written += (out.size() - before) * options.fragment_bytes;
  counters.lanes_used += out.size() - before;
  counters.lanes_issued += in.size();
}

}  // namespace beampipe
