#include "simd/cell_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/cell_rows.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A block is four columns of both rows: first those of row 0.
constexpr std::size_t kColumns = 4, kBlock = 2 * kColumns;
alignas(64) constexpr double kColumn[kBlock] = {0, 1, 2, 3, 0, 1, 2, 3};
alignas(64) constexpr double kRow[kBlock] = {0, 0, 0, 0, 1, 1, 1, 1};

CellRows cell_rows_kernel(const EdgeOverCells (&edges)[3], std::size_t count) {
  const hn::CappedTag<double, kBlock> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  CellRows result{};
  for (std::size_t lane = 0; lane < kBlock; lane += lanes) {
    const auto column = hn::Load(d, kColumn + lane), row = hn::Load(d, kRow + lane);
    for (std::size_t first = 0; first < count; first += kColumns) {
      const auto cell = hn::Add(column, hn::Set(d, static_cast<double>(first)));
      auto least_deep = zero, least_shallow = zero;
      for (int k = 0; k < 3; ++k) {
        const auto in_row = hn::Add(hn::Set(d, edges[k].start), hn::Mul(hn::Set(d, edges[k].step), cell));
        const auto corner = hn::Add(in_row, hn::Mul(hn::Set(d, edges[k].down), row));
        const auto deep = hn::Add(corner, hn::Set(d, edges[k].deepest));
        const auto shallow = hn::Add(corner, hn::Set(d, edges[k].shallowest));
        least_deep = k == 0 ? deep : hn::Min(least_deep, deep);
        least_shallow = k == 0 ? shallow : hn::Min(least_shallow, shallow);
      }
      std::uint8_t touched[8] = {}, full[8] = {};
      hn::StoreMaskBits(d, hn::Ge(least_deep, zero), touched);
      hn::StoreMaskBits(d, hn::Ge(least_shallow, zero), full);
      // Both rows are in one vector, or one row in one or several.
      const std::uint32_t touched_bits = std::uint32_t{touched[0]} << lane, full_bits = std::uint32_t{full[0]} << lane;
      constexpr std::uint32_t kInRow = (1u << kColumns) - 1;
      result.rows[0].touched |= (touched_bits & kInRow) << first;
      result.rows[0].full |= (full_bits & kInRow) << first;
      result.rows[1].touched |= (touched_bits >> kColumns) << first;
      result.rows[1].full |= (full_bits >> kColumns) << first;
    }
  }
  const std::uint32_t valid = ~0u >> (kCellsPerRow - count);
  for (CellRow& row : result.rows) row = {row.touched & valid, row.full & row.touched & valid};
  return result;
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(cell_rows_kernel);
CellRows cell_rows(const EdgeOverCells (&edges)[3], std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(cell_rows_kernel)(edges, count);
}
}  // namespace beampipe
#endif
