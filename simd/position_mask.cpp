#include "simd/position_mask.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/position_mask.cpp"
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

// Both lane types hold every product and sum exactly: double up to 2^53, and int32 where slopes are small.
constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());

// The cells of a pixel that triangles' boxes touch, both ends included.
template <std::size_t kCount>
struct TouchedCells {
  std::int32_t left[kCount], top[kCount], right[kCount], bottom[kCount];
};

// The edges of triangles over the positions. `c`: at the upper left corner of the first touched cell. `right`, `down`:
// what the value gains from one vector of cells to the next one in its row, and from one row of cells to the next.
template <class Lane, std::size_t kCount>
struct EdgesOverCells {
  Lane a[3][kCount], b[3][kCount], c[3][kCount], right[3][kCount], down[3][kCount];
};

// Vectors of positions: at most 16 lanes, the positions of two cells.
template <class Lane>
struct PositionVectors {
  using Tag = hn::CappedTag<Lane, 16>;
  static constexpr std::size_t kSize = hn::MaxLanes(Tag());
  static constexpr std::size_t kCells = kSize > 8 ? 2 : 1;          // per vector
  static constexpr std::size_t kParts = kSize > 8 ? 1 : 8 / kSize;  // vectors per cell, or per two
};

// Triangle i of those that were set up. No cell that it does not touch has positions inside.
template <std::size_t kColumns, class Lane, std::size_t kCount>
HWY_INLINE void set_mask(const EdgesOverCells<Lane, kCount>& edges, const TouchedCells<kCount>& touched, std::size_t i,
                         const PositionGrid& grid, WideMask& mask) {
  using Vectors = PositionVectors<Lane>;
  const typename Vectors::Tag d;
  using V = hn::Vec<typename Vectors::Tag>;
  const hn::Rebind<std::int32_t, typename Vectors::Tag> di;
  const auto load = [&](const std::int32_t* values) {
    if constexpr (sizeof(Lane) == 4) {
      return hn::Load(d, values);
    } else {
      return hn::PromoteTo(d, hn::Load(di, values));
    }
  };
  // Negative if one of the three is negative.
  const auto least = [](V e0, V e1, V e2) {
    if constexpr (sizeof(Lane) == 4) {
      return hn::Or3(e0, e1, e2);
    } else {
      return hn::Min(hn::Min(e0, e1), e2);
    }
  };
  const auto of = [&](const Lane(&column)[3][kCount], int k) { return hn::Set(d, column[k][i]); };
  const V right0 = of(edges.right, 0), right1 = of(edges.right, 1), right2 = of(edges.right, 2);
  const V down0 = of(edges.down, 0), down1 = of(edges.down, 1), down2 = of(edges.down, 2);
  static_assert(std::endian::native == std::endian::little);
  mask = {};
  auto* const bytes = reinterpret_cast<std::uint8_t*>(mask.words.data());  // a cell has 8 positions: one byte
  const auto first = static_cast<std::size_t>(touched.left[i]), last = static_cast<std::size_t>(touched.right[i]);
  const auto top = static_cast<std::size_t>(touched.top[i]), bottom = static_cast<std::size_t>(touched.bottom[i]);
  for (std::size_t part = 0; part < Vectors::kParts; ++part) {
    const V x = load(grid.first_cells.x.data() + part * Vectors::kSize);
    const V y = load(grid.first_cells.y.data() + part * Vectors::kSize);
    const auto at_first = [&](int k) {
      return hn::Add(hn::Add(hn::Mul(of(edges.a, k), x), hn::Mul(of(edges.b, k), y)), of(edges.c, k));
    };
    V column0 = at_first(0), column1 = at_first(1), column2 = at_first(2);
    for (std::size_t column = first; column <= last; column += Vectors::kCells) {
      V edge0 = column0, edge1 = column1, edge2 = column2;
      for (std::size_t row = top; row <= bottom; ++row) {
        const auto inside = hn::Not(hn::Lt(least(edge0, edge1, edge2), hn::Zero(d)));
        std::uint8_t* const cell = bytes + row * kColumns + column;
        if (Vectors::kSize >= 8) {
          hn::StoreMaskBits(d, inside, cell);
        } else {
          std::uint8_t bits[8] = {};
          hn::StoreMaskBits(d, inside, bits);
          *cell = static_cast<std::uint8_t>(*cell | bits[0] << (part * Vectors::kSize));
        }
        edge0 = hn::Add(edge0, down0), edge1 = hn::Add(edge1, down1), edge2 = hn::Add(edge2, down2);
      }
      column0 = hn::Add(column0, right0), column1 = hn::Add(column1, right1), column2 = hn::Add(column2, right2);
    }
  }
}

