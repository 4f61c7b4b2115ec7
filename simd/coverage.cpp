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

// Edge values, exact in double precision, rounded to float; into columns of `lanes`.
struct EdgeColumns {
  float a[hn::MaxLanes(D())], b[hn::MaxLanes(D())], c[hn::MaxLanes(D())], c_right[hn::MaxLanes(D())];
};

HWY_INLINE void set_edge(const std::int32_t* x0, const std::int32_t* y0, const std::int32_t* x1, const std::int32_t* y1,
                         std::size_t lanes, EdgeColumns& edge) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<std::int32_t, decltype(d)> di;
  const hn::Rebind<float, decltype(d)> df;
  const auto unit = hn::Set(df, 1.0f / kSubpixelUnits);
  const auto unit_area = hn::Set(df, 1.0f / kSubpixelUnits / kSubpixelUnits);
  for (std::size_t i = 0; i < lanes; i += hn::Lanes(d)) {
    const auto at = [&](const std::int32_t* column) { return hn::PromoteTo(d, hn::Load(di, column + i)); };
    const auto px = at(x0), py = at(y0);
    const auto a = hn::Sub(py, at(y1)), b = hn::Sub(at(x1), px);
    const auto c = hn::Sub(hn::Zero(d), hn::Add(hn::Mul(a, px), hn::Mul(b, py)));
    const auto c_right = hn::Add(c, hn::Mul(a, hn::Set(d, double{kSubpixelUnits})));
    hn::Store(hn::Mul(hn::DemoteTo(df, a), unit), df, edge.a + i);
    hn::Store(hn::Mul(hn::DemoteTo(df, b), unit), df, edge.b + i);
    hn::Store(hn::Mul(hn::DemoteTo(df, c), unit_area), df, edge.c + i);
    hn::Store(hn::Mul(hn::DemoteTo(df, c_right), unit_area), df, edge.c_right + i);
  }
}

void coverage_kernel(const TriangleInPixel* in, std::size_t count, Coverage<float>* out) {
  const D d;
  const hn::RebindToSigned<D> di;
  const std::size_t lanes = hn::Lanes(d);
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), unit = hn::Set(d, 1.0f / kSubpixelUnits);
  constexpr std::size_t kInputs = sizeof(TriangleInPixel) / sizeof(float);
  constexpr std::size_t kOutputs = sizeof(Coverage<float>) / sizeof(float);
  HWY_ALIGN std::int32_t columns[kInputs * hn::MaxLanes(d)];  // x of the three vertices, then y
  HWY_ALIGN float results[kOutputs * hn::MaxLanes(d)];
  HWY_ALIGN EdgeColumns edge;
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t n = HWY_MIN(lanes, count - first);
    rows_to_columns(in + first, n, lanes, columns);
    const auto column = [&](std::size_t i) { return columns + i * lanes; };
    V u[3], v[3];
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = hn::Mul(hn::ConvertTo(d, hn::Load(di, column(k))), unit);
      v[k] = hn::Mul(hn::ConvertTo(d, hn::Load(di, column(3 + k))), unit);
    }

    EdgeSums sums{zero, zero, zero};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      set_edge(column(k), column(3 + k), column(next), column(3 + next), lanes, edge);
      add_edge(v[k], v[next], hn::Load(d, edge.a), hn::Load(d, edge.b), hn::Load(d, edge.c), hn::Load(d, edge.c_right),
               sums);
    }
    const V alpha = hn::Min(hn::Max(sums.area, zero), one);

    const V safe_area = hn::IfThenElse(hn::Gt(sums.area, zero), sums.area, one);
    const auto inside = [&](V moment, const V* x) {
      const V low = hn::Max(hn::Min(hn::Min(x[0], x[1]), x[2]), zero);
      const V high = hn::Min(hn::Max(hn::Max(x[0], x[1]), x[2]), one);
      return hn::Min(hn::Max(hn::Div(moment, safe_area), low), high);
    };
    const V outputs[kOutputs] = {alpha, inside(sums.moment_u, u), inside(sums.moment_v, v)};
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
void coverage(const TriangleInPixel* in, std::size_t count, Coverage<float>* out) {
  HWY_DYNAMIC_DISPATCH(coverage_kernel)(in, count, out);
}
}  // namespace beampipe
#endif
