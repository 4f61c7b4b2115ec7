#include "stages/raster/bin_sort.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "simd/prefetch.h"
#include "stages/data/pixel_depth.h"
#include "stages/raster/bin_sort_cost.h"

namespace beampipe {
namespace {

constexpr int kDroppedBits = 7;                 // of a float's 31 bits without its sign
constexpr std::uint32_t kKeyOfZero = 1u << 23;  // the far plane; magnitudes up to 2 have 23 bits
constexpr std::uint32_t kLastKey = (1u << 24) - 1;

struct Entry {
  std::uint32_t key, place;  // place: in the list
};

// By key_of(triangle). The triangles of a bin are close to each other, so the upper digits of most keys are equal.
template <class KeyOf>
std::vector<Entry> sorted(const SetupTriangles& triangles, const TriangleList& list, KeyOf&& key_of) {
  std::vector<Entry> entries(list.size()), other(list.size());
  constexpr std::size_t kAhead = 12;  // triangles
  std::uint32_t least = list.empty() ? 0 : kLastKey, most = 0;
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    if (i + kAhead < list.size()) prefetch(triangles.triangles[list[i + kAhead]]);
    entries[i] = {key_of(triangles.triangles[list[i]]), i};
    least = std::min(least, entries[i].key), most = std::max(most, entries[i].key);
  }
  constexpr int kDigitBits = 8;
  constexpr std::uint32_t kDigits = 1u << kDigitBits;
  for (int shift = 0; (most - least) >> shift != 0; shift += kDigitBits) {
    const auto digit_of = [&](const Entry& entry) { return (entry.key - least) >> shift & (kDigits - 1); };
    std::uint32_t first[kDigits + 1] = {};
    for (const Entry& entry : entries) ++first[digit_of(entry) + 1];
    for (std::uint32_t digit = 0; digit < kDigits; ++digit) first[digit + 1] += first[digit];
    for (const Entry& entry : entries) other[first[digit_of(entry)]++] = entry;
    entries.swap(other);
  }
  return entries;
}

// The nearest depth of the triangle in the tile, as pair_bounds for a pixel. Both round, so this one has a margin:
// eight roundings of the largest sum that can occur. Without it, one triangle in a thousand is nearer by a rounding
// error.
float nearest_in(const SetupTriangle& triangle, const Tile& tile) {
  constexpr float kRounding = 0x1p-21f;
  const float width = static_cast<float>(tile.width()), height = static_cast<float>(tile.height());
  DepthPlane<float> plane{static_cast<float>(triangle.depth.at(0.5 * (tile.x0 + tile.x1), 0.5 * (tile.y0 + tile.y1))),
                          width * static_cast<float>(triangle.depth.dzdx),
                          height * static_cast<float>(triangle.depth.dzdy)};
  plane.z -= kRounding * (magnitude(plane.z) + magnitude(plane.dzdu) + magnitude(plane.dzdv));
  return pair_bounds(plane, vertex_bounds(triangle.vertex_z)).nearest;
}

}  // namespace

// Floats of one sign are in the order of their bits. Cutting off bits of a magnitude rounds it down. For depths below 0
// that is away from the viewer, so their keys are taken from the magnitude rounded up.
std::uint32_t sort_key(float depth) {
  const std::uint32_t magnitude = std::bit_cast<std::uint32_t>(std::abs(depth));  // not -0
  if (depth > 0) return kKeyOfZero + std::min(magnitude >> kDroppedBits, kKeyOfZero - 1);
  const std::uint32_t kept = (magnitude + (1u << kDroppedBits) - 1) >> kDroppedBits;
  return kKeyOfZero - std::min(kept, kKeyOfZero);
}

float nearest_of(std::uint32_t key) {
  if (key > kKeyOfZero) return std::bit_cast<float>((key - kKeyOfZero) << kDroppedBits);
  return -std::bit_cast<float>((kKeyOfZero - key) << kDroppedBits);
}

OrderedList bin_sort(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                     StageCounters& counters) {
  const std::vector<Entry> entries =
      sorted(triangles, list, [&](const SetupTriangle& triangle) { return sort_key(nearest_in(triangle, tile)); });
  OrderedList ordered;
  ordered.triangles.resize(list.size());
  ordered.watermarks.resize(list.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    ordered.triangles[i] = list[entries[i].place];
    ordered.watermarks[i] = nearest_of(entries[i].key);
  }
  static const UnitCost of_key = nearest_key_cost();
  charge_bin_sort(list.size(), of_key, counters);
  return ordered;
}

TriangleList sort_far_to_near(const SetupTriangles& triangles, const TriangleList& list, StageCounters& counters) {
  TriangleList ordered;
  ordered.reserve(list.size());
  for (const Entry& entry : sorted(triangles, list, [](const SetupTriangle& triangle) {
         return kLastKey - sort_key(mean_depth(triangle.vertex_z));
       }))
    ordered.push_back(list[entry.place]);
  static const UnitCost of_key = mean_key_cost();
  charge_bin_sort(list.size(), of_key, counters);
  return ordered;
}

}  // namespace beampipe
