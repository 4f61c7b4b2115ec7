// What the scalar twins are written with: functions that exist for float, for double and for counting numbers alike.
// A twin has no data-dependent branch: it selects, as a SIMD lane does, so that its operation count is a constant.
#pragma once

#include <bit>
#include <cstdint>

namespace beampipe {

inline float select(bool condition, float yes, float no) { return condition ? yes : no; }
inline float lesser(float a, float b) { return a < b ? a : b; }
inline float greater(float a, float b) { return a > b ? a : b; }
inline float magnitude(float a) { return a < 0 ? -a : a; }
inline std::uint32_t select(bool condition, std::uint32_t yes, std::uint32_t no) { return condition ? yes : no; }
inline float bit_count(std::uint32_t mask) { return static_cast<float>(std::popcount(mask)); }

}  // namespace beampipe
