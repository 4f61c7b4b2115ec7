#include "simd/vertex_transform.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/vertex_transform.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

#include "simd/vertex_transform-inl.h"

using D = hn::CappedTag<double, 8>;
using Reals = Lanes<D>;
constexpr std::size_t kLanes = hn::MaxLanes(D());

struct Positions {
  float x[kLanes], y[kLanes], z[kLanes];
};

std::size_t transform_vertices_kernel(const float* positions, std::size_t count, const VertexTransform& transform,
                                      ProjectedVertex* out, const float* ws) {
  const D d;
  const hn::Rebind<float, D> df;
  const hn::Rebind<std::int32_t, D> di;
  std::array<Reals, 16> to_clip;
  for (std::size_t i = 0; i < 16; ++i) to_clip[i] = Reals(transform.to_clip[i]);
  const Reals zero(0.0), unit(1.0 / kSubpixelUnits), width(transform.width), height(transform.height);
  HWY_ALIGN double clip[4][kLanes], screen[3][kLanes];
  HWY_ALIGN std::int32_t snapped[2][kLanes];
  HWY_ALIGN float w[kLanes] = {};
  std::size_t seen = 0;
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t n = HWY_MIN(kLanes, count - first);
    HWY_ALIGN const auto columns =
        load_rows<Positions>(reinterpret_cast<const std::array<float, 3>*>(positions) + first, n);
    const auto load = [&](const float* column) { return Reals(hn::PromoteTo(d, hn::Load(df, column))); };
    const Reals x = load(columns.x), y = load(columns.y), z = load(columns.z);
    if (ws) std::copy_n(ws + first, n, w);
    const ClipVertex<Reals> vertex =
        ws ? transform_vertex(to_clip, x, y, z, load(w)) : transform_vertex(to_clip, x, y, z);
    const Reals sum = vertex.x + vertex.y + vertex.z + vertex.w;
    const auto finite = sum - sum == zero, visible = finite & in_view(vertex);

    const ScreenVertex<Reals> projected = project(vertex, width, height);
    const auto on_grid = [&](Reals pixels) { return Reals(hn::Floor(to_grid(select(visible, pixels, zero)).raw)); };
    const Reals grid_x = on_grid(projected.x), grid_y = on_grid(projected.y);

    const auto store = [&](Reals values, double* to) { hn::Store(values.raw, d, to); };
    store(vertex.x, clip[0]), store(vertex.y, clip[1]), store(vertex.z, clip[2]), store(vertex.w, clip[3]);
    store(grid_x * unit, screen[0]), store(grid_y * unit, screen[1]);
    store(select(visible, projected.z, zero), screen[2]);
    hn::Store(hn::DemoteTo(di, grid_x.raw), di, snapped[0]), hn::Store(hn::DemoteTo(di, grid_y.raw), di, snapped[1]);
    std::uint8_t finite_bits[8] = {}, view_bits[8] = {};
    hn::StoreMaskBits(d, finite.raw, finite_bits);
    hn::StoreMaskBits(d, visible.raw, view_bits);
    for (std::size_t i = 0; i < n; ++i) {
      const bool is_in_view = view_bits[0] >> i & 1;
      out[first + i] = {.clip = {clip[0][i], clip[1][i], clip[2][i], clip[3][i]},
                        .screen = {screen[0][i], screen[1][i], screen[2][i]},
                        .x = snapped[0][i],
                        .y = snapped[1][i],
                        .finite = (finite_bits[0] >> i & 1) != 0,
                        .in_view = is_in_view};
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
                               ProjectedVertex* out, const float* ws) {
  return HWY_DYNAMIC_DISPATCH(transform_vertices_kernel)(positions, count, transform, out, ws);
}
}  // namespace beampipe
#endif
