// bin_sort: a bin's list of triangles -> the same triangles near to far, with watermarks.
//
// The key of a triangle is the nearest depth that it may have inside the bin. It is rounded to 24 bits towards the
// viewer, so it is also a watermark: no later triangle of the list is nearer than that anywhere in the bin. Among equal
// keys the earlier triangle comes first. The idea is that of an approximate sort of objects before an exact one of
// fragments (Callahan et al. 2005, "Hardware-Assisted Visibility Sorting"), inside a bin.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// A list in the order in which a bin takes its triangles.
struct OrderedList {
  TriangleList triangles;
  std::vector<float> watermarks;  // one per triangle: no later one is nearer; depths as in SetupTriangles
};

// A depth as a 24-bit key: a nearer depth has a smaller key. `depth`: -2..1.
std::uint32_t sort_key(float depth);

// The nearest depth that has this key.
float nearest_of(std::uint32_t key);

// Counts as items the triangles. The modelled machine computes keys while it bins and keeps them in the list. A radix
// sort of 8 bits at a time then reads and writes the list three times.
OrderedList bin_sort(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                     StageCounters& counters);

// The triangles far to near, as programs sort what they blend: by the mean depth of their vertices, which is the same
// in all bins. Among equal keys the earlier triangle comes first. Counts the same.
TriangleList sort_far_to_near(const SetupTriangles& triangles, const TriangleList& list, StageCounters& counters);

}  // namespace beampipe
