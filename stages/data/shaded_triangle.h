// A triangle that a stage shades where it needs the colour, and not as a fragment.
#pragma once

#include <cstdint>

namespace beampipe {

struct ShadedTriangle {
  std::uint32_t triangle;  // index into SetupTriangles
};

}  // namespace beampipe
