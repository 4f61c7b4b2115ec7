#include "simd/window_owners.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::window_owners_test {

WideMask random_mask(Random& random, std::size_t words) {
  WideMask mask;
  for (std::size_t w = 0; w < words; ++w) {
    const auto bits = [&] { return static_cast<std::uint32_t>(random.integer(0, 0xffffffff)); };
    mask.words[w] = random.one_in(3) ? 0 : random.one_in(3) ? ~0u : random.one_in(2) ? bits() : bits() & bits();
  }
  return mask;
}

// Planes of all slopes. Many are equal, so that ties decide.
MaskedPlane random_fragment(Random& random, std::size_t words) {
  DepthPlane<float> plane{random.real32(-1, 0), 0, 0};
  if (random.one_in(3)) plane.z = -0.5f;
  if (!random.one_in(3)) plane.dzdu = random.real32(-2, 2), plane.dzdv = random.real32(-2, 2);
  return {random_mask(random, words), corner_plane(plane)};
}

void expect_twin(Random& random, int windows, const std::vector<float>& unusual_depths) {
  on_every_target([&] {
    for (int i = 0; i < windows; ++i) {
      const std::size_t words = std::size_t{1} << random.integer(0, 3);
      const std::vector<SamplePattern> patterns = cell_patterns(static_cast<int>(32 * words));
      std::vector<MaskedPlane> fragments;
      for (std::int64_t n = random.integer(1, random.one_in(8) ? 60 : 5); n > 0; --n)
        fragments.push_back(random_fragment(random, words));
      for (MaskedPlane& fragment : fragments)
        for (const float depth : unusual_depths)
          if (random.one_in(2)) fragment.plane.z = depth;
      const WideMask taken = random.one_in(2) ? WideMask{} : random_mask(random, words);
      std::vector<Ownership> found(fragments.size()), expected(fragments.size());
      const WindowCounts counts =
          window_owners(fragments.data(), fragments.size(), taken, patterns.data(), found.data());
      const WindowCounts twin =
          window_owners_scalar(fragments.data(), fragments.size(), taken, patterns.data(), expected.data());
      ASSERT_EQ(counts.taken, twin.taken);
      ASSERT_EQ(counts.tests, twin.tests);
      for (std::size_t k = 0; k < fragments.size(); ++k) {
        ASSERT_EQ(found[k].owned, expected[k].owned) << "window " << i << ", fragment " << k;
        ASSERT_EQ(found[k].covered, expected[k].covered);
        ASSERT_EQ(found[k].visible, expected[k].visible);
      }
    }
  });
}

TEST(WindowOwners, KernelEqualsTwin) {
  Random random(65);
  expect_twin(random, 1'500, {});
}

TEST(WindowOwners, KernelEqualsTwinWhereDepthsAreNotFinite) {
  Random random(67);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  expect_twin(random, 500, {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity});
}

// Every position that is covered and not taken has exactly one owner. Other positions have none.
TEST(WindowOwners, PartitionWhatIsOpen) {
  Random random(66);
  const std::vector<SamplePattern> patterns = cell_patterns(256);
  for (int i = 0; i < 2'000; ++i) {
    std::vector<MaskedPlane> fragments;
    WideMask covered;
    for (std::int64_t n = random.integer(1, 12); n > 0; --n) {
      fragments.push_back(random_fragment(random, 8));
      covered = covered | fragments.back().mask;
    }
    const WideMask taken = random_mask(random, 8);
    std::vector<Ownership> owners(fragments.size());
    window_owners(fragments.data(), fragments.size(), taken, patterns.data(), owners.data());
    WideMask all;
    for (std::size_t k = 0; k < owners.size(); ++k) {
      ASSERT_TRUE((all & owners[k].owned).none());
      ASSERT_TRUE(without(owners[k].owned, fragments[k].mask).none());
      all = all | owners[k].owned;
    }
    ASSERT_EQ(all, without(covered, taken));
  }
}

}  // namespace beampipe::window_owners_test
