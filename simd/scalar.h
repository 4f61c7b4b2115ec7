// The functions that formulas use besides operators, for float and double. Formulas are templates: the same text is
// compiled for float, for counting numbers (stages/cost/counting.h) and for vectors (simd/lanes-inl.h), each of which
// has these functions too. A formula selects by data, as a vector must, so that it always costs the same number of
// operations. Only a formula with early-outs branches: any() asks whether any lane has work, and choose() is what a
// branch does, free of charge.
//
// Formulas stand in files simd/*-inl.h without include guards. A header includes them once in namespace `scalar`; a
// kernel includes them again in the namespace of each instruction set, because a compiler generates a function for the
// instruction set that is chosen where the function stands. `scalar` is a namespace of its own so that a formula on
// vectors does not find the formulas on numbers as well, through its arguments' types.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace beampipe {

inline float select(bool condition, float yes, float no) { return condition ? yes : no; }
inline float lesser(float a, float b) { return a < b ? a : b; }
inline float greater(float a, float b) { return a > b ? a : b; }
inline float magnitude(float a) { return std::fabs(a); }  // without a branch, which would be hard to predict
inline double magnitude(double a) { return std::fabs(a); }
inline std::uint32_t select(bool condition, std::uint32_t yes, std::uint32_t no) { return condition ? yes : no; }
inline std::int32_t select(bool condition, std::int32_t yes, std::int32_t no) { return condition ? yes : no; }
inline std::int32_t lesser(std::int32_t a, std::int32_t b) { return a < b ? a : b; }
inline std::int32_t greater(std::int32_t a, std::int32_t b) { return a > b ? a : b; }
inline std::int64_t lesser(std::int64_t a, std::int64_t b) { return a < b ? a : b; }
inline std::int64_t greater(std::int64_t a, std::int64_t b) { return a > b ? a : b; }
inline std::int64_t magnitude(std::int64_t a) { return a < 0 ? -a : a; }
inline std::uint32_t lesser(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
inline std::uint32_t greater(std::uint32_t a, std::uint32_t b) { return a > b ? a : b; }
inline double select(bool condition, double yes, double no) { return condition ? yes : no; }
inline double lesser(double a, double b) { return a < b ? a : b; }
inline double greater(double a, double b) { return a > b ? a : b; }
inline double square_root(double x) { return std::sqrt(x); }
inline float square_root(float x) { return std::sqrt(x); }
inline std::int32_t to_integer(float x) { return static_cast<std::int32_t>(x); }  // towards 0
inline std::uint32_t to_bits(float x) { return static_cast<std::uint32_t>(x); }   // towards 0; x >= 0
inline std::uint32_t bits_of(float x) { return std::bit_cast<std::uint32_t>(x); }
inline std::uint32_t bits_of(std::int32_t x) { return static_cast<std::uint32_t>(x); }
inline float float_of(std::uint32_t bits) { return std::bit_cast<float>(bits); }
inline std::uint32_t plain(std::uint32_t x) { return x; }  // a value that decides what is done next
inline float to_float(std::int32_t x) { return static_cast<float>(x); }
inline float to_float(std::int64_t x) { return static_cast<float>(x); }
inline float to_float(double x) { return static_cast<float>(x); }
inline float to_float(std::uint32_t x) { return static_cast<float>(x); }
inline double to_double(std::int64_t x) { return static_cast<double>(x); }
inline float converted(float x) { return x; }  // to another format of a surface; a counting number counts it
inline std::uint32_t fetch(const std::uint32_t* table, std::int32_t index) { return table[index]; }
inline std::int32_t low_word(std::int64_t x) { return static_cast<std::int32_t>(x); }
inline std::uint32_t sign_bit(std::int32_t x) { return static_cast<std::uint32_t>(x) >> 31; }
inline std::uint32_t sign_bit(std::int64_t x) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(x) >> 63);
}
template <class Int>
std::uint32_t shift_in_sign(std::uint32_t word, Int x) {
  return word << 1 | sign_bit(x);
}
inline float bit_count(std::uint32_t mask) { return static_cast<float>(std::popcount(mask)); }

inline bool any(bool condition) { return condition; }
inline bool has_bit(std::uint32_t mask, int bit) {
  return (mask >> bit & 1u) != 0;
}  // for a loop over the bits of a mask
template <class Value>
Value choose(bool condition, const Value& yes, const Value& no) {
  return condition ? yes : no;
}

}  // namespace beampipe
