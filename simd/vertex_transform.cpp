#include "simd/vertex_transform.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/vertex_transform.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

std::size_t transform_vertices_kernel(const float* positions, std::size_t count, const VertexTransform& transform,
                                      ProjectedVertex* out) {
  const D d;
  const hn::Rebind<float, D> df;
  const hn::Rebind<std::int32_t, D> di;
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  const std::array<double, 16>& m = transform.to_clip;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0), half = hn::Set(d, 0.5);
  const V units = hn::Set(d, double{kSubpixelUnits}), unit = hn::Set(d, 1.0 / kSubpixelUnits);
  const V width = hn::Set(d, transform.width), height = hn::Set(d, transform.height);
  HWY_ALIGN float columns[3 * kLanes];
  HWY_ALIGN double clip[4][kLanes], screen[3][kLanes];
  HWY_ALIGN std::int32_t snapped[2][kLanes];
  std::size_t seen = 0;
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t n = HWY_MIN(kLanes, count - first);
    rows_to_columns(reinterpret_cast<const std::array<float, 3>*>(positions) + first, n, kLanes, columns);
    const auto column = [&](std::size_t i) { return hn::PromoteTo(d, hn::Load(df, columns + i * kLanes)); };
    const V px = column(0), py = column(1), pz = column(2);
    const auto row = [&](std::size_t r) {
      const V sum = hn::Add(hn::Mul(hn::Set(d, m[r]), px), hn::Mul(hn::Set(d, m[4 + r]), py));
      return hn::Add(hn::Add(sum, hn::Mul(hn::Set(d, m[8 + r]), pz)), hn::Set(d, m[12 + r]));
    };
    const V x = row(0), y = row(1), z = row(2), w = row(3);

    const V sum = hn::Add(hn::Add(hn::Add(x, y), z), w);
    const auto finite = hn::Eq(hn::Sub(sum, sum), zero);
    const auto within = [&](V value) { return hn::Le(hn::Abs(value), w); };
    const auto in_view = hn::And(hn::And(hn::And(finite, hn::Gt(w, zero)), within(x)), hn::And(within(y), within(z)));

    const V inverse_w = hn::Div(one, w);
    const auto visible = [&](V value) { return hn::IfThenElseZero(in_view, value); };
    const V screen_x = visible(hn::Mul(hn::Mul(hn::Add(hn::Mul(x, inverse_w), one), half), width));
    const V screen_y = visible(hn::Mul(hn::Mul(hn::Sub(one, hn::Mul(y, inverse_w)), half), height));
    const V screen_z = visible(hn::Mul(hn::Sub(hn::Mul(z, inverse_w), one), half));
    const auto on_grid = [&](V pixels) { return hn::Floor(hn::Add(hn::Mul(pixels, units), half)); };
    const V grid_x = on_grid(screen_x), grid_y = on_grid(screen_y);

    hn::Store(x, d, clip[0]), hn::Store(y, d, clip[1]), hn::Store(z, d, clip[2]), hn::Store(w, d, clip[3]);
    hn::Store(hn::Mul(grid_x, unit), d, screen[0]), hn::Store(hn::Mul(grid_y, unit), d, screen[1]);
    hn::Store(screen_z, d, screen[2]);
    hn::Store(hn::DemoteTo(di, grid_x), di, snapped[0]), hn::Store(hn::DemoteTo(di, grid_y), di, snapped[1]);
    std::uint8_t finite_bits[8] = {}, view_bits[8] = {};
    hn::StoreMaskBits(d, finite, finite_bits);
    hn::StoreMaskBits(d, in_view, view_bits);
    for (std::size_t i = 0; i < n; ++i) {
      const bool is_in_view = view_bits[0] >> i & 1;
      out[first + i] = {{clip[0][i], clip[1][i], clip[2][i], clip[3][i]},
                        {screen[0][i], screen[1][i], screen[2][i]},
                        snapped[0][i],
                        snapped[1][i],
                        (finite_bits[0] >> i & 1) != 0,
                        is_in_view};
      seen += is_in_view;
    }
  }
  return seen;
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(transform_vertices_kernel);
std::size_t transform_vertices(const float* positions, std::size_t count, const VertexTransform& transform,
                               ProjectedVertex* out) {
  return HWY_DYNAMIC_DISPATCH(transform_vertices_kernel)(positions, count, transform, out);
}
}  // namespace beampipe
#endif
