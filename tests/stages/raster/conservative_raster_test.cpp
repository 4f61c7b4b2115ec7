#include "stages/raster/conservative_raster.h"

#include "tests/stages/screen_triangles.h"

namespace beampipe::conservative_raster_test {

constexpr Tile kFrame{0, 0, 12, 10};

using TouchedPair = std::tuple<std::uint32_t, std::int32_t, std::int32_t, bool>;  // triangle, x, y, full

struct Raster {
  std::vector<Pair> pairs;
  StageCounters counters;

  std::set<TouchedPair> set() const {
    std::set<TouchedPair> all;
    for (const Pair& p : pairs) all.emplace(p.triangle, p.x, p.y, p.full);
    return all;
  }
};

Raster rasterize(const SetupTriangles& triangles, const Tile& tile) {
  Raster raster;
  conservative_raster(triangles, all_of(triangles), tile, raster.counters, raster.pairs);
  return raster;
}

// Does the closed triangle meet the closed square? Decided by intersecting segments, unlike the product.

struct At {
  std::int64_t x, y;
};

int side_of(const At& p, const At& q, const At& r) {
  const std::int64_t cross = (q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y);
  return (cross > 0) - (cross < 0);
}

bool in_box(const At& p, const At& q, const At& r) {  // r within the bounds of p and q
  return std::min(p.x, q.x) <= r.x && r.x <= std::max(p.x, q.x) && std::min(p.y, q.y) <= r.y &&
         r.y <= std::max(p.y, q.y);
}

bool segments_meet(const At& p, const At& q, const At& r, const At& s) {
  const int pqr = side_of(p, q, r), pqs = side_of(p, q, s), rsp = side_of(r, s, p), rsq = side_of(r, s, q);
  if (pqr != pqs && rsp != rsq) return true;
  return (pqr == 0 && in_box(p, q, r)) || (pqs == 0 && in_box(p, q, s)) || (rsp == 0 && in_box(r, s, p)) ||
         (rsq == 0 && in_box(r, s, q));
}

struct Truth {
  bool touched, full;
};

Truth truth(const SetupTriangle& t, std::int32_t x, std::int32_t y) {
  const std::int64_t left = 256 * x, top = 256 * y;
  const At corners[4] = {{left, top}, {left + 256, top}, {left + 256, top + 256}, {left, top + 256}};
  At v[3];
  for (int k = 0; k < 3; ++k) v[k] = {t.x[k], t.y[k]};
  int corners_inside = 0;
  bool touched = false;
  for (const At& c : corners)
    corners_inside += side_of(v[0], v[1], c) >= 0 && side_of(v[1], v[2], c) >= 0 && side_of(v[2], v[0], c) >= 0;
  for (int k = 0; k < 3; ++k) {
    touched |= in_box(corners[0], corners[2], v[k]);
    for (int side = 0; side < 4; ++side)
      touched |= segments_meet(v[k], v[(k + 1) % 3], corners[side], corners[(side + 1) % 4]);
  }
  return {touched || corners_inside > 0, corners_inside == 4};
}

// The pairs of a tile are those of all its pixels that triangles touch.
void expect_touched_pixels(const SetupTriangles& triangles, const Tile& tile) {
  std::set<TouchedPair> expected;
  for (std::uint32_t i = 0; i < triangles.triangles.size(); ++i)
    for (std::int32_t y = tile.y0; y < tile.y1; ++y)
      for (std::int32_t x = tile.x0; x < tile.x1; ++x)
        if (const Truth found = truth(triangles.triangles[i], x, y); found.touched)
          expected.emplace(i, x, y, found.full);
  const Raster raster = rasterize(triangles, tile);
  EXPECT_EQ(raster.set().size(), raster.pairs.size()) << "a pixel occurs twice";
  EXPECT_TRUE(raster.set() == expected);
  EXPECT_EQ(raster.counters.items_out, expected.size());
}

TEST(ConservativeRaster, FindsExactlyTheTouchedPixels) {
  Random random(101);
  const SetupTriangles triangles = random_triangles(random, 6'000);
  expect_touched_pixels(triangles, kFrame);
}

TEST(ConservativeRaster, TilesTogetherGiveWhatOneTileGives) {
  Random random(102);
  const SetupTriangles triangles = random_triangles(random, 2'000);
  const Raster whole = rasterize(triangles, kFrame);
  for (const std::int32_t size : {2, 4, 8}) {
    Raster split;
    for (std::int32_t y = 0; y < kFrame.y1; y += size)
      for (std::int32_t x = 0; x < kFrame.x1; x += size) {
        const Raster tile = rasterize(triangles, {x, y, std::min(x + size, kFrame.x1), std::min(y + size, kFrame.y1)});
        split.pairs.insert(split.pairs.end(), tile.pairs.begin(), tile.pairs.end());
        split.counters += tile.counters;
      }
    EXPECT_TRUE(split.set() == whole.set()) << size;
    split.counters.ops = whole.counters.ops;  // bounds and first edge values are computed in every tile
    EXPECT_TRUE(split.counters == whole.counters) << size;
  }
}

// Triangles that are wider and higher than what is tested at once, in a tile that begins and ends anywhere on even
// pixels.
TEST(ConservativeRaster, FindsThePixelsOfLargeTriangles) {
  Random random(104);
  constexpr Tile kTile{6, 4, 106, 98};
  const auto coordinate = [&] {
    return random.one_in(2) ? random.int32(-10, 120) * 256 : random.int32(-10 * 256, 120 * 256);
  };
  SetupTriangles triangles;
  while (triangles.triangles.size() < 100)
    add_triangle(triangles, {coordinate(), coordinate()}, {coordinate(), coordinate()}, {coordinate(), coordinate()});
  expect_touched_pixels(triangles, kTile);
}

// The quads of a triangle come row by row, and the pixels of a quad as well. Pixels have the same quad number if and
// only if they have the same triangle and 2x2 quad.
TEST(ConservativeRaster, PairsAreInOrderAndQuadsHaveNumbers) {
  Random random(105);
  const SetupTriangles triangles = random_triangles(random, 2'000);
  const auto place = [](const Pair& p) { return std::tuple(p.triangle, p.y >> 1, p.x >> 1, p.y & 1, p.x & 1); };
  const std::vector<Pair> pairs = rasterize(triangles, {0, 0, 100, 60}).pairs;
  const auto quad = [](const Pair& p) { return std::tuple(p.triangle, p.x >> 1, p.y >> 1); };
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const Pair &before = pairs[i - 1], &here = pairs[i];
    ASSERT_LT(place(before), place(here)) << i;
    ASSERT_LE(before.quad, here.quad) << i;
    ASSERT_EQ(quad(before) == quad(here), before.quad == here.quad) << i;
  }
}

}  // namespace beampipe::conservative_raster_test
