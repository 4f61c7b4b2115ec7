// The formulas of simd/depth_plane.h. No include guard: see simd/scalar.h.

// u and v from the pixel's centre, in pixels.
template <class Float>
Float depth_at(const DepthPlane<Float>& plane, Float u, Float v) {
  return plane.z + plane.dzdu * u + plane.dzdv * v;
}

// How far depths in the pixel are at most from that at its centre.
template <class Float>
Float reach_in_pixel(Float dzdu, Float dzdv) {
  return Float(0.5f) * (magnitude(dzdu) + magnitude(dzdv));
}
