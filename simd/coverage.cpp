#include "simd/coverage.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/coverage.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// This order: a formula finds only those above it.
#include "simd/triangle_in_pixel-inl.h"
//
#include "simd/coverage-inl.h"

void coverage_kernel(const TriangleInPixel* in, std::size_t count, Coverage<float>* out) {
  map_rows<TriangleInPixelOf<Ints>>(in, count, out, [](const TriangleInPixelOf<Ints>& triangle) {
    TriangleInPixelOf<Doubles> exact;
    for (int k = 0; k < 3; ++k) exact.x[k] = Doubles(triangle.x[k]), exact.y[k] = Doubles(triangle.y[k]);
    return coverage_formula<Doubles, Floats>(exact);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(coverage_kernel);
void coverage(const TriangleInPixel* in, std::size_t count, Coverage<float>* out) {
  HWY_DYNAMIC_DISPATCH(coverage_kernel)(in, count, out);
}
}  // namespace beampipe
#endif
