// Lane operations as loops over lanes, which compilers make vectors of. Included once per SIMD target.
#if defined(BEAMPIPE_SPIRV_LANE_KERNELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_SPIRV_LANE_KERNELS_INL_H_
#undef BEAMPIPE_SPIRV_LANE_KERNELS_INL_H_
#else
#define BEAMPIPE_SPIRV_LANE_KERNELS_INL_H_
#endif

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "hwy/highway.h"
#include "stages/spirv/lane_math-inl.h"
#include "stages/spirv/shader_executor.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// So many lanes at a time: the widest vector that any target has.
constexpr std::size_t kLaneGroup = 16;

// Rows after those of the program: results that only some lanes take, lanes that take an edge, what each lane has
// spent, and the block that it wants.
constexpr std::uint32_t kAsideRow = 0, kTakesRow = 1, kSpentRow = 2, kWantedRow = 3, kOwnRows = 4;

using LaneKernel = void (*)(const LaneOp&, const LaneState&);

template <class Value>
HWY_INLINE Value lane_value(std::uint32_t bits) {
  return std::bit_cast<Value>(bits);
}
HWY_INLINE std::uint32_t lane_bits(float value) { return std::bit_cast<std::uint32_t>(value); }
HWY_INLINE std::uint32_t lane_bits(std::int32_t value) { return static_cast<std::uint32_t>(value); }
HWY_INLINE std::uint32_t lane_bits(std::uint32_t value) { return value; }
HWY_INLINE std::uint32_t lane_bits(bool value) { return value ? ~0u : 0u; }

// A kernel that calls a function for each lane.
template <auto kFunction>
struct EachLane;
template <class Result, class A, Result (*kFunction)(A)>
struct EachLane<kFunction> {
  static void run(const LaneOp& op, const LaneState& state) {
    std::uint32_t* HWY_RESTRICT result = state.rows[op.result].bits.data();
    const std::uint32_t* a = state.rows[op.a].bits.data();
    for (std::size_t first = 0; first < state.lanes; first += kLaneGroup)
      for (std::size_t i = first; i < first + kLaneGroup; ++i) result[i] = lane_bits(kFunction(lane_value<A>(a[i])));
  }
};
template <class Result, class A, class B, Result (*kFunction)(A, B)>
struct EachLane<kFunction> {
  static void run(const LaneOp& op, const LaneState& state) {
    std::uint32_t* HWY_RESTRICT result = state.rows[op.result].bits.data();
    const std::uint32_t *a = state.rows[op.a].bits.data(), *b = state.rows[op.b].bits.data();
    for (std::size_t first = 0; first < state.lanes; first += kLaneGroup)
      for (std::size_t i = first; i < first + kLaneGroup; ++i)
        result[i] = lane_bits(kFunction(lane_value<A>(a[i]), lane_value<B>(b[i])));
  }
};
template <class Result, class A, class B, class C, Result (*kFunction)(A, B, C)>
struct EachLane<kFunction> {
  static void run(const LaneOp& op, const LaneState& state) {
    std::uint32_t* HWY_RESTRICT result = state.rows[op.result].bits.data();
    const std::uint32_t *a = state.rows[op.a].bits.data(), *b = state.rows[op.b].bits.data(),
                        *c = state.rows[op.c].bits.data();
    for (std::size_t first = 0; first < state.lanes; first += kLaneGroup)
      for (std::size_t i = first; i < first + kLaneGroup; ++i)
        result[i] = lane_bits(kFunction(lane_value<A>(a[i]), lane_value<B>(b[i]), lane_value<C>(c[i])));
  }
};

