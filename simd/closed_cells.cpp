#include "simd/closed_cells.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/closed_cells.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// The cells of one row have two bits of each quad's four: here they are brought together, and put back.
HWY_INLINE std::uint32_t cells_of_row(std::uint64_t quads) {
  quads &= 0x3333333333333333;
  quads = (quads | quads >> 2) & 0x0f0f0f0f0f0f0f0f;
  quads = (quads | quads >> 4) & 0x00ff00ff00ff00ff;
  quads = (quads | quads >> 8) & 0x0000ffff0000ffff;
  return static_cast<std::uint32_t>(quads | quads >> 16);
}
HWY_INLINE std::uint64_t quads_of_row(std::uint64_t cells) {
  cells = (cells | cells << 16) & 0x0000ffff0000ffff;
  cells = (cells | cells << 8) & 0x00ff00ff00ff00ff;
  cells = (cells | cells << 4) & 0x0f0f0f0f0f0f0f0f;
  return (cells | cells << 2) & 0x3333333333333333;
}

HWY_INLINE std::uint32_t count_of(std::uint64_t mask) { return static_cast<std::uint32_t>(std::popcount(mask)); }

ClosedCells close_cells_kernel(const ClosingTriangle& triangle, const ClosedTile& tile, ClosingRow* rows,
                               std::size_t count) {
  using Tag = hn::CappedTag<float, 8>;
  using Depths = Lanes<Tag>;
  const Tag d;
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  const Depths nearest(triangle.nearest), farthest(triangle.farthest), farthest_of_tile(tile.farthest);
  const std::ptrdiff_t width = tile.x1 - tile.x0;
  ClosedCells result{};
  for (ClosingRow* row = rows; row != rows + count; ++row) {
    const std::uint64_t touched = row->visible;
    const auto first = static_cast<std::size_t>(std::countr_zero(touched)) / 4 * 2;
    const auto end = static_cast<std::size_t>(std::bit_width(touched) + 3) / 4 * 2;
    float* const upper = tile.depths + (row->y - tile.y0) * width + (row->x - tile.x0);
    float* const sides[2] = {upper, row->y + 1 < tile.y1 ? upper + width : upper};
    std::uint64_t behind[2] = {0, 0};
    for (std::size_t i = first; i < end; i += kLanes)
      for (int side = 0; side < 2; ++side)
        behind[side] |= std::uint64_t{mask_bits(nearest > Depths(hn::LoadU(d, sides[side] + i)))} << i;
    std::uint64_t hidden = 0;
    if ((behind[0] | behind[1]) != 0)
      hidden = quads_of_row(behind[0] & 0xffffffff) | quads_of_row(behind[1] & 0xffffffff) << 2;
    row->visible = touched & ~hidden;
    const std::uint64_t closed = triangle.closes ? row->full & row->visible : 0;
    for (int side = 0; closed != 0 && side < 2; ++side) {
      const std::uint32_t cells = cells_of_row(closed >> 2 * side);
      for (std::size_t i = first; i < end; i += kLanes) {
        const Depths depth(hn::LoadU(d, sides[side] + i));
        const auto changes = (farthest < depth) & mask_of_bits<Tag>(cells, i);
        hn::StoreU(select(changes, farthest, depth).raw, d, sides[side] + i);
        result.changed += count_of(mask_bits(changes));
        result.changed_from_farthest += count_of(mask_bits(changes & (depth == farthest_of_tile)));
      }
    }
    result.tested += count_of(touched), result.hidden += count_of(touched & hidden);
    result.closed += count_of(closed);
  }
  return result;
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(close_cells_kernel);
ClosedCells close_cells(const ClosingTriangle& triangle, const ClosedTile& tile, ClosingRow* rows, std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(close_cells_kernel)(triangle, tile, rows, count);
}
}  // namespace beampipe
#endif
