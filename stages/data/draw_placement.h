// Where vertex_setup puts a draw on the screen and in depth, by the draw's fixed-function state. The defaults are those
// of a draw that says nothing.
#pragma once

#include <cstdint>

namespace beampipe {

// What decides between triangles in a pixel: their depths, which express the order of draws as far as depths can; or
// the API's order of draws, with its tests (stages/rop/rop_rules.h).
enum class DrawOrder { by_depth, of_api };

struct DrawPlacement {
  static constexpr std::int32_t kNoSide = 1 << 23;  // the guard band

  bool is_drawn = true;

  // From the draw's clip space to the frame's: x_scale x + x_offset w, and the same for y.
  double x_scale = 1, x_offset = 0, y_scale = 1, y_offset = 0;

  // The rectangle that the draw may touch, in 1/256 px. A side where the frame ends is at +-kNoSide.
  std::int32_t left = -kNoSide, top = -kNoSide, right = kNoSide, bottom = kNoSide;

  // The frame's depth is depth_scale z + depth_offset; z is -1 at the draw's near plane and 0 at its far plane.
  double depth_scale = 1, depth_offset = 0;
  // If this is not 0, the draw is painted: each triangle has one depth, depth_offset - layer_step times its number in
  // the mesh.
  double layer_step = 0;

  // Added to window depth: bias_constant + bias_slope max(|dz/dx|, |dz/dy|), limited by bias_clamp as in DepthBias.
  double bias_constant = 0, bias_slope = 0, bias_clamp = 0;

  // The frame's depth is window_scale times window depth, 0..1, plus window_offset. Painted draws have none.
  double window_scale = 1, window_offset = -1;

  bool clips_depth = true;  // else what lies beyond the near and far planes is drawn at their depths
  bool last_wins = false;   // at equal depth, its triangles hide earlier ones
  bool is_opaque = false;   // translucent materials are drawn as opaque ones

  bool mirrors() const { return (x_scale < 0) != (y_scale < 0); }
  bool has_bias() const { return bias_constant != 0 || bias_slope != 0; }
  bool operator==(const DrawPlacement&) const = default;
};

}  // namespace beampipe
