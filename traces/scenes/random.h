// Random numbers that are the same on every machine. Those of the standard library's distributions are not. Use one call
// of these functions in an expression: compilers choose the order in which they evaluate arguments and operands.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace beampipe {

// SplitMix64's output function: every input bit changes about half of the output bits.
inline std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() { return mix_bits(state_ += 0x9e3779b97f4a7c15u); }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }  // 0 <= x < 1
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  // A point in a box. Its last coordinate is drawn first.
  glm::dvec3 uniform(const glm::dvec3& low, const glm::dvec3& high) {
    glm::dvec3 result;
    for (int i = 2; i >= 0; --i) result[i] = uniform(low[i], high[i]);
    return result;
  }

  glm::dvec3 direction() {
    const double z = uniform(-1, 1), angle = uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  // Makes `color` darker or brighter, and changes each channel a little.
  glm::vec3 vary(const glm::vec3& color, double amount) {
    const double all = uniform(1 - amount, 1 + amount);
    glm::vec3 result;
    for (int i = 0; i < 3; ++i) {
      result[i] = static_cast<float>(color[i] * all * uniform(1 - 0.4 * amount, 1 + 0.4 * amount));
    }
    return result;
  }

 private:
  std::uint64_t state_;
};

}  // namespace beampipe
