// Vectors that a formula can use like numbers: operators, comparisons, `select` and the functions of simd/scalar.h, one
// number per lane. Included once per SIMD target. A multiplication and an addition are never fused, so that every
// target gives the same bits as one number at a time.
#if defined(BEAMPIPE_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_SIMD_LANES_INL_H_
#undef BEAMPIPE_SIMD_LANES_INL_H_
#else
#define BEAMPIPE_SIMD_LANES_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// What a comparison gives: true or false per lane. D is the tag of a vector of float or double; integers of the same
// size share its masks.
template <class D>
struct LaneMask {
  hn::Mask<D> raw;
};

template <class D>
HWY_INLINE LaneMask<D> operator&(LaneMask<D> a, LaneMask<D> b) {
  return {hn::And(a.raw, b.raw)};
}
template <class D>
HWY_INLINE LaneMask<D> operator|(LaneMask<D> a, LaneMask<D> b) {
  return {hn::Or(a.raw, b.raw)};
}
template <class D>
HWY_INLINE LaneMask<D> operator!=(LaneMask<D> a, LaneMask<D> b) {
  return {hn::Xor(a.raw, b.raw)};
}
template <class D>
HWY_INLINE LaneMask<D> operator!(LaneMask<D> a) {
  return {hn::Not(a.raw)};
}

// D is Highway's tag: what a lane holds and how many there are.
template <class D>
struct Lanes {
  hn::Vec<D> raw;

  Lanes() = default;
  HWY_INLINE explicit Lanes(hn::TFromD<D> value) : raw(hn::Set(D(), value)) {}  // the same in every lane
  HWY_INLINE explicit Lanes(hn::Vec<D> vector) : raw(vector) {}
};

#define BEAMPIPE_LANES_BINARY(op, function)                 \
  template <class D>                                        \
  HWY_INLINE Lanes<D> operator op(Lanes<D> a, Lanes<D> b) { \
    return Lanes<D>(hn::function(a.raw, b.raw));            \
  }
BEAMPIPE_LANES_BINARY(+, Add)
BEAMPIPE_LANES_BINARY(-, Sub)
BEAMPIPE_LANES_BINARY(*, Mul)
BEAMPIPE_LANES_BINARY(/, Div)
BEAMPIPE_LANES_BINARY(&, And)
BEAMPIPE_LANES_BINARY(|, Or)
#undef BEAMPIPE_LANES_BINARY

template <class D>
HWY_INLINE Lanes<D> operator~(Lanes<D> a) {
  return Lanes<D>(hn::Not(a.raw));
}

#define BEAMPIPE_LANES_COMPARISON(op, function)                                   \
  template <class D>                                                              \
  HWY_INLINE LaneMask<hn::RebindToFloat<D>> operator op(Lanes<D> a, Lanes<D> b) { \
    return {hn::RebindMask(hn::RebindToFloat<D>(), hn::function(a.raw, b.raw))};  \
  }
BEAMPIPE_LANES_COMPARISON(<, Lt)
BEAMPIPE_LANES_COMPARISON(<=, Le)
BEAMPIPE_LANES_COMPARISON(>, Gt)
BEAMPIPE_LANES_COMPARISON(>=, Ge)
BEAMPIPE_LANES_COMPARISON(==, Eq)
BEAMPIPE_LANES_COMPARISON(!=, Ne)
#undef BEAMPIPE_LANES_COMPARISON

template <class D>
HWY_INLINE Lanes<D> select(LaneMask<hn::RebindToFloat<D>> condition, Lanes<D> yes, Lanes<D> no) {
  return Lanes<D>(hn::IfThenElse(hn::RebindMask(D(), condition.raw), yes.raw, no.raw));
}
// See simd/scalar.h.
template <class D>
HWY_INLINE bool any(LaneMask<D> condition) {
  return !hn::AllFalse(D(), condition.raw);
}
template <class D>
HWY_INLINE Lanes<D> choose(LaneMask<hn::RebindToFloat<D>> condition, Lanes<D> yes, Lanes<D> no) {
  return select(condition, yes, no);
}
// Min and Max of x86 give their second operand where the two compare equal (0 and -0) or not at all. Other processors
// order zeros and pass on what is not a number, so there the rule is written out.
template <class D>
HWY_INLINE Lanes<D> lesser(Lanes<D> a, Lanes<D> b) {
#if HWY_ARCH_X86
  return Lanes<D>(hn::Min(a.raw, b.raw));
#else
  return select(a < b, a, b);
#endif
}
template <class D>
HWY_INLINE Lanes<D> greater(Lanes<D> a, Lanes<D> b) {
#if HWY_ARCH_X86
  return Lanes<D>(hn::Max(a.raw, b.raw));
#else
  return select(a > b, a, b);
#endif
}
template <class D>
HWY_INLINE Lanes<D> magnitude(Lanes<D> a) {
  return Lanes<D>(hn::Abs(a.raw));
}
template <class D>
HWY_INLINE Lanes<D> square_root(Lanes<D> a) {
  return Lanes<D>(hn::Sqrt(a.raw));
}

