// The scalar twin of beam_fragment: one pair after the other, as the paper describes a fragment.
#include <numbers>

#include "simd/coverage.h"
#include "simd/depth_range.h"
#include "simd/mask_table.h"
#include "simd/position_mask.h"
#include "simd/sample_mask.h"
#include "stages/data/fragment_geometry.h"
#include "tests/stages/beam_pixels.h"
#include "tests/stages/scene_twins.h"

namespace beampipe::fragment_twins_test {

using namespace twins;

class FragmentTwins : public SceneTwins {
 protected:
  void expect_equal(const BeamFragmentOptions& options) {
    StageCounters counters;
    const std::vector<Pair> pairs = pairs_of(triangles_, tile_);
    std::vector<Fragment> fragments;
    beam_fragment(triangles_, pairs, tile_, options, counters, fragments);
    twin_ = {}, directed_ = kNoTriangle;
    std::size_t next = 0;
    for (const Pair& pair : pairs) {
      const std::optional<Fragment> twin = fragment(pair, options);
      if (!twin) continue;
      ASSERT_LT(next, fragments.size());
      const Fragment& found = fragments[next++];
      ASSERT_EQ(found.triangle, pair.triangle);
      ASSERT_EQ(found.alpha, twin->alpha);
      ASSERT_EQ(found.mask, twin->mask);
      ASSERT_EQ(found.tiny, twin->tiny);
      ASSERT_EQ(found.centroid_u, twin->centroid_u);
      ASSERT_EQ(found.centroid_v, twin->centroid_v);
      ASSERT_EQ(found.centroid_z, twin->centroid_z);
      ASSERT_EQ(found.plane.z, twin->plane.z);
      ASSERT_EQ(found.plane.dzdu, twin->plane.dzdu);
      ASSERT_EQ(found.plane.dzdv, twin->plane.dzdv);
      ASSERT_EQ(found.z_min, twin->z_min);
      ASSERT_EQ(found.z_max, twin->z_max);
    }
    EXPECT_EQ(next, fragments.size());
    EXPECT_EQ(counters.ops, twin_);
    EXPECT_EQ(counters.lanes_used, fragments.size());
    EXPECT_EQ(counters.lanes_issued, pairs.size());
  }

 private:
  static constexpr std::uint32_t kNoTriangle = ~0u;

  std::optional<Fragment> fragment(const Pair& pair, const BeamFragmentOptions& options) {
    const SetupTriangle& triangle = triangles_.triangles[pair.triangle];
    Fragment out;
    DepthPlane<Float> plane;
    Coverage<Float> covered{real(1.0f), real(0.5f), real(0.5f)};
    WideMask mask;
    DepthRange<Float> range{real(pair.nearest), real(pair.farthest)};
    if (!pair.full || options.clipped_depth) {
      const TriangleInPixelOf<Int> seen = seen_from(triangle, pair);
      const Coverage<Float> area = coverage_formula<Int, Float>(seen);
      if (!pair.full) covered = area;
      mask = masks(pair, seen, options);
      if (options.clipped_depth) {
        plane = pixel_plane_of(triangle, pair);
        range = clipped_range(triangle, seen, plane);
      }
    }
    if (!pair.full && covered.alpha <= Float(5e-7f)) return {};  // a rounding error of 0
    if (pair.full) std::fill_n(mask.words.begin(), words(options), ~0u);
    if (!options.clipped_depth) plane = pixel_plane_of(triangle, pair);
    out.alpha = covered.alpha.value;
    out.centroid_u = covered.centroid_u.value, out.centroid_v = covered.centroid_v.value;
    out.plane = {plane.z.value, plane.dzdu.value, plane.dzdv.value};
    out.z_min = range.z_min.value, out.z_max = range.z_max.value;
    out.tiny = words(options) > 0 && mask.none();
    out.centroid_z = 0;
    if (options.clipped_depth || out.tiny) {
      const Float half(0.5f), u = covered.centroid_u - half, v = covered.centroid_v - half;
      out.centroid_z = lesser(greater(plane.z + plane.dzdu * u + plane.dzdv * v, range.z_min), range.z_max).value;
    }
    if (out.tiny && options.tiny_positions > 0) mask = located(covered, options);
    out.mask = mask;
    return out;
  }

  static std::size_t words(const BeamFragmentOptions& options) {
    return options.grid ? static_cast<std::size_t>(options.grid->count()) / 32 : options.positions.size();
  }

