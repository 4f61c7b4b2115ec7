// The depth test of a horizontal run of samples in double precision: the inner loop of the reference.
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

// Sample i of the run lies at x_i = x + step i, in pixels from the depth plane's anchor. Its depth is
// (z + dzdx x_i) + row.
template <class Real>
struct DepthSpanOf {
  Real z, dzdx, row;
  Real x, step;
};
using DepthSpan = DepthSpanOf<double>;

// Replaces depth[i] and owner[i] where the span is nearer (LESS), for i in [0, count). Returns how many it replaced.
std::uint64_t depth_span(const DepthSpan& span, std::size_t count, std::uint64_t owner_id, double* depth,
                         std::uint64_t* owner);

namespace scalar {
#include "simd/depth_span-inl.h"
}
using namespace scalar;

// The scalar twin, for the samples [first, count).
inline std::uint64_t depth_span_scalar(const DepthSpan& span, std::size_t first, std::size_t count,
                                       std::uint64_t owner_id, double* depth, std::uint64_t* owner) {
  std::uint64_t passed = 0;
  for (std::size_t i = first; i < count; ++i) {
    double z = 0;
    const auto index = static_cast<double>(i);
    if (!depth_span_sample(span, index, depth[i], z)) continue;
    depth[i] = z;
    owner[i] = owner_id;
    ++passed;
  }
  return passed;
}

}  // namespace beampipe
