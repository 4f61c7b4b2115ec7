#include "simd/sample_mask.h"

#include <bit>
#include <span>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/sample_mask.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Both lane types hold every product and sum exactly: double up to 2^53, and int32 where slopes are below kSmallSlope
// and c is clamped to +-kDecided, beyond which it decides the sign on its own.
constexpr std::int32_t kSmallSlope = 1 << 20;
constexpr std::int64_t kDecided = 1 << 30;

template <class Lane>
HWY_INLINE std::uint32_t cell_mask(const Lane (&a)[3], const Lane (&b)[3], const Lane (&c)[3],
                                   const SamplePattern& pattern) {
  const hn::CappedTag<Lane, kMaxMaskSamples> d;
  const hn::Rebind<std::int32_t, decltype(d)> di;
  std::uint32_t mask = 0;
  for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); s += hn::Lanes(d)) {
    const auto position = [&](const std::int32_t* values) {
      if constexpr (sizeof(Lane) == 4) {
        return hn::Load(d, values + s);
      } else {
        return hn::PromoteTo(d, hn::Load(di, values + s));
      }
    };
    const auto x = position(pattern.x.data()), y = position(pattern.y.data());
    const auto edge = [&](int k) {
      const auto value = hn::Add(hn::Add(hn::Mul(hn::Set(d, a[k]), x), hn::Mul(hn::Set(d, b[k]), y)), hn::Set(d, c[k]));
      return hn::Not(hn::Lt(value, hn::Zero(d)));
    };
    const auto inside = hn::And(hn::And(edge(0), edge(1)), edge(2));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, inside, bytes);
    const std::uint32_t bits = bytes[0] | (static_cast<std::uint32_t>(bytes[1]) << 8);
    mask |= bits << s;
  }
  return mask & (~0u >> (32 - pattern.count));
}

void sample_masks_kernel(const CellEdges* cells, std::size_t count, const SamplePattern& pattern,
                         std::uint32_t* masks) {
  for (std::size_t i = 0; i < count; ++i) {
    const CellEdges& edges = cells[i];
    bool small = true;
    for (int k = 0; k < 3; ++k) {
      small &= -kSmallSlope < edges.a[k] && edges.a[k] < kSmallSlope;
      small &= -kSmallSlope < edges.b[k] && edges.b[k] < kSmallSlope;
    }
    if (small) {
      std::int32_t c[3];
      for (int k = 0; k < 3; ++k) c[k] = static_cast<std::int32_t>(HWY_MAX(-kDecided, HWY_MIN(edges.c[k], kDecided)));
      masks[i] = cell_mask<std::int32_t>(edges.a, edges.b, c, pattern);
    } else {
      double a[3], b[3], c[3];
      for (int k = 0; k < 3; ++k) {
        a[k] = edges.a[k], b[k] = edges.b[k], c[k] = static_cast<double>(edges.c[k]);
      }
      masks[i] = cell_mask<double>(a, b, c, pattern);
    }
  }
}

// Sets the bits of samples s, s + 1, ... in the masks of one triangle's cells.
template <class D>
HWY_INLINE void grid_masks(D d, const GridEdges& edges, std::span<const GridCell> cells, const SamplePattern& pattern,
                           std::size_t s, std::uint32_t* masks) {
  const hn::Rebind<std::int32_t, D> di;
  const auto x = hn::PromoteTo(d, hn::Load(di, pattern.x.data() + s));
  const auto y = hn::PromoteTo(d, hn::Load(di, pattern.y.data() + s));
  const auto in_cell = [&](int k) {
    return hn::Add(hn::Mul(hn::Set(d, edges.a[k]), x), hn::Mul(hn::Set(d, edges.b[k]), y));
  };
  const auto in_cell0 = in_cell(0), in_cell1 = in_cell(1), in_cell2 = in_cell(2);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double column = cells[i].x, row = cells[i].y;
    const auto corner = [&](int k) {
      return hn::Set(d, edges.start[k] + edges.right[k] * column + edges.down[k] * row);
    };
    const auto least =
        hn::Min(hn::Min(hn::Add(in_cell0, corner(0)), hn::Add(in_cell1, corner(1))), hn::Add(in_cell2, corner(2)));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Ge(least, hn::Zero(d)), bits);
    masks[i] |= std::uint32_t{bits[0]} << s;
  }
}

// As many lanes as the pattern has samples are enough.
template <class D>
HWY_INLINE std::uint64_t grid_masks(D d, const GridEdges* edges, std::span<const GridCell> cells,
                                    const SamplePattern& pattern, std::uint32_t* masks) {
  const std::size_t count = cells.size(), samples = static_cast<std::size_t>(pattern.count);
  for (std::size_t i = 0; i < count; ++i) masks[i] = 0;
  for (std::size_t first = 0, end = 0; first < count; first = end) {
    while (end < count && cells[end].edges == cells[first].edges) ++end;
    for (std::size_t s = 0; s < samples; s += hn::Lanes(d))
      grid_masks(d, edges[cells[first].edges], cells.subspan(first, end - first), pattern, s, masks + first);
  }
  std::uint64_t covered = 0;
  for (std::size_t i = 0; i < count; ++i) {
    masks[i] &= ~0u >> (kMaxMaskSamples - pattern.count);
    covered += static_cast<std::uint64_t>(std::popcount(masks[i]));
  }
  return covered;
}

std::uint64_t grid_masks_kernel(const GridEdges* edges, const GridCell* cells, std::size_t count,
                                const SamplePattern& pattern, std::uint32_t* masks) {
  const std::span all(cells, count);
  return pattern.count <= 4 ? grid_masks(hn::CappedTag<double, 4>(), edges, all, pattern, masks)
                            : grid_masks(hn::CappedTag<double, 8>(), edges, all, pattern, masks);
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(sample_masks_kernel);
void sample_masks(const CellEdges* cells, std::size_t count, const SamplePattern& pattern, std::uint32_t* masks) {
  HWY_DYNAMIC_DISPATCH(sample_masks_kernel)(cells, count, pattern, masks);
}
HWY_EXPORT(grid_masks_kernel);
std::uint64_t sample_masks(const GridEdges* edges, const GridCell* cells, std::size_t count,
                           const SamplePattern& pattern, std::uint32_t* masks) {
  return HWY_DYNAMIC_DISPATCH(grid_masks_kernel)(edges, cells, count, pattern, masks);
}
}  // namespace beampipe
#endif
