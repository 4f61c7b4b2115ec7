// What a pixel is in the framebuffer and in the buffers between stages: PixelColor, and sizes in the modelled machine.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace beampipe {

// The part of an aggregate that the resolve stage needs.
struct PixelColor {
  float alpha;      // covered area, 0..1
  glm::vec3 color;  // linear RGB times alpha
};

inline constexpr std::uint32_t kColorBytes = 3 * 2;  // fp16 RGB

// Deferred shading. The G-buffer holds what lighting needs here: Kd as RGBA8 and the normal as RGB10A2. A visibility id
// holds the numbers of a triangle and a draw in 32 bits.
inline constexpr std::uint32_t kGBufferBytes = 8;
inline constexpr std::uint32_t kVisibilityBytes = 4;

}  // namespace beampipe