namespace lane {

using U = std::uint32_t;
using S = std::int32_t;

HWY_INLINE U copy(U a) { return a; }
HWY_INLINE float f_add(float a, float b) { return a + b; }
HWY_INLINE float f_sub(float a, float b) { return a - b; }
HWY_INLINE float f_mul(float a, float b) { return a * b; }
HWY_INLINE float f_div(float a, float b) { return a / b; }
HWY_INLINE float f_mod(float a, float b) { return a - b * std::floor(a / b); }
HWY_INLINE float f_rem(float a, float b) { return a - b * std::trunc(a / b); }
HWY_INLINE U f_negate(U a) { return a ^ 0x80000000u; }
HWY_INLINE U f_abs(U a) { return a & 0x7fffffffu; }
HWY_INLINE float f_sign(float a) { return a > 0 ? 1.0f : a < 0 ? -1.0f : a; }
HWY_INLINE float f_min(float a, float b) { return a != a || b < a ? b : a; }
HWY_INLINE float f_max(float a, float b) { return a != a || a < b ? b : a; }
HWY_INLINE float floor(float a) { return std::floor(a); }
HWY_INLINE float ceil(float a) { return std::ceil(a); }
HWY_INLINE float trunc(float a) { return std::trunc(a); }
// Numbers from 2^23 on are whole.
HWY_INLINE float round_even(float a) {
  const float size = std::fabs(a), rounded = size < 0x1p23f ? (size + 0x1p23f) - 0x1p23f : size;
  return std::copysign(rounded, a);
}
HWY_INLINE float sqrt(float a) { return std::sqrt(a); }
HWY_INLINE float inverse_sqrt(float a) { return 1.0f / std::sqrt(a); }
HWY_INLINE float ldexp(float a, S exponent) {
  const S bounded = exponent < -300 ? -300 : exponent > 300 ? 300 : exponent;
  return static_cast<float>(static_cast<double>(a) *
                            std::bit_cast<double>(static_cast<std::uint64_t>(bounded + 1023) << 52));
}
// Doubles have no denormal floats.
HWY_INLINE U double_exponent(float a) {
  return static_cast<U>(std::bit_cast<std::uint64_t>(static_cast<double>(a)) >> 52) & 0x7ffu;
}
HWY_INLINE float fraction(float a) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(static_cast<double>(a));
  const double scaled = std::bit_cast<double>((bits & 0x800fffffffffffffu) | 0x3fe0000000000000u);
  const U exponent = double_exponent(a);
  return exponent == 0 || exponent == 0x7ffu ? a : static_cast<float>(scaled);
}
HWY_INLINE S exponent(float a) {
  const U e = double_exponent(a);
  return e == 0 || e == 0x7ffu ? 0 : static_cast<S>(e) - 1022;
}
HWY_INLINE bool f_less(float a, float b) { return a < b; }
HWY_INLINE bool f_less_equal(float a, float b) { return a <= b; }
HWY_INLINE bool f_equal(float a, float b) { return a == b; }
HWY_INLINE bool f_not_equal(float a, float b) { return a != b; }
HWY_INLINE bool f_ordered_not_equal(float a, float b) { return (a < b) | (b < a); }
HWY_INLINE bool is_nan(U a) { return (a & 0x7fffffffu) > 0x7f800000u; }
HWY_INLINE bool is_infinite(U a) { return (a & 0x7fffffffu) == 0x7f800000u; }

HWY_INLINE U i_add(U a, U b) { return a + b; }
HWY_INLINE U i_sub(U a, U b) { return a - b; }
HWY_INLINE U i_mul(U a, U b) { return a * b; }
HWY_INLINE U i_negate(U a) { return 0u - a; }
// Whatever is divided by 0 gives all ones, and a remainder of 0 as well. The least integer by -1 is itself.
HWY_INLINE U u_div(U a, U b) { return b == 0 ? ~0u : a / b; }
HWY_INLINE U u_mod(U a, U b) { return b == 0 ? ~0u : a % b; }
HWY_INLINE S s_div(S a, S b) { return b == 0 ? -1 : b == -1 ? static_cast<S>(0u - static_cast<U>(a)) : a / b; }
HWY_INLINE S s_rem(S a, S b) { return b == 0 ? -1 : b == -1 ? 0 : a % b; }
HWY_INLINE S s_mod(S a, S b) {
  const S rest = s_rem(a, b);
  return b != 0 && rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}
