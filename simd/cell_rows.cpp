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

CellRow cell_row_kernel(const EdgeOverCells (&edges)[3], std::size_t count) {
  const hn::CappedTag<double, 8> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  const auto index = hn::Iota(d, 0.0);
  CellRow row{};
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto cell = hn::Add(index, hn::Set(d, static_cast<double>(i)));
    auto least_deep = zero, least_shallow = zero;
    for (int k = 0; k < 3; ++k) {
      const auto corner = hn::Add(hn::Set(d, edges[k].start), hn::Mul(hn::Set(d, edges[k].step), cell));
      const auto deep = hn::Add(corner, hn::Set(d, edges[k].deepest));
      const auto shallow = hn::Add(corner, hn::Set(d, edges[k].shallowest));
      least_deep = k == 0 ? deep : hn::Min(least_deep, deep);
      least_shallow = k == 0 ? shallow : hn::Min(least_shallow, shallow);
    }
    std::uint8_t touched[8] = {}, full[8] = {};
    hn::StoreMaskBits(d, hn::Ge(least_deep, zero), touched);
    hn::StoreMaskBits(d, hn::Ge(least_shallow, zero), full);
    row.touched |= std::uint32_t{touched[0]} << i;
    row.full |= std::uint32_t{full[0]} << i;
  }
  const std::uint32_t valid = ~0u >> (kCellsPerRow - count);
  return {row.touched & valid, row.full & row.touched & valid};
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(cell_row_kernel);
CellRow cell_row(const EdgeOverCells (&edges)[3], std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(cell_row_kernel)(edges, count);
}
}  // namespace beampipe
#endif
