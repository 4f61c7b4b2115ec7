#include "stages/data/casav_aggregate.h"

#include "tests/simd/merge_cases.h"

namespace beampipe::casav_aggregate_test {

Aggregate aggregate_of(float dzdu, float dzdv, float thickness) {
  return {.alpha = 0.3f,
          .mask = 0x1234u,
          .plane = {-0.5f, dzdu, dzdv},
          .thickness = thickness,
          .z_min = -0.6f,
          .z_max = -0.4f,
          .color = {0.1f, 0.2f, 0.3f}};
}

TEST(CasavStorage, SlidesKeepAllButTheColour) {
  const Aggregate a = aggregate_of(1e-9f, -2e-3f, 0.001f);
  Aggregate b = SlidesAggregate(a);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(b.color[c], a.color[c], a.color[c] / 2048);
  std::copy_n(a.color, 3, b.color);
  EXPECT_EQ(b.mask, a.mask);
  EXPECT_EQ(numbers_of(b), numbers_of(a));
}

TEST(CasavStorage, TheTextsSizeRoundsSlopesAndThicknessToEightBits) {
  Random random(64);
  for (int i = 0; i < 10000; ++i) {
    const auto slope = [&] {
      return random.real32(-1, 1) * std::ldexp(1.0f, static_cast<int>(random.integer(-40, 3)));
    };
    const float dzdu = slope(), dzdv = slope();
    const Aggregate a = aggregate_of(dzdu, dzdv, std::abs(slope()));
    const Aggregate b = TextAggregate(a);
    EXPECT_EQ(b.alpha, a.alpha);
    EXPECT_EQ(b.plane.z, a.plane.z);
    EXPECT_NEAR(b.plane.dzdu, a.plane.dzdu, std::abs(a.plane.dzdu) / 256);
    EXPECT_NEAR(b.plane.dzdv, a.plane.dzdv, std::abs(a.plane.dzdv) / 256);
    EXPECT_NEAR(b.thickness, a.thickness, a.thickness / 256);
    EXPECT_EQ(b.z_max, a.z_max);
  }
}

TEST(CasavStorage, EmptyStaysEmpty) {
  for (const Aggregate& empty :
       {Aggregate(SlidesAggregate(kEmptyAggregate)), Aggregate(TextAggregate(kEmptyAggregate))}) {
    EXPECT_EQ(empty.alpha, 0.0f);
    EXPECT_EQ(empty.mask, 0u);
    EXPECT_GT(empty.z_min, empty.z_max);
  }
}

}  // namespace beampipe::casav_aggregate_test
