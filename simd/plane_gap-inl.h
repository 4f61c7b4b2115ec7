// The formulas of simd/plane_gap.h. No include guard: see simd/scalar.h.

template <class Float>
struct PlaneGap {
  Float middle, reach;
};
template <class Float>
PlaneGap<Float> plane_gap(const DepthPlane<Float>& plane, const DepthPlane<Float>& other) {
  return {plane.z - other.z, Float(0.5f) * (magnitude(plane.dzdu - other.dzdu) + magnitude(plane.dzdv - other.dzdv))};
}

// Is the first plane nearer, or farther, in the whole pixel?
template <class Float>
auto is_nearer(const PlaneGap<Float>& gap) {
  return gap.middle < Float(0.0f) - gap.reach;
}
template <class Float>
auto is_farther(const PlaneGap<Float>& gap) {
  return gap.middle > gap.reach;
}
