#include "tools/evaluate/planes.h"

#include <algorithm>

namespace beampipe {
namespace {

// sums[x] += weight * values[x]
template <class T>
void add_row(T weight, const T* values, std::uint32_t width, T* sums) {
  for (std::uint32_t x = 0; x < width; ++x) sums[x] += weight * values[x];
}

// Row y of the plane, filtered along it. `padded` has room for it and the pixels beyond its ends.
template <class T>
void filter_row(const Plane<T>& plane, std::size_t y, const std::vector<T>& weights, std::vector<T>& padded, T* sums) {
  const T* const first = plane.values.data() + y * plane.width;
  const auto radius = static_cast<std::ptrdiff_t>(weights.size() / 2);
  std::fill_n(padded.begin(), radius, first[0]);
  std::fill(std::copy_n(first, plane.width, padded.begin() + radius), padded.end(), first[plane.width - 1]);
  std::fill_n(sums, plane.width, T{0});
  for (std::size_t k = 0; k < weights.size(); ++k) add_row(weights[k], padded.data() + k, plane.width, sums);
}

}  // namespace

template <class T>
Plane<T> filtered(const Plane<T>& plane, const std::vector<T>& rows, const std::vector<T>& columns) {
  Plane<T> result{plane.width, plane.height, std::vector<T>(plane.values.size())};
  const auto radius = static_cast<std::int64_t>(columns.size() / 2), last = std::int64_t{plane.height} - 1;
  std::vector<T> padded(plane.width + rows.size() - 1);
  std::vector<T> ring(columns.size() * plane.width);  // filtered rows; that of y is at y modulo their number
  const auto in_ring = [&](std::int64_t y) {
    return ring.data() + static_cast<std::size_t>(y) % columns.size() * plane.width;
  };
  std::int64_t finished = 0;  // rows that have been filtered
  for (std::int64_t y = 0; y <= last; ++y) {
    for (; finished <= std::min(y + radius, last); ++finished)
      filter_row(plane, static_cast<std::size_t>(finished), rows, padded, in_ring(finished));
    T* const sums = result.values.data() + y * plane.width;
    for (std::size_t k = 0; k < columns.size(); ++k)
      add_row(columns[k], in_ring(std::clamp<std::int64_t>(y + static_cast<std::int64_t>(k) - radius, 0, last)),
              plane.width, sums);
  }
  return result;
}

template Plane<float> filtered(const Plane<float>&, const std::vector<float>&, const std::vector<float>&);
template Plane<double> filtered(const Plane<double>&, const std::vector<double>&, const std::vector<double>&);

}  // namespace beampipe
