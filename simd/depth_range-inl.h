// The formula of simd/depth_range.h. No include guard: see simd/scalar.h.

template <class Float>
DepthRange<Float> depth_range_formula(const DepthRangeInput<Float>& in) {
  const Float zero(0.0f), one(1.0f), half(0.5f);
  DepthRange<Float> out;
  const Float z_nearest = lesser(lesser(in.vertex_z[0], in.vertex_z[1]), in.vertex_z[2]);
  const Float z_farthest = greater(greater(in.vertex_z[0], in.vertex_z[1]), in.vertex_z[2]);
  const auto plane = [&](Float u, Float v) {
    const Float z = in.z + in.dzdu * (u - half) + in.dzdv * (v - half);
    return lesser(greater(z, z_nearest), z_farthest);
  };
  out.z_min = z_farthest, out.z_max = z_nearest;
  const auto include = [&](auto valid, Float z) {
    out.z_min = select(valid, lesser(out.z_min, z), out.z_min);
    out.z_max = select(valid, greater(out.z_max, z), out.z_max);
  };
  for (int k = 0; k < 3; ++k) {
    const auto inside_u = (in.u[k] >= zero) & (in.u[k] <= one), inside_v = (in.v[k] >= zero) & (in.v[k] <= one);
    include(inside_u & inside_v, in.vertex_z[k]);
  }
  const Float corner_u[4] = {zero, one, zero, one}, corner_v[4] = {zero, zero, one, one};
  for (int i = 0; i < 4; ++i) {
    const auto inside = (in.corner[0][i] >= zero) & (in.corner[1][i] >= zero) & (in.corner[2][i] >= zero);
    include(inside, plane(corner_u[i], corner_v[i]));
  }
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Float* corner = in.corner[k];
    const auto crossing = [&](int from, int to) {  // parameter 0..1 along the border between two corners
      const Float difference = corner[from] - corner[to];
      return corner[from] / select(difference == zero, one, difference);
    };
    for (int side = 0; side < 2; ++side) {  // u = 0 and u = 1, then v = 0 and v = 1
      const Float border = side == 0 ? zero : one;
      const auto straddles_u = (in.u[k] < border) != (in.u[next] < border);
      const auto along_v = (corner[side] < zero) != (corner[side + 2] < zero);
      include(straddles_u & along_v, plane(border, crossing(side, side + 2)));
      const auto straddles_v = (in.v[k] < border) != (in.v[next] < border);
      const auto along_u = (corner[2 * side] < zero) != (corner[2 * side + 1] < zero);
      include(straddles_v & along_u, plane(crossing(2 * side, 2 * side + 1), border));
    }
  }
  return out;
}
