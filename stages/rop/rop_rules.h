// What the draws of a frame do to what a pixel stores, in the API's order: tests, blending and writes. Every technique
// that keeps this order asks here.
//
// Depths are those of the frame: window depth minus 1, so that 0 is where most programs clear to.
//
// Sources: Vulkan 1.3, chapters 26 (fragment operations) and 27 (the framebuffer); OpenGL 4.6 core, sections 14.9, 17.3
// and 17.4.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "stages/data/setup_triangle.h"
#include "traces/trace.h"

namespace beampipe {

struct RopRule {
  Compare depth = Compare::less;  // of what arrives with what is stored; `always` is no test
  bool writes_depth = true;
  double nearest = -1, farthest = 0;  // depths of the frame to which fragments' depths are limited
  bool has_stencil = false;
  std::array<Stencil, 2> stencil{};  // of front and of back faces
  bool front_is_clockwise = false;
  std::optional<Blend> blend{};  // none: what arrives replaces what is stored
  std::uint32_t color_mask = kAllChannels;

  const Stencil& stencil_of(const SetupTriangle& triangle) const {
    return stencil[triangle.front != front_is_clockwise ? 0 : 1];
  }
  bool writes_stencil() const;
  bool writes_color() const;
  bool tests() const { return has_stencil || depth != Compare::always; }
  bool operator==(const RopRule&) const = default;
};

// Of a draw whose materials are not blended.
RopRule rop_rule(const DrawState& state);

// What is cleared right before a draw, in the whole frame.
struct RopClear {
  std::uint32_t draw = 0;  // index into Frame::draws
  bool depth = false;
  std::optional<std::uint32_t> stencil{};  // to this
};

struct RopRules {
  std::vector<std::array<RopRule, 2>> draws;  // by draw: of its triangles, and of those that their material blends
  std::vector<RopClear> clears;               // in the order of draws
  float clear_depth = 0;                      // of the frame
  glm::vec4 clear_color{0.0f, 0.0f, 0.0f, 1.0f};
  // To 0..1, as targets of fixed point do: where all draws have programs, unless the target stores floats.
  bool limits_color = false;

  // `background`: as the frame's target stores it. Materials that are blended, in draws without a blend function, are
  // put over what is stored and do not write depth.
  RopRules(const Trace& trace, const Frame& frame, const glm::vec3& background);

  const RopRule& of(const SetupTriangles& triangles, std::uint32_t triangle) const {
    const bool is_blended = !triangles.surfaces.empty() && triangles.surfaces[triangle].is_blended;
    return draws[triangles.draws[triangle]][is_blended ? 1 : 0];
  }

  // Calls clear(RopClear) for what is cleared before draw `next`, from clear number `at` on, which becomes that of the
  // first clear after it.
  template <class Clear>
  void clear_before(std::uint32_t next, std::size_t& at, Clear&& clear) const {
    for (; at < clears.size() && clears[at].draw <= next; ++at) clear(clears[at]);
  }
};

// Window depth where depth buffers are cleared: the captured one, or else the one that lets most triangles pass that
// write depth.
float window_clear_depth(const Trace& trace, const Frame& frame);

}  // namespace beampipe