// Rounded towards 0.
HWY_INLINE Ints clamped(const Doubles& x, double limit) {
  const auto part = [&](std::size_t i) {
    const Doubles::Tag d;
    const auto within = hn::Min(hn::Max(x.part[i].raw, hn::Set(d, -limit)), hn::Set(d, limit));
    return hn::DemoteTo(hn::Rebind<std::int32_t, Doubles::Tag>(), within);
  };
#if HWY_TARGET == HWY_SCALAR
  return Ints(part(0));
#else
  return Ints(hn::Combine(IntTag(), part(1), part(0)));
#endif
}

// As many triangles as there are lanes: lanes are across triangles here, and across positions in set_mask. Bit i of
// `small`: all slopes of triangle i are below kSmallSlope; else its columns hold no edges. Bit i of tested[k]: if they
// are, edge k of triangle i does not have the whole pixel inside.
template <std::size_t kColumns, std::size_t kRows>
HWY_INLINE void set_up(const TriangleInPixelOf<Ints>& triangles, EdgesOverCells<std::int32_t, kLanes>& edges,
                       TouchedCells<kLanes>& touched, std::uint32_t& small, std::uint32_t (&tested)[3]) {
  constexpr std::int32_t kCellWidth = kSubpixelUnits / kColumns, kCellHeight = kSubpixelUnits / kRows;
  constexpr std::int32_t kStep = PositionVectors<std::int32_t>::kCells;
  const IntTag d;
  const Ints zero(0), one(1), last(kSubpixelUnits - 1), steep(kSmallSlope), minus_steep(-kSmallSlope);
  const auto within = [&](Ints place) { return lesser(greater(place, zero), last).raw; };
  const auto least = [](const Ints(&v)[3]) { return lesser(lesser(v[0], v[1]), v[2]); };
  const auto greatest = [](const Ints(&v)[3]) { return greater(greater(v[0], v[1]), v[2]); };
  const auto column = [&](Ints x) { return Ints(hn::ShiftRight<std::countr_zero(unsigned{kCellWidth})>(within(x))); };
  const auto row = [&](Ints y) { return Ints(hn::ShiftRight<std::countr_zero(unsigned{kCellHeight})>(within(y))); };
  const auto store = [&](Ints values, std::int32_t* to) { hn::StoreU(values.raw, d, to); };
  const Ints left = column(least(triangles.x)) & Ints(-kStep), top = row(least(triangles.y));
  store(left, touched.left), store(top, touched.top);
  store(column(greatest(triangles.x)), touched.right), store(row(greatest(triangles.y)), touched.bottom);
  TriangleInPixelOf<Doubles> exact;
  for (int k = 0; k < 3; ++k) exact.x[k] = Doubles(triangles.x[k]), exact.y[k] = Doubles(triangles.y[k]);
  auto all_small = zero == zero;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Ints a = triangles.y[k] - triangles.y[next], b = triangles.x[next] - triangles.x[k];
    all_small = all_small & (a < steep) & (a > minus_steep) & (b < steep) & (b > minus_steep);
    const auto owns = (a > zero) | ((a == zero) & (b > zero));
    const Ints c = clamped(edge_in_pixel(exact, k).c, double{kDecidedByC}) - select(owns, zero, one);
    const Ints right = a * Ints(kCellWidth), down = b * Ints(kCellHeight);
    tested[k] = mask_bits(c + Ints(kSubpixelUnits) * (lesser(a, zero) + lesser(b, zero)) < zero);
    store(a, edges.a[k]), store(b, edges.b[k]), store(c + right * left + down * top, edges.c[k]);
    store(right * Ints(kStep), edges.right[k]), store(down, edges.down[k]);
  }
  small = mask_bits(all_small);
}

