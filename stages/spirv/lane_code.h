// What a lane operation does to one lane, and what it costs.
//
// Every operand is a row: 32 bits for each lane. Floats are float32; a 16-bit float is kept as the float32 of its
// value. Integers of 8 and 16 bits are kept with zeros above. A boolean is all ones or all zeros.
#pragma once

#include <cstdint>

#include "stages/cost/counters.h"

namespace beampipe {

enum class LaneCode : std::uint8_t {
  copy,
  // Floats.
  f_add,
  f_sub,
  f_mul,
  f_div,
  f_mod,
  f_rem,
  f_negate,
  f_abs,
  f_sign,
  f_min,  // of a number and what is not one, the number; as f_max
  f_max,
  floor,
  ceil,
  trunc,
  round_even,
  sqrt,
  inverse_sqrt,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  atan2,
  sinh,
  cosh,
  tanh,
  asinh,
  acosh,
  atanh,
  exp,
  exp2,
  log,
  log2,
  pow,
  ldexp,
  fraction,
  exponent,  // fraction, exponent: x = fraction * 2^exponent, 0.5 <= |fraction| < 1
  f_less,
  f_less_equal,
  f_equal,
  f_not_equal,
  f_ordered_not_equal,
  is_nan,
  is_infinite,
  // Integers.
  i_add,
  i_sub,
  i_mul,
  i_negate,
  u_div,
  s_div,
  u_mod,
  s_mod,
  s_rem,
  u_mul_high,
  s_mul_high,
  s_abs,
  s_sign,
  u_min,
  u_max,
  s_min,
  s_max,
  shift_left,
  shift_right,
  shift_right_signed,
  bit_and,
  bit_or,
  bit_xor,
  bit_not,
  bit_reverse,
  bit_count,
  bit_field_mask,  // bit_field_mask: ones at `a` and on, `b` of them
  find_lowest,
  find_highest,
  find_highest_signed,
  i_equal,
  i_not_equal,
  u_less,
  u_less_equal,
  s_less,
  s_less_equal,
  select,  // of a condition, b where it holds, else c
  // Conversions. Floats become the nearest integer that the type has, towards zero; what is no number becomes 0.
  f_to_s,
  f_to_u,
  s_to_f,
  u_to_f,
  to_half,
  to_half_towards_zero,
  half_bits,
  half_value,
  sign_extend_8,
  sign_extend_16,
  // Memory. load_bytes: `width` bytes of buffer c at byte a (if it is a row) + d, 0 outside of it. load_local: row
  // c + a of d rows from c on, 0 outside of them. store_local: the same row becomes b in lanes that run.
  load_bytes,
  load_local,
  store_local,
  // Differences in a group of four lanes (see stages/spirv/shader_executor.h).
  dx,
  dy,
  dx_coarse,
  dy_coarse,
  image,    // image operation number c
  discard,  // lanes that run become helpers
  codes,    // how many there are
};

// What one lane's operation counts as (stages/cost/counters.cpp): what a processor executes, which is not always what
// the executor does. Copies and casts of bits are free, as registers are renamed; an instruction of the unit for
// special functions is one of these, whatever it approximates.
struct LaneCodeInfo {
  LaneCode code;
  std::uint8_t rows;  // how many operands are rows: a, a and b, or a, b and c
  OperationCounts cost;
};
const LaneCodeInfo& info_of(LaneCode code);

}  // namespace beampipe
