// How traces name the items of a draw's state, in the order of the enumerators.
#pragma once

#include <string_view>

namespace beampipe {

inline constexpr std::string_view kCompareNames[] = {"never",   "less",      "equal",         "less_equal",
                                                     "greater", "not_equal", "greater_equal", "always"};
inline constexpr std::string_view kBlendFactorNames[] = {"zero",
                                                         "one",
                                                         "source_color",
                                                         "one_minus_source_color",
                                                         "source_alpha",
                                                         "one_minus_source_alpha",
                                                         "destination_color",
                                                         "one_minus_destination_color",
                                                         "destination_alpha",
                                                         "one_minus_destination_alpha",
                                                         "source_alpha_saturate",
                                                         "constant",
                                                         "one_minus_constant",
                                                         "constant_alpha",
                                                         "one_minus_constant_alpha"};
inline constexpr std::string_view kBlendOperationNames[] = {"add", "subtract", "reverse_subtract", "min", "max"};
inline constexpr std::string_view kStencilOperationNames[] = {
    "keep", "zero", "replace", "increment", "decrement", "invert", "increment_wrap", "decrement_wrap"};
inline constexpr std::string_view kFrontFaceNames[] = {"counter_clockwise", "clockwise"};
inline constexpr std::string_view kChannelNames = "rgba";  // of DrawState::color_mask, from its lowest bit on

}  // namespace beampipe
