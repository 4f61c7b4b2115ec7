#include "simd/plane_order.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::plane_order_test {

// Planes that are steep, flat, equal, or one bit apart at the centre.
std::vector<DepthPlane<float>> hard_planes(Random& random) {
  std::vector<DepthPlane<float>> planes;
  for (int i = 0; i < 60; ++i) {
    const float slope = std::ldexp(1.0f, static_cast<int>(random.integer(-30, 6)));
    planes.push_back({random.real32(-1, 0), random.real32(-1, 1) * slope, random.real32(-1, 1) * slope});
    planes.push_back(planes.back());
    if (random.one_in(2)) planes.back().z = std::nextafter(planes.back().z, -2.0f);
    if (random.one_in(4)) planes.back().dzdu = planes.back().dzdv = 0;
  }
  return planes;
}

// A plane whose depth at every position is a multiple of 2^-18 with few enough bits that float arithmetic is exact.
struct IntegerPlane {
  std::int64_t z, dzdu, dzdv;  // times 2^-10

  DepthPlane<float> plane() const {
    const auto real = [](std::int64_t value) { return static_cast<float>(value) / 1024; };
    return {real(z), real(dzdu), real(dzdv)};
  }
  std::int64_t at(const SamplePattern& pattern, std::size_t s) const {  // times 2^-18; the centre is at 128
    return 256 * z + dzdu * (pattern.x[s] - 128) + dzdv * (pattern.y[s] - 128);
  }
};

// Calls body(patterns) for each of these numbers of positions, on every target.
template <class Body>
void for_positions(std::initializer_list<int> counts, Body&& body) {
  for (const int count : counts) {
    const std::vector<SamplePattern> patterns = cell_patterns(count);
    on_every_target([&] { body(patterns); });
  }
}

TEST(PlaneOrder, EqualsIntegerArithmetic) {
  Random random(63);
  const std::vector<SamplePattern> patterns = cell_patterns(256);
  int ties = 0;
  on_every_target([&] {
    for (int draw = 0; draw < 300; ++draw) {
      const auto slope = [&] { return random.integer(-8, 8) * random.integer(0, 100); };
      const IntegerPlane plane{random.integer(-1024, 0), slope(), slope()};
      IntegerPlane other{random.integer(-1024, 0), slope(), slope()};
      if (random.one_in(3)) other = {plane.z, plane.dzdv, plane.dzdu};  // they meet along a diagonal
      if (random.one_in(10)) other = plane;
      std::uint32_t masks[8];
      nearer_positions(plane.plane(), other.plane(), offsets_of(patterns).data(), patterns.size(), masks);
      for (std::size_t p = 0; p < 256; ++p) {
        const std::int64_t depth = plane.at(patterns[p / 32], p % 32), of_other = other.at(patterns[p / 32], p % 32);
        ASSERT_EQ(masks[p / 32] >> (p % 32) & 1, depth < of_other) << "draw " << draw << ", position " << p;
        ties += depth == of_other;
      }
    }
  });
  EXPECT_GT(ties, 100);
}

// Masks without positions, with all of them, with one, and random ones; a word may be empty while others are not.
std::vector<std::array<std::uint32_t, 8>> hard_masks(Random& random) {
  std::vector<std::array<std::uint32_t, 8>> masks(2);
  masks[1].fill(~0u);
  for (std::size_t position = 0; position < 256; position += 5) {
    masks.emplace_back();
    masks.back()[position / 32] = 1u << (position % 32);
  }
  for (int i = 0; i < 60; ++i) {
    masks.emplace_back();
    for (std::uint32_t& word : masks.back()) word = random.one_in(3) ? 0 : random.word();
  }
  return masks;
}

bool has(const std::array<std::uint32_t, 8>& mask, std::size_t position) {
  return mask[position / 32] >> (position % 32) & 1;
}

