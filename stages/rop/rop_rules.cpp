#include "stages/rop/rop_rules.h"

#include <algorithm>

#include "stages/rop/draw_effect.h"

namespace beampipe {
namespace {

// A colour that is not multiplied by its alpha, over what is stored.
constexpr Blend kOver{BlendEquation{}, BlendEquation{BlendFactor::one, BlendFactor::one_minus_source_alpha}};

bool writes(const Stencil& stencil) {
  constexpr StencilOperation kKeep = StencilOperation::keep;
  return stencil.write_mask != 0 && (stencil.fail != kKeep || stencil.depth_fail != kKeep || stencil.pass != kKeep);
}

}  // namespace

RopRule rop_rule(const DrawState& state) {
  RopRule rule;
  rule.depth = state.depth.test ? state.depth.function : Compare::always;
  rule.writes_depth = state.depth.test && state.depth.write;
  if (!state.depth.clip) {
    rule.nearest = double{std::min(state.depth.near, state.depth.far)} - 1;
    rule.farthest = double{std::max(state.depth.near, state.depth.far)} - 1;
  }
  if (state.stencil || state.stencil_back) {
    rule.has_stencil = true;
    rule.stencil[0] = state.stencil.value_or(Stencil{});
    rule.stencil[1] = state.stencil_back.value_or(rule.stencil[0]);
  }
  if (state.blend && !(state.blend->color == kReplacing && state.blend->alpha.value_or(kReplacing) == kReplacing))
    rule.blend = state.blend;
  rule.color_mask = state.color_mask;
  rule.front_is_clockwise = state.front_is_clockwise;
  return rule;
}

bool RopRule::writes_stencil() const { return has_stencil && (writes(stencil[0]) || writes(stencil[1])); }

bool RopRule::writes_color() const {
  const bool keeps_rgb = blend && blend->color == kKeeping,
             keeps_alpha = blend && blend->alpha.value_or(blend->color) == kKeeping;
  return ((color_mask & kColorChannels) != 0 && !keeps_rgb) || ((color_mask & kAlphaChannel) != 0 && !keeps_alpha);
}

RopRules::RopRules(const Trace& trace, const Frame& frame, const glm::vec3& background)
    : clear_depth(window_clear_depth(trace, frame) - 1),
      clear_color(background, frame.background_alpha),
      limits_color(frame.target != ColorTarget::floats &&
                   std::ranges::all_of(frame.draws, [](const Draw& draw) { return draw.program.has_value(); })) {
  draws.reserve(frame.draws.size());
  for (std::uint32_t i = 0; i < frame.draws.size(); ++i) {
    const Draw& draw = frame.draws[i];
    const DrawState& state = draw.state;
    if (state.depth.cleared_before || state.stencil_cleared_to)
      clears.push_back({i, state.depth.cleared_before, state.stencil_cleared_to});
    RopRule rule = rop_rule(state);
    draws.push_back({rule, rule});
    if (!state.blend && !draw.program) draws.back()[1].blend = kOver, draws.back()[1].writes_depth = false;
  }
}

float window_clear_depth(const Trace& trace, const Frame& frame) {
  if (!frame.capture.pictures.depth.empty()) return frame.capture.pictures.clear_depth;
  std::uint64_t less = 0, greater = 0;  // triangles
  for (const Draw& draw : frame.draws) {
    const DepthState& depth = draw.state.depth;
    if (!depth.test || !depth.write) continue;
    const std::uint64_t triangles = trace.meshes[draw.mesh].triangles.size();
    if (depth.function == Compare::less || depth.function == Compare::less_equal) less += triangles;
    if (depth.function == Compare::greater || depth.function == Compare::greater_equal) greater += triangles;
  }
  return greater > less ? 0.0f : 1.0f;
}

}  // namespace beampipe
