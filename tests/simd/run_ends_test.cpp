#include "simd/run_ends.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::run_ends_test {

TEST(RunEnds, AreWhereTheNextValueDiffers) {
  Random random(11);
  on_every_target([&] {
    for (int i = 0; i < 300; ++i) {
      const auto count = static_cast<std::size_t>(random.integer(1, 300));
      std::vector<std::uint32_t> values((count + kRunWord - 1) / kRunWord * kRunWord + 1);
      std::uint32_t value = 0;
      for (std::uint32_t& each : values) each = value = random.one_in(3) ? random.word() : value;
      std::vector<std::uint64_t> words(values.size() / kRunWord);
      mark_run_ends(values.data(), count, words.data());
      for (std::size_t s = 0; s < count; ++s)
        ASSERT_EQ(words[s / kRunWord] >> s % kRunWord & 1, values[s] != values[s + 1]) << s << " of " << count;
    }
  });
}

}  // namespace beampipe::run_ends_test