HWY_INLINE U u_mul_high(U a, U b) { return static_cast<U>(std::uint64_t{a} * b >> 32); }
HWY_INLINE U s_mul_high(S a, S b) { return static_cast<U>(static_cast<std::uint64_t>(std::int64_t{a} * b) >> 32); }
HWY_INLINE U s_abs(S a) { return a < 0 ? 0u - static_cast<U>(a) : static_cast<U>(a); }
HWY_INLINE S s_sign(S a) { return (a > 0) - (a < 0); }
HWY_INLINE U u_min(U a, U b) { return b < a ? b : a; }
HWY_INLINE U u_max(U a, U b) { return a < b ? b : a; }
HWY_INLINE S s_min(S a, S b) { return b < a ? b : a; }
HWY_INLINE S s_max(S a, S b) { return a < b ? b : a; }
HWY_INLINE U shift_left(U a, U places) { return a << (places & 31u); }
HWY_INLINE U shift_right(U a, U places) { return a >> (places & 31u); }
HWY_INLINE S shift_right_signed(S a, U places) { return a >> (places & 31u); }
HWY_INLINE U bit_and(U a, U b) { return a & b; }
HWY_INLINE U bit_or(U a, U b) { return a | b; }
HWY_INLINE U bit_xor(U a, U b) { return a ^ b; }
HWY_INLINE U bit_not(U a) { return ~a; }
HWY_INLINE U bit_reverse(U a) {
  a = (a >> 1 & 0x55555555u) | (a & 0x55555555u) << 1;
  a = (a >> 2 & 0x33333333u) | (a & 0x33333333u) << 2;
  a = (a >> 4 & 0x0f0f0f0fu) | (a & 0x0f0f0f0fu) << 4;
  a = (a >> 8 & 0x00ff00ffu) | (a & 0x00ff00ffu) << 8;
  return a >> 16 | a << 16;
}
HWY_INLINE U bit_count(U a) {
  a = a - (a >> 1 & 0x55555555u);
  a = (a & 0x33333333u) + (a >> 2 & 0x33333333u);
  a = (a + (a >> 4)) & 0x0f0f0f0fu;
  return a * 0x01010101u >> 24;
}
HWY_INLINE U bit_field_mask(U offset, U count) {
  const U ones = count >= 32 ? ~0u : (1u << (count & 31u)) - 1;
  return offset >= 32 ? 0 : ones << (offset & 31u);
}
HWY_INLINE U filled_below(U a) {  // ones from the highest one down
  a |= a >> 1;
  a |= a >> 2;
  a |= a >> 4;
  a |= a >> 8;
  return a | a >> 16;
}
HWY_INLINE U find_lowest(U a) { return a == 0 ? ~0u : bit_count((a & (0u - a)) - 1); }
HWY_INLINE U find_highest(U a) { return bit_count(filled_below(a)) - 1; }  // -1 of 0
HWY_INLINE U find_highest_signed(U a) { return find_highest(a >> 31 ? ~a : a); }
HWY_INLINE bool i_equal(U a, U b) { return a == b; }
HWY_INLINE bool i_not_equal(U a, U b) { return a != b; }
HWY_INLINE bool u_less(U a, U b) { return a < b; }
HWY_INLINE bool u_less_equal(U a, U b) { return a <= b; }
HWY_INLINE bool s_less(S a, S b) { return a < b; }
HWY_INLINE bool s_less_equal(S a, S b) { return a <= b; }
HWY_INLINE U select(U condition, U yes, U no) { return (yes & condition) | (no & ~condition); }

