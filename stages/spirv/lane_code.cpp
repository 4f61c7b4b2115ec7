#include "stages/spirv/lane_code.h"

#include <iterator>

namespace beampipe {
namespace {

constexpr OperationCounts kFree{}, kMul{.mul_add = 1}, kAdd{.add = 1}, kBit{.bit = 1}, kFetch{.fetch = 1},
    kSpecial{.special = 1}, kConvert{.convert = 1};

constexpr LaneCodeInfo kInfos[] = {
    {LaneCode::copy, 1, kFree},
    {LaneCode::f_add, 2, kAdd},
    {LaneCode::f_sub, 2, kAdd},
    {LaneCode::f_mul, 2, kMul},
    {LaneCode::f_div, 2, kSpecial},
    {LaneCode::f_mod, 2, kSpecial},
    {LaneCode::f_rem, 2, kSpecial},
    {LaneCode::f_negate, 1, kBit},
    {LaneCode::f_abs, 1, kBit},
    {LaneCode::f_sign, 1, {.add = 2}},
    {LaneCode::f_min, 2, kAdd},
    {LaneCode::f_max, 2, kAdd},
    {LaneCode::floor, 1, kConvert},
    {LaneCode::ceil, 1, kConvert},
    {LaneCode::trunc, 1, kConvert},
    {LaneCode::round_even, 1, kConvert},
    {LaneCode::sqrt, 1, kSpecial},
    {LaneCode::inverse_sqrt, 1, kSpecial},
    {LaneCode::sin, 1, kSpecial},
    {LaneCode::cos, 1, kSpecial},
    {LaneCode::tan, 1, {.special = 3}},  // sin / cos
    {LaneCode::asin, 1, kSpecial},
    {LaneCode::acos, 1, kSpecial},
    {LaneCode::atan, 1, kSpecial},
    {LaneCode::atan2, 2, {.special = 2}},                         // y / x
    {LaneCode::sinh, 1, {.mul_add = 2, .add = 1, .special = 2}},  // of e^x and 1 / e^x
    {LaneCode::cosh, 1, {.mul_add = 2, .add = 1, .special = 2}},
    {LaneCode::tanh, 1, {.mul_add = 1, .add = 2, .special = 2}},  // of e^2x
    {LaneCode::asinh, 1, {.mul_add = 2, .add = 2, .special = 2}},
    {LaneCode::acosh, 1, {.mul_add = 2, .add = 2, .special = 2}},
    {LaneCode::atanh, 1, {.mul_add = 1, .add = 2, .special = 2}},
    {LaneCode::exp, 1, {.mul_add = 1, .special = 1}},
    {LaneCode::exp2, 1, kSpecial},
    {LaneCode::log, 1, {.mul_add = 1, .special = 1}},
    {LaneCode::log2, 1, kSpecial},
    {LaneCode::pow, 2, {.mul_add = 1, .special = 2}},
    {LaneCode::ldexp, 2, kBit},
    {LaneCode::fraction, 1, kBit},
    {LaneCode::exponent, 1, kBit},
    {LaneCode::f_less, 2, kAdd},
    {LaneCode::f_less_equal, 2, kAdd},
    {LaneCode::f_equal, 2, kAdd},
    {LaneCode::f_not_equal, 2, kAdd},
    {LaneCode::f_ordered_not_equal, 2, kAdd},
    {LaneCode::is_nan, 1, kAdd},
    {LaneCode::is_infinite, 1, kAdd},
    {LaneCode::i_add, 2, kAdd},
    {LaneCode::i_sub, 2, kAdd},
    {LaneCode::i_mul, 2, kMul},
    {LaneCode::i_negate, 1, kAdd},
    {LaneCode::u_div, 2, kSpecial},
    {LaneCode::s_div, 2, kSpecial},
    {LaneCode::u_mod, 2, kSpecial},
    {LaneCode::s_mod, 2, kSpecial},
    {LaneCode::s_rem, 2, kSpecial},
    {LaneCode::u_mul_high, 2, kMul},
    {LaneCode::s_mul_high, 2, kMul},
    {LaneCode::s_abs, 1, kBit},
    {LaneCode::s_sign, 1, {.add = 2}},
    {LaneCode::u_min, 2, kAdd},
    {LaneCode::u_max, 2, kAdd},
    {LaneCode::s_min, 2, kAdd},
    {LaneCode::s_max, 2, kAdd},
    {LaneCode::shift_left, 2, kBit},
    {LaneCode::shift_right, 2, kBit},
    {LaneCode::shift_right_signed, 2, kBit},
    {LaneCode::bit_and, 2, kBit},
    {LaneCode::bit_or, 2, kBit},
    {LaneCode::bit_xor, 2, kBit},
    {LaneCode::bit_not, 1, kBit},
    {LaneCode::bit_reverse, 1, kBit},
    {LaneCode::bit_count, 1, kBit},
    {LaneCode::bit_field_mask, 2, kBit},
    {LaneCode::find_lowest, 1, kBit},
    {LaneCode::find_highest, 1, kBit},
    {LaneCode::find_highest_signed, 1, kBit},
    {LaneCode::i_equal, 2, kAdd},
    {LaneCode::i_not_equal, 2, kAdd},
    {LaneCode::u_less, 2, kAdd},
    {LaneCode::u_less_equal, 2, kAdd},
    {LaneCode::s_less, 2, kAdd},
    {LaneCode::s_less_equal, 2, kAdd},
    {LaneCode::select, 3, kAdd},
    {LaneCode::f_to_s, 1, kConvert},
    {LaneCode::f_to_u, 1, kConvert},
    {LaneCode::s_to_f, 1, kConvert},
    {LaneCode::u_to_f, 1, kConvert},
    {LaneCode::to_half, 1, kConvert},
    {LaneCode::to_half_towards_zero, 1, kConvert},
    {LaneCode::half_bits, 1, kFree},
    {LaneCode::half_value, 1, kFree},
    {LaneCode::sign_extend_8, 1, kConvert},
    {LaneCode::sign_extend_16, 1, kConvert},
    {LaneCode::load_bytes, 1, kFetch},
    {LaneCode::load_local, 1, kFetch},
    {LaneCode::store_local, 2, kFetch},
    {LaneCode::dx, 1, kAdd},
    {LaneCode::dy, 1, kAdd},
    {LaneCode::dx_coarse, 1, kAdd},
    {LaneCode::dy_coarse, 1, kAdd},
    {LaneCode::image, 0, kFree},  // requests are counted by themselves
    {LaneCode::discard, 0, kFree},
};
static_assert(std::size(kInfos) == static_cast<std::size_t>(LaneCode::codes));
static_assert([] {
  for (std::size_t i = 0; i < std::size(kInfos); ++i)
    if (static_cast<std::size_t>(kInfos[i].code) != i) return false;
  return true;
}());

}  // namespace

const LaneCodeInfo& info_of(LaneCode code) { return kInfos[static_cast<std::size_t>(code)]; }

}  // namespace beampipe
