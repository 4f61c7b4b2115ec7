#include "simd/depth_range.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/depth_range.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

#include "simd/depth_range-inl.h"

void depth_range_kernel(const DepthRangeInput<float>* in, std::size_t count, DepthRange<float>* out) {
  using Columns = DepthRangeInput<Floats>;
  map_rows<Columns>(in, count, out, [](const Columns& columns) { return depth_range_formula(columns); });
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(depth_range_kernel);
void depth_range(const DepthRangeInput<float>* in, std::size_t count, DepthRange<float>* out) {
  HWY_DYNAMIC_DISPATCH(depth_range_kernel)(in, count, out);
}
}  // namespace beampipe
#endif