HWY_INLINE S f_to_s(float a) {
  constexpr float kLeast = -2147483648.0f, kMost = 2147483520.0f;
  const float number = a == a ? a : 0.0f, above = number > kLeast ? number : kLeast;
  return static_cast<S>(above < kMost ? above : kMost);
}
HWY_INLINE U f_to_u(float a) {
  constexpr float kHalf = 2147483648.0f, kMost = 4294967040.0f;
  const float above = a > 0 ? a : 0.0f, number = above < kMost ? above : kMost;
  const bool is_large = number >= kHalf;
  return static_cast<U>(static_cast<S>(is_large ? number - kHalf : number)) + (is_large ? 0x80000000u : 0u);
}
HWY_INLINE float s_to_f(S a) { return static_cast<float>(a); }
HWY_INLINE float u_to_f(U a) {  // both parts are exact
  return static_cast<float>(static_cast<S>(a >> 16)) * 65536.0f + static_cast<float>(static_cast<S>(a & 0xffffu));
}
HWY_INLINE U to_half(U bits) {
  const U magnitude = bits & 0x7fffffffu;
  const U normal = (magnitude + 0xfffu + (magnitude >> 13 & 1u)) & ~0x1fffu;
  const U bounded = normal >= 143u << 23 ? 255u << 23 : normal;                       // from 65520 on it is infinite
  const U small = std::bit_cast<U>((std::bit_cast<float>(magnitude) + 0.5f) - 0.5f);  // a multiple of 2^-24
  const U finite = magnitude < 113u << 23 ? small : bounded;
  return (magnitude > 255u << 23 ? 0x7fc00000u : finite) | (bits & 0x80000000u);
}
HWY_INLINE U to_half_towards_zero(U bits) {
  constexpr U kMost = 0x477fe000u, kInfinity = 255u << 23;  // 65504
  const U magnitude = bits & 0x7fffffffu, normal = magnitude & ~0x1fffu;
  const U bounded = normal > kMost && magnitude < kInfinity ? kMost : normal;
  const U number = magnitude < 113u << 23 ? magnitude : 0u;
  const U small =
      std::bit_cast<U>(static_cast<float>(static_cast<S>(std::bit_cast<float>(number) * 0x1p24f)) * 0x1p-24f);
  const U finite = magnitude < 113u << 23 ? small : bounded;
  return (magnitude > kInfinity ? 0x7fc00000u : finite) | (bits & 0x80000000u);
}
HWY_INLINE U half_bits(U bits) {  // of a number that to_half() gave
  const U magnitude = bits & 0x7fffffffu;
  const U small = std::bit_cast<U>(std::bit_cast<float>(magnitude) + 0.5f) - std::bit_cast<U>(0.5f);
  const U normal = (magnitude - (112u << 23)) >> 13;
  const U large = magnitude > 255u << 23 ? 0x7e00u : 0x7c00u;
  const U half = magnitude < 113u << 23 ? small : magnitude < 143u << 23 ? normal : large;
  return half | (bits >> 16 & 0x8000u);
}
HWY_INLINE U half_value(U bits) {
  const U magnitude = bits & 0x7fffu;
  const U small = std::bit_cast<U>(static_cast<float>(static_cast<S>(magnitude)) * 0x1p-24f);
  const U normal = (magnitude << 13) + (112u << 23), large = magnitude << 13 | 255u << 23;
  const U value = magnitude < 0x400u ? small : magnitude < 0x7c00u ? normal : large;
  return value | (bits & 0x8000u) << 16;
}
HWY_INLINE S sign_extend_8(U a) { return static_cast<S>(a << 24) >> 24; }
HWY_INLINE S sign_extend_16(U a) { return static_cast<S>(a << 16) >> 16; }

// The difference between `step` lanes (1: columns, 2: rows) of a group, in the lane's own row (column) if both lanes of
// that run, else in the other one; coarse: in the first one if it can.
template <std::size_t kStep, bool kIsCoarse>
void difference(const LaneOp& op, const LaneState& state) {
  const LaneRow &a = state.rows[op.a], &active = state.rows[kActiveRow];
  LaneRow& result = state.rows[op.result];
  constexpr std::size_t kOther = 3 - kStep;
  for (std::size_t first = 0; first < state.lanes; first += 4) {
    const auto between = [&](std::size_t lane) {
      const bool runs = active.bits[lane] != 0 && active.bits[lane + kStep] != 0;
      return std::pair(runs, runs ? a.number(lane + kStep) - a.number(lane) : 0.0f);
    };
    const auto [has_first, first_difference] = between(first);
    const auto [has_second, second_difference] = between(first + kOther);
    for (std::size_t i = 0; i < 4; ++i) {
      const bool takes_second = (i & kOther) != 0 && !kIsCoarse ? has_second : !has_first;
      result.set(first + i, takes_second ? second_difference : first_difference);
    }
  }
}

