// A colour in four bytes: three mantissas and one exponent (Ward 1991, "Real Pixels").
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace beampipe {

struct SharedExponent {
  std::uint8_t mantissa[3] = {}, exponent = 0;  // exponent 0: black

  SharedExponent() = default;

  // `color`: linear RGB; negative channels become 0. The error of a channel is at most 1/127 of the largest channel.
  // `threshold`, above 0 and up to 1: the part of a step above it counts as a whole step. If it differs from case to
  // case, a colour that is changed a little many times is right on average.
  SharedExponent(const glm::vec3& color, float threshold) {
    const float largest = std::max({color[0], color[1], color[2]});
    if (!(largest > 0x1p-100f)) return;
    int power = 0;
    std::frexp(largest * (1 + 0x1p-8f), &power);  // what would be rounded up to 256 takes the next exponent
    power = std::min(power, 127);
    for (int c = 0; c < 3; ++c)
      mantissa[c] =
          static_cast<std::uint8_t>(std::clamp(std::ldexp(color[c], 8 - power) + 1.0f - threshold, 0.0f, 255.0f));
    exponent = static_cast<std::uint8_t>(power + 128);
  }

  operator glm::vec3() const {
    if (exponent == 0) return glm::vec3(0.0f);
    const float unit = std::ldexp(1.0f, exponent - 128 - 8);
    return unit * glm::vec3(mantissa[0], mantissa[1], mantissa[2]);
  }
};
static_assert(sizeof(SharedExponent) == 4);

}  // namespace beampipe
