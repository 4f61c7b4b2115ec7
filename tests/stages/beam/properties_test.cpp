// Properties that must hold for every triangle, tried on random ones. BEAMPIPE_THOROUGH=N tries N times as many. A
// failure names the seed of its case.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "stages/raster/sample_raster.h"
#include "tests/simd/coverage_cases.h"
#include "tests/stages/beam_pixels.h"
#include "tests/stages/search.h"

namespace beampipe {
namespace {

constexpr Tile kTile{0, 0, 12, 10};
constexpr double kAlphaError = 5e-7;  // simd/coverage.h

using Rational = boost::multiprecision::cpp_rational;

// Do the open triangle and the open pixel have a point in common? Decided by clipping, in doubles where these are
// precise enough, otherwise in rational numbers.
template <class Number>
Number clipped_area(const SetupTriangle& t, std::int32_t x, std::int32_t y) {
  using Corners = std::vector<std::pair<Number, Number>>;
  Corners polygon;
  for (int k = 0; k < 3; ++k) polygon.emplace_back(Number(t.x[k] - 256 * x), Number(t.y[k] - 256 * y));
  for (int side = 0; side < 4; ++side) {
    const auto inside_by = [&](const std::pair<Number, Number>& p) -> Number {
      return side == 0 ? p.first : side == 1 ? Number(256 - p.first) : side == 2 ? p.second : Number(256 - p.second);
    };
    Corners kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const auto &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
      const Number d_from = inside_by(from), d_to = inside_by(to);
      if (d_from >= 0) kept.push_back(from);
      if ((d_from >= 0) == (d_to >= 0)) continue;
      const Number s = d_from / (d_from - d_to);
      kept.emplace_back(Number(from.first + s * (to.first - from.first)),
                        Number(from.second + s * (to.second - from.second)));
    }
    polygon = std::move(kept);
  }
  Number twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    twice += p.first * q.second - q.first * p.second;
  }
  return twice / 2;
}

// Does a line along a side of the pixel or of the triangle have the triangle on one side and the pixel on the other?
// Both may touch it. Then they have no area in common. Exact, since coordinates are below 2^24.
bool are_separated(const SetupTriangle& t, std::int32_t x, std::int32_t y) {
  const std::int64_t left = 256 * std::int64_t{x}, top = 256 * std::int64_t{y}, right = left + 256, bottom = top + 256;
  if (std::ranges::max(t.x) <= left || std::ranges::min(t.x) >= right || std::ranges::max(t.y) <= top ||
      std::ranges::min(t.y) >= bottom)
    return true;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const std::int64_t dx = t.x[next] - t.x[k], dy = t.y[next] - t.y[k];
    const auto side_of = [&](std::int64_t px, std::int64_t py) { return dx * (py - t.y[k]) - dy * (px - t.x[k]); };
    const std::int64_t inside = side_of(t.x[(k + 2) % 3], t.y[(k + 2) % 3]) > 0 ? 1 : -1;
    if (inside * side_of(left, top) <= 0 && inside * side_of(right, top) <= 0 && inside * side_of(left, bottom) <= 0 &&
        inside * side_of(right, bottom) <= 0)
      return true;
  }
  return false;
}

bool has_area(const SetupTriangle& t, std::int32_t x, std::int32_t y) {
  if (are_separated(t, x, y)) return false;
  const double area = clipped_area<double>(t, x, y);  // in 1/65536 px, from coordinates below 2^24: error below 0.01
  return area > 1 || clipped_area<Rational>(t, x, y) > 0;
}

// The shortcuts above decide as rational arithmetic does.
TEST(Properties, AreaInCommonIsThatOfRationalNumbers) {
  search(500'000, 150, [&](Random& random) {
    const SetupTriangles triangles = random_triangles(random, 1);
    const SetupTriangle& t = triangles.triangles[0];
    for (std::int32_t y = kTile.y0; y < kTile.y1; ++y)
      for (std::int32_t x = kTile.x0; x < kTile.x1; ++x)
        ASSERT_EQ(has_area(t, x, y), clipped_area<Rational>(t, x, y) > 0) << "pixel " << x << ", " << y;
  });
}