// The same for one triangle with long edges.
template <std::size_t kColumns>
EdgesTested set_long_mask(const TriangleInPixel& in, const TouchedCells<kLanes>& touched_by_all, std::size_t i,
                          const PositionGrid& grid, WideMask& mask) {
  constexpr std::int32_t kStep = PositionVectors<double>::kCells;
  const TouchedCells<1> touched{
      {touched_by_all.left[i]}, {touched_by_all.top[i]}, {touched_by_all.right[i]}, {touched_by_all.bottom[i]}};
  TriangleInPixelOf<double> triangle;
  for (int k = 0; k < 3; ++k) triangle.x[k] = in.x[k], triangle.y[k] = in.y[k];
  EdgesOverCells<double, 1> edges;
  EdgesTested tested;
  for (int k = 0; k < 3; ++k) {
    const EdgeInPixel<double> edge = edge_for_positions(triangle, k);
    const double right = edge.a * grid.cell_width, down = edge.b * grid.cell_height;
    if (!is_pixel_inside(edge)) ++(has_small_slopes(edge) ? tested.narrow : tested.wide);
    edges.a[k][0] = edge.a, edges.b[k][0] = edge.b, edges.right[k][0] = right * kStep, edges.down[k][0] = down;
    edges.c[k][0] = edge.c + right * touched.left[0] + down * touched.top[0];
  }
  set_mask<kColumns>(edges, touched, 0, grid, mask);
  return tested;
}

template <std::size_t kColumns, std::size_t kRows>
EdgesTested set_masks(const TriangleInPixel* in, std::size_t count, const PositionGrid& grid, WideMask* masks) {
  EdgesOverCells<std::int32_t, kLanes> edges;
  TouchedCells<kLanes> touched;
  EdgesTested tested;
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t n = HWY_MIN(kLanes, count - first);
    std::uint32_t small = 0, narrow[3] = {};
    set_up<kColumns, kRows>(load_rows<TriangleInPixelOf<Ints>>(in + first, n), edges, touched, small, narrow);
    small &= ~0u >> (32 - n);
    for (const std::uint32_t edge : narrow) tested.narrow += static_cast<unsigned>(std::popcount(edge & small));
    for (std::size_t i = 0; i < n; ++i) {
      if (small >> i & 1) {
        set_mask<kColumns>(edges, touched, i, grid, masks[first + i]);
      } else {
        tested += set_long_mask<kColumns>(in[first + i], touched, i, grid, masks[first + i]);
      }
    }
  }
  return tested;
}

EdgesTested position_masks_kernel(const TriangleInPixel* in, std::size_t count, const PositionGrid& grid,
                                  WideMask* masks) {
  switch (grid.cells.columns * grid.cells.rows) {
    case 4:
      return set_masks<2, 2>(in, count, grid, masks);
    case 8:
      return set_masks<4, 2>(in, count, grid, masks);
    case 16:
      return set_masks<4, 4>(in, count, grid, masks);
    default:
      return set_masks<8, 4>(in, count, grid, masks);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {

PositionGrid::PositionGrid(int count)
    : cells(split_into_cells(count / 8)),
      cell_width(kSubpixelUnits / cells.columns),
      cell_height(kSubpixelUnits / cells.rows),
      first_cells(standard_pattern(8, cell_width, cell_height)) {
  for (std::size_t s = 0; s < 8; ++s) {
    first_cells.x[8 + s] = first_cells.x[s] + cell_width;
    first_cells.y[8 + s] = first_cells.y[s];
  }
  first_cells.count = 16;
}

HWY_EXPORT(position_masks_kernel);
EdgesTested position_masks(const TriangleInPixel* in, std::size_t count, const PositionGrid& grid, WideMask* masks) {
  return HWY_DYNAMIC_DISPATCH(position_masks_kernel)(in, count, grid, masks);
}
}  // namespace beampipe
#endif
