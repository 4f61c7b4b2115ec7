#include "simd/population_count.h"

#include "tests/simd/random.h"

namespace beampipe::population_count_test {

TEST(PopulationCount, EqualsTheStandardLibrary) {
  for (std::uint32_t low = 0; low < 1u << 16; ++low)
    for (const std::uint32_t bits : {low, low << 16, ~low, low << 8 | 0x80000001u})
      ASSERT_EQ(population_count(bits), static_cast<std::uint32_t>(std::popcount(bits))) << bits;
  Random random(1);
  for (int i = 0; i < 100'000; ++i) {
    const std::uint32_t bits = random.word();
    ASSERT_EQ(population_count(bits), static_cast<std::uint32_t>(std::popcount(bits))) << bits;
  }
}

}  // namespace beampipe::population_count_test
