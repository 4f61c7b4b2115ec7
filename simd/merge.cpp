#include "simd/merge.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/merge.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// This order: a formula finds only those above it.
#include "simd/depth_plane-inl.h"
#include "simd/mask_table-inl.h"
#include "simd/plane_gap-inl.h"
//
#include "simd/merge-inl.h"

void merge_kernel(const MergeFragment* fragments, std::size_t count, const MergePositions& positions,
                  const MergeRules& rules, Aggregate* aggregates, MergeSteps* steps) {
  const std::size_t lanes = hn::Lanes(FloatTag());
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t n = HWY_MIN(lanes, count - first);
    const auto in = load_rows<FragmentOf<Floats, Words>>(fragments + first, n);
    const auto old = load_rows<AggregateOf<Floats, Words>>(aggregates + first, n);
    MergeStepsOf<Words> done;
    store_rows(merge_formula(in, old, positions, rules, done), n, aggregates + first);
    store_rows(done, n, steps + first);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(merge_kernel);
void merge(const MergeFragment* fragments, std::size_t count, const MergePositions& positions, const MergeRules& rules,
           Aggregate* aggregates, MergeSteps* steps) {
  HWY_DYNAMIC_DISPATCH(merge_kernel)(fragments, count, positions, rules, aggregates, steps);
}
}  // namespace beampipe
#endif
