#include "stages/beam/compose_pooled.h"

#include "tests/simd/random.h"
#include "tests/stages/open_pixels.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::compose_pooled_test {

constexpr glm::vec3 kRed{1, 0, 0}, kGreen{0, 1, 0};

// Where a record lies changes nothing.
TEST(ComposePooled, RecordsInMemoryAreThoseOfThePool) {
  for (std::uint64_t seed = 420; seed < 440; ++seed) {
    Random random(seed);
    const SetupTriangles triangles = random_triangles(random, 60);
    const std::vector<glm::vec3> colors = random_colors(triangles, random);
    const Tile area{0, 0, 12, 12};
    OpenTile<8> pooled(triangles, colors, area), no_pool(triangles, colors, area, ChunkPool(0));
    const TriangleList list = all_of(triangles);
    const std::vector<PixelColor> found = pooled.compose(list), in_memory = no_pool.compose(list);
    for (std::size_t i = 0; i < area.pixels(); ++i) {
      ASSERT_EQ(in_memory[i].color, found[i].color);
      ASSERT_EQ(in_memory[i].alpha, found[i].alpha);
    }
    EXPECT_GT(no_pool.result.spills.all(), 0u);
    EXPECT_EQ(pooled.result.spills.all(), 0u);
  }
}

TEST(ComposePooled, MergesBeyondTheMostOwners) {
  SetupTriangles triangles;
  for (int i = 0; i < 8; ++i)
    add_triangle(triangles, {32 * i, -9'000, -0.5f}, {32 * i + 32, -9'000, -0.5f}, {32 * i + 32, 9'000, -0.5f});
  const std::vector<glm::vec3> colors(8, glm::vec3(0.25f, 0.5f, 1.0f));
  OpenTile<8, 2> two(triangles, colors);
  OpenTile<8> enough(triangles, colors);
  const TriangleList list = all_of(triangles);
  const PixelColor merged = two.compose(list).at(0), expected = enough.compose(list).at(0);
  EXPECT_EQ(two.merges[0], 6);
  EXPECT_EQ(enough.merges[0], 0);
  expect_pixel(merged, expected.alpha, expected.color, 1e-6);
}

// A closed pool of a frame guarantees what two surfaces take: a plane of 16 bytes, and a chunk of two slots.
TEST(ComposePooled, AClosedPoolRefusesAThirdSurfaceAndSpecks) {
  SetupTriangles triangles = triangles_of({everywhere(-0.25f),
                                           left_of(128, -0.75f),
                                           right_of(192, -0.8f),
                                           {{50, 50, -0.85f}, {51, 50, -0.85f}, {50, 51, -0.85f}}});
  const std::vector<glm::vec3> colors(4, kRed);
  const auto compose = [&](const TriangleList& list) {
    ChunkPool pool = ChunkPool::of_frame(least_chunks(4));
    pool.close();
    OpenTile<4> tile(triangles, colors, {0, 0, 1, 1}, pool);
    tile.compose(list);
    EXPECT_LE(tile.pixels.pool.peak(), 2u);
    return std::vector<float>{tile.refusals[0], tile.lost_specks[0], tile.merges[0]};
  };
  EXPECT_EQ(compose({0, 1}), (std::vector<float>{0, 0, 0}));
  EXPECT_EQ(compose({0, 1, 2}), (std::vector<float>{1, 0, 1}));
  EXPECT_EQ(compose({0, 1, 3}), (std::vector<float>{1, 1, 0})) << "a chunk for its sum would be the third";
  EXPECT_EQ(compose({3, 1}), (std::vector<float>{1, 1, 0})) << "its sum is the third beside a plane and a slot";
}

// In streaming order a speck may be hidden later: by a triangle that covers the pixel, or by two halves. What closes
// the pixel behind it, or leaves a part open, does not hide it.
TEST(ComposePooled, SpecksThatAreHiddenLaterAreForgotten) {
  SetupTriangles triangles = triangles_of({everywhere(-0.2f),
                                           {{50, 50, -0.5f}, {56, 50, -0.5f}, {50, 56, -0.5f}},
                                           everywhere(-0.9f),
                                           left_of(128, -0.8f),
                                           right_of(128, -0.8f),
                                           right_of(128, -0.4f)});
  const std::vector<glm::vec3> colors{kRed, kGreen, kRed, kRed, kRed, kRed};
  const auto green = [&](const TriangleList& list) {
    OpenTile<8> tile(triangles, colors);
    return tile.compose(list).at(0).color.g;
  };
  const float seen = green({0, 1});
  EXPECT_NEAR(seen, 18.0 / 65536, 1.01 / FixedSum::kUnits);
  EXPECT_EQ(green({0, 1, 2}), 0);
  EXPECT_EQ(green({0, 1, 3, 4}), 0);
  EXPECT_GT(green({0, 1, 3, 5}), 0.9f * seen);
  EXPECT_GT(green({0, 1, 3}), 0.9f * seen);
  OpenTile<8> tile(triangles, colors);
  tile.compose({0, 1, 2});
  EXPECT_EQ(tile.pixels.words[0].kind, PixelKind::covered) << "the record is free again";
}

TEST(ComposePooled, ACollectionFinishesPixels) {
  SetupTriangles triangles = triangles_of({left_of(128, -0.9f), right_of(128, -0.8f), everywhere(-0.1f)});
  const std::vector<glm::vec3> colors{kRed, kGreen, {0, 0, 1}};
  const std::vector<float> watermarks{-0.9f, -0.8f, -0.1f};
  OpenTile<8> tile(triangles, colors, {0, 0, 1, 1}, ChunkPool(0));  // no room at all: every fragment collects
  expect_pixel(tile.compose({0, 1, 2}, &watermarks).at(0), 1, {0.5, 0.5, 0}, 1e-7);
  EXPECT_EQ(tile.pixels.words[0].kind, PixelKind::finished);
  EXPECT_EQ(tile.pixels.pool.used(), 0u);
  const std::array taken{tile.pixels.records.take(0), tile.pixels.records.take(0)};
  EXPECT_EQ(std::ranges::count(taken, tile.pixels.words[0].record), 1) << "the pixel's record is free again";
  EXPECT_TRUE(tile.closed.hides(0, 0, -0.99f)) << "nothing can be seen there any more";
  EXPECT_EQ(tile.result.collections, (std::vector<std::vector<std::uint32_t>>{{0}, {0}})) << "each writes the pixel";
}

// Also where surfaces of several pixels could be shaded together. A record that is written was read just before.
TEST(ComposePooled, ACollectionVisitsRecordsPixelByPixel) {
  Material metal;
  metal.metallic = 1, metal.roughness = 0.3f;
  SurfaceTrace scene(4, 1);
  for (const double half : {0.0, 0.5})
    for (int x = 0; x < 4; ++x) scene.add_rectangle(x + half, 0, x + half + 0.5, 1, 0.1 + half, metal);
  scene.add_rectangle(0, 0, 4, 1, 0.9, metal);
  const ShadedScene shaded(scene.trace);
  const std::vector<glm::vec3> no_colors(shaded.triangles.triangles.size());
  OpenTile<8> tile(shaded.triangles, no_colors, {0, 0, 4, 1}, ChunkPool(0));
  tile.shader = &shaded.shader;
  tile.result.lists_visits = true;
  tile.compose_sorted();
  std::size_t several = 0;  // collections that have written several pixels
  for (const std::vector<std::uint32_t>& written : tile.result.collections) several += written.size() > 1;
  EXPECT_GT(several, 0u);
  std::array<bool, 4> has_record{};
  for (std::size_t i = 0; i < tile.result.visits.size(); ++i) {
    const RecordVisit& visit = tile.result.visits[i];
    if (!visit.is_write) continue;
    if (has_record[visit.pixel]) {
      EXPECT_EQ(tile.result.visits[i - 1].pixel, visit.pixel) << i;
    }
    has_record[visit.pixel] = visit.chunks > 0;
  }
}

}  // namespace beampipe::compose_pooled_test
