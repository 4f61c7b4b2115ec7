// The formula of simd/depth_plane.h. No include guard: see simd/scalar.h.

// u and v from the pixel's centre, in pixels.
template <class Float>
Float depth_at(const DepthPlane<Float>& plane, Float u, Float v) {
  return plane.z + plane.dzdu * u + plane.dzdv * v;
}
