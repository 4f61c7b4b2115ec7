// The encoding of colours in images (IEC 61966-2-1).
#pragma once

#include <cmath>

namespace beampipe {

// Linear light of an encoded value; both 0..1.
inline double linear_of_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

// The encoded value of linear light; both from 0 on.
inline double encoded_as_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

}  // namespace beampipe
