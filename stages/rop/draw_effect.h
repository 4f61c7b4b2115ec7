// What the state of a draw does, whatever the order of draws.
#pragma once

#include "traces/draw_state.h"

namespace beampipe {

inline constexpr std::uint32_t kColorChannels = kRedChannel | kGreenChannel | kBlueChannel;

inline constexpr BlendEquation kReplacing{BlendFactor::one, BlendFactor::zero};
inline constexpr BlendEquation kKeeping{BlendFactor::zero, BlendFactor::one};
inline constexpr BlendEquation kAlphaBlending{};
inline constexpr BlendEquation kPremultipliedBlending{BlendFactor::one, BlendFactor::one_minus_source_alpha};

// Does the colour that arrives replace the stored one where opacity is 1?
inline bool replaces_where_opaque(const BlendEquation& equation) {
  return equation == kAlphaBlending || equation == kReplacing || equation == kPremultipliedBlending ||
         equation == BlendEquation{BlendFactor::source_alpha, BlendFactor::zero};
}

inline bool writes_color(const DrawState& state) {
  return (state.color_mask & kColorChannels) != 0 && !(state.blend && state.blend->color == kKeeping);
}

inline bool writes_depth(const DepthState& depth) {
  return depth.test && depth.write && depth.function != Compare::never;
}
inline bool passes_always(const DepthState& depth) { return !depth.test || depth.function == Compare::always; }
inline bool is_less(Compare function) { return function == Compare::less || function == Compare::less_equal; }
inline bool is_greater(Compare function) { return function == Compare::greater || function == Compare::greater_equal; }

// Does a depth pass that is equal to the stored one, but not every depth?
inline bool passes_equal(Compare function) {
  return function == Compare::less_equal || function == Compare::equal || function == Compare::greater_equal;
}

// Either face's; a test that always passes is none.
inline bool has_stencil_test(const DrawState& state) {
  const auto tests = [](const std::optional<Stencil>& face) { return face && face->function != Compare::always; };
  return tests(state.stencil) || tests(state.stencil_back);
}

}  // namespace beampipe
