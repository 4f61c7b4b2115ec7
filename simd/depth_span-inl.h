// The formula of simd/depth_span.h. No include guard: see simd/scalar.h.

// Of sample `index`: its depth, and is it nearer than the stored one?
template <class Real>
auto depth_span_sample(const DepthSpanOf<Real>& span, Real index, Real stored, Real& depth) {
  depth = (span.z + span.dzdx * (span.x + span.step * index)) + span.row;
  return depth < stored;
}
