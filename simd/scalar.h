// What the scalar twins are written with: functions that exist for float, for double and for counting numbers alike.
// A twin has no data-dependent branch: it selects, as a SIMD lane does, so that its operation count is a constant.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace beampipe {

inline float select(bool condition, float yes, float no) { return condition ? yes : no; }
inline float lesser(float a, float b) { return a < b ? a : b; }
inline float greater(float a, float b) { return a > b ? a : b; }
inline float magnitude(float a) { return a < 0 ? -a : a; }
inline double magnitude(double a) { return a < 0 ? -a : a; }
inline std::uint32_t select(bool condition, std::uint32_t yes, std::uint32_t no) { return condition ? yes : no; }
inline std::int32_t select(bool condition, std::int32_t yes, std::int32_t no) { return condition ? yes : no; }
inline double lesser(double a, double b) { return a < b ? a : b; }
inline double greater(double a, double b) { return a > b ? a : b; }
inline double square_root(double x) { return std::sqrt(x); }
inline std::int32_t to_integer(float x) { return static_cast<std::int32_t>(x); }  // towards 0
inline float to_float(std::int64_t x) { return static_cast<float>(x); }
inline float to_float(double x) { return static_cast<float>(x); }
inline double to_double(std::int64_t x) { return static_cast<double>(x); }
inline float converted(float x) { return x; }  // between formats of a surface, where it costs and rounds
inline std::uint32_t fetch(const std::uint32_t* table, std::int32_t index) { return table[index]; }
inline float bit_count(std::uint32_t mask) { return static_cast<float>(std::popcount(mask)); }

}  // namespace beampipe
