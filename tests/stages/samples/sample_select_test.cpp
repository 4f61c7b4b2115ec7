#include "stages/samples/sample_select.h"

#include "tests/test.h"

namespace beampipe::sample_select_test {

constexpr Tile kQuad{0, 0, 2, 2};
const Sampling kEight{CellGrid{}, standard_pattern(8)};

// A surface whose sample i (pixel by pixel, 8 each) shows triangle ids[i]. Every triangle has its own material.
SampleTile surface_of(const std::vector<std::uint32_t>& ids, const Tile& tile = kQuad) {
  SampleTile surface(tile, kEight);
  std::copy(ids.begin(), ids.end(), surface.triangle.begin());
  return surface;
}

const std::vector<std::uint32_t> kOwnMaterials = {0, 1, 2, 3, 4, 5, 6, 7};

SampleQuad select(const SampleTile& surface, const SelectOptions& options, const Tile& tile = kQuad) {
  StageCounters counters;
  return sample_select(surface, tile, kOwnMaterials, options, counters).front();
}

// Properties of every quad: masks are disjoint and contain only samples of their own material. A pixel's samples go to
// a shading sample at the same pixel if there is one of their material.
void check(const std::vector<std::uint32_t>& ids, const SampleQuad& quad) {
  std::uint32_t all = 0;
  std::set<std::uint32_t> shaded;
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(all & quad.mask[i], 0u);
    all |= quad.mask[i];
    EXPECT_EQ(quad.triangle[i], ids[quad.location[i]]);
    shaded.insert(quad.triangle[i]);
  }
  for (std::uint32_t s = 0; s < 32; ++s) {
    const bool has_sample = shaded.count(ids[s]) > 0;
    ASSERT_EQ(all >> s & 1, has_sample ? 1u : 0u) << s;
    for (int i = 0; i < 4; ++i) {
      if (!(quad.mask[i] >> s & 1)) continue;
      EXPECT_EQ(quad.triangle[i], ids[s]);
      bool local = false;
      for (int j = 0; j < 4; ++j) local |= quad.triangle[j] == ids[s] && quad.location[j] / 8u == s / 8;
      if (local) {
        EXPECT_EQ(quad.location[i] / 8u, s / 8);
      }
    }
  }
}

TEST(SampleSelect, OneMaterialKeepsTheJitteredSamples) {
  const SampleTile surface = surface_of(std::vector<std::uint32_t>(32, 5));
  for (std::uint32_t jitter = 0; jitter < 8; ++jitter) {
    const SampleQuad quad = select(surface, {jitter, 1});
    for (std::uint32_t p = 0; p < 4; ++p) {
      EXPECT_EQ(quad.location[p], 8 * p + jitter);
      EXPECT_EQ(quad.mask[p], 0xffu << 8 * p);
    }
  }
}

TEST(SampleSelect, EveryMaterialOfUpToFourGetsASample) {
  std::mt19937 bits(3);
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::uint32_t> ids(32);
    const std::uint32_t count = 1 + bits() % 6;
    for (auto& id : ids) id = bits() % 3 ? 0 : bits() % count;
    const SampleQuad quad =
        select(surface_of(ids), {static_cast<std::uint32_t>(bits() % 8), static_cast<std::uint32_t>(bits())});
    check(ids, quad);
    const std::set<std::uint32_t> present(ids.begin(), ids.end());
    const std::set<std::uint32_t> shaded(std::begin(quad.triangle), std::end(quad.triangle));
    EXPECT_EQ(shaded.size(), std::min<std::size_t>(present.size(), 4));
  }
}

