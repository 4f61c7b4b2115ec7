// Random numbers for property tests: the same from the same seed on every machine (SplitMix64, Steele et al. 2014).
#pragma once

#include "tests/test.h"

namespace beampipe {

class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed), state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint32_t word() { return static_cast<std::uint32_t>(bits() >> 32); }
  std::int64_t integer(std::int64_t low, std::int64_t high) {  // from low to high, both included
    return low + static_cast<std::int64_t>(bits() % static_cast<std::uint64_t>(high - low + 1));
  }
  std::int32_t int32(std::int32_t low, std::int32_t high) { return static_cast<std::int32_t>(integer(low, high)); }
  double real(double low, double high) { return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1.0p-53); }
  float real32(double low, double high) { return static_cast<float>(real(low, high)); }
  bool one_in(std::int64_t n) { return integer(1, n) == 1; }
  template <class Values>
  auto pick(const Values& values) {
    return values[static_cast<std::size_t>(integer(0, static_cast<std::int64_t>(std::size(values)) - 1))];
  }

  template <class Values>
  void shuffle(Values& values) {
    for (std::size_t i = values.size(); i > 1; --i)
      std::swap(values[i - 1], values[static_cast<std::size_t>(integer(0, static_cast<std::int64_t>(i) - 1))]);
  }

  std::string name() const { return "seed " + std::to_string(seed_); }

 private:
  std::uint64_t seed_, state_;
  testing::ScopedTrace named_in_failures_{__FILE__, __LINE__, name()};
};

}  // namespace beampipe
