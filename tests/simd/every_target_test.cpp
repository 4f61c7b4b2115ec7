#include "tests/simd/every_target.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/simd/every_target_test.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

std::int64_t own_target() { return HWY_TARGET; }

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
namespace {

HWY_EXPORT(own_target);

// If the helper did not change the dispatch, every comparison of kernels would test one target only.
TEST(EveryTarget, DispatchesToEachSupportedTargetInTurnAndThenToTheBest) {
  const std::int64_t best = HWY_DYNAMIC_DISPATCH(own_target)();
  std::set<std::int64_t> seen;
  on_every_target([&] { seen.insert(HWY_DYNAMIC_DISPATCH(own_target)()); });
  hwy::SetSupportedTargetsForTest(0);  // a test before this one may have chosen a target
  const auto targets = hwy::SupportedAndGeneratedTargets();
  use_simd_target(simd_targets().front());
  EXPECT_EQ(seen, std::set<std::int64_t>(targets.begin(), targets.end()));
  EXPECT_EQ(HWY_DYNAMIC_DISPATCH(own_target)(), best);
}

TEST(EveryTarget, IsNamedWhileItIsInUse) {
  std::vector<std::string> used;
  on_every_target([&] { used.push_back(simd_target()); });
  EXPECT_EQ(used, simd_targets());
  EXPECT_THROW(use_simd_target("abacus"), std::invalid_argument);
  EXPECT_EQ(simd_target(), used.front());
}

}  // namespace
}  // namespace beampipe
#endif
