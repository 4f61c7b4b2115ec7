// Pictures of one number per pixel, and filters on them that are products of rows and columns.
#pragma once

#include <cstdint>
#include <vector>

namespace beampipe {

template <class T>
struct Plane {
  std::uint32_t width = 0, height = 0;
  std::vector<T> values;  // row 0 on top
};

// At each pixel, the sum of rows[j] columns[k] times the pixel j - r to the right and k - r below, where there are 2 r
// + 1 weights of each. Beyond the edge, the nearest pixel counts. The sums of rows come first; all run from the first
// weight up. T is float or double.
template <class T>
Plane<T> filtered(const Plane<T>& plane, const std::vector<T>& rows, const std::vector<T>& columns);

}  // namespace beampipe