  TriangleInPixelOf<Int> seen_from(const SetupTriangle& triangle, const Pair& pair) {
    TriangleInPixelOf<Int> seen;
    for (int k = 0; k < 3; ++k) {
      seen.x[k] = integer(triangle.x[k]) - integer(256 * pair.x);
      seen.y[k] = integer(triangle.y[k]) - integer(256 * pair.y);
    }
    return seen;
  }

  DepthPlane<Float> pixel_plane_of(const SetupTriangle& triangle, const Pair& pair) {
    const ScreenDepth& depth = triangle.depth;
    const Real dzdx = real(depth.dzdx), dzdy = real(depth.dzdy);
    const Real dx = real(pair.x + 0.5) - real(depth.anchor_x), dy = real(pair.y + 0.5) - real(depth.anchor_y);
    return {to_float(real(depth.z) + dzdx * dx + dzdy * dy), to_float(dzdx), to_float(dzdy)};
  }

  DepthRange<Float> clipped_range(const SetupTriangle& triangle, const TriangleInPixelOf<Int>& seen,
                                  const DepthPlane<Float>& plane) {
    DepthRangeInput<Float> in;
    set_geometry(seen, in);
    in.z = plane.z, in.dzdu = plane.dzdu, in.dzdv = plane.dzdv;
    for (int k = 0; k < 3; ++k) in.vertex_z[k] = real(triangle.vertex_z[k]);
    return depth_range_formula(in);
  }

  WideMask masks(const Pair& pair, const TriangleInPixelOf<Int>& seen, const BeamFragmentOptions& options) {
    WideMask mask;
    if (options.mask == MaskSource::none) return mask;
    if (options.grid) return position_mask_scalar(seen, *options.grid);
    const SetupTriangle& triangle = triangles_.triangles[pair.triangle];
    if (directed_ != pair.triangle) direct(triangle, options.table != nullptr);
    directed_ = pair.triangle;
    if (options.table) {
      TableTriangleOf<Counted<std::int32_t>, Bits, Float> lookup;
      for (int k = 0; k < 3; ++k) {
        const Direction& direction = directions_[static_cast<std::size_t>(k)];
        const Int center_x(256 * pair.x + 128), center_y(256 * pair.y + 128);
        lookup.edges[k] = {
            direction.angle, bits(direction.flip ? ~0u : 0u),
            to_float(to_double(edges_[static_cast<std::size_t>(k)].at(center_x, center_y)) * direction.per_unit)};
      }
      mask.words[0] = table_mask_formula(lookup, *options.table).value;
      return mask;
    }
    Int a[3], b[3], c[3];
    for (int k = 0; k < 3; ++k) {
      const EdgeAt<Int>& e = edges_[static_cast<std::size_t>(k)];
      a[k] = e.a, b[k] = e.b;
      c[k] = e.at(Int(256 * pair.x), Int(256 * pair.y)) - Int(edge_of(triangle, k).owns ? 0 : 1);
    }
    for (std::size_t w = 0; w < options.positions.size(); ++w)
      mask.words[w] = sample_mask_scalar(a, b, c, options.positions[w]);
    return mask;
  }

  // The edges of a triangle. For exact masks: whether they own the samples on them. For the table: their directions, in
  // 32 steps per half turn, and the factor that turns their values into distances.
  void direct(const SetupTriangle& triangle, bool for_table) {
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const Int x = integer(triangle.x[k]), y = integer(triangle.y[k]), origin(0);
      EdgeAt<Int>& e = edges_[static_cast<std::size_t>(k)];
      e.a = y - integer(triangle.y[next]), e.b = integer(triangle.x[next]) - x;
      e.c = origin - (e.a * x + e.b * y);
      if (!for_table) {
        const bool left = e.a > origin, level = e.a == origin, top = e.b > origin;
        ASSERT_EQ(left || (level && top), edge_of(triangle, k).owns);
        continue;
      }
      const Real zero(0.0), a = to_double(e.a), b = to_double(e.b);
      const bool below = b < zero, level = b == zero, leftwards = a < zero;
      Direction& direction = directions_[static_cast<std::size_t>(k)];
      direction.flip = below || (level && leftwards);
      const Real up = select(direction.flip, zero - b, b), right = select(direction.flip, zero - a, a);
      ++twin_.special;  // the arc tangent
      const Real theta = real(std::atan2(up.value, right.value)) * Real(32 / std::numbers::pi) + Real(0.5);
      direction.angle = Counted<std::int32_t>(static_cast<std::int32_t>(converted(theta).value), twin_);
      const bool turns = !(direction.angle < Counted<std::int32_t>(32));  // half a turn: the reverse of 0
      direction.angle = select(turns, Counted<std::int32_t>(0), direction.angle);
      direction.flip = direction.flip != turns;
      direction.per_unit = select(direction.flip, real(-1.0), real(1.0)) / (square_root(a * a + b * b) * Real(256.0));
    }
  }

