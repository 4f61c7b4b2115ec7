// The fixed-function state of a draw, as OpenGL and Vulkan know it. The defaults are those of a trace that says
// nothing.
//
// Window depth: 0..1, as the depth buffer stores it. By default, 0 is at the near plane (clip z = -w) and 1 at the far
// plane (clip z = w).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

namespace beampipe {

// What a value that arrives must be, compared with the stored one, to pass.
enum class Compare { never, less, equal, less_equal, greater, not_equal, greater_equal, always };

// Where the clip volume lies in the picture, in pixels: x / w = -1 at x and 1 at x + width; y / w = 1 at y and -1 at
// y + height. A negative height turns the picture upside down. Pixels outside are not touched.
struct Viewport {
  float x = 0, y = 0, width = 0, height = 0;  // width > 0, height != 0
  bool operator==(const Viewport&) const = default;
};

// Pixels that may be touched; row 0 is on top.
struct Scissor {
  std::int32_t x = 0, y = 0;
  std::uint32_t width = 0, height = 0;
  bool operator==(const Scissor&) const = default;
};

// What is added to a triangle's window depth: constant + slope * max(|dz/dx|, |dz/dy|) per pixel, at most `clamp` away
// from 0 if that is not 0 (OpenGL 4.6 core, section 14.6.5).
struct DepthBias {
  float constant = 0;  // window depth, -1..1, the format's resolution included
  float slope = 0;     // -2^20..2^20
  float clamp = 0;     // window depth, -1..1; a negative one is a lower bound
  bool operator==(const DepthBias&) const = default;
};

struct DepthState {
  bool test = true, write = true;
  Compare function = Compare::less;
  float near = 0, far = 1;  // window depth at clip z = -w and z = w, each 0..1
  DepthBias bias{};
  bool clip = true;             // false: what lies beyond the near and far planes is drawn at their depth
  bool cleared_before = false;  // the whole depth buffer was cleared right before the draw
  bool operator==(const DepthState&) const = default;
};

enum class BlendFactor {
  zero,
  one,
  source_color,
  one_minus_source_color,
  source_alpha,
  one_minus_source_alpha,
  destination_color,
  one_minus_destination_color,
  destination_alpha,
  one_minus_destination_alpha,
  source_alpha_saturate,
  constant,
  one_minus_constant,
  constant_alpha,
  one_minus_constant_alpha,
};
enum class BlendOperation { add, subtract, reverse_subtract, min, max };

struct BlendEquation {
  BlendFactor source = BlendFactor::source_alpha, destination = BlendFactor::one_minus_source_alpha;
  BlendOperation operation = BlendOperation::add;
  bool operator==(const BlendEquation&) const = default;
};

// How a fragment is blended with what is stored.
struct Blend {
  BlendEquation color{};                 // of RGB
  std::optional<BlendEquation> alpha{};  // else as RGB
  glm::vec4 constant{0.0f};              // RGBA of the factors that are constant, 0..1
  bool operator==(const Blend&) const = default;
};

enum class StencilOperation { keep, zero, replace, increment, decrement, invert, increment_wrap, decrement_wrap };

struct Stencil {
  Compare function = Compare::always;  // the reference, compared with the stored value, both masked
  std::uint32_t reference = 0, mask = 255, write_mask = 255;  // 0..255
  StencilOperation fail = StencilOperation::keep, depth_fail = StencilOperation::keep, pass = StencilOperation::keep;
  bool operator==(const Stencil&) const = default;
};

// Bits of DrawState::color_mask.
inline constexpr std::uint32_t kRedChannel = 1, kGreenChannel = 2, kBlueChannel = 4, kAlphaChannel = 8,
                               kAllChannels = 15;

struct DrawState {
  std::optional<Viewport> viewport{};  // else the whole frame
  std::optional<Scissor> scissor{};    // else the whole frame
  DepthState depth{};
  bool front_is_clockwise = false;  // as seen in the picture
  std::optional<Blend> blend{};     // else what the material says
  std::uint32_t color_mask = kAllChannels;
  bool alpha_to_coverage = false;         // alpha is the part of a pixel's samples that a fragment takes
  std::optional<Stencil> stencil{};       // else no test
  std::optional<Stencil> stencil_back{};  // of back faces; else as that of front faces
  // The whole stencil buffer was cleared to this, 0..255, right before the draw.
  std::optional<std::uint32_t> stencil_cleared_to{};
  bool operator==(const DrawState&) const = default;
};

}  // namespace beampipe
