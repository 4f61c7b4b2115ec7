#include "simd/depth_compare.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::depth_compare_test {

struct Samples {
  std::vector<float> depth;
  std::vector<std::uint32_t> triangle;
  bool operator==(const Samples&) const = default;
};

Samples cleared(std::size_t cells, const SamplePattern& pattern) {
  const std::size_t samples = cells * static_cast<std::size_t>(pattern.count) + kSampleSlack;
  return {std::vector<float>(samples, 1.0f), std::vector<std::uint32_t>(samples, 0xdeadbeef)};
}

std::uint64_t twin(const std::vector<CellDepth>& items, const SamplePattern& pattern, Samples& samples) {
  std::uint64_t passed = 0;
  for (const CellDepth& item : items)
    for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s) {
      const std::size_t i = item.cell * static_cast<std::size_t>(pattern.count) + s;
      float depth = 0;
      if (!(item.mask >> s & 1)) continue;
      const auto x = static_cast<float>(pattern.x[s]), y = static_cast<float>(pattern.y[s]);
      if (!depth_test_scalar(item.plane, x, y, samples.depth[i], depth)) continue;
      samples.depth[i] = depth;
      samples.triangle[i] = item.triangle;
      ++passed;
    }
  return passed;
}

// Several items per cell, equal depths, and neighbouring samples that a wide store must not change.
TEST(DepthCompare, KernelEqualsTwinForEveryPatternSize) {
  Random random(51);
  constexpr float kSlopes[] = {0.0f, 0.0f, 1.0f / 4096, -1.0f / 4096, 1e-5f};
  constexpr std::size_t kCells = 7;
  for (int count = 1; count <= kMaxMaskSamples; ++count) {
    SamplePattern pattern;
    pattern.count = count;
    for (std::size_t s = 0; s < static_cast<std::size_t>(count); ++s)
      pattern.x[s] = random.int32(0, 255), pattern.y[s] = random.int32(0, 255);
    std::vector<CellDepth> items;
    for (std::uint32_t i = 0; i < 300; ++i)
      items.push_back({static_cast<std::uint32_t>(random.integer(0, kCells - 1)),
                       random.word() & (~0u >> (kMaxMaskSamples - count)),
                       i,
                       {-random.real32(0, 4) / 4, random.pick(kSlopes), random.pick(kSlopes)}});
    std::uint64_t tested = 0;
    for (const CellDepth& item : items) tested += static_cast<std::uint64_t>(std::popcount(item.mask));
    Samples expected = cleared(kCells, pattern);
    const std::uint64_t expected_passes = twin(items, pattern, expected);
    on_every_target([&] {
      Samples found = cleared(kCells, pattern);
      const SampleCounts counts =
          depth_test(items.data(), items.size(), pattern, {found.depth.data(), found.triangle.data()});
      ASSERT_EQ(counts.tested, tested) << count << " samples";
      ASSERT_EQ(counts.passed, expected_passes) << count << " samples";
      ASSERT_TRUE(found == expected) << count << " samples";
    });
  }
}

TEST(DepthCompare, NearerReplacesEqualDoesNot) {
  const SamplePattern pattern = standard_pattern(4);
  // Triangle 1 takes all samples, 2 has the same depth, 3 is nearer but covers samples 0 and 2 only, 4 is farther.
  const std::vector<CellDepth> items = {{0, 0b1111u, 1, {-0.5f, 0, 0}},
                                        {0, 0b1111u, 2, {-0.5f, 0, 0}},
                                        {0, 0b0101u, 3, {-0.75f, 0, 0}},
                                        {0, 0b1111u, 4, {-0.25f, 0, 0}}};
  on_every_target([&] {
    Samples found = cleared(1, pattern);
    EXPECT_EQ(depth_test(items.data(), items.size(), pattern, {found.depth.data(), found.triangle.data()}).passed, 6u);
    const std::vector<std::uint32_t> owners(found.triangle.begin(), found.triangle.begin() + 4);
    EXPECT_EQ(owners, (std::vector<std::uint32_t>{3, 1, 3, 1}));
    EXPECT_EQ(found.depth[0], -0.75f);
    EXPECT_EQ(found.depth[1], -0.5f);
  });
}

}  // namespace beampipe::depth_compare_test
