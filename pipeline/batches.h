// A few triangles at a time between the raster and what follows, so that fragments stay in cache.
#pragma once

#include <algorithm>
#include <cstddef>

#include "stages/data/tile.h"

namespace beampipe {

// Calls body(batch) for the list's triangles in order, 512 at a time.
template <class Body>
void for_each_batch(const TriangleList& list, Body&& body) {
  constexpr std::size_t kBatchTriangles = 512;
  for (std::size_t first = 0; first < list.size(); first += kBatchTriangles) {
    const auto begin = list.begin() + static_cast<std::ptrdiff_t>(first);
    body(TriangleList(begin, begin + static_cast<std::ptrdiff_t>(std::min(kBatchTriangles, list.size() - first))));
  }
}

}  // namespace beampipe
