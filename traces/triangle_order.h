// The same frame with its triangles in another order.
#pragma once

#include <cstddef>
#include <cstdint>

#include "traces/trace.h"

namespace beampipe {

enum class TriangleOrder { given, shuffled, near_to_far, far_to_near };

// A trace of one frame: frame `frame` of `trace`, its triangles in this order over all draws. Near and far: mean depth
// of the three vertices along the view direction; equal depths keep the given order, as does everything else about a
// triangle, to the last bit. Draws are split where their triangles part. `seed` is of the shuffle: same seed, same
// order on every machine.
Trace with_triangle_order(const Trace& trace, std::size_t frame, TriangleOrder order, std::uint64_t seed = 1);

}  // namespace beampipe
