// The formulas of simd/depth_bounds.h. No include guard: see simd/scalar.h.

// At (x, y), in pixels.
template <class Real>
Real depth_at(const AnchoredPlane<Real>& plane, Real x, Real y) {
  return plane.z + plane.dzdx * (x - plane.anchor_x) + plane.dzdy * (y - plane.anchor_y);
}

// Bounds within a pixel: the range of the plane over the whole pixel, limited to the depths of the vertices.
template <class Float>
DepthBounds<Float> pair_bounds(const DepthPlane<Float>& plane, const DepthBounds<Float>& vertices) {
  const Float reach = reach_in_pixel(plane.dzdu, plane.dzdv);
  return {lesser(greater(plane.z - reach, vertices.nearest), vertices.farthest),
          greater(lesser(plane.z + reach, vertices.farthest), vertices.nearest)};
}
