// The formula of simd/depth_span.h. No include guard: see simd/scalar.h.

// Of sample `index`: its depth, and is it nearer than the stored one?
template <class Real>
auto depth_span_sample(Real z, Real dzdx, Real row, Real x, Real step, Real index, Real stored, Real& depth) {
  depth = (z + dzdx * (x + step * index)) + row;
  return depth < stored;
}
