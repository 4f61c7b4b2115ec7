// Where a texture coordinate lies in a level, for numbers and for vectors. No include guard: see simd/scalar.h.

// The largest whole number that is not above x, which is less than 2^31 away from 0. std::floor is a function call on
// machines that may lack the instruction.
template <class Real>
auto floor_of(const Real& x) {
  const auto whole = to_integer(x);
  using Int = std::remove_const_t<decltype(whole)>;
  return whole - select(to_float(whole) > x, Int(1), Int(0));
}

// The number of a texel as a number within the image. It lies between -1 and 2 * size, as in_texels() sees to, or
// anywhere with Wrap::clamp. There is no division.
template <class Int>
Int wrapped(Int texel, const Int& size, Wrap wrap) {
  const Int zero(0), last = size - Int(1);
  if (wrap == Wrap::clamp) return lesser(greater(texel, zero), last);
  const Int period = wrap == Wrap::repeat ? size : size + size;
  texel = texel + select(texel < zero, period, zero);
  for (int i = 0; i < 2; ++i) texel = texel - select(texel < period, zero, period);
  return select(texel < size, texel, size + last - texel);
}

// A texture coordinate in texels of a level. Coordinates that are not finite, or so large that texels cannot be told
// apart, become 0.
template <class Real>
Real in_texels(Real coordinate, const Real& size, Wrap wrap) {
  const Real most(1 << 24);
  coordinate = select(magnitude(coordinate) < most, coordinate, Real(0.0f));
  // the period of `mirror`
  if (wrap != Wrap::clamp) coordinate = coordinate - Real(2.0f) * to_float(floor_of(Real(0.5f) * coordinate));
  return lesser(greater(coordinate, Real(-1.0f)), Real(3.0f)) * size;
}

// The two texels, in a row or column of this size, around a place in texels, and the share of the second one.
template <class Real, class Int>
TexelPairOf<Real, Int> texels_around(const Real& place, const Int& size, Wrap wrap) {
  const Real from_centre = place - Real(0.5f);
  const Int first = floor_of(from_centre);
  return {wrapped(first, size, wrap), wrapped(first + Int(1), size, wrap), from_centre - to_float(first)};
}
