// The formula of simd/coverage.h. No include guard: see simd/scalar.h.

// One edge's part of the area and of the first moments.
template <class Float>
struct EdgeIntegral {
  Float area, moment_u, moment_v;
};

// By Green's theorem the clipped area is the sum over edges of +-(integral of clamp(u_edge(v), 0, 1) dv), v over the
// edge's extent within [0,1]; the first moments likewise. The sign is the edge's direction, so the two triangles of a
// shared edge add exactly opposite numbers: the areas of a tessellation sum to the whole's.
//
// The edge runs from v0 to v1, in pixels; its value is a u + b v + c, and c_right = a + c is the constant of the same
// edge seen from u = 1.
template <class Float>
EdgeIntegral<Float> edge_integral(Float v0, Float v1, Float a, Float b, Float c, Float c_right) {
  const Float zero(0.0f), one(1.0f), half(0.5f), sixth(1.0f / 6.0f);
  const Float low = lesser(greater(lesser(v0, v1), zero), one);
  const Float high = lesser(greater(greater(v0, v1), zero), one);
  const auto vertical = b == zero, horizontal = a == zero;
  const Float safe_a = select(horizontal, one, a), safe_b = select(vertical, one, b);
  // Where the edge crosses u = 0 and u = 1, clamped to its extent. A vertical edge counts as wholly between.
  const Float at_left = select(vertical, low, lesser(greater((zero - c) / safe_b, low), high));
  const Float at_right = select(vertical, high, lesser(greater((zero - c_right) / safe_b, low), high));
  const Float v_in = lesser(at_left, at_right), v_out = greater(at_left, at_right);
  const Float u_in = lesser(greater((zero - (b * v_in + c)) / safe_a, zero), one);
  const Float u_out = lesser(greater((zero - (b * v_out + c)) / safe_a, zero), one);
  const Float inner = v_out - v_in;
  // Beyond u = 1 the whole width counts: above the crossing where u grows with v, else below it.
  const auto u_grows = a * b <= zero;
  const Float from = select(u_grows, at_right, low), to = select(u_grows, high, at_right);
  const Float beyond = to - from;
  const Float sum_u = u_in + u_out;
  const Float area = half * sum_u * inner + beyond;
  const Float moment_u = sixth * (u_in * sum_u + u_out * u_out) * inner + half * beyond;
  const Float moment_v =
      sixth * (v_in * (sum_u + u_in) + v_out * (sum_u + u_out)) * inner + half * beyond * (from + to);
  const Float sign = select(horizontal, zero, select(a < zero, one, zero - one));
  return {sign * area, sign * moment_u, sign * moment_v};
}

// Int holds edge values exactly. They are rounded to Float only afterwards, so that reversing an edge negates them.
template <class Int, class Float>
Coverage<Float> coverage_formula(const TriangleInPixelOf<Int>& in) {
  const Float zero(0.0f), one(1.0f), unit(1.0f / kSubpixelUnits), unit_area(1.0f / kSubpixelUnits / kSubpixelUnits);
  Float u[3], v[3];
  for (int k = 0; k < 3; ++k) u[k] = to_float(in.x[k]) * unit, v[k] = to_float(in.y[k]) * unit;
  Float area = zero, moment_u = zero, moment_v = zero;
  for (int k = 0; k < 3; ++k) {
    const EdgeInPixel<Int> edge = edge_in_pixel(in, k);
    const Float c = to_float(edge.c) * unit_area;
    const Float c_right = to_float(edge.c + edge.a * Int(kSubpixelUnits)) * unit_area;
    const EdgeIntegral<Float> integral =
        edge_integral(v[k], v[(k + 1) % 3], to_float(edge.a) * unit, to_float(edge.b) * unit, c, c_right);
    area = area + integral.area;
    moment_u = moment_u + integral.moment_u;
    moment_v = moment_v + integral.moment_v;
  }
  Coverage<Float> out;
  out.alpha = lesser(greater(area, zero), one);

  // The centroid is clamped to the part of the pixel that the triangle's bounding box reaches: where the area is tiny,
  // the quotient is mostly rounding error.
  const Float safe_area = select(area > zero, area, one);
  const auto inside = [&](Float moment, const Float* x) {
    const Float low = greater(lesser(lesser(x[0], x[1]), x[2]), zero);
    const Float high = lesser(greater(greater(x[0], x[1]), x[2]), one);
    return lesser(greater(moment / safe_area, low), high);
  };
  out.centroid_u = inside(moment_u, u);
  out.centroid_v = inside(moment_v, v);
  return out;
}
