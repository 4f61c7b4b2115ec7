// Where in its triangle a point of the screen lies, for numbers and for vectors. (x, y): pixels from the planes'
// anchor. No include guard: see simd/scalar.h.

template <class Real>
Real value_at(const ScreenPlane<Real>& plane, const Real& x, const Real& y) {
  return plane.value + plane.dx * x + plane.dy * y;
}

template <class Real>
Real limited_weight(const Real& weight) {
  return lesser(greater(weight, Real(-kMostWeight)), Real(1.0f + kMostWeight));
}

template <class Real>
Barycentrics<Real> weights_at(const BarycentricPlanes<Real>& planes, const Real& x, const Real& y) {
  const Real w = Real(1.0f) / value_at(planes.inverse_w, x, y);
  return {limited_weight(value_at(planes.second, x, y) * w), limited_weight(value_at(planes.third, x, y) * w)};
}

// How the weights change per pixel, to the right and down, at a point where they are `weights`.
template <class Real>
std::array<Barycentrics<Real>, 2> weight_slopes(const BarycentricPlanes<Real>& planes, const Real& x, const Real& y,
                                                const Barycentrics<Real>& weights) {
  const Real w = Real(1.0f) / value_at(planes.inverse_w, x, y);
  return {{{(planes.second.dx - weights.second * planes.inverse_w.dx) * w,
            (planes.third.dx - weights.third * planes.inverse_w.dx) * w},
           {(planes.second.dy - weights.second * planes.inverse_w.dy) * w,
            (planes.third.dy - weights.third * planes.inverse_w.dy) * w}}};
}
