#include "stages/data/owner_slot.h"

#include "stages/data/pixel_sums.h"
#include "stages/data/position_states.h"
#include "tests/simd/random.h"

namespace beampipe::owner_slot_test {

OwnerSlot merged_slot(std::uint32_t number, float error, const glm::vec3& color, float threshold) {
  const float channels[] = {color[0], color[1], color[2]};
  return OwnerSlot(OwnerSlot::words_of_merged(number, error, channels, threshold));
}

TEST(OwnerSlot, ASlotKeepsItsTriangleAndItsCentroid) {
  OwnerSlot slot;
  EXPECT_TRUE(slot.is_free());
  for (const std::uint32_t number : {0u, 1u, 0x7fu, 0x12345u, OwnerSlot::kMostTriangles - 1}) {
    for (const std::uint32_t covered : {1u, 32u, 255u, 256u}) {
      slot.set(number, -1.0f, covered, 0.25f, 1.0f);
      EXPECT_FALSE(slot.is_free());
      EXPECT_FALSE(slot.is_merged());
      EXPECT_EQ(slot.triangle(), number);
      EXPECT_EQ(slot.covered(), static_cast<float>(covered));
      EXPECT_EQ(slot.error(), -1.0f);
      EXPECT_NEAR(slot.centroid().x, 0.25f, 0.5f / 255);
      EXPECT_EQ(slot.centroid().y, 1.0f);
    }
  }
  for (int i = 0; i <= 255; ++i) {  // every byte of both coordinates
    slot.set(7, 0, 1, static_cast<float>(i) / 255, static_cast<float>(255 - i) / 255);
    EXPECT_FLOAT_EQ(slot.centroid().x, static_cast<float>(i) / 255);
    EXPECT_FLOAT_EQ(slot.centroid().y, static_cast<float>(255 - i) / 255);
    EXPECT_EQ(slot.covered(), 1.0f);
  }
  slot.clear();
  EXPECT_TRUE(slot.is_free());
}

TEST(OwnerSlot, AMergedSlotKeepsAColour) {
  OwnerSlot slot;
  slot = merged_slot(OwnerSlot::kMostTriangles - 1, 3.5f, {1.0f, 0.5f, 0.25f}, 0.5f);
  EXPECT_TRUE(slot.is_merged());
  EXPECT_FALSE(slot.is_free());
  EXPECT_EQ(slot.triangle(), OwnerSlot::kMostTriangles - 1);
  EXPECT_EQ(slot.error(), 3.5f);
  EXPECT_EQ(slot.color(), glm::vec3(1.0f, 0.5f, 0.25f));
  slot.set(3, 0, 5, 0, 0);
  EXPECT_FALSE(slot.is_merged());
  slot = merged_slot(3, 0, {0, 0, 0}, 0.5f);
  EXPECT_EQ(slot.color(), glm::vec3(0.0f));
  slot.clear();
  EXPECT_TRUE(slot.is_free());
  EXPECT_FALSE(slot.is_merged());
}

// The error of a mask is rounded to the nearest step of 1/32 position, and limited to what 8 bits hold.
TEST(OwnerSlot, TheErrorOfASlotIsRoundedAndLimited) {
  Random random(201);
  constexpr float kMost = 127.0f / 32;
  OwnerSlot slot;
  const auto stored = [&](float error, bool merged) {
    if (merged) {
      slot = merged_slot(12345, error, glm::vec3(1.0f), 0.5f);
    } else {
      slot.set(12345, error, 10, 0.5f, 0.5f);
    }
    EXPECT_EQ(slot.triangle(), 12345u) << error;
    EXPECT_EQ(slot.is_merged(), merged) << error;
    return slot.error();
  };
  for (const bool merged : {false, true}) {
    for (int step = -127; step <= 127; ++step) {
      const float error = static_cast<float>(step) / 32;
      EXPECT_EQ(stored(error, merged), error);
    }
    for (int i = 0; i < 10'000; ++i) {
      const float error = random.real32(-kMost, kMost);
      ASSERT_LE(std::abs(stored(error, merged) - error), 1.0f / 64) << error;
    }
    for (const float error : {3.98f, 4.0f, 100.0f, 1e30f}) {
      EXPECT_EQ(stored(error, merged), kMost) << error;
      EXPECT_EQ(stored(-error, merged), -kMost) << error;
    }
  }
}

// With thresholds that differ, sums of many small addends are right on average: a sum of n has a standard deviation of
// at most sqrt(n) / 2 units, and five of these are allowed.
TEST(FixedSum, ManySmallAddendsAreRightOnAverage) {
  Random random(202);
  for (const double largest : {2.0 / 32768, 1.0 / 65536, 1e-6}) {
    FixedSum sum;
    double exact = 0;
    int count = 0;
    for (; count < 100'000 && exact < 1.8; ++count) {
      const float x = random.real32(0, largest);
      exact += x;
      sum.add(x, random.real32(0x1p-24, 1));
    }
    EXPECT_LE(std::abs(sum - exact), 5 * 0.5 * std::sqrt(count) / 32768) << largest;
  }
}

TEST(FixedSum, RoundsAtTheThreshold) {
  for (const float threshold : {0x1p-8f, 0.25f, 0.5f, 1.0f}) {
    FixedSum sum;
    for (int i = 0; i < 60'000; ++i) sum.add(1.0f / 32768, threshold);  // whole units are exact
    EXPECT_EQ(sum.units, 60'000);
    sum.add(0.0f, threshold);
    EXPECT_EQ(sum.units, 60'000);
    sum.add(0.3f / 32768, threshold);
    EXPECT_EQ(sum.units, threshold < 0.3f ? 60'001 : 60'000);
  }
}

TEST(FixedSum, StopsAtItsLimits) {
  FixedSum sum;
  for (int i = 0; i < 100; ++i) sum.add(0.3f, 0.5f);
  EXPECT_EQ(sum.units, 0xffff);
  sum.add(2.0f, 0.5f);
  EXPECT_EQ(sum.units, 0xffff);
}

// The six sums against doubles: colours from 10^-6 to 10^6, added in any order, are right to the sum's last bits, and
// many small addends are right on average.
TEST(ColorSums, AreRightWhateverTheSizeOfColors) {
  Random random(203);
  for (const double brightest : {1e-6, 1e-3, 1.0, 100.0, 1e6}) {
    for (int run = 0; run < 20; ++run) {
      ColorSums sums;
      double exact[ColorSums::kCount] = {}, largest = 0;
      const int count = 1 + random.int32(0, 400);
      for (int k = 0; k < count; ++k) {
        float addends[ColorSums::kCount];
        for (std::size_t i = 0; i < ColorSums::kCount; ++i) {
          addends[i] = random.real32(0, brightest / count);
          exact[i] += addends[i];
          largest = std::max(largest, exact[i]);
        }
        sums.add(addends, random.real32(0x1p-8, 1));
      }
      // A unit is at most 2^-13 of the largest sum. Each addend is wrong by a unit at most, and errors cancel.
      for (std::size_t i = 0; i < ColorSums::kCount; ++i)
        EXPECT_NEAR(sums.values()[i], exact[i], largest * 0x1p-13 * (2 + 3 * std::sqrt(count))) << brightest;
    }
  }
}

TEST(ColorSums, HoldABrightColorAfterDarkOnes) {
  ColorSums sums;
  for (int k = 0; k < 100; ++k) sums.add({0.004f, 0.002f, 0.001f, 0.004f, 0.002f, 0.001f}, 0.5f);
  EXPECT_NEAR(sums.values()[0], 0.4, 0.001);
  sums.add({900.0f, 0.0f, 0.0f, 900.0f, 0.0f, 0.0f}, 0.5f);
  EXPECT_NEAR(sums.values()[0], 900.4, 0.1);
  EXPECT_NEAR(sums.values()[1], 0.2, 0.1);
  sums.add({1e38f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}, 0.5f);  // more than a sum can hold
  EXPECT_GT(sums.values()[0], 1e11);
  EXPECT_TRUE(std::isfinite(sums.values()[0]));
}

// Every position is in the state that it was put into last, and words beyond the pixel's are 0.
template <std::size_t Words, std::size_t Bits>
void expect_states(std::uint64_t seed) {
  Random random(seed);
  PositionStates<Words, Bits> states{};
  std::vector<std::uint32_t> expected(32 * Words);
  for (int step = 0; step < 200; ++step) {
    WideMask positions;
    for (std::size_t w = 0; w < Words; ++w)
      positions.words[w] = random.one_in(5) ? ~0u : random.one_in(4) ? 0 : random.word() & random.word();
    const auto into = static_cast<std::uint32_t>(random.integer(0, (1 << Bits) - 1));
    states.put(positions, into);
    for (std::size_t p = 0; p < expected.size(); ++p)
      if (positions.test(p)) expected[p] = into;
    for (std::uint32_t state = 0; state < 1u << Bits; ++state) {
      const WideMask found = states.positions_in(state);
      for (std::size_t p = 0; p < expected.size(); ++p) ASSERT_EQ(found.test(p), expected[p] == state) << p;
      for (std::size_t w = 0; w < kMaxMaskWords; ++w) {
        std::array<std::uint32_t, Bits> planes{};
        if (w < Words)
          for (std::size_t b = 0; b < Bits; ++b) planes[b] = states.planes[b][w];
        ASSERT_EQ(found.words[w], w < Words ? word_in_state(planes, state) : 0) << w;
      }
    }
    for (std::size_t p = 0; p < expected.size(); ++p) ASSERT_EQ(states.at(p), expected[p]);
  }
}

TEST(PositionStates, AreWhatWasPutLast) {
  expect_states<1, 2>(203);
  expect_states<2, 3>(204);
  expect_states<4, 4>(205);
  expect_states<8, 3>(206);
  expect_states<8, 6>(207);
}

}  // namespace beampipe::owner_slot_test
