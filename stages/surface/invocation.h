// Where fragment shaders are called.
#pragma once

#include <cstdint>

namespace beampipe {

// The part of a pixel that a colour stands for, as a parallelogram: its sides are (xx, xy) and (0, yy), in pixels to
// the right and down.
struct Footprint {
  float xx = 1, xy = 0, yy = 1;

  Footprint() = default;
  Footprint(float side) : xx(side), yy(side) {}  // a square
  Footprint(float right, float down, float height) : xx(right), xy(down), yy(height) {}
};

// A point in a pixel of the frame.
struct ShadingPlace {
  std::int32_t x = 0, y = 0;  // the pixel
  float u = 0.5f, v = 0.5f;   // in it: from its upper left corner, 0..1
};

// One call of a fragment shader.
struct Invocation {
  std::uint32_t triangle;
  ShadingPlace place;
  Footprint footprint{};
};

}  // namespace beampipe