inline void load_bytes(const LaneOp& op, const LaneState& state) {
  LaneRow& result = state.rows[op.result];
  const std::span<const std::byte> buffer =
      op.c < state.resources->buffers.size() ? state.resources->buffers[op.c] : std::span<const std::byte>();
  const auto read = [&](std::uint64_t at) {
    std::uint32_t bits = 0;
    if (at + op.width <= buffer.size()) std::memcpy(&bits, buffer.data() + at, op.width);  // low bytes first
    return bits;
  };
  if (op.a == kNoRow) {
    const std::uint32_t bits = read(op.d);
    for (std::size_t i = 0; i < state.lanes; ++i) result.bits[i] = bits;
    return;
  }
  const LaneRow& index = state.rows[op.a];
  for (std::size_t i = 0; i < state.lanes; ++i) result.bits[i] = read(index.bits[i] + op.d);
}

inline void load_local(const LaneOp& op, const LaneState& state) {
  const LaneRow& index = state.rows[op.a];
  LaneRow& result = state.rows[op.result];
  for (std::size_t i = 0; i < state.lanes; ++i)
    result.bits[i] = index.bits[i] < op.d ? state.rows[op.c + index.bits[i]].bits[i] : 0;
}

inline void store_local(const LaneOp& op, const LaneState& state) {
  const LaneRow &index = state.rows[op.a], &value = state.rows[op.b], &active = state.rows[kActiveRow];
  for (std::size_t i = 0; i < state.lanes; ++i)
    if (active.bits[i] != 0 && index.bits[i] < op.d) state.rows[op.c + index.bits[i]].bits[i] = value.bits[i];
}

inline void discard(const LaneOp&, const LaneState& state) {
  const LaneRow& active = state.rows[kActiveRow];
  LaneRow& helpers = state.rows[kHelperRow];
  for (std::size_t i = 0; i < state.lanes; ++i) helpers.bits[i] |= active.bits[i];
}

inline void image(const LaneOp& op, const LaneState& state) {
  const ImageOp& image_op = state.program->image_ops[op.c];
  const auto row = [&](std::uint32_t number) -> const LaneRow* {
    return number == kNoRow ? nullptr : &state.rows[number];
  };
  ImageRequest request{.action = image_op.action,
                       .image = image_op.image,
                       .sampler = image_op.sampler,
                       .image_element = row(image_op.image_element),
                       .sampler_element = row(image_op.sampler_element),
                       .lod = row(image_op.lod),
                       .bias = row(image_op.bias),
                       .least_lod = row(image_op.least_lod),
                       .reference = row(image_op.reference),
                       .component = image_op.component,
                       .lanes = state.lanes,
                       .active = row(kActiveRow)};
  for (std::size_t i = 0; i < 4; ++i) request.coordinates[i] = row(image_op.coordinates[i]);
  for (std::size_t i = 0; i < 3; ++i) {
    request.dx[i] = row(image_op.dx[i]), request.dy[i] = row(image_op.dy[i]);
    request.offset[i] = row(image_op.offset[i]);
  }
  LaneRow readers;  // without those whose results nobody keeps
  if (!image_op.is_for_helpers) {
    const LaneRow &active = *request.active, &helpers = state.rows[kHelperRow];
    for (std::size_t i = 0; i < state.lanes; ++i) readers.bits[i] = active.bits[i] & ~helpers.bits[i];
    request.active = &readers;
  }
  std::array<LaneRow, 4> texels{};
  if (state.resources->images) state.resources->images->read(request, {&texels[0], &texels[1], &texels[2], &texels[3]});
  for (std::size_t j = 0; j < texels.size(); ++j) {
    if (image_op.results[j] == kNoRow) continue;
    LaneRow& result = state.rows[image_op.results[j]];
    for (std::size_t i = 0; i < state.lanes; ++i)
      if (request.asks(i)) result.bits[i] = texels[j].bits[i];
  }
}

}  // namespace lane

