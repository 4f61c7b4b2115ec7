#include "traces/files/draw_state_reader.h"

#include <array>
#include <cmath>
#include <span>

#include "traces/files/draw_state_names.h"

namespace beampipe {
namespace {

constexpr float kMostPlace = 1 << 20;  // of viewports and scissors, in pixels, on either side of 0
constexpr float kMostSlope = 1 << 20;  // factor of a depth bias

template <std::size_t Count>
std::array<float, Count> read_places(const JsonCursor& at) {
  const std::vector<JsonCursor> elements = at.elements();
  if (elements.size() != Count) at.fail("an array of " + std::to_string(Count) + " numbers");
  std::array<float, Count> places{};
  for (std::size_t i = 0; i < Count; ++i) places[i] = elements[i].real(-kMostPlace, kMostPlace);
  return places;
}

Viewport read_viewport(const JsonCursor& at) {
  const auto [x, y, width, height] = read_places<4>(at);
  if (!(width > 0) || height == 0) at.fail("a width above 0 and a height other than 0");
  return {x, y, width, height};
}

Scissor read_scissor(const JsonCursor& at) {
  const std::array<float, 4> places = read_places<4>(at);
  for (const float place : places)
    if (place != std::floor(place)) at.fail("whole pixels");
  if (places[2] < 0 || places[3] < 0) at.fail("a width and a height of 0 and up");
  return {static_cast<std::int32_t>(places[0]), static_cast<std::int32_t>(places[1]),
          static_cast<std::uint32_t>(places[2]), static_cast<std::uint32_t>(places[3])};
}

std::uint32_t read_color_mask(const JsonCursor& at) {
  std::uint32_t mask = 0;
  for (const char letter : at.string()) {
    const std::size_t channel = kChannelNames.find(letter);
    const std::uint32_t bit = channel == std::string_view::npos ? 0 : 1u << channel;
    if (bit == 0 || (mask & bit) != 0) at.fail("letters of \"rgba\", each at most once");
    mask |= bit;
  }
  return mask;
}

Form<DepthBias> bias_form() {
  return ObjectForm<DepthBias>()
      .optional("constant", &DepthBias::constant, form::real(-1, 1),
                "In window depth; the resolution of the format is included.")
      .optional("slope", &DepthBias::slope, form::real(-kMostSlope, kMostSlope), "Factor of the larger slope.")
      .optional("clamp", &DepthBias::clamp, form::real(-1, 1),
                "The largest bias, or the least if negative; 0 is no limit.");
}

// `equation`: of an object that has the equation's keys, the equation.
template <class Object, class Equation>
ObjectForm<Object> equation_form(Equation equation) {
  const Form<BlendFactor> factor = form::choice<BlendFactor>(kBlendFactorNames);
  return ObjectForm<Object>()
      .required(
          "source", [equation](auto& object) -> auto& { return equation(object).source; }, factor,
          "Factor of what the fragment has.")
      .required(
          "destination", [equation](auto& object) -> auto& { return equation(object).destination; }, factor,
          "Factor of what is stored.")
      .optional(
          "operation", [equation](auto& object) -> auto& { return equation(object).operation; },
          form::choice<BlendOperation>(kBlendOperationNames), "What is done with the two.");
}

Form<Blend> blend_form() {
  const Form<BlendEquation> alpha = equation_form<BlendEquation>([](auto& equation) -> auto& { return equation; });
  const Form<glm::vec4> constant = {form::array_schema(form::fraction().schema, 4),
                                    [](const JsonCursor& at, glm::vec4& value) {
                                      const std::vector<JsonCursor> elements = at.elements();
                                      if (elements.size() != 4) at.fail("an array of 4 numbers");
                                      for (int i = 0; i < 4; ++i)
                                        value[i] = static_cast<float>(elements[static_cast<std::size_t>(i)].fraction());
                                    }};
  return equation_form<Blend>([](auto& blend) -> auto& { return blend.color; })
      .optional("alpha", &Blend::alpha, alpha, "The equation of opacity, where it is not that of the colours.")
      .optional("constant", &Blend::constant, constant, "RGBA of constant factors.");
}

Form<Stencil> stencil_form() {
  const Form<Compare> compare = form::choice<Compare>(kCompareNames);
  const Form<StencilOperation> operation = form::choice<StencilOperation>(kStencilOperationNames);
  const Form<std::uint32_t> byte = form::integer(0, 255);
  return ObjectForm<Stencil>()
      .optional("function", &Stencil::function, compare,
                "What the reference must be, compared with the stored value, to pass.")
      .optional("reference", &Stencil::reference, byte, "The reference.")
      .optional("mask", &Stencil::mask, byte, "Bits that are compared.")
      .optional("write_mask", &Stencil::write_mask, byte, "Bits that are written.")
      .optional("fail", &Stencil::fail, operation, "What happens to the stored value where the stencil test fails.")
      .optional("depth_fail", &Stencil::depth_fail, operation, "Where the depth test fails.")
      .optional("pass", &Stencil::pass, operation, "Where both pass.");
}

Form<DrawState> make_form() {
  const Form<Viewport> viewport = {form::array_schema(form::number().schema, 4),
                                   [](const JsonCursor& at, Viewport& value) { value = read_viewport(at); }};
  const Form<Scissor> scissor = {form::array_schema({{"type", "integer"}}, 4),
                                 [](const JsonCursor& at, Scissor& value) { value = read_scissor(at); }};
  const Form<std::uint32_t> mask = {form::text().schema,
                                    [](const JsonCursor& at, std::uint32_t& value) { value = read_color_mask(at); }};
  const auto read_range = [](const JsonCursor& at, DrawState& state) {
    const std::vector<JsonCursor> ends = at.elements();
    if (ends.size() != 2) at.fail("an array of 2 numbers");
    state.depth.near = ends[0].fraction();
    state.depth.far = ends[1].fraction();
  };
  return ObjectForm<DrawState>()
      .optional("viewport", &DrawState::viewport, viewport,
                "x, y, width and height, in pixels: clip x / w = -1 is at x and 1 at x + width; y / w = 1 is at y and "
                "-1 at y + height, which may be negative. The whole frame when left out.")
      .optional("scissor", &DrawState::scissor, scissor,
                "x, y, width and height of the pixels that may be touched. The whole frame when left out.")
      .optional(
          "depth_test", [](auto& state) -> auto& { return state.depth.test; }, form::boolean(),
          "Whether depth is compared.")
      .optional(
          "depth_write", [](auto& state) -> auto& { return state.depth.write; }, form::boolean(),
          "Whether depth is stored.")
      .optional(
          "depth_function", [](auto& state) -> auto& { return state.depth.function; },
          form::choice<Compare>(kCompareNames),
          "What the depth of a fragment must be, compared with the stored one, to pass.")
      .add({"depth_range", "Window depth, 0..1, of clip z = -w and of z = w; [0, 1] when left out.", false,
            form::array_schema(form::fraction().schema, 2), read_range})
      .optional(
          "depth_bias", [](auto& state) -> auto& { return state.depth.bias; }, bias_form(),
          "What is added to window depth: constant + slope * max(|dz/dx|, |dz/dy|) per pixel.")
      .optional(
          "depth_clip", [](auto& state) -> auto& { return state.depth.clip; }, form::boolean(),
          "Whether triangles are clipped to the near and far planes; if not, depth is clamped to the planes'.")
      .optional(
          "clears_depth", [](auto& state) -> auto& { return state.depth.cleared_before; }, form::boolean(),
          "Whether the depth buffer was cleared right before this draw.")
      .optional("front_face", &DrawState::front_is_clockwise, form::choice<bool>(kFrontFaceNames),
                "How the vertices of a front face turn in the picture.")
      .optional("blend", &DrawState::blend, blend_form(),
                "How colours are blended with what is stored. Without it, the material decides.")
      .optional("color_mask", &DrawState::color_mask, mask,
                "The channels that are written: letters of \"rgba\", which is the default.")
      .optional("alpha_to_coverage", &DrawState::alpha_to_coverage, form::boolean(),
                "Whether alpha is the part of a pixel's samples that a fragment takes.")
      .optional("stencil", &DrawState::stencil, stencil_form(), "The stencil test. Without it, there is none.")
      .optional("stencil_back", &DrawState::stencil_back, stencil_form(),
                "That of back faces, where it is not that of front faces.")
      .optional("clears_stencil", &DrawState::stencil_cleared_to, form::integer(0, 255),
                "The stencil buffer was cleared to this right before the draw.");
}

}  // namespace

const Form<DrawState>& draw_state_form() {
  static const Form<DrawState> form = make_form();
  return form;
}

}  // namespace beampipe
