// Maps of two pictures in bands of rows, which need little memory and may be worked on at the same time.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pipeline/technique.h"
#include "tools/evaluate/metrics.h"

namespace beampipe {

// The rows first..last - 1.
inline Image rows_of(const Image& image, std::uint32_t first, std::uint32_t last) {
  const auto row = [&](std::uint32_t y) { return image.rgba.begin() + std::ptrdiff_t{4} * image.width * y; };
  return {image.width, last - first, {row(first), row(last)}};
}

// `map` gives a T for each pixel of two pictures, which depends on pixels at most `radius` rows away. Throws
// std::invalid_argument if the sizes differ.
template <class T, class Map>
std::vector<T> map_in_bands(const Image& image, const Image& reference, std::uint32_t radius, Map map) {
  require_same_size(image, reference);
  constexpr std::uint32_t kRows = 64;
  std::vector<T> values(image.rgba.size() / 4);
  tbb::parallel_for(0u, (image.height + kRows - 1) / kRows, [&](std::uint32_t number) {
    const std::uint32_t y = number * kRows, end = std::min(y + kRows, image.height);
    const std::uint32_t first = y - std::min(y, radius), last = std::min(end + radius, image.height);
    const std::vector<T> band = map(rows_of(image, first, last), rows_of(reference, first, last));
    const auto begin = band.begin() + std::ptrdiff_t{image.width} * (y - first);
    std::copy_n(begin, std::size_t{image.width} * (end - y), values.begin() + std::ptrdiff_t{image.width} * y);
  });
  return values;
}

}  // namespace beampipe
