#include "stages/beam/beam_fragment.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "simd/coverage.h"
#include "simd/depth_range.h"
#include "simd/sample_mask.h"
#include "stages/beam/beam_fragment_cost.h"
#include "stages/beam/specks.h"
#include "stages/data/fragment_geometry.h"

namespace beampipe {
namespace {

TriangleInPixel seen_from(const SetupTriangle& triangle, const Pair& pair) {
  return in_pixel(triangle.x, triangle.y, pair.x * kSubpixelUnits, pair.y * kSubpixelUnits);
}

DepthRangeInput<float> depth_range_input(const SetupTriangle& triangle, const TriangleInPixel& narrow,
                                         const DepthPlane<float>& plane) {
  DepthRangeInput<float> in;
  TriangleInPixelOf<std::int64_t> wide;
  for (int k = 0; k < 3; ++k) {
    wide.x[k] = narrow.x[k], wide.y[k] = narrow.y[k];
    in.vertex_z[k] = triangle.vertex_z[k];
  }
  set_geometry(wide, in);
  in.z = plane.z, in.dzdu = plane.dzdu, in.dzdv = plane.dzdv;
  return in;
}

// `x`, `y`: the pixel.
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
  double per_unit;  // 1 px / length of the normal; negative if flipped, so that distances are those of the edge itself
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

bool is_computed(const Pair& pair, const BeamFragmentOptions& options) { return !pair.full || options.clipped_depth; }

// The edges of one triangle after the other, prepared for masks.
class PreparedEdges {
 public:
  explicit PreparedEdges(MaskSource mask) : mask_(mask) {}

  bool is_needed() const { return mask_ == MaskSource::table || mask_ == MaskSource::exact; }

  void prepare(const SetupTriangle& triangle) {
    if (last_ == &triangle) return;
    for (int k = 0; k < 3; ++k) {
      edges_[k] = edge_of(triangle, k);
      if (mask_ == MaskSource::table) directions_[k] = edge_direction(edges_[k]);
    }
    last_ = &triangle;
    ++prepared_;
  }

  TableTriangle lookup(const Pair& pair) const { return table_edges(edges_, directions_, pair.x, pair.y); }
  CellEdges cell(const Pair& pair) const { return exact_edges(edges_, pair.x, pair.y); }
  std::uint64_t prepared() const { return prepared_; }

