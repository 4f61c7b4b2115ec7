#include "simd/depth_compare.h"
#include "tests/simd/every_target.h"

namespace beampipe::depth_equal_test {

TEST(DepthEqual, KernelEqualsTwin) {
  std::mt19937 bits(11);
  const auto uniform = [&] { return static_cast<float>(bits() / 4294967296.0 - 0.5); };
  for (const int samples : {1, 2, 4, 8, 16, 32}) {
    const SamplePattern pattern = samples == 32 ? hammersley_pattern() : standard_pattern(samples);
    const auto n = static_cast<std::size_t>(samples);
    std::vector<float> depth(100 * n + kSampleSlack);
    std::vector<SampleAccess> items;
    std::vector<CellPlane<float>> planes;
    std::vector<std::uint32_t> expected;
    for (std::uint32_t cell = 0; cell < 100; ++cell) {
      const std::uint32_t tested = static_cast<std::uint32_t>(bits()) & ~0u >> (32 - samples);
      items.push_back({cell, 0, tested, 0xdeadbeef});
      planes.push_back({uniform(), uniform() / 256, uniform() / 256});
      std::uint32_t mask = 0;
      for (std::size_t s = 0; s < n; ++s) {
        const auto x = static_cast<float>(pattern.x[s]), y = static_cast<float>(pattern.y[s]);
        float& stored = depth[cell * n + s];
        depth_test_scalar(planes.back(), x, y, 1e9f, stored);
        if (bits() % 3 == 0) stored = std::nextafter(stored, -2.0f);  // one bit nearer
        const bool equal = depth_equal_scalar(planes.back(), x, y, stored);
        mask |= (equal ? tested >> s & 1 : 0u) << s;
      }
      expected.push_back(mask);
    }
    on_every_target([&] {
      depth_equal(items.data(), planes.data(), items.size(), pattern, depth.data());
      for (std::size_t i = 0; i < items.size(); ++i) EXPECT_EQ(items[i].passed, expected[i]) << samples;
    });
  }
}

}  // namespace beampipe::depth_equal_test