// No pixel that has area in common with the triangle is missed. A pixel that is found without common area touches the
// triangle in a point or along an edge, because both are closed sets.
TEST(Properties, ConservativeRasterMissesNoPixel) {
  std::uint64_t pairs = 0, without_area = 0, on_corner = 0;
  search(1'000'000, 4'000, [&](Random& random) {
    const SetupTriangles triangles = random_triangles(random, 1);
    const SetupTriangle& t = triangles.triangles[0];
    std::vector<Pair> found;
    StageCounters counters;
    conservative_raster(triangles, {0}, kTile, counters, found);
    std::array<bool, 12 * 10> is_found{};  // by pixel of the tile
    for (const Pair& pair : found) is_found[kTile.index(pair.x, pair.y)] = true;
    for (std::int32_t y = kTile.y0; y < kTile.y1; ++y) {
      for (std::int32_t x = kTile.x0; x < kTile.x1; ++x) {
        const bool area = has_area(t, x, y), listed = is_found[kTile.index(x, y)];
        ASSERT_TRUE(listed || !area) << "pixel " << x << ", " << y << " is missed";
        pairs += listed;
        if (!listed || area) continue;
        ++without_area;
        bool vertex_on_border = false;
        for (int k = 0; k < 3; ++k) vertex_on_border |= t.x[k] % 256 == 0 || t.y[k] % 256 == 0;
        on_corner += !vertex_on_border;
      }
    }
  });
  std::printf(
      "pairs %llu, of them without area %llu; no vertex lies on a pixel border, an edge goes through a pixel "
      "corner: %llu\n",
      static_cast<unsigned long long>(pairs), static_cast<unsigned long long>(without_area),
      static_cast<unsigned long long>(on_corner));
  EXPECT_LT(without_area, pairs / 4) << "vertices lie on pixel borders far more often than in scenes";
}

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
      const Sampling sampling{CellGrid{}, standard_pattern(samples)};
      std::vector<SampleFragment> fragments;
      StageCounters counters;
      sample_raster({parts, kTile, sampling}, all_of(parts), counters, fragments);
      std::vector<std::uint32_t> once(kTile.pixels());
      for (const SampleFragment& fragment : fragments) {
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
  search(3'000'000, 150, [&](Random& random) {
    const SetupTriangles parts = random_partition(random, random.int32(1, 200));
    std::vector<Pair> pairs;
    StageCounters counters;
    conservative_raster(parts, all_of(parts), kTile, counters, pairs);
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
  std::printf("largest difference from 1: %.3g\n", worst);
}

// A triangle inside another one has at most the other's area in every pixel, and only mask positions of the other.
// Vertices have odd coordinates in 1/256 px, so that no position lies on a vertex, where the top-left rule could give
// it to the inner triangle alone.
TEST(Properties, AreaAndMaskGrowWithTheTriangle) {
  search(4'000'000, 1'500, [&](Random& random) {
    const auto odd = [&](std::int32_t low, std::int32_t high) { return 2 * random.int32(low / 2, high / 2) + 1; };
    ScreenPoint p[3];
    for (ScreenPoint& point : p) point = {odd(-1500, 4500), odd(-1500, 4000)};
    const std::int32_t times = 2 * random.int32(1, 20) + 1;
    // The third vertex is moved away from the first along their edge, so the smaller triangle lies in the larger one.
    const ScreenPoint far{p[0].x + times * (p[2].x - p[0].x), p[0].y + times * (p[2].y - p[0].y)};
    SetupTriangles smaller, larger;
    add_triangle(smaller, p[0], p[1], p[2]);
    add_triangle(larger, p[0], p[1], far);
    std::map<std::uint32_t, Fragment> in_larger;
    for (const Fragment& fragment : beam_fragments(larger, kTile, MaskSource::exact, 0).list)
      in_larger.emplace(fragment.pixel, fragment);
    for (const Fragment& fragment : beam_fragments(smaller, kTile, MaskSource::exact, 0).list) {
      const auto whole = in_larger.find(fragment.pixel);
      ASSERT_TRUE(whole != in_larger.end() || fragment.alpha <= kZeroArea + 2 * kAlphaError);
      if (whole == in_larger.end()) continue;
      ASSERT_LE(fragment.alpha, whole->second.alpha + 2 * kAlphaError);
      ASSERT_TRUE(without(fragment.mask, whole->second.mask).none());
    }
  });
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
    const auto a = beam_fragments(here, kTile, MaskSource::exact).list;
    const auto b = beam_fragments(there, moved, MaskSource::exact).list;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].pixel, b[i].pixel);
      ASSERT_EQ(a[i].alpha, b[i].alpha);
      ASSERT_EQ(a[i].mask, b[i].mask);
    }
  });
}

}  // namespace
}  // namespace beampipe