// A mask of at most 16 lanes as bits of a word, lane 0 first, and back: bits from `first` on.
template <class D>
HWY_INLINE std::uint32_t mask_bits(LaneMask<D> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(D(), mask.raw, bytes);
  return bytes[0] | std::uint32_t{bytes[1]} << 8;
}
template <class D>
HWY_INLINE LaneMask<D> mask_of_bits(std::uint32_t word, std::size_t first) {
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(word >> first),
                                 static_cast<std::uint8_t>(word >> first >> 8)};
  return {hn::LoadMaskBits(D(), bytes)};
}

// The widest vectors that the target has, all with as many lanes.
using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using WordTag = hn::RebindToUnsigned<FloatTag>;
using Floats = Lanes<FloatTag>;
using Ints = Lanes<IntTag>;    // std::int32_t
using Words = Lanes<WordTag>;  // std::uint32_t

HWY_INLINE Ints to_integer(Floats x) { return Ints(hn::ConvertTo(IntTag(), x.raw)); }  // towards 0
HWY_INLINE Floats to_float(Ints x) { return Floats(hn::ConvertTo(FloatTag(), x.raw)); }
HWY_INLINE Floats bit_count(Words x) { return to_float(Ints(hn::BitCast(IntTag(), hn::PopulationCount(x.raw)))); }
HWY_INLINE LaneMask<FloatTag> has_bit(Words mask, int bit) { return (mask & Words(1u << bit)) != Words(0u); }
HWY_INLINE Words fetch(const std::uint32_t* table, Ints index) {
  return Words(hn::GatherIndex(WordTag(), table, index.raw));
}

// Numbers in double precision, as many as Floats has. They need two vectors, except where a vector is a single lane.
struct Doubles {
  using Tag = hn::ScalableTag<double>;
  static constexpr std::size_t kParts = hn::MaxLanes(FloatTag()) / hn::MaxLanes(Tag());
  Lanes<Tag> part[kParts];

  Doubles() = default;
  HWY_INLINE explicit Doubles(double value) {
    for (Lanes<Tag>& p : part) p = Lanes<Tag>(value);
  }
  HWY_INLINE explicit Doubles(Ints x) {
#if HWY_TARGET == HWY_SCALAR
    part[0] = Lanes<Tag>(hn::PromoteTo(Tag(), x.raw));
#else
    part[0] = Lanes<Tag>(hn::PromoteTo(Tag(), hn::LowerHalf(x.raw)));
    part[1] = Lanes<Tag>(hn::PromoteTo(Tag(), hn::UpperHalf(hn::Half<IntTag>(), x.raw)));
#endif
  }
};

#define BEAMPIPE_DOUBLES_BINARY(op)                                                            \
  HWY_INLINE Doubles operator op(const Doubles& a, const Doubles& b) {                         \
    Doubles result;                                                                            \
    for (std::size_t i = 0; i < Doubles::kParts; ++i) result.part[i] = a.part[i] op b.part[i]; \
    return result;                                                                             \
  }
BEAMPIPE_DOUBLES_BINARY(+)
BEAMPIPE_DOUBLES_BINARY(-)
BEAMPIPE_DOUBLES_BINARY(*)
#undef BEAMPIPE_DOUBLES_BINARY

HWY_INLINE Floats to_float(const Doubles& x) {
#if HWY_TARGET == HWY_SCALAR
  return Floats(hn::DemoteTo(FloatTag(), x.part[0].raw));
#else
  const hn::Half<FloatTag> half;
  return Floats(hn::Combine(FloatTag(), hn::DemoteTo(half, x.part[1].raw), hn::DemoteTo(half, x.part[0].raw)));
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