inline LaneKernel kernel_of(LaneCode code) {
  switch (code) {
    case LaneCode::copy:
      return EachLane<lane::copy>::run;
    case LaneCode::f_add:
      return EachLane<lane::f_add>::run;
    case LaneCode::f_sub:
      return EachLane<lane::f_sub>::run;
    case LaneCode::f_mul:
      return EachLane<lane::f_mul>::run;
    case LaneCode::f_div:
      return EachLane<lane::f_div>::run;
    case LaneCode::f_mod:
      return EachLane<lane::f_mod>::run;
    case LaneCode::f_rem:
      return EachLane<lane::f_rem>::run;
    case LaneCode::f_negate:
      return EachLane<lane::f_negate>::run;
    case LaneCode::f_abs:
      return EachLane<lane::f_abs>::run;
    case LaneCode::f_sign:
      return EachLane<lane::f_sign>::run;
    case LaneCode::f_min:
      return EachLane<lane::f_min>::run;
    case LaneCode::f_max:
      return EachLane<lane::f_max>::run;
    case LaneCode::floor:
      return EachLane<lane::floor>::run;
    case LaneCode::ceil:
      return EachLane<lane::ceil>::run;
    case LaneCode::trunc:
      return EachLane<lane::trunc>::run;
    case LaneCode::round_even:
      return EachLane<lane::round_even>::run;
    case LaneCode::sqrt:
      return EachLane<lane::sqrt>::run;
    case LaneCode::inverse_sqrt:
      return EachLane<lane::inverse_sqrt>::run;
    case LaneCode::sin:
      return EachLane<lane_math::sin>::run;
    case LaneCode::cos:
      return EachLane<lane_math::cos>::run;
    case LaneCode::tan:
      return EachLane<lane_math::tan>::run;
    case LaneCode::asin:
      return EachLane<lane_math::asin>::run;
    case LaneCode::acos:
      return EachLane<lane_math::acos>::run;
    case LaneCode::atan:
      return EachLane<lane_math::atan>::run;
    case LaneCode::atan2:
      return EachLane<lane_math::atan2>::run;
    case LaneCode::sinh:
      return EachLane<lane_math::sinh>::run;
    case LaneCode::cosh:
      return EachLane<lane_math::cosh>::run;
    case LaneCode::tanh:
      return EachLane<lane_math::tanh>::run;
    case LaneCode::asinh:
      return EachLane<lane_math::asinh>::run;
    case LaneCode::acosh:
      return EachLane<lane_math::acosh>::run;
    case LaneCode::atanh:
      return EachLane<lane_math::atanh>::run;
    case LaneCode::exp:
      return EachLane<lane_math::exp>::run;
    case LaneCode::exp2:
      return EachLane<lane_math::exp2>::run;
    case LaneCode::log:
      return EachLane<lane_math::log>::run;
    case LaneCode::log2:
      return EachLane<lane_math::log2>::run;
    case LaneCode::pow:
      return EachLane<lane_math::pow>::run;
    case LaneCode::ldexp:
      return EachLane<lane::ldexp>::run;
    case LaneCode::fraction:
      return EachLane<lane::fraction>::run;
    case LaneCode::exponent:
      return EachLane<lane::exponent>::run;
    case LaneCode::f_less:
      return EachLane<lane::f_less>::run;
    case LaneCode::f_less_equal:
      return EachLane<lane::f_less_equal>::run;
    case LaneCode::f_equal:
      return EachLane<lane::f_equal>::run;
    case LaneCode::f_not_equal:
      return EachLane<lane::f_not_equal>::run;
    case LaneCode::f_ordered_not_equal:
      return EachLane<lane::f_ordered_not_equal>::run;
    case LaneCode::is_nan:
      return EachLane<lane::is_nan>::run;
    case LaneCode::is_infinite:
      return EachLane<lane::is_infinite>::run;
    case LaneCode::i_add:
      return EachLane<lane::i_add>::run;
    case LaneCode::i_sub:
      return EachLane<lane::i_sub>::run;
    case LaneCode::i_mul:
      return EachLane<lane::i_mul>::run;
    case LaneCode::i_negate:
      return EachLane<lane::i_negate>::run;
    case LaneCode::u_div:
      return EachLane<lane::u_div>::run;
    case LaneCode::s_div:
      return EachLane<lane::s_div>::run;
    case LaneCode::u_mod:
      return EachLane<lane::u_mod>::run;
    case LaneCode::s_mod:
      return EachLane<lane::s_mod>::run;
    case LaneCode::s_rem:
      return EachLane<lane::s_rem>::run;
    case LaneCode::u_mul_high:
      return EachLane<lane::u_mul_high>::run;
    case LaneCode::s_mul_high:
      return EachLane<lane::s_mul_high>::run;
    case LaneCode::s_abs:
      return EachLane<lane::s_abs>::run;
    case LaneCode::s_sign:
      return EachLane<lane::s_sign>::run;
    case LaneCode::u_min:
      return EachLane<lane::u_min>::run;
    case LaneCode::u_max:
      return EachLane<lane::u_max>::run;
    case LaneCode::s_min:
      return EachLane<lane::s_min>::run;
    case LaneCode::s_max:
      return EachLane<lane::s_max>::run;
    case LaneCode::shift_left:
      return EachLane<lane::shift_left>::run;
    case LaneCode::shift_right:
      return EachLane<lane::shift_right>::run;
    case LaneCode::shift_right_signed:
      return EachLane<lane::shift_right_signed>::run;
    case LaneCode::bit_and:
      return EachLane<lane::bit_and>::run;
    case LaneCode::bit_or:
      return EachLane<lane::bit_or>::run;
    case LaneCode::bit_xor:
      return EachLane<lane::bit_xor>::run;
    case LaneCode::bit_not:
      return EachLane<lane::bit_not>::run;
    case LaneCode::bit_reverse:
      return EachLane<lane::bit_reverse>::run;
    case LaneCode::bit_count:
      return EachLane<lane::bit_count>::run;
    case LaneCode::bit_field_mask:
      return EachLane<lane::bit_field_mask>::run;
    case LaneCode::find_lowest:
      return EachLane<lane::find_lowest>::run;
    case LaneCode::find_highest:
      return EachLane<lane::find_highest>::run;
    case LaneCode::find_highest_signed:
      return EachLane<lane::find_highest_signed>::run;
    case LaneCode::i_equal:
      return EachLane<lane::i_equal>::run;
    case LaneCode::i_not_equal:
      return EachLane<lane::i_not_equal>::run;
    case LaneCode::u_less:
      return EachLane<lane::u_less>::run;
    case LaneCode::u_less_equal:
      return EachLane<lane::u_less_equal>::run;
    case LaneCode::s_less:
      return EachLane<lane::s_less>::run;
    case LaneCode::s_less_equal:
      return EachLane<lane::s_less_equal>::run;
    case LaneCode::select:
      return EachLane<lane::select>::run;
    case LaneCode::f_to_s:
      return EachLane<lane::f_to_s>::run;
    case LaneCode::f_to_u:
      return EachLane<lane::f_to_u>::run;
    case LaneCode::s_to_f:
      return EachLane<lane::s_to_f>::run;
    case LaneCode::u_to_f:
      return EachLane<lane::u_to_f>::run;
    case LaneCode::to_half:
      return EachLane<lane::to_half>::run;
    case LaneCode::to_half_towards_zero:
      return EachLane<lane::to_half_towards_zero>::run;
    case LaneCode::half_bits:
      return EachLane<lane::half_bits>::run;
    case LaneCode::half_value:
      return EachLane<lane::half_value>::run;
    case LaneCode::sign_extend_8:
      return EachLane<lane::sign_extend_8>::run;
    case LaneCode::sign_extend_16:
      return EachLane<lane::sign_extend_16>::run;
    case LaneCode::load_bytes:
      return lane::load_bytes;
    case LaneCode::load_local:
      return lane::load_local;
    case LaneCode::store_local:
      return lane::store_local;
    case LaneCode::dx:
      return lane::difference<1, false>;
    case LaneCode::dy:
      return lane::difference<2, false>;
    case LaneCode::dx_coarse:
      return lane::difference<1, true>;
    case LaneCode::dy_coarse:
      return lane::difference<2, true>;
    case LaneCode::image:
      return lane::image;
    case LaneCode::discard:
      return lane::discard;
    case LaneCode::codes:
      break;
  }
  return nullptr;
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
