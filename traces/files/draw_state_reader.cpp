#include "traces/files/draw_state_reader.h"

#include <array>
#include <cmath>
#include <span>

#include "traces/files/draw_state_names.h"

namespace beampipe {
namespace {

constexpr float kMostPlace = 1 << 20;  // of viewports and scissors, in pixels, on either side of 0
constexpr float kMostSlope = 1 << 20;  // factor of a depth bias

template <class Enum>
void read_choice(const JsonCursor& at, const char* key, std::span<const std::string_view> names, Enum& result) {
  if (const auto found = at.find(key)) result = Enum(found->choice(names));
}

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

DepthState read_depth(const JsonCursor& at) {
  DepthState depth;
  if (const auto test = at.find("depth_test")) depth.test = test->boolean();
  if (const auto write = at.find("depth_write")) depth.write = write->boolean();
  read_choice(at, "depth_function", kCompareNames, depth.function);
  if (const auto range = at.find("depth_range")) {
    const std::vector<JsonCursor> ends = range->elements();
    if (ends.size() != 2) range->fail("an array of 2 numbers");
    depth.near = ends[0].fraction();
    depth.far = ends[1].fraction();
  }
  if (const auto bias = at.find("depth_bias")) {
    bias->expect_keys({"constant", "slope", "clamp"});
    if (const auto constant = bias->find("constant")) depth.bias.constant = constant->real(-1, 1);
    if (const auto slope = bias->find("slope")) depth.bias.slope = slope->real(-kMostSlope, kMostSlope);
    if (const auto clamp = bias->find("clamp")) depth.bias.clamp = clamp->real(-1, 1);
  }
  if (const auto clip = at.find("depth_clip")) depth.clip = clip->boolean();
  if (const auto cleared = at.find("clears_depth")) depth.cleared_before = cleared->boolean();
  return depth;
}

Blend read_blend(const JsonCursor& at) {
  at.expect_keys({"source", "destination", "operation"});
  Blend blend;
  blend.source = BlendFactor(at["source"].choice(kBlendFactorNames));
  blend.destination = BlendFactor(at["destination"].choice(kBlendFactorNames));
  read_choice(at, "operation", kBlendOperationNames, blend.operation);
  return blend;
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

Stencil read_stencil(const JsonCursor& at) {
  at.expect_keys({"function", "reference", "mask", "write_mask", "fail", "depth_fail", "pass"});
  Stencil stencil;
  const auto byte = [&](const char* key, std::uint32_t& result) {
    if (const auto found = at.find(key)) result = found->integer(0, 255);
  };
  read_choice(at, "function", kCompareNames, stencil.function);
  byte("reference", stencil.reference);
  byte("mask", stencil.mask);
  byte("write_mask", stencil.write_mask);
  read_choice(at, "fail", kStencilOperationNames, stencil.fail);
  read_choice(at, "depth_fail", kStencilOperationNames, stencil.depth_fail);
  read_choice(at, "pass", kStencilOperationNames, stencil.pass);
  return stencil;
}

}  // namespace

DrawState read_draw_state(const JsonCursor& at) {
  at.expect_keys({"viewport", "scissor", "depth_test", "depth_write", "depth_function", "depth_range", "depth_bias",
                  "depth_clip", "clears_depth", "front_face", "blend", "color_mask", "stencil"});
  DrawState state;
  if (const auto viewport = at.find("viewport")) state.viewport = read_viewport(*viewport);
  if (const auto scissor = at.find("scissor")) state.scissor = read_scissor(*scissor);
  state.depth = read_depth(at);
  read_choice(at, "front_face", kFrontFaceNames, state.front_is_clockwise);
  if (const auto blend = at.find("blend")) state.blend = read_blend(*blend);
  if (const auto mask = at.find("color_mask")) state.color_mask = read_color_mask(*mask);
  if (const auto stencil = at.find("stencil")) state.stencil = read_stencil(*stencil);
  return state;
}

}  // namespace beampipe
