#include "simd/position_mask.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/position_mask.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Both lane types hold every product and sum exactly: double up to 2^53, and int32 where slopes are below kSmallSlope
// and c is clamped to +-kDecided, beyond which it decides the sign on its own.
constexpr std::int64_t kSmallSlope = 1 << 20;
constexpr std::int64_t kDecided = 1 << 30;

// The cells of a pixel that a triangle's box touches, both ends included.
struct TouchedCells {
  std::size_t left, top, right, bottom;
};

template <int kColumns, int kRows>
HWY_INLINE TouchedCells touched_cells(const TriangleInPixel& in) {
  const auto cell = [](std::int32_t place, int count) {
    const std::int32_t within = HWY_MAX(0, HWY_MIN(place, kSubpixelUnits - 1));
    return static_cast<std::size_t>(within / (kSubpixelUnits / count));
  };
  const auto least = [](const std::int32_t(&v)[3]) { return HWY_MIN(HWY_MIN(v[0], v[1]), v[2]); };
  const auto greatest = [](const std::int32_t(&v)[3]) { return HWY_MAX(HWY_MAX(v[0], v[1]), v[2]); };
  return {cell(least(in.x), kColumns), cell(least(in.y), kRows), cell(greatest(in.x), kColumns),
          cell(greatest(in.y), kRows)};
}

// A vector has at most 16 lanes: the positions of the first two cells. `touched`: no other cell has positions inside.
template <class Lane, std::size_t kColumns>
HWY_INLINE void set_mask(const EdgeInPixel<std::int64_t> (&edges)[3], const TouchedCells& touched,
                         const PositionGrid& grid, WideMask& mask) {
  const hn::CappedTag<Lane, 16> d;
  using V = hn::Vec<decltype(d)>;
  const hn::Rebind<std::int32_t, decltype(d)> di;
  const std::size_t lanes = hn::Lanes(d), parts = lanes > 8 ? 1 : 8 / lanes;  // vectors per cell, or per two
  const std::size_t step = lanes > 8 ? 2 : 1;                                 // cells per vector
  const auto load = [&](const std::int32_t* values) {
    if constexpr (sizeof(Lane) == 4) {
      return hn::Load(d, values);
    } else {
      return hn::PromoteTo(d, hn::Load(di, values));
    }
  };
  const auto set = [&](std::int64_t value) { return hn::Set(d, static_cast<Lane>(value)); };
  // Negative if one of the three is negative.
  const auto least = [](V e0, V e1, V e2) {
    if constexpr (sizeof(Lane) == 4) {
      return hn::Or3(e0, e1, e2);
    } else {
      return hn::Min(hn::Min(e0, e1), e2);
    }
  };
  const auto down = [&](int k) { return set(edges[k].b * grid.cell_height); };
  const V down0 = down(0), down1 = down(1), down2 = down(2);
  static_assert(std::endian::native == std::endian::little);
  mask = {};
  auto* const bytes = reinterpret_cast<std::uint8_t*>(mask.words.data());  // a cell has 8 positions: one byte
  for (std::size_t part = 0; part < parts; ++part) {
    const V x = load(grid.first_cells.x.data() + part * lanes), y = load(grid.first_cells.y.data() + part * lanes);
    const auto base = [&](int k) {
      return hn::Add(hn::Add(hn::Mul(set(edges[k].a), x), hn::Mul(set(edges[k].b), y)), set(edges[k].c));
    };
    const V base0 = base(0), base1 = base(1), base2 = base(2);
    for (std::size_t column = touched.left / step * step; column <= touched.right; column += step) {
      const auto left = static_cast<std::int64_t>(column) * grid.cell_width;
      const auto top = static_cast<std::int64_t>(touched.top) * grid.cell_height;
      const auto first = [&](V of_edge, int k) { return hn::Add(of_edge, set(edges[k].a * left + edges[k].b * top)); };
      V edge0 = first(base0, 0), edge1 = first(base1, 1), edge2 = first(base2, 2);
      for (std::size_t row = touched.top; row <= touched.bottom; ++row) {
        const auto inside = hn::Not(hn::Lt(least(edge0, edge1, edge2), hn::Zero(d)));
        std::uint8_t* const cell = bytes + row * kColumns + column;
        if (lanes >= 8) {
          hn::StoreMaskBits(d, inside, cell);
        } else {
          std::uint8_t bits[8] = {};
          hn::StoreMaskBits(d, inside, bits);
          *cell = static_cast<std::uint8_t>(*cell | bits[0] << (part * lanes));
        }
        edge0 = hn::Add(edge0, down0), edge1 = hn::Add(edge1, down1), edge2 = hn::Add(edge2, down2);
      }
    }
  }
}

template <int kColumns, int kRows>
void set_masks(const TriangleInPixel* in, std::size_t count, const PositionGrid& grid, WideMask* masks) {
  for (std::size_t i = 0; i < count; ++i) {
    TriangleInPixelOf<std::int64_t> triangle;
    for (int k = 0; k < 3; ++k) triangle.x[k] = in[i].x[k], triangle.y[k] = in[i].y[k];
    const TouchedCells touched = touched_cells<kColumns, kRows>(in[i]);
    EdgeInPixel<std::int64_t> edges[3];
    bool small = true;
    for (int k = 0; k < 3; ++k) {
      EdgeInPixel<std::int64_t>& edge = edges[k] = edge_in_pixel(triangle, k);
      edge.c -= !owns_its_samples(edge.a, edge.b);
      small &= -kSmallSlope < edge.a && edge.a < kSmallSlope && -kSmallSlope < edge.b && edge.b < kSmallSlope;
    }
    if (small) {
      for (EdgeInPixel<std::int64_t>& edge : edges) edge.c = HWY_MAX(-kDecided, HWY_MIN(edge.c, kDecided));
      set_mask<std::int32_t, kColumns>(edges, touched, grid, masks[i]);
    } else {
      set_mask<double, kColumns>(edges, touched, grid, masks[i]);
    }
  }
}

void position_masks_kernel(const TriangleInPixel* in, std::size_t count, const PositionGrid& grid, WideMask* masks) {
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
void position_masks(const TriangleInPixel* in, std::size_t count, const PositionGrid& grid, WideMask* masks) {
  HWY_DYNAMIC_DISPATCH(position_masks_kernel)(in, count, grid, masks);
}
}  // namespace beampipe
#endif
