#include "stages/surface/surface_points.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/surface/surface_points.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

#include "stages/data/surface-inl.h"
#include "stages/surface/surface_formulas-inl.h"
#include "stages/surface/surface_points-inl.h"

// Of the triangles in the lanes of a vector, which most often are one.
class LaneRows {
 public:
  static constexpr std::size_t kLanes = sizeof(Floats) / sizeof(float);

  // Lanes past `count` repeat the last one.
  LaneRows(const Invocation* invocations, std::size_t count) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      triangles_[lane] = invocations[HWY_MIN(lane, count - 1)].triangle;
      are_one_ = are_one_ && triangles_[lane] == triangles_[0];
    }
  }

  template <class Columns, class RowOf>
  HWY_INLINE Columns get(const RowOf& row_of) const {
    if (are_one_) return repeat_row<Columns>(row_of(triangles_[0]));
    return gather_rows<Columns>([&](std::size_t lane) { return &row_of(triangles_[lane]); });
  }

 private:
  std::uint32_t triangles_[kLanes];
  bool are_one_ = true;
};

void find_points_kernel(const SetupTriangles& triangles, const ShaderInputs& shader, const PointRules& rules,
                        std::span<const Invocation> invocations, PointInputs<PointColumn>* inputs,
                        const std::array<TexturePoints*, 2>& places) {
  for (std::size_t first = 0; first < invocations.size(); first += LaneRows::kLanes) {
    const std::size_t count = HWY_MIN(LaneRows::kLanes, invocations.size() - first);
    const LaneRows rows(&invocations[first], count);
    const auto at = load_rows<InvocationOf<Floats, Ints>>(&invocations[first], count);
    const SurfacePoint<Floats, Ints, LaneRows> point(triangles, rows, at, rules);
    if (inputs) {
      auto found = load_columns<PointInputs<Floats>>(*inputs, first);
      point.set_inputs(shader, found);
      store_columns(found, first, *inputs);
    }
    for (std::size_t set = 0; set < places.size(); ++set)
      if (places[set]) store_columns(point.place(set), first, *places[set]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(find_points_kernel);

void find_points(const SetupTriangles& triangles, const ShaderInputs& shader, const PointRules& rules,
                 std::span<const Invocation> invocations, PointInputs<PointColumn>* inputs,
                 const std::array<TexturePoints*, 2>& places) {
  HWY_DYNAMIC_DISPATCH(find_points_kernel)(triangles, shader, rules, invocations, inputs, places);
}
}  // namespace beampipe
#endif
