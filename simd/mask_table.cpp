#include "simd/mask_table.h"

#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/mask_table.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void table_masks_kernel(const TableTriangle* triangles, std::size_t count, const MaskTable& table,
                        std::uint32_t* masks) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN std::int32_t angle[hn::MaxLanes(d)];
  HWY_ALIGN std::uint32_t flip[hn::MaxLanes(d)], words[hn::MaxLanes(d)];
  HWY_ALIGN float distance[hn::MaxLanes(d)];
  const auto reach = hn::Set(d, kHalfDiagonal);
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t n = HWY_MIN(lanes, count - first);
    auto mask = hn::Set(du, ~0u);
    for (int k = 0; k < 3; ++k) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const TableEdge& edge = triangles[first + HWY_MIN(lane, n - 1)].edges[k];
        angle[lane] = edge.angle, flip[lane] = edge.flip, distance[lane] = edge.distance;
      }
      const auto r = hn::Load(d, distance);
      const auto scaled = hn::Mul(hn::Add(hn::Mul(r, hn::Set(d, 1.0f / kHalfDiagonal)), hn::Set(d, 1.0f)),
                                  hn::Set(d, static_cast<float>(kTableDistances / 2)));
      const auto clamped = hn::Min(hn::Max(scaled, hn::Zero(d)), hn::Set(d, static_cast<float>(kTableDistances - 1)));
      const auto column = hn::ConvertTo(di, clamped);
      const auto flipped = hn::Load(du, flip);
      const auto is_flipped = hn::RebindMask(di, hn::Ne(flipped, hn::Zero(du)));
      const auto row = hn::Mul(hn::Load(di, angle), hn::Set(di, kTableDistances));
      const auto index = hn::IfThenElse(
          is_flipped, hn::Sub(hn::Add(row, hn::Set(di, (kTableAngles / 2 + 1) * kTableDistances - 1)), column),
          hn::Add(row, column));
      auto word = hn::GatherIndex(du, table.words(), index);
      word = hn::IfThenElse(hn::RebindMask(du, hn::Le(r, hn::Neg(reach))), flipped, word);
      word = hn::IfThenElse(hn::RebindMask(du, hn::Ge(r, reach)), hn::Not(flipped), word);
      mask = hn::And(mask, word);
    }
    hn::Store(mask, du, words);
    for (std::size_t lane = 0; lane < n; ++lane) masks[first + lane] = words[lane];
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {

MaskTable::MaskTable(const SamplePattern& pattern) {
  for (int angle = 0; angle < kTableAngles / 2; ++angle) {
    const double theta = (angle + 0.5) * 2 * std::numbers::pi / kTableAngles;
    for (int r = 0; r < kTableDistances; ++r) {
      const double distance = ((r + 0.5) / (kTableDistances / 2) - 1) * kHalfDiagonal;
      std::uint32_t word = 0;
      for (int s = 0; s < pattern.count; ++s) {
        const auto i = static_cast<std::size_t>(s);
        const double x = pattern.x[i] / double(kSubpixelUnits) - 0.5, y = pattern.y[i] / double(kSubpixelUnits) - 0.5;
        if (std::cos(theta) * x + std::sin(theta) * y + distance >= 0) word |= 1u << s;
      }
      words_[static_cast<std::size_t>(angle * kTableDistances + r)] = word;
      const int reverse = (angle + kTableAngles / 2) * kTableDistances + (kTableDistances - 1 - r);
      words_[static_cast<std::size_t>(reverse)] = ~word;
    }
  }
}

std::int32_t table_angle(double a, double b, bool& flip) {
  flip = b < 0 || (b == 0 && a < 0);
  const double theta = flip ? std::atan2(-b, -a) : std::atan2(b, a);  // 0 <= theta < pi
  const auto angle = static_cast<std::int32_t>(theta * (kTableAngles / (2 * std::numbers::pi)));
  return angle < kTableAngles / 2 ? angle : kTableAngles / 2 - 1;
}

HWY_EXPORT(table_masks_kernel);
void table_masks(const TableTriangle* triangles, std::size_t count, const MaskTable& table, std::uint32_t* masks) {
  HWY_DYNAMIC_DISPATCH(table_masks_kernel)(triangles, count, table, masks);
}

}  // namespace beampipe
#endif
