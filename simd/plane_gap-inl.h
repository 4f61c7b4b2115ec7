// The formulas of simd/plane_gap.h. No include guard: see simd/scalar.h.

template <class Float>
struct PlaneGap {
  Float z, dzdu, dzdv;  // a plane itself
  Float reach;          // how far the difference is at most from `z`
};
template <class Float>
PlaneGap<Float> plane_gap(const DepthPlane<Float>& plane, const DepthPlane<Float>& other) {
  const Float dzdu = plane.dzdu - other.dzdu, dzdv = plane.dzdv - other.dzdv;
  return {plane.z - other.z, dzdu, dzdv, reach_in_pixel(dzdu, dzdv)};
}

// Is the first plane nearer, or farther, in the whole pixel?
template <class Float>
auto is_nearer(const PlaneGap<Float>& gap) {
  return gap.z < Float(0.0f) - gap.reach;
}
template <class Float>
auto is_farther(const PlaneGap<Float>& gap) {
  return gap.z > gap.reach;
}
