// Properties that must hold for every triangle, tried on random ones. BEAMPIPE_THOROUGH=N tries N times as many. A
// failure names the seed of its case.
#include <cstdio>

#include "tests/stages/beam_pixels.h"
#include "tests/stages/sample_pixels.h"
#include "tests/stages/search.h"

namespace beampipe::properties_test {

constexpr Tile kTile{0, 0, 12, 10};

// Random points repeatedly split a triangle around the tile into three. This makes edges at all angles, specks and
// slivers.
SetupTriangles random_partition(Random& random, int splits) {
  using Corners = std::array<ScreenPoint, 3>;
  std::vector<Corners> parts = {{{{-9'000, -9'000}, {20'000, -9'000}, {-9'000, 20'000}}}};
  for (int i = 0; i < splits; ++i) {
    const auto at = static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(parts.size()) - 1));
    const Corners t = parts[at];
    double u = random.real(0, 1), v = random.real(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto mix = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
      return static_cast<std::int32_t>(std::floor(a + u * (b - a) + v * (c - a)));
    };
    ScreenPoint p{mix(t[0].x, t[1].x, t[2].x), mix(t[0].y, t[1].y, t[2].y)};
    if (twice_area(t[0], t[1], p) < 0 || twice_area(t[1], t[2], p) < 0 || twice_area(t[2], t[0], p) < 0) continue;
    parts[at] = {t[0], t[1], p};
    parts.push_back({t[1], t[2], p});
    parts.push_back({t[2], t[0], p});
  }
  SetupTriangles triangles;
  for (const Corners& t : parts) add_triangle(triangles, t[0], t[1], t[2]);
  return triangles;
}

TEST(Properties, EverySampleOfAPartitionOnce) {
  search(2'000'000, 150, [&](Random& random) {
    const SetupTriangles parts = random_partition(random, random.int32(1, 200));
    for (const int samples : {1, 8, 16}) {
      std::vector<std::uint32_t> once(kTile.pixels());
      for (const SampleFragment& fragment : sample_fragments(parts, kTile, {CellGrid{}, standard_pattern(samples)})) {
        std::uint32_t& seen = once[static_cast<std::size_t>(fragment.y * kTile.width() + fragment.x)];
        ASSERT_EQ(seen & fragment.mask, 0u) << "a sample twice";
        seen |= fragment.mask;
      }
      for (const std::uint32_t seen : once) ASSERT_EQ(seen, (1u << samples) - 1) << "a sample never";
    }
  });
}

// Every part rounds its own sum by at most 2^-24, or is dropped below kZeroArea. Shared edges cancel exactly.
TEST(Properties, AreasOfAPartitionAddUp) {
  double worst = 0;
  std::uint64_t all_pairs = 0;
  search(3'000'000, 150, [&](Random& random) {
    const SetupTriangles parts = random_partition(random, random.int32(1, 200));
    std::vector<Pair> pairs;
    StageCounters counters;
    conservative_raster(parts, all_of(parts), kTile, counters, pairs);
    all_pairs += pairs.size();
    std::vector<double> sum(kTile.pixels()), dropped(kTile.pixels()), kept(kTile.pixels());
    for (const Pair& pair : pairs) ++dropped[static_cast<std::size_t>(pair.y * kTile.width() + pair.x)];
    for (const Fragment& fragment : beam_fragments(parts, kTile, MaskSource::exact).list) {
      sum[fragment.pixel] += fragment.alpha;
      ++kept[fragment.pixel], --dropped[fragment.pixel];
    }
    for (std::size_t i = 0; i < sum.size(); ++i) {
      worst = std::max(worst, std::abs(sum[i] - 1));
      ASSERT_NEAR(sum[i], 1, 0x1p-24 * kept[i] + kZeroArea * dropped[i]);
    }
  });
  std::printf("pairs: %llu; largest difference from 1: %.3g\n", static_cast<unsigned long long>(all_pairs), worst);
}

TEST(Properties, MovingByWholePixelsChangesNothing) {
  search(5'000'000, 2'000, [&](Random& random) {
    const SetupTriangles here = random_triangles(random, 1);
    const std::int32_t right = 2 * random.int32(-25, 8'000),
                       down = 2 * random.int32(-25, 8'000);  // tiles start at even pixels
    SetupTriangles there = here;
    SetupTriangle& t = there.triangles[0];
    for (int k = 0; k < 3; ++k) {
      t.x[k] += 256 * right, t.y[k] += 256 * down;
      if (std::abs(t.x[k]) > 1 << 23 || std::abs(t.y[k]) > 1 << 23) return;  // beyond the guard band
    }
    const Tile moved{right, down, right + kTile.x1, down + kTile.y1};
    for (const MaskSource source : {MaskSource::table, MaskSource::exact}) {
      const auto a = beam_fragments(here, kTile, source).list, b = beam_fragments(there, moved, source).list;
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].pixel, b[i].pixel);
        ASSERT_EQ(a[i].alpha, b[i].alpha);
        ASSERT_EQ(a[i].mask, b[i].mask);
        ASSERT_EQ(a[i].centroid_u, b[i].centroid_u);
        ASSERT_EQ(a[i].centroid_v, b[i].centroid_v);
      }
    }
  });
}

}  // namespace beampipe::properties_test
