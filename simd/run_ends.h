// Where runs of equal values end.
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

inline constexpr std::size_t kRunWord = 64;  // values per word of bits

// Bit s of the words, lowest first: value s differs from value s + 1. Sets the words of `count` values. As many values
// as fill the last word, and one more, must be readable; what they are decides the bits from value count - 1 on.
void mark_run_ends(const std::uint32_t* values, std::size_t count, std::uint64_t* words);

}  // namespace beampipe