// At all positions, and at those of a mask alone.
TEST(PlaneOrder, NearerOnEveryTargetEqualsTheFormulaOnFloat) {
  Random random(61);
  const std::vector<DepthPlane<float>> planes = hard_planes(random);
  const std::vector<std::array<std::uint32_t, 8>> masks = hard_masks(random);
  for_positions({32, 128, 256}, [&](const std::vector<SamplePattern>& patterns) {
    for (std::size_t i = 1; i < planes.size(); ++i) {
      const std::array<std::uint32_t, 8>& where = masks[i % masks.size()];
      std::uint32_t all[8], some[8];
      std::fill(some, some + 8, ~0u);
      nearer_positions(planes[i], planes[i - 1], offsets_of(patterns).data(), patterns.size(), all);
      nearer_positions(planes[i], planes[i - 1], offsets_of(patterns).data(), patterns.size(), some, where.data());
      for (std::size_t w = 0; w < patterns.size(); ++w) {
        ASSERT_EQ(some[w], all[w] & where[w]) << i << " word " << w;
        for (std::size_t s = 0; s < 32; ++s)
          ASSERT_EQ(all[w] >> s & 1,
                    nearer_formula(planes[i], planes[i - 1], position_u(patterns[w], s), position_v(patterns[w], s)))
              << i << " position " << 32 * w + s;
      }
    }
  });
}

TEST(PlaneOrder, FarthestOnEveryTargetEqualsTheFormulaOnFloat) {
  Random random(64);
  const std::vector<DepthPlane<float>> planes = hard_planes(random);
  const std::vector<std::array<std::uint32_t, 8>> masks = hard_masks(random);
  for_positions({32, 64, 128, 256}, [&](const std::vector<SamplePattern>& patterns) {
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const std::array<std::uint32_t, 8>& mask = masks[i % masks.size()];
      float expected = kInFront;
      for (std::size_t p = 0; p < 32 * patterns.size(); ++p)
        expected = farthest_formula(planes[i], position_u(patterns[p / 32], p % 32),
                                    position_v(patterns[p / 32], p % 32), has(mask, p), expected);
      ASSERT_EQ(farthest_depth(planes[i], offsets_of(patterns).data(), patterns.size(), mask.data()), expected) << i;
    }
  });
}

TEST(PlaneOrder, FarthestEqualsIntegerArithmetic) {
  Random random(65);
  const std::vector<SamplePattern> patterns = cell_patterns(256);
  const std::vector<std::array<std::uint32_t, 8>> masks = hard_masks(random);
  on_every_target([&] {
    for (const auto& mask : masks) {
      const auto slope = [&] { return random.integer(-8, 8) * random.integer(0, 100); };
      const IntegerPlane plane{random.integer(-1024, 0), slope(), slope()};
      bool any = false;
      std::int64_t farthest = 0;
      for (std::size_t p = 0; p < 256; ++p) {
        if (!has(mask, p)) continue;
        const std::int64_t depth = plane.at(patterns[p / 32], p % 32);
        farthest = any ? std::max(farthest, depth) : depth;
        any = true;
      }
      // Depths of these planes may be in front of everything that is visible, but an owner's are not.
      const float expected = any ? std::max(kInFront, static_cast<float>(farthest) / (1 << 18)) : kInFront;
      ASSERT_EQ(farthest_depth(plane.plane(), offsets_of(patterns).data(), patterns.size(), mask.data()), expected);
    }
  });
}

TEST(PlaneOrder, PositionSumsAreSumsOfIntegers) {
  Random random(66);
  const std::vector<std::array<std::uint32_t, 8>> masks = hard_masks(random);
  for_positions({32, 64, 128, 256}, [&](const std::vector<SamplePattern>& patterns) {
    for (std::size_t i = 0; i < masks.size(); ++i) {
      std::int32_t x = 0, y = 0, xx = 0, xy = 0, yy = 0;
      for (std::size_t p = 0; p < 32 * patterns.size(); ++p) {
        if (!has(masks[i], p)) continue;
        const std::int32_t px = patterns[p / 32].x[p % 32], py = patterns[p / 32].y[p % 32];
        x += px, y += py, xx += px * px, xy += px * py, yy += py * py;
      }
      const PositionSums sums = position_sums(patterns.data(), patterns.size(), masks[i].data());
      ASSERT_EQ(sums.x, x) << i;
      ASSERT_EQ(sums.y, y) << i;
      const PositionSquares squares = position_squares(patterns.data(), patterns.size(), masks[i].data());
      ASSERT_EQ(squares.xx, xx) << i;
      ASSERT_EQ(squares.xy, xy) << i;
      ASSERT_EQ(squares.yy, yy) << i;
    }
  });
}

}  // namespace beampipe::plane_order_test
