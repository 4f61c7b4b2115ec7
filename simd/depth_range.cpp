#include "simd/depth_range.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/depth_range.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/soa-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

void depth_range_kernel(const DepthRangeInput<float>* in, std::size_t count, DepthRange<float>* out) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  constexpr std::size_t kInputs = sizeof(DepthRangeInput<float>) / sizeof(float);
  constexpr std::size_t kOutputs = sizeof(DepthRange<float>) / sizeof(float);
  HWY_ALIGN float columns[kInputs * hn::MaxLanes(d)];
  HWY_ALIGN float results[kOutputs * hn::MaxLanes(d)];
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t n = HWY_MIN(lanes, count - first);
    rows_to_columns(in + first, n, lanes, columns);
    const auto column = [&](std::size_t i) { return hn::Load(d, columns + i * lanes); };
    // Columns in the order of DepthRangeInput's members.
    V u[3], v[3], corner[3][4], vertex_z[3];
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = column(k), v[k] = column(3 + k);
      for (std::size_t i = 0; i < 4; ++i) corner[k][i] = column(6 + 4 * k + i);
      vertex_z[k] = column(21 + k);
    }
    const V z = column(18), dzdu = column(19), dzdv = column(20);

    const V z_nearest = hn::Min(hn::Min(vertex_z[0], vertex_z[1]), vertex_z[2]);
    const V z_farthest = hn::Max(hn::Max(vertex_z[0], vertex_z[1]), vertex_z[2]);
    const auto plane = [&](V at_u, V at_v) {
      const V at = hn::Add(hn::Add(z, hn::Mul(dzdu, hn::Sub(at_u, half))), hn::Mul(dzdv, hn::Sub(at_v, half)));
      return hn::Min(hn::Max(at, z_nearest), z_farthest);
    };
    V z_min = z_farthest, z_max = z_nearest;
    const auto include = [&](M valid, V at) {
      z_min = hn::IfThenElse(valid, hn::Min(z_min, at), z_min);
      z_max = hn::IfThenElse(valid, hn::Max(z_max, at), z_max);
    };
    for (int k = 0; k < 3; ++k) {
      const M inside_u = hn::And(hn::Ge(u[k], zero), hn::Le(u[k], one));
      const M inside_v = hn::And(hn::Ge(v[k], zero), hn::Le(v[k], one));
      include(hn::And(inside_u, inside_v), vertex_z[k]);
    }
    const V corner_u[4] = {zero, one, zero, one}, corner_v[4] = {zero, zero, one, one};
    for (int i = 0; i < 4; ++i) {
      const M covered =
          hn::And(hn::And(hn::Ge(corner[0][i], zero), hn::Ge(corner[1][i], zero)), hn::Ge(corner[2][i], zero));
      include(covered, plane(corner_u[i], corner_v[i]));
    }
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const auto crossing = [&](int from, int to) {
        const V difference = hn::Sub(corner[k][from], corner[k][to]);
        return hn::Div(corner[k][from], hn::IfThenElse(hn::Eq(difference, zero), one, difference));
      };
      const auto differ = [&](V x, V y, V border) { return hn::Xor(hn::Lt(x, border), hn::Lt(y, border)); };
      for (int side = 0; side < 2; ++side) {
        const V border = side == 0 ? zero : one;
        include(hn::And(differ(u[k], u[next], border), differ(corner[k][side], corner[k][side + 2], zero)),
                plane(border, crossing(side, side + 2)));
        include(hn::And(differ(v[k], v[next], border), differ(corner[k][2 * side], corner[k][2 * side + 1], zero)),
                plane(crossing(2 * side, 2 * side + 1), border));
      }
    }
    const V outputs[kOutputs] = {z_min, z_max};
    for (std::size_t i = 0; i < kOutputs; ++i) hn::Store(outputs[i], d, results + i * lanes);
    columns_to_rows(results, n, lanes, out + first);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(depth_range_kernel);
void depth_range(const DepthRangeInput<float>* in, std::size_t count, DepthRange<float>* out) {
  HWY_DYNAMIC_DISPATCH(depth_range_kernel)(in, count, out);
}
}  // namespace beampipe
#endif
