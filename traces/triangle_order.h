// The same frame with its triangles in another order.
#pragma once

#include <cstddef>
#include <cstdint>

#include "traces/trace.h"

namespace beampipe {

enum class TriangleOrder { given, shuffled, near_to_far, far_to_near };

// Returns a trace with one frame: frame `frame` of `trace` with its triangles in this order, across all draws. Near and
// far mean the mean depth of a triangle's three vertices along the view direction; triangles of equal depth keep their
// order. Each triangle itself stays the same to the last bit. A draw is split where triangles of other draws come
// between its own. The same seed shuffles in the same way on every machine.
Trace with_triangle_order(const Trace& trace, std::size_t frame, TriangleOrder order, std::uint64_t seed = 1);

}  // namespace beampipe
