#include "simd/coverage.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/coverage.cpp"
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

// The same steps as edge_integral, a vector at a time.
struct EdgeSums {
  V area, moment_u, moment_v;
};

HWY_INLINE void add_edge(V v0, V v1, V a, V b, V c, V c_right, EdgeSums& sums) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f), sixth = hn::Set(d, 1.0f / 6.0f);
  const V low = hn::Min(hn::Max(hn::Min(v0, v1), zero), one);
  const V high = hn::Min(hn::Max(hn::Max(v0, v1), zero), one);
  const M vertical = hn::Eq(b, zero), horizontal = hn::Eq(a, zero);
  const V safe_a = hn::IfThenElse(horizontal, one, a), safe_b = hn::IfThenElse(vertical, one, b);
  const V at_left = hn::IfThenElse(vertical, low, hn::Min(hn::Max(hn::Div(hn::Sub(zero, c), safe_b), low), high));
  const V at_right =
      hn::IfThenElse(vertical, high, hn::Min(hn::Max(hn::Div(hn::Sub(zero, c_right), safe_b), low), high));
  const V v_in = hn::Min(at_left, at_right), v_out = hn::Max(at_left, at_right);
  const auto u_at = [&](V v) {
    const V u = hn::Div(hn::Sub(zero, hn::Add(hn::Mul(b, v), c)), safe_a);
    return hn::Min(hn::Max(u, zero), one);
  };
  const V u_in = u_at(v_in), u_out = u_at(v_out);
  const V inner = hn::Sub(v_out, v_in);
  const M u_grows = hn::Le(hn::Mul(a, b), zero);
  const V from = hn::IfThenElse(u_grows, at_right, low), to = hn::IfThenElse(u_grows, high, at_right);
  const V beyond = hn::Sub(to, from);
  const V sum_u = hn::Add(u_in, u_out);
  const V area = hn::Add(hn::Mul(hn::Mul(half, sum_u), inner), beyond);
  const V square = hn::Add(hn::Mul(u_in, sum_u), hn::Mul(u_out, u_out));
  const V moment_u = hn::Add(hn::Mul(hn::Mul(sixth, square), inner), hn::Mul(half, beyond));
  const V weighted = hn::Add(hn::Mul(v_in, hn::Add(sum_u, u_in)), hn::Mul(v_out, hn::Add(sum_u, u_out)));
  const V moment_v =
      hn::Add(hn::Mul(hn::Mul(sixth, weighted), inner), hn::Mul(hn::Mul(half, beyond), hn::Add(from, to)));
  const V sign = hn::IfThenElse(horizontal, zero, hn::IfThenElse(hn::Lt(a, zero), one, hn::Sub(zero, one)));
  sums.area = hn::Add(sums.area, hn::Mul(sign, area));
  sums.moment_u = hn::Add(sums.moment_u, hn::Mul(sign, moment_u));
  sums.moment_v = hn::Add(sums.moment_v, hn::Mul(sign, moment_v));
}

void coverage_kernel(const CoverageInput<float>* in, std::size_t count, Coverage<float>* out) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  constexpr std::size_t kInputs = sizeof(CoverageInput<float>) / sizeof(float);
  constexpr std::size_t kOutputs = sizeof(Coverage<float>) / sizeof(float);
  HWY_ALIGN float columns[kInputs * hn::MaxLanes(d)];
  HWY_ALIGN float results[kOutputs * hn::MaxLanes(d)];
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t n = HWY_MIN(lanes, count - first);
    rows_to_columns(in + first, n, lanes, columns);
    const auto column = [&](std::size_t i) { return hn::Load(d, columns + i * lanes); };
    // Columns in the order of CoverageInput's members.
    V u[3], v[3], a[3], b[3], corner[3][4], vertex_z[3];
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = column(k), v[k] = column(3 + k), a[k] = column(6 + k), b[k] = column(9 + k);
      for (std::size_t i = 0; i < 4; ++i) corner[k][i] = column(12 + 4 * k + i);
      vertex_z[k] = column(27 + k);
    }
    const V z = column(24), dzdu = column(25), dzdv = column(26);

    EdgeSums sums{zero, zero, zero};
    for (int k = 0; k < 3; ++k) add_edge(v[k], v[(k + 1) % 3], a[k], b[k], corner[k][0], corner[k][1], sums);
    const V alpha = hn::Min(hn::Max(sums.area, zero), one);

    const V safe_area = hn::IfThenElse(hn::Gt(sums.area, zero), sums.area, one);
    const auto inside = [&](V moment, const V* x) {
      const V low = hn::Max(hn::Min(hn::Min(x[0], x[1]), x[2]), zero);
      const V high = hn::Min(hn::Max(hn::Max(x[0], x[1]), x[2]), one);
      return hn::Min(hn::Max(hn::Div(moment, safe_area), low), high);
    };
    const V centroid_u = inside(sums.moment_u, u), centroid_v = inside(sums.moment_v, v);

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
    const V outputs[kOutputs] = {alpha, centroid_u, centroid_v, z_min, z_max};
    for (std::size_t i = 0; i < kOutputs; ++i) hn::Store(outputs[i], d, results + i * lanes);
    columns_to_rows(results, n, lanes, out + first);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(coverage_kernel);
void coverage(const CoverageInput<float>* in, std::size_t count, Coverage<float>* out) {
  HWY_DYNAMIC_DISPATCH(coverage_kernel)(in, count, out);
}
}  // namespace beampipe
#endif
