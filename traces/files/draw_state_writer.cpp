#include "traces/files/draw_state_writer.h"

#include "traces/files/draw_state_names.h"

namespace beampipe {
namespace {

void write_bias(TraceText& text, const DepthBias& bias) {
  text.put_key("depth_bias");
  text.open_object();
  text.put_member("constant", bias.constant, 0.0f);
  text.put_member("slope", bias.slope, 0.0f);
  text.put_member("clamp", bias.clamp, 0.0f);
  text.close_object();
}

void write_equation(TraceText& text, const BlendEquation& blend) {
  text.put_name_of("source", blend.source, kBlendFactorNames);
  text.put_name_of("destination", blend.destination, kBlendFactorNames);
  text.put_choice("operation", blend.operation, BlendOperation::add, kBlendOperationNames);
}

void write_blend(TraceText& text, const Blend& blend) {
  text.put_key("blend");
  text.open_object();
  write_equation(text, blend.color);
  if (blend.alpha) {
    text.put_key("alpha");
    text.open_object();
    write_equation(text, *blend.alpha);
    text.close_object();
  }
  text.put_member("constant", blend.constant, glm::vec4(0.0f));
  text.close_object();
}

void write_color_mask(TraceText& text, std::uint32_t mask) {
  std::string letters;
  for (std::size_t channel = 0; channel < kChannelNames.size(); ++channel)
    if (mask >> channel & 1) letters += kChannelNames[channel];
  text.put_key("color_mask");
  text.put("\"" + letters + "\"");
}

void write_stencil(TraceText& text, const char* key, const Stencil& stencil) {
  const Stencil defaults;
  text.put_key(key);
  text.open_object();
  text.put_choice("function", stencil.function, defaults.function, kCompareNames);
  text.put_member("reference", stencil.reference, defaults.reference);
  text.put_member("mask", stencil.mask, defaults.mask);
  text.put_member("write_mask", stencil.write_mask, defaults.write_mask);
  text.put_choice("fail", stencil.fail, defaults.fail, kStencilOperationNames);
  text.put_choice("depth_fail", stencil.depth_fail, defaults.depth_fail, kStencilOperationNames);
  text.put_choice("pass", stencil.pass, defaults.pass, kStencilOperationNames);
  text.close_object();
}

}  // namespace

void write_draw_state(TraceText& text, const DrawState& state) {
  const DrawState defaults;
  text.put(", \"state\": ");
  text.open_object();
  if (state.viewport) {
    text.put_key("viewport");
    text.put_array(glm::vec4(state.viewport->x, state.viewport->y, state.viewport->width, state.viewport->height));
  }
  if (state.scissor) {
    text.put_key("scissor");
    text.put_array(glm::dvec4(state.scissor->x, state.scissor->y, state.scissor->width, state.scissor->height));
  }
  text.put_member("depth_test", state.depth.test, defaults.depth.test);
  text.put_member("depth_write", state.depth.write, defaults.depth.write);
  text.put_choice("depth_function", state.depth.function, defaults.depth.function, kCompareNames);
  text.put_member("depth_range", glm::vec2(state.depth.near, state.depth.far), glm::vec2(0.0f, 1.0f));
  if (state.depth.bias != DepthBias{}) write_bias(text, state.depth.bias);
  text.put_member("depth_clip", state.depth.clip, defaults.depth.clip);
  text.put_member("clears_depth", state.depth.cleared_before, defaults.depth.cleared_before);
  text.put_choice("front_face", state.front_is_clockwise, defaults.front_is_clockwise, kFrontFaceNames);
  if (state.blend) write_blend(text, *state.blend);
  if (state.color_mask != defaults.color_mask) write_color_mask(text, state.color_mask);
  text.put_member("alpha_to_coverage", state.alpha_to_coverage, defaults.alpha_to_coverage);
  if (state.stencil) write_stencil(text, "stencil", *state.stencil);
  if (state.stencil_back) write_stencil(text, "stencil_back", *state.stencil_back);
  if (state.stencil_cleared_to) {
    text.put_key("clears_stencil");
    text.put_number(*state.stencil_cleared_to);
  }
  text.close_object();
}

}  // namespace beampipe
