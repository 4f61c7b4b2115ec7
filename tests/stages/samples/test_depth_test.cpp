#include "stages/samples/test_depth.h"

#include "stages/data/closed_depth.h"
#include "tests/stages/sample_pixels.h"

namespace beampipe::test_depth_test {

constexpr Tile kTile{2, 4, 6, 8};  // not at the frame's origin

struct Tested {
  SampleTile surface;
  StageCounters counters;
};

Tested render(const SetupTriangles& triangles, const Sampling& sampling, const Tile& tile = kTile) {
  Tested tested{SampleTile(tile, sampling), {}};
  std::vector<SampleAccess> accesses;
  depth_test({triangles, tile, sampling}, sample_fragments(triangles, tile, sampling), tested.counters, tested.surface,
             accesses);
  return tested;
}

// Triangles at a few depths or slanted ones; large ones, and slivers with steep planes.
SetupTriangles random_layers(Random& random) {
  SetupTriangles triangles;
  const auto corner = [&](std::int32_t reach, float z, float slant) {
    return ScreenPoint{4 * 256 + random.int32(-reach, reach), 6 * 256 + random.int32(-reach, reach),
                       z + random.real32(-slant, slant)};
  };
  for (int i = 0; i < 60; ++i) {
    const std::int32_t reach = random.pick(std::array{700, 3'000, 60'000});
    const float z = -0.125f * static_cast<float>(random.integer(1, 7));
    const float slant = random.pick(std::array{0.0f, 1e-6f, 1e-3f, 0.1f});
    ScreenPoint a = corner(reach, z, slant), b = corner(reach, z, slant), c = corner(reach, z, slant);
    if (random.one_in(4)) c = {(a.x + b.x) / 2 + random.int32(-2, 2), (a.y + b.y) / 2 + random.int32(-2, 2), c.z};
    add_triangle(triangles, a, b, c);
  }
  return triangles;
}

const Sampling kMsaa8{CellGrid{}, standard_pattern(8)};

TEST(DepthTestStage, NearerWinsInAnyOrder) {
  for (const float first : {-0.25f, -0.75f}) {
    SetupTriangles triangles = triangles_of({everywhere(first), everywhere(-1.0f - first)});
    const Tested found = render(triangles, kMsaa8);
    const std::uint32_t nearer = first < -0.5f ? 0 : 1;
    for (std::size_t i = 0; i < kTile.pixels() * 8; ++i) ASSERT_EQ(found.surface.triangle[i], nearer);
    EXPECT_EQ(found.counters.items_in, 2 * kTile.pixels() * 8);
    EXPECT_EQ(found.counters.items_out, (1 + nearer) * kTile.pixels() * 8);
  }
}

TEST(DepthTestStage, EqualDepthKeepsTheEarlier) {
  // slanted, so that depths are not round numbers
  SetupTriangles triangles =
      triangles_of({{{-9'000, -9'000, -0.9f}, {20'000, -9'000, -0.3f}, {-9'000, 20'000, -0.2f}}});
  triangles.triangles.push_back(triangles.triangles[0]);
  for (const Sampling& sampling : {kMsaa8, Sampling{CellGrid{4, 2}, standard_pattern(8, 64, 128)}}) {
    const Tested found = render(triangles, sampling);
    for (std::size_t i = 0; i < kTile.pixels() * found.surface.samples_per_pixel; ++i)
      ASSERT_EQ(found.surface.triangle[i], 0u);
  }
}

// Compares the surface without what is hidden behind closed cells to the surface with everything. Returns how many
// fragments were left out.
std::size_t left_out(const SetupTriangles& triangles, const Sampling& sampling) {
  SampleTile open(kTile, sampling);
  StageCounters unused;
  std::vector<SampleAccess> accesses;
  ClosedDepth closed(cells_of(kTile, sampling.grid));
  const std::vector<SampleFragment> shown = sample_fragments(triangles, kTile, sampling, &closed);
  depth_test({triangles, kTile, sampling}, shown, unused, open, accesses);
  const Tested all = render(triangles, sampling);
  EXPECT_EQ(open.depth, all.surface.depth);
  EXPECT_EQ(open.triangle, all.surface.triangle);
  return sample_fragments(triangles, kTile, sampling).size() - shown.size();
}

// Fragments that are left out behind closed cells would not have passed, so the surface is the same to the last bit.
TEST(DepthTestStage, ClosedCellsHideNothingThatPasses) {
  Random random(81);
  std::size_t hidden = 0;
  for (int i = 0; i < 2'000 && !HasFailure(); ++i) {
    const SetupTriangles triangles = random_layers(random);
    for (const Sampling& sampling : {kMsaa8, Sampling{CellGrid{4, 2}, standard_pattern(8, 64, 128)}})
      hidden += left_out(triangles, sampling);
  }
  EXPECT_GT(hidden, 100'000u);
}

// A layer at one depth, and a steep triangle that begins behind it by the last bit, at a sample. Rounding moves some of
// them in front of the layer there.
TEST(DepthTestStage, ClosedCellsHideNothingThatRoundingBringsBeforeThem) {
  Random random(82);
  for (int i = 0; i < 5'000 && !HasFailure(); ++i) {
    const auto sample = static_cast<std::size_t>(random.integer(0, 7));
    const std::int32_t x = random.int32(kTile.x0, kTile.x1 - 1) * 256 + kMsaa8.pattern.x[sample],
                       y = random.int32(kTile.y0, kTile.y1 - 1) * 256 + kMsaa8.pattern.y[sample];
    const float behind = std::nextafter(-0.5f, 0.0f);
    const auto corner = [&] {
      return ScreenPoint{x + random.int32(-20, 20), y + random.int32(-20, 20), behind + random.real32(0, 0.4f)};
    };
    SetupTriangles triangles = triangles_of({everywhere(-0.5f), {{x, y, behind}, corner(), corner()}});
    left_out(triangles, kMsaa8);
  }
}

TEST(DepthTestStage, UncoveredSamplesKeepTheBackground) {
  SetupTriangles triangles = triangles_of({
      {{4 * 256, -90'000}, {4 * 256, 90'000}, {-90'000, 0}}  // the tile's left half
  });
  const Tested found = render(triangles, kMsaa8);
  for (std::size_t i = 0; i < kTile.pixels() * 8; ++i) {
    const bool left = i / 8 % 4 < 2;
    ASSERT_EQ(found.surface.triangle[i], left ? 0u : kNoTriangle);
    ASSERT_EQ(found.surface.depth[i], left ? -0.5f : kFarDepth);
  }
}

// Two planes cross at x = 4 px, in the middle of the tile. Each sample belongs to the one that is nearer there.
TEST(DepthTestStage, CrossingPlanesAreComparedAtTheSamples) {
  for (const Sampling& sampling : {kMsaa8, Sampling{CellGrid{2, 2}, standard_pattern(8, 128, 128)}}) {
    SetupTriangles triangles;
    const std::int32_t middle = 4 * 256 + 1;  // between samples, which have even positions
    const auto add_slanted = [&](float left, float right) {
      const std::int32_t reach = 8'192;
      add_triangle(triangles, {middle - reach, -reach, left}, {middle + reach, -reach, right},
                   {middle - reach, 3 * reach, left});
      add_triangle(triangles, {middle + reach, -reach, right}, {middle + reach, 3 * reach, right},
                   {middle - reach, 3 * reach, left});
    };
    add_slanted(-1.0f, 0.0f);
    add_slanted(0.0f, -1.0f);
    const Tested found = render(triangles, sampling);
    const CellGrid& grid = sampling.grid;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(kTile.pixels() * found.surface.samples_per_pixel); ++i) {
      const std::int32_t sample = i % 8, cell = i / 8 % grid.cells_per_pixel(), pixel = i / 8 / grid.cells_per_pixel();
      const std::int32_t x = (kTile.x0 + pixel % kTile.width()) * 256 + cell % grid.columns * grid.cell_width() +
                             sampling.pattern.x[static_cast<std::size_t>(sample)];
      const std::uint32_t owner = found.surface.triangle[static_cast<std::size_t>(i)];
      ASSERT_EQ(owner < 2, x < middle) << "sample " << i;
      const double z = -0.5 - std::abs(x - middle) * 0.5 / 8'192;
      ASSERT_NEAR(found.surface.depth[static_cast<std::size_t>(i)], z, 1e-6);
    }
  }
}

// TwinCounts count operations.
TEST(DepthTestStage, CountsOperationsAndBytes) {
  SetupTriangles triangles = triangles_of({
      everywhere(-0.5f),
      everywhere(-0.25f)  // hidden
  });
  const Tested found = render(triangles, kMsaa8);
  const std::uint64_t samples = kTile.pixels() * 8, fragments = 2 * kTile.pixels();
  EXPECT_EQ(found.counters.ops, (OperationCounts{.mul_add = 2 * 2 * samples + 4 * fragments,
                                                 .add = 2 * 3 * samples + 4 * fragments,
                                                 .convert = 3 * fragments}));
  EXPECT_EQ(found.counters.bytes_read, 2 * samples * 4 + 2 * kTile.pixels() * 10);
  EXPECT_EQ(found.counters.bytes_written, samples * (4 + 6));
}

}  // namespace beampipe::test_depth_test
