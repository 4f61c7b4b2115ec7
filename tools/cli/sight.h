// What a camera sees, as a small picture of depths: where to stand in a model is decided by it.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

// What is seen first in a pixel.
struct FirstSurface {
  double depth = std::numeric_limits<double>::infinity();  // from the eye along the line of sight; infinite: nothing
  glm::dvec3 point{0.0};                                   // where it is, in world space
  bool is_back = false;                                    // it shows its back
};

struct Sight {
  std::vector<FirstSurface> pixels;  // at their centres, row 0 on top
  std::uint64_t triangles = 0;       // whose middle is in the picture, and hidden by no other surface in its pixel
};

// Of a picture of width x height pixels. Sides that a draw culls are not seen; the camera's near and far planes hide
// nothing.
Sight sight_from(const Trace& trace, const Frame& frame, const Camera& camera, std::uint32_t width,
                 std::uint32_t height);

}  // namespace beampipe
