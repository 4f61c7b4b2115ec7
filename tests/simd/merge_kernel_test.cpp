#include "tests/simd/every_target.h"
#include "tests/simd/merge_cases.h"

namespace beampipe::merge_kernel_test {

using Bits = std::array<std::uint32_t, sizeof(Aggregate) / sizeof(std::uint32_t)>;
using StepBits = std::array<std::uint32_t, sizeof(MergeSteps) / sizeof(std::uint32_t)>;

// Aggregates of up to eight fragments, so that slabs are thick and alphas reach 1.
TEST(MergeKernel, EveryTargetEqualsTheFormulaOnChains) {
  const MergePositions positions(hammersley_pattern());
  const std::vector<MergeRules> every_rule = every_merge_rule();
  on_every_target([&] {
    Random random(41);
    for (std::size_t rule = 0; rule < every_rule.size(); ++rule) {
      std::vector<Aggregate> aggregates(1'003, kEmptyAggregate);
      std::vector<MergeFragment> fragments(aggregates.size());
      for (int round = 0; round < 8; ++round) {
        for (MergeFragment& fragment : fragments) fragment = random_fragment(random);
        std::vector<Aggregate> expected;
        std::vector<MergeSteps> steps(fragments.size()), expected_steps(fragments.size());
        for (std::size_t i = 0; i < fragments.size(); ++i)
          expected.push_back(
              merge_formula(fragments[i], aggregates[i], positions, every_rule[rule], expected_steps[i]));
        merge(fragments.data(), fragments.size(), positions, every_rule[rule], aggregates.data(), steps.data());
        for (std::size_t i = 0; i < aggregates.size(); ++i) {
          ASSERT_EQ(std::bit_cast<StepBits>(steps[i]), std::bit_cast<StepBits>(expected_steps[i]))
              << "rule " << rule << ", pixel " << i << ", round " << round;
          ASSERT_EQ(std::bit_cast<Bits>(aggregates[i]), std::bit_cast<Bits>(expected[i]))
              << "rule " << rule << ", pixel " << i << ", round " << round;
        }
      }
    }
  });
}

TEST(MergeKernel, EveryTargetEqualsTheFormulaForEveryBatchSize) {
  const MergePositions positions(hammersley_pattern());
  Random random(42);
  std::vector<MergeFragment> fragments(20);
  for (MergeFragment& fragment : fragments) fragment = random_fragment(random);
  const Aggregate old = random_fragment(random).surface;
  on_every_target([&] {
    for (std::size_t count = 0; count <= fragments.size(); ++count) {
      std::vector<Aggregate> aggregates(fragments.size(), old);
      std::vector<MergeSteps> steps(fragments.size());
      merge(fragments.data(), count, positions, {}, aggregates.data(), steps.data());
      for (std::size_t i = 0; i < aggregates.size(); ++i) {
        const Aggregate expected = i < count ? merge_formula(fragments[i], old, positions, {}) : old;
        ASSERT_EQ(std::bit_cast<Bits>(aggregates[i]), std::bit_cast<Bits>(expected)) << i << " of " << count;
      }
    }
  });
}

}  // namespace beampipe::merge_kernel_test