  // The paper gives a speck the nearest position; the slides give it the nearest ones, as many as its area fills.
  WideMask located(const Coverage<Float>& covered, const BeamFragmentOptions& options) {
    WideMask mask;
    const Float filled = covered.alpha * Float(static_cast<float>(32 * options.positions.size()));
    for (int k = 0; k < options.tiny_positions; ++k) {
      if (real(static_cast<float>(k)) >= filled) break;
      Float least = real(4.0f);
      Bits nearest = bits(0);
      for (std::uint32_t i = 0; i < 32 * options.positions.size(); ++i) {
        const SamplePattern& pattern = options.positions[i / 32];
        const Float du = Float(static_cast<float>(pattern.x[i % 32]) / 256) - covered.centroid_u;
        const Float dv = Float(static_cast<float>(pattern.y[i % 32]) / 256) - covered.centroid_v;
        const Float distance = du * du + dv * dv;
        const bool nearer = distance < least, taken = (bits(mask.words[i / 32]) & Bits(1u << i % 32)).value != 0;
        least = select(nearer && !taken, distance, least);
        nearest = select(nearer && !taken, bits(i), nearest);
      }
      mask.words[nearest.value / 32] = (bits(mask.words[nearest.value / 32]) | Bits(1u << nearest.value % 32)).value;
    }
    return mask;
  }

  struct Direction {
    Counted<std::int32_t> angle;
    bool flip = false;
    Real per_unit;
  };
  std::array<EdgeAt<Int>, 3> edges_;
  std::array<Direction, 3> directions_;
  std::uint32_t directed_ = kNoTriangle;  // the triangle that they belong to
};

TEST_P(FragmentTwins, OnAGrid) {  // full pixels are not computed
  const PositionGrid grid(256);
  expect_equal(grid_options(grid, 0));
}

TEST_P(FragmentTwins, WithTheTable) {
  const SamplePattern pattern = hammersley_pattern();
  const MaskTable table(pattern);
  for (const int positions : {1, 3}) {
    BeamFragmentOptions options;
    options.positions = {pattern};
    options.table = &table;
    options.tiny_positions = positions;
    expect_equal(options);
  }
}

TEST_P(FragmentTwins, WithExactMasks) {
  BeamFragmentOptions options;
  options.mask = MaskSource::exact;
  options.positions = cell_patterns(256);
  expect_equal(options);
}

TEST_P(FragmentTwins, WithoutMasks) {
  BeamFragmentOptions options;
  options.mask = MaskSource::none;
  expect_equal(options);
}

BEAMPIPE_ON_EVERY_SCENE(FragmentTwins);

// An edge at 256 positions. Steps: 8 positions of 4 rows of 8 cells. Its slopes times the cell's size, and its value at
// the 8 positions of the last cell; one step to each other cell of a row, and from row to row; one shift for each
// position; and an inversion and an intersection for each word.
TEST(BeamFragmentCost, OfAnEdgeAtAllPositions) {
  const OperationCounts cost = count_operations([](OperationCounts& counts) {
    const Counted<std::int32_t> one(1, counts);
    Counted<std::uint32_t> words[kMaxMaskWords];
    cut_mask(EdgeInPixel<Counted<std::int32_t>>{one, one, one}, PositionGrid(256), words);
  });
  EXPECT_EQ(cost.mul_add, 2 + 8 * 2);
  EXPECT_EQ(cost.add, 8 * 2 + 8 * (4 * 7 + 3));
  EXPECT_EQ(cost.bit, 256 + 8 * 2);
  EXPECT_EQ(cost.total(), 18u + 264u + 272u);
  EXPECT_EQ(cost.wide, 0u);
}

}  // namespace beampipe::fragment_twins_test
