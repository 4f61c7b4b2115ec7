#include "simd/mask_table.h"

#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/mask_table.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

#include "simd/mask_table-inl.h"

void table_masks_kernel(const TableTriangle* triangles, std::size_t count, const MaskTable& table,
                        std::uint32_t* masks) {
  using Columns = TableTriangleOf<Ints, Words, Floats>;
  map_rows<Columns>(triangles, count, masks,
                    [&](const Columns& columns) { return table_mask_formula(columns, table); });
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {

MaskTable::MaskTable(const SamplePattern& pattern) {
  for (int angle = 0; angle < kTableAngles; ++angle) {
    const double theta = angle * std::numbers::pi / kTableAngles;
    for (int r = 0; r < kTableDistances; ++r) {
      const double distance = ((r + 0.5) / (kTableDistances / 2) - 1) * kHalfDiagonal;
      std::uint32_t word = 0;
      for (int s = 0; s < pattern.count; ++s) {
        const auto i = static_cast<std::size_t>(s);
        const double x = pattern.x[i] / double(kSubpixelUnits) - 0.5, y = pattern.y[i] / double(kSubpixelUnits) - 0.5;
        if (std::cos(theta) * x + std::sin(theta) * y + distance >= 0) word |= 1u << s;
      }
      words_[static_cast<std::size_t>(angle * kTableDistances + r)] = word;
    }
  }
}

std::int32_t table_angle(double a, double b, bool& flip) {
  flip = b < 0 || (b == 0 && a < 0);
  const double theta = flip ? std::atan2(-b, -a) : std::atan2(b, a);  // 0 <= theta < pi
  const auto angle = static_cast<std::int32_t>(theta * (kTableAngles / std::numbers::pi) + 0.5);
  if (angle < kTableAngles) return angle;
  flip = !flip;  // pi is the reverse of 0
  return 0;
}

HWY_EXPORT(table_masks_kernel);
void table_masks(const TableTriangle* triangles, std::size_t count, const MaskTable& table, std::uint32_t* masks) {
  HWY_DYNAMIC_DISPATCH(table_masks_kernel)(triangles, count, table, masks);
}

}  // namespace beampipe
#endif
