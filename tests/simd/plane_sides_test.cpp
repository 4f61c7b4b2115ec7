#include "simd/plane_gap.h"
#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/simd/plane_sides_test.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/plane_sides-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

template <std::size_t kCount>
std::uint64_t sides_of(const DepthPlane<float>& plane, const DepthPlane<const float*>& surfaces,
                       std::uint64_t& nearer) {
  const PlaneSides<kCount> sides = plane_sides<kCount>(plane, surfaces);
  nearer = sides.nearer;
  return sides.crossing;
}
std::uint64_t sides_of_2(const DepthPlane<float>& plane, const DepthPlane<const float*>& surfaces,
                         std::uint64_t& nearer) {
  return sides_of<2>(plane, surfaces, nearer);
}
std::uint64_t sides_of_5(const DepthPlane<float>& plane, const DepthPlane<const float*>& surfaces,
                         std::uint64_t& nearer) {
  return sides_of<5>(plane, surfaces, nearer);
}
std::uint64_t sides_of_32(const DepthPlane<float>& plane, const DepthPlane<const float*>& surfaces,
                          std::uint64_t& nearer) {
  return sides_of<32>(plane, surfaces, nearer);
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
namespace {

HWY_EXPORT(sides_of_2);
HWY_EXPORT(sides_of_5);
HWY_EXPORT(sides_of_32);

// Planes that are far apart, cross, touch at a corner of the pixel, or are equal; zeros of either sign.
DepthPlane<float> other_plane(Random& random, const DepthPlane<float>& plane) {
  const float slope = std::ldexp(1.0f, random.int32(-30, 6));
  DepthPlane<float> other{random.real32(-1, 0), random.real32(-1, 1) * slope, random.real32(-1, 1) * slope};
  if (random.one_in(4)) return plane;
  if (random.one_in(4)) other.z = plane.z;
  if (random.one_in(4)) other = {plane.z + (random.one_in(2) ? 0.25f : -0.25f), plane.dzdu + 0.5f, plane.dzdv};
  if (random.one_in(8)) other.dzdu = other.dzdv = -0.0f;
  return other;
}

template <std::size_t kCount, class Kernel>
void expect_scalar_twin(std::uint64_t seed, const Kernel& kernel) {
  Random random(seed);
  int nearer_in_all = 0, farther_in_all = 0, crossing_in_all = 0;
  for (int draw = 0; draw < 2'000; ++draw) {
    DepthPlane<float> plane = other_plane(random, {-0.5f, 0, 0});
    if (random.one_in(4)) plane.z = std::round(plane.z * 4) / 4, plane.dzdu = 0;  // sums that are exact
    float z[2 * kCount] = {}, dzdu[2 * kCount] = {}, dzdv[2 * kCount] = {};
    for (std::size_t i = 0; i < kCount; ++i) {
      const DepthPlane<float> other = other_plane(random, plane);
      z[i] = other.z, dzdu[i] = other.dzdu, dzdv[i] = other.dzdv;
    }
    std::uint64_t nearer;
    const std::uint64_t crossing = kernel(plane, DepthPlane<const float*>{z, dzdu, dzdv}, nearer);
    for (std::size_t i = 0; i < kCount; ++i) {
      const PlaneGap<float> gap = plane_gap(plane, DepthPlane<float>{z[i], dzdu[i], dzdv[i]});
      ASSERT_EQ(nearer >> i & 1, is_nearer(gap)) << draw;
      ASSERT_EQ(crossing >> i & 1, !is_nearer(gap) && !is_farther(gap)) << draw;
      nearer_in_all += is_nearer(gap), farther_in_all += is_farther(gap), crossing_in_all += crossing >> i & 1;
    }
  }
  for (const int seen : {nearer_in_all, farther_in_all, crossing_in_all}) EXPECT_GT(seen, 200);
}

TEST(PlaneSides, AreThoseOfTheFormulaOnEveryTarget) {
  on_every_target([] {
    expect_scalar_twin<2>(81, HWY_DYNAMIC_DISPATCH(sides_of_2));
    expect_scalar_twin<5>(82, HWY_DYNAMIC_DISPATCH(sides_of_5));
    expect_scalar_twin<32>(83, HWY_DYNAMIC_DISPATCH(sides_of_32));
  });
}

}  // namespace
}  // namespace beampipe
#endif
