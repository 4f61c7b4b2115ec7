#include "simd/quad_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/quad_rows.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// A block of cells, in the order of the masks' bits.
constexpr std::size_t kBlock = 8, kBlockQuads = 2;
alignas(64) constexpr double kColumn[kBlock] = {0, 1, 0, 1, 2, 3, 2, 3};
alignas(64) constexpr double kRow[kBlock] = {0, 0, 1, 1, 0, 0, 1, 1};

void quad_rows_kernel(const EdgeOverCells (&edges)[3], std::size_t quads, std::size_t rows, QuadRow* out) {
  const hn::CappedTag<double, kBlock> d;
  using Reals = Lanes<decltype(d)>;
  constexpr std::size_t kLanes = hn::MaxLanes(d), kParts = kBlock / kLanes;
  Reals deepest[3][kParts], shallowest[3][kParts];  // what the value gains from the block's corner
  for (int k = 0; k < 3; ++k) {
    for (std::size_t part = 0; part < kParts; ++part) {
      const auto load = [&](const double* values) { return Reals(hn::Load(d, values + part * kLanes)); };
      const Reals corner = Reals(edges[k].step) * load(kColumn) + Reals(edges[k].down) * load(kRow);
      deepest[k][part] = corner + Reals(edges[k].deepest);
      shallowest[k][part] = corner + Reals(edges[k].shallowest);
    }
  }
  const Reals zero(0.0);
  for (std::size_t row = 0; row < rows; ++row) {
    QuadRow masks{};
    for (std::size_t quad = 0; quad < quads; quad += kBlockQuads) {
      Reals start[3];
      for (int k = 0; k < 3; ++k)
        start[k] = Reals(edges[k].start + edges[k].step * static_cast<double>(2 * quad) +
                         edges[k].down * static_cast<double>(2 * row));
      for (std::size_t part = 0; part < kParts; ++part) {
        const auto least = [&](const Reals(&gains)[3][kParts]) {
          return lesser(lesser(start[0] + gains[0][part], start[1] + gains[1][part]), start[2] + gains[2][part]);
        };
        const std::size_t first = 4 * quad + part * kLanes;
        masks.touched |= std::uint64_t{mask_bits(least(deepest) >= zero)} << first;
        masks.full |= std::uint64_t{mask_bits(least(shallowest) >= zero)} << first;
      }
    }
    masks.touched &= ~std::uint64_t{0} >> (4 * (kQuadsPerRow - quads));  // without the rest of the last block
    out[row] = {masks.touched, masks.full & masks.touched};
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(quad_rows_kernel);
void quad_rows(const EdgeOverCells (&edges)[3], std::size_t quads, std::size_t rows, QuadRow* out) {
  HWY_DYNAMIC_DISPATCH(quad_rows_kernel)(edges, quads, rows, out);
}
}  // namespace beampipe
#endif
