// The scalar twin of sample_select: quad by quad, on words that count.

#include "stages/samples/sample_select.h"
#include "tests/stages/sample_pixels.h"
#include "tests/stages/scene_twins.h"

namespace beampipe::select_twins_test {

using namespace twins;

class SelectTwins : public SceneTwins {
 protected:
  // Processes one quad: the materials of 32 samples, the samples inside the frame, and the quad's place.
  void select(const std::uint32_t (&ids)[32], std::uint32_t inside, int x, int y, const SelectOptions& options,
              std::uint32_t (&given)[4], int (&location)[4], std::vector<ExtraSample>& extras) {
    state_ = mixed(mixed(mixed(bits(options.seed)) ^ bits(static_cast<std::uint32_t>(x))) ^
                   bits(static_cast<std::uint32_t>(y)));
    Bits mask[4];
    for (int p = 0; p < 4; ++p) {
      location[p] = 8 * p + static_cast<int>(options.jitter);
      const bool is_inside = inside >> 8 * p & 1;
      mask[p] = same_material(ids, location[p]) & bits(is_inside ? inside : 0);
    }
    Bits missing = bits(inside) & ~(mask[0] | mask[1] | mask[2] | mask[3]);
    while (missing.value != 0 && extras.size() < options.room) {
      const int at = pick(missing);
      const Bits found = same_material(ids, at) & bits(inside);
      missing = missing & ~found;
      extras.push_back({0, found.value, static_cast<std::uint8_t>(at), {}});
    }
    while (missing.value != 0) {
      const Bits spare = shared(mask);
      if (spare.value == 0) break;
      const int slot = pick(spare);
      location[slot] = pick(missing);
      mask[slot] = same_material(ids, location[slot]) & bits(inside);
      missing = missing & ~mask[slot];
    }
    for (int i = 0; i < 4; ++i) {
      Bits alike(0u);
      for (int j = 0; j < 4; ++j) {
        const bool there = mask[i] != bits(0), equal = mask[i] == mask[j];
        alike = alike | bits(std::uint32_t{there && equal} << j);
      }
      if (lowest(alike) == integer(i)) share_out(alike.value, mask[i].value, location, given);
    }
  }

 private:
  Bits mixed(Bits x) {  // the last step of Murmur3
    x = x ^ (x >> 16), x = x * Bits(0x85ebca6bu);
    x = x ^ (x >> 13), x = x * Bits(0xc2b2ae35u);
    return x ^ (x >> 16);
  }

  Int lowest(const Bits& word) {
    ++twin_.bit;
    return integer(word.value == 0 ? -1 : std::countr_zero(word.value));
  }

  // One of the bits that are set: drops the lowest bits, as many as the random number says.
  int pick(Bits word) {
    state_ = mixed(state_ + bits(0x9e3779b9u));
    ++twin_.bit;  // the number of set bits
    const Bits skips = state_ % bits(static_cast<std::uint32_t>(std::popcount(word.value)));
    for (std::uint32_t skip = 0; skip < skips.value; ++skip) word = word & (word - Bits(1u));
    return static_cast<int>(lowest(word).value);
  }

  Bits same_material(const std::uint32_t (&ids)[32], int as) {
    Bits mask(0u);
    for (int s = 0; s < 32; ++s) {
      const bool equal = bits(ids[s]) == bits(ids[as]);
      mask = mask | bits(std::uint32_t{equal} << s);
    }
    return mask;
  }

  // Shading samples whose material has another shading sample.
  Bits shared(const Bits (&mask)[4]) {
    Bits slots(0u);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        if (i == j) continue;
        const bool there = mask[i] != bits(0), equal = mask[i] == mask[j];
        slots = slots | bits(std::uint32_t{there && equal} << i);
      }
    }
    return slots;
  }

  // A material's samples go to its shading sample at the same pixel or, if there is none, to any of its shading
  // samples.
  void share_out(std::uint32_t alike, std::uint32_t mask, const int (&location)[4], std::uint32_t (&given)[4]) {
    for (int pixel = 0; pixel < 4; ++pixel) {
      Bits here = bits(alike);
      for (int j = 0; j < 4; ++j) {
        const bool is_here =
            (bits(static_cast<std::uint32_t>(location[j])) >> 3) == bits(static_cast<std::uint32_t>(pixel));
        here = here & bits(is_here ? ~0u : ~(1u << j));
      }
      const Bits candidates = here != bits(0) ? here : bits(alike);
      ++twin_.bit;  // the test whether there is only one
      const bool one = std::has_single_bit(candidates.value);
      Bits left = bits(mask) & bits(0xffu << 8 * pixel);
      while (left.value != 0) {
        const Bits sample = left & (~left + Bits(1u));
        const int to = one ? static_cast<int>(lowest(candidates).value) : pick(candidates);
        given[to] = (bits(given[to]) | sample).value;
        left = left & (left - Bits(1u));
      }
    }
  }

  Bits state_;
};

TEST_P(SelectTwins, SampleSelect) {
  const Sampling sampling{CellGrid{}, standard_pattern(8)};
  const SampleTile surface = tested_samples(triangles_, tile_, sampling);
  std::vector<std::uint32_t> materials;
  for (const std::uint32_t triangle : list_) materials.push_back(triangle / 3);
  for (const std::uint32_t room : {0u, 3u}) {
    const SelectOptions options{.jitter = 5, .seed = 7, .room = room};
    StageCounters counters;
    const std::vector<SampleQuad> quads = sample_select(surface, tile_, materials, options, counters);
    ASSERT_EQ(quads.size(), tile_.pixels() / 4);
    twin_ = {};
    std::size_t all_extras = 0;
    for (std::size_t q = 0; q < quads.size(); ++q) {
      const int columns = tile_.width() / 2, x = static_cast<int>(q) % columns, y = static_cast<int>(q) / columns;
      std::uint32_t ids[32];
      for (int s = 0; s < 32; ++s) {
        const std::size_t pixel = tile_.index(2 * x + s / 8 % 2, 2 * y + s / 16);
        const std::uint32_t triangle = surface.triangle[8 * pixel + static_cast<std::size_t>(s % 8)];
        ids[s] = triangle == kNoTriangle ? kNoTriangle : materials[triangle];
      }
      std::uint32_t given[4] = {};
      int location[4];
      std::vector<ExtraSample> extras;
      select(ids, ~0u, x, y, options, given, location, extras);
      ASSERT_EQ(quads[q].extras.size(), extras.size()) << q;
      all_extras += extras.size();
      for (std::size_t i = 0; i < extras.size(); ++i) {
        ASSERT_EQ(quads[q].extras[i].mask, extras[i].mask) << q;
        ASSERT_EQ(quads[q].extras[i].location, extras[i].location) << q;
      }
      for (int p = 0; p < 4; ++p) {
        ASSERT_EQ(quads[q].mask[p], given[p]) << q;
        ASSERT_EQ(quads[q].location[p], location[p]) << q;
      }
    }
    EXPECT_EQ(counters.ops, twin_);
    EXPECT_EQ(counters.lanes_used, shaded_samples(quads));
    EXPECT_EQ(counters.lanes_issued, 4 * quads.size() + all_extras);
  }
}

BEAMPIPE_ON_EVERY_SCENE(SelectTwins);

}  // namespace beampipe::select_twins_test
