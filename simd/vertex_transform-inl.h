// The formulas of simd/vertex_transform.h. No include guard: see simd/scalar.h.

// `last(r)`: what row r of the matrix adds for w.
template <class Real, class Last>
ClipVertex<Real> transform_rows(const std::array<Real, 16>& m, Real x, Real y, Real z, Last&& last) {
  const auto row = [&](std::size_t r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + last(r); };
  return {row(0), row(1), row(2), row(3)};
}

template <class Real>
ClipVertex<Real> transform_vertex(const std::array<Real, 16>& m, Real x, Real y, Real z) {
  return transform_rows(m, x, y, z, [&](std::size_t r) { return m[12 + r]; });
}

// The same for a homogeneous position.
template <class Real>
ClipVertex<Real> transform_vertex(const std::array<Real, 16>& m, Real x, Real y, Real z, Real w) {
  return transform_rows(m, x, y, z, [&](std::size_t r) { return m[12 + r] * w; });
}

template <class Real>
auto in_view(const ClipVertex<Real>& v) {
  return (v.w > Real(0.0)) & (magnitude(v.x) <= v.w) & (magnitude(v.y) <= v.w) & (magnitude(v.z) <= v.w);
}

// Viewport transform. Depth goes from [-1, 1] to [-1, 0].
template <class Real>
ScreenVertex<Real> project(const ClipVertex<Real>& v, Real width, Real height) {
  const Real half(0.5), one(1.0);
  const Real inverse_w = one / v.w;
  return {(v.x * inverse_w + one) * half * width, (one - v.y * inverse_w) * half * height,
          (v.z * inverse_w - one) * half};
}

// Pixels in units of 1/256 px, plus a half: rounding down then rounds to the nearest unit.
template <class Real>
Real to_grid(Real pixels) {
  return pixels * Real(double{kSubpixelUnits}) + Real(0.5);
}
