#include "simd/sample_mask.h"

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

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(sample_masks_kernel);
void sample_masks(const CellEdges* cells, std::size_t count, const SamplePattern& pattern, std::uint32_t* masks) {
  HWY_DYNAMIC_DISPATCH(sample_masks_kernel)(cells, count, pattern, masks);
}
}  // namespace beampipe
#endif