 private:
  MaskSource mask_;
  const SetupTriangle* last_ = nullptr;
  Edge edges_[3] = {};
  EdgeDirection directions_[3] = {};
  std::uint64_t prepared_ = 0;
};

// As many pairs go through the kernels together.
constexpr std::size_t kBatch = 64;

// What the kernels read: one item per computed pair, in the order of the pairs.
struct KernelInput {
  std::size_t count = 0;
  TriangleInPixel triangles[kBatch];
  DepthRangeInput<float> ranges[kBatch];  // with clipped_depth
  TableTriangle lookups[kBatch];          // for MaskSource::table
  CellEdges cells[kBatch];                // for MaskSource::exact
};

void set_input(const SetupTriangles& triangles, std::span<const Pair> in, const BeamFragmentOptions& options,
               PreparedEdges& edges, KernelInput& kernels) {
  std::size_t count = 0;
  for (const Pair& pair : in) {
    if (!is_computed(pair, options)) continue;
    const SetupTriangle& triangle = triangles.triangles[pair.triangle];
    const std::size_t i = count++;
    kernels.triangles[i] = seen_from(triangle, pair);
    if (options.clipped_depth)
      kernels.ranges[i] = depth_range_input(triangle, kernels.triangles[i], pixel_plane(triangle, pair.x, pair.y));
    if (!edges.is_needed()) continue;
    edges.prepare(triangle);
    if (options.mask == MaskSource::table) {
      kernels.lookups[i] = edges.lookup(pair);
    } else {
      kernels.cells[i] = edges.cell(pair);
    }
  }
  kernels.count = count;
}

// What the kernels compute, in the same order.
struct KernelOutput {
  Coverage<float> coverage[kBatch];
  DepthRange<float> depth[kBatch];  // with clipped_depth
  WideMask masks[kBatch];
};

EdgesTested run_kernels(const KernelInput& in, const BeamFragmentOptions& options, KernelOutput& out) {
  coverage(in.triangles, in.count, out.coverage);
  if (options.clipped_depth) depth_range(in.ranges, in.count, out.depth);
  if (options.mask == MaskSource::grid) return position_masks(in.triangles, in.count, *options.grid, out.masks);
  std::uint32_t words[kBatch] = {};
  for (std::size_t word = 0; word < options.positions.size(); ++word) {
    if (options.mask == MaskSource::table) table_masks(in.lookups, in.count, *options.table, words);
    if (options.mask == MaskSource::exact) sample_masks(in.cells, in.count, options.positions[word], words);
    for (std::size_t i = 0; i < in.count; ++i) out.masks[i].words[word] = words[i];
  }
  return {};
}

WideMask whole_mask(const BeamFragmentOptions& options) {
  WideMask mask;
  const std::size_t words =
      options.grid ? static_cast<std::size_t>(options.grid->count() / kMaxMaskSamples) : options.positions.size();
  std::fill_n(mask.words.begin(), words, ~0u);
  return mask;
}

// Sets what the kernels do not compute.
void start_fragment(const Pair& pair, const SetupTriangle& triangle, const Tile& tile, Fragment& fragment) {
  fragment.triangle = pair.triangle;
  fragment.quad = pair.quad;
  fragment.pixel = static_cast<std::uint32_t>(tile.index(pair.x, pair.y));
  fragment.front = triangle.front;
  fragment.plane = pixel_plane(triangle, pair.x, pair.y);
  fragment.z_min = pair.nearest, fragment.z_max = pair.farthest;
  fragment.centroid_z = 0;
  fragment.color = glm::vec3(0.0f);
}

float depth_at_centroid(const Fragment& fragment) {
  const float z = depth_at(fragment.plane, fragment.centroid_u - 0.5f, fragment.centroid_v - 0.5f);
  return lesser(greater(z, fragment.z_min), fragment.z_max);
}

// Gives a speck the positions that are nearest to its centroid.
void locate(const BeamFragmentOptions& options, Fragment& speck, BeamFragmentWork& work) {
  if (options.tiny_positions == 0) return;
  const float filled = speck.alpha * static_cast<float>(options.positions.size() * kMaxMaskSamples);
  ++work.specks;
  for (int k = 0; k < options.tiny_positions; ++k) {
    ++work.speck_comparisons;
    if (static_cast<float>(k) >= filled) return;
    speck.mask.set(nearest_position(options.positions, speck.centroid_u, speck.centroid_v, speck.mask));
    ++work.given;
  }
}

}  // namespace

void beam_fragment(const SetupTriangles& triangles, const std::vector<Pair>& in, const Tile& tile,
                   const BeamFragmentOptions& options, StageCounters& counters, std::vector<Fragment>& out) {
  const WideMask whole = whole_mask(options);
  const std::size_t before = out.size();
  PreparedEdges edges(options.mask);
  BeamFragmentWork work;
  KernelInput kernels;
  KernelOutput computed;
  out.reserve(before + in.size());
  for (std::size_t first = 0; first < in.size(); first += kBatch) {
    const std::span batch = std::span(in).subspan(first, std::min(kBatch, in.size() - first));
    set_input(triangles, batch, options, edges, kernels);
    work.edges += run_kernels(kernels, options, computed);
    work.computed += kernels.count;
    std::size_t next = 0;
    for (const Pair& pair : batch) {
      const std::size_t i = next;
      next += is_computed(pair, options);
      work.partial += !pair.full;
      if (!pair.full && computed.coverage[i].alpha <= kZeroArea) continue;
      Fragment& fragment = out.emplace_back();  // filled in place: copying it would wait for all of its parts
      start_fragment(pair, triangles.triangles[pair.triangle], tile, fragment);
      if (pair.full) {
        fragment.alpha = 1.0f, fragment.centroid_u = fragment.centroid_v = 0.5f;
        fragment.mask = whole;
      } else {
        const Coverage<float>& c = computed.coverage[i];
        fragment.alpha = c.alpha, fragment.centroid_u = c.centroid_u, fragment.centroid_v = c.centroid_v;
        fragment.mask = computed.masks[i];
      }
      if (options.clipped_depth) fragment.z_min = computed.depth[i].z_min, fragment.z_max = computed.depth[i].z_max;
      fragment.tiny = options.mask != MaskSource::none && fragment.mask.none();
      if (options.clipped_depth || fragment.tiny) {
        fragment.centroid_z = depth_at_centroid(fragment);
        ++work.centroid_depths;
      }
      if (fragment.tiny) locate(options, fragment, work);
      fragment.whole = pair.full || (fragment.alpha == 1.0f && fragment.mask == whole);
      work.whole += fragment.whole;
    }
  }
  work.pairs = in.size();
  work.triangles = edges.prepared();
  work.fragments = out.size() - before;
  charge(work, options, counters);
}

}  // namespace beampipe