// The samples at the jitter position are all of material 0. Five others have one or two samples each.
TEST(SampleSelect, MaterialsWithoutASampleTakeExtraOnes) {
  std::vector<std::uint32_t> ids(32, 0);
  ids[9] = ids[10] = 1, ids[17] = 2, ids[18] = 3, ids[25] = 4, ids[31] = 5;
  const std::map<std::uint32_t, std::uint32_t> masks = {
      {1, 3u << 9}, {2, 1u << 17}, {3, 1u << 18}, {4, 1u << 25}, {5, 1u << 31}};
  for (const std::uint32_t room : {0u, 4u, 28u}) {
    StageCounters counters;
    const SampleQuad quad = sample_select(surface_of(ids), kQuad, kOwnMaterials, {0, 1, room}, counters).front();
    std::uint32_t known = quad.mask[0] | quad.mask[1] | quad.mask[2] | quad.mask[3];
    std::set<std::uint32_t> different;
    for (const ExtraSample& extra : quad.extras) {
      EXPECT_EQ(extra.mask, masks.at(extra.triangle));
      EXPECT_EQ(ids[extra.location], extra.triangle);
      EXPECT_EQ(known & extra.mask, 0u);
      known |= extra.mask;
      different.insert(extra.triangle);
    }
    EXPECT_EQ(different.size(), std::min(room, 5u)) << "one for each material";
    int switched = 0;
    for (int p = 0; p < 4; ++p) switched += quad.location[p] != 8 * p;
    EXPECT_EQ(switched, room == 0 ? 3 : room == 4 ? 1 : 0) << room;
    EXPECT_EQ(known == ~0u, room > 0) << "at first, two materials remain";
    EXPECT_EQ(shaded_samples({quad}), 4 + different.size());
    EXPECT_EQ(counters.items_out, 4 + different.size());
    EXPECT_EQ(counters.bytes_written, (4 + different.size()) * 9 + (room == 28 ? 4 : 0)) << "a mask of 0 ends the list";
  }
}

// A tile of 3 x 2 pixels has a whole quad and one of a single column.
TEST(SampleSelect, QuadsKnowTheirMaterialsAndPixels) {
  const Tile tile{0, 0, 3, 2};
  std::vector<std::uint32_t> ids(6 * 8, 0);  // pixels row by row
  for (std::size_t material = 1; material < 6; ++material) ids[material] = static_cast<std::uint32_t>(material);
  ids[8 * 4 + 7] = kNoTriangle;
  ids[8 * 5 + 3] = 7;
  StageCounters counters;
  const std::vector<SampleQuad> quads = sample_select(surface_of(ids, tile), tile, kOwnMaterials, {0, 1}, counters);
  ASSERT_EQ(quads.size(), 2u);
  EXPECT_EQ(quads[0].materials, 7) << "0 to 5, and the background";
  EXPECT_EQ(quads[0].pixels, 4);
  EXPECT_EQ(quads[1].materials, 2) << "0 and 7; outside the frame there is nothing";
  EXPECT_EQ(quads[1].pixels, 2);
  EXPECT_EQ(triangles_of(quads).size(), 8u);
}

TEST(SampleSelect, BackgroundIsAMaterial) {
  std::vector<std::uint32_t> ids(32, kNoTriangle);
  ids[17] = 2;
  const SampleQuad quad = select(surface_of(ids), {0, 9});
  check(ids, quad);
  StageCounters counters;
  EXPECT_EQ(shaded_samples(sample_select(surface_of(ids), kQuad, kOwnMaterials, {0, 9}, counters)), 1u);
}

TEST(SampleSelect, NoSampleIsStarved) {
  // Only pixel 0 has material 1, at its samples 2..7. Any of the four shading samples may be switched, to any of these
  // six places.
  std::vector<std::uint32_t> ids(32, 0);
  for (std::size_t s = 2; s < 8; ++s) ids[s] = 1;
  std::map<int, int> slots, places;
  for (std::uint32_t seed = 0; seed < 6000; ++seed) {
    const SampleQuad quad = select(surface_of(ids), {0, seed});
    for (int i = 0; i < 4; ++i)
      if (quad.triangle[i] == 1) ++slots[i], ++places[quad.location[i]];
  }
  ASSERT_EQ(slots.size(), 4u);
  ASSERT_EQ(places.size(), 6u);
  for (const auto& [slot, times] : slots) EXPECT_NEAR(times, 1500, 200) << slot;
  for (const auto& [place, times] : places) EXPECT_NEAR(times, 1000, 160) << place;
}

TEST(SampleSelect, PixelsOutsideTheFrameHaveNoSamples) {
  const Tile tile{4, 6, 5, 7};  // one pixel
  const std::vector<std::uint32_t> ids = {0, 0, 0, 1, 1, 1, 2, 2};
  const SampleQuad quad = select(surface_of(ids, tile), {3, 1}, tile);
  EXPECT_EQ(quad.mask[0], 0b00111000u);
  for (int i = 1; i < 4; ++i) {
    EXPECT_EQ(quad.mask[i], 0u);
    EXPECT_EQ(quad.triangle[i], kNoTriangle);
  }
}

}  // namespace beampipe::sample_select_test
