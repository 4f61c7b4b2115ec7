// Localization masks of up to 256 bits, in words of 32: bit s of word w belongs to position s of pattern w.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace beampipe {

inline constexpr std::size_t kMaxMaskWords = 8;

struct WideMask {
  std::array<std::uint32_t, kMaxMaskWords> words{};

  int count() const {
    // Counts the bits of all bytes in parallel: the baseline instruction set has no population count.
    std::uint64_t bytes = 0;
    for (std::size_t i = 0; i < kMaxMaskWords; i += 2) {
      std::uint64_t x = words[i] | std::uint64_t{words[i + 1]} << 32;
      x -= x >> 1 & 0x5555555555555555u;
      x = (x & 0x3333333333333333u) + (x >> 2 & 0x3333333333333333u);
      bytes += (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fu;
    }
    const std::uint64_t pairs = (bytes & 0x00ff00ff00ff00ffu) + (bytes >> 8 & 0x00ff00ff00ff00ffu);
    return static_cast<int>(pairs * 0x0001000100010001u >> 48);
  }
  bool none() const {
    std::uint32_t any = 0;
    for (const std::uint32_t word : words) any |= word;
    return any == 0;
  }
  bool test(std::size_t bit) const { return words[bit / 32] >> (bit % 32) & 1; }
  void set(std::size_t bit) { words[bit / 32] |= 1u << (bit % 32); }
  bool operator==(const WideMask&) const = default;
};

// All bits of the first words.
constexpr WideMask first_words(std::size_t words) {
  WideMask mask;
  for (std::size_t i = 0; i < words; ++i) mask.words[i] = ~0u;
  return mask;
}

template <class Combine>
WideMask combine(const WideMask& a, const WideMask& b, Combine&& word) {
  WideMask result;
  for (std::size_t i = 0; i < kMaxMaskWords; ++i) result.words[i] = word(a.words[i], b.words[i]);
  return result;
}
inline WideMask operator|(const WideMask& a, const WideMask& b) {
  return combine(a, b, [](std::uint32_t x, std::uint32_t y) { return x | y; });
}
inline WideMask operator&(const WideMask& a, const WideMask& b) {
  return combine(a, b, [](std::uint32_t x, std::uint32_t y) { return x & y; });
}
inline WideMask without(const WideMask& a, const WideMask& b) {  // a & ~b
  return combine(a, b, [](std::uint32_t x, std::uint32_t y) { return x & ~y; });
}

}  // namespace beampipe
