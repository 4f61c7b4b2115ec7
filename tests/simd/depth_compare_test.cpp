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

struct Items {
  std::vector<SampleAccess> accesses;
  std::vector<CellPlane<float>> planes;

  void add(std::uint32_t cell, std::uint32_t triangle, std::uint32_t mask, const CellPlane<float>& plane) {
    accesses.push_back({cell, triangle, mask, 0xdeadbeef});
    planes.push_back(plane);
  }
  SampleCounts test(const SamplePattern& pattern, Samples& samples) {
    return depth_test(accesses.data(), planes.data(), accesses.size(), pattern,
                      {samples.depth.data(), samples.triangle.data()});
  }
  std::vector<std::uint32_t> passed() const {
    std::vector<std::uint32_t> masks;
    for (const SampleAccess& access : accesses) masks.push_back(access.passed);
    return masks;
  }
};

// `ties`: becomes larger by the samples whose depth is the stored one.
std::vector<std::uint32_t> twin(const Items& items, const SamplePattern& pattern, Samples& samples, int& ties) {
  std::vector<std::uint32_t> passed;
  for (std::size_t n = 0; n < items.accesses.size(); ++n) {
    const SampleAccess& item = items.accesses[n];
    passed.push_back(0);
    for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s) {
      const std::size_t i = item.cell * static_cast<std::size_t>(pattern.count) + s;
      float depth = 0;
      if (!(item.tested >> s & 1)) continue;
      const auto x = static_cast<float>(pattern.x[s]), y = static_cast<float>(pattern.y[s]);
      const bool passes = depth_test_scalar(items.planes[n], x, y, samples.depth[i], depth);
      ties += depth == samples.depth[i];
      if (!passes) continue;
      samples.depth[i] = depth;
      samples.triangle[i] = item.triangle;
      passed.back() |= 1u << s;
    }
  }
  return passed;
}

std::uint64_t bits_of(const std::vector<std::uint32_t>& masks) {
  std::uint64_t bits = 0;
  for (const std::uint32_t mask : masks) bits += static_cast<std::uint64_t>(std::popcount(mask));
  return bits;
}

// Several items per cell, equal depths, and neighbouring samples that a wide store must not change.
TEST(DepthCompare, KernelEqualsTwinForEveryPatternSize) {
  Random random(51);
  constexpr float kSlopes[] = {0.0f, 0.0f, 1.0f / 4096, -1.0f / 4096, 1e-5f};
  constexpr std::size_t kCells = 7;
  int ties = 0;
  for (int count = 1; count <= kMaxMaskSamples; ++count) {
    SamplePattern pattern;
    pattern.count = count;
    for (std::size_t s = 0; s < static_cast<std::size_t>(count); ++s)
      pattern.x[s] = random.int32(0, 255), pattern.y[s] = random.int32(0, 255);
    Items items;
    std::vector<std::uint32_t> tested;
    for (std::uint32_t i = 0; i < 300; ++i) {
      tested.push_back(random.word() & (~0u >> (kMaxMaskSamples - count)));
      items.add(static_cast<std::uint32_t>(random.integer(0, kCells - 1)), i, tested.back(),
                {random.one_in(2) ? -0.5f : random.real32(-1, 0), random.pick(kSlopes), random.pick(kSlopes)});
    }
    Samples expected = cleared(kCells, pattern);
    const std::vector<std::uint32_t> expected_passes = twin(items, pattern, expected, ties);
    on_every_target([&] {
      Samples found = cleared(kCells, pattern);
      const SampleCounts counts = items.test(pattern, found);
      ASSERT_EQ(counts.tested, bits_of(tested)) << count << " samples";
      ASSERT_EQ(counts.passed, bits_of(expected_passes)) << count << " samples";
      ASSERT_EQ(items.passed(), expected_passes) << count << " samples";
      ASSERT_TRUE(found == expected) << count << " samples";
    });
  }
  EXPECT_GT(ties, 100);
}

}  // namespace beampipe::depth_compare_test
