// The formulas of simd/triangle_setup.h. No include guard: see simd/scalar.h.

template <class Real>
Slopes<Real> depth_slopes(const ScreenVertex<Real>& p, const ScreenVertex<Real>& q, const ScreenVertex<Real>& r) {
  const Real qx = q.x - p.x, qy = q.y - p.y, qz = q.z - p.z;
  const Real rx = r.x - p.x, ry = r.y - p.y, rz = r.z - p.z;
  const Real inverse = Real(1.0) / (qx * ry - rx * qy);
  return {(qz * ry - rz * qy) * inverse, (rz * qx - qz * rx) * inverse};
}

// By x, then y, then depth.
template <class Real>
void put_in_order(ScreenVertex<Real>& p, ScreenVertex<Real>& q) {
  const auto swap = (q.x < p.x) | ((q.x == p.x) & ((q.y < p.y) | ((q.y == p.y) & (q.z < p.z))));
  const ScreenVertex<Real> first{select(swap, q.x, p.x), select(swap, q.y, p.y), select(swap, q.z, p.z)};
  q = {select(swap, p.x, q.x), select(swap, p.y, q.y), select(swap, p.z, q.z)};
  p = first;
}

// Sorted, so that a triangle has the same depth whichever vertex comes first and whichever way it turns.
template <class Real>
AnchoredPlane<Real> depth_plane_of(ScreenVertex<Real> p, ScreenVertex<Real> q, ScreenVertex<Real> r) {
  put_in_order(p, q), put_in_order(q, r), put_in_order(p, q);
  const Slopes<Real> slopes = depth_slopes(p, q, r);
  return {p.z, slopes.dzdx, slopes.dzdy, p.x, p.y};
}

// `m`: column-major. The sums are grouped as in glm.
template <class Real>
Vector<Real> world_point(const std::array<Real, 16>& m, const Vector<Real>& p) {
  const auto row = [&](std::size_t r) { return (m[r] * p.x + m[4 + r] * p.y) + (m[8 + r] * p.z + m[12 + r]); };
  return {row(0), row(1), row(2)};
}

// The normal of a triangle, not normalized, and its length.
template <class Real>
Vector<Real> face_normal(const Vector<Real>& p, const Vector<Real>& q, const Vector<Real>& r, Real& length) {
  const Real ax = q.x - p.x, ay = q.y - p.y, az = q.z - p.z;
  const Real bx = r.x - p.x, by = r.y - p.y, bz = r.z - p.z;
  const Vector<Real> normal{ay * bz - by * az, az * bx - bz * ax, ax * by - bx * ay};
  length = square_root(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
  return normal;
}

// The same with length 1 or, if `side` is -1, the other way; 0 if the triangle has no area. `corners`: in the mesh.
template <class Real>
Vector<Real> unit_normal(const std::array<Real, 16>& to_world, const Vector<Real> (&corners)[3], Real side) {
  Real length;
  const Vector<Real> normal = face_normal(world_point(to_world, corners[0]), world_point(to_world, corners[1]),
                                          world_point(to_world, corners[2]), length);
  const Real zero(0.0), scale = side / length;
  const auto has_area = length > zero;
  return {select(has_area, normal.x * scale, zero), select(has_area, normal.y * scale, zero),
          select(has_area, normal.z * scale, zero)};
}
