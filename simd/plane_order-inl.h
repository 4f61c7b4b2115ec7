// The formulas of simd/plane_order.h, for one position: u and v from the pixel's centre, in pixels. No include guard:
// see simd/scalar.h.

template <class Float>
auto nearer_formula(const DepthPlane<Float>& plane, const DepthPlane<Float>& other, Float u, Float v) {
  return depth_at(plane, u, v) < depth_at(other, u, v);
}

template <class Float, class Bool>
Float farthest_formula(const DepthPlane<Float>& plane, Float u, Float v, Bool in_mask, Float farthest) {
  return select(in_mask, greater(farthest, depth_at(plane, u, v)), farthest);
}
