// temporal: this frame's picture and the history -> the accumulated picture. Reprojection by depth, colour clamp,
// blend.
//
// Motion comes from the two frames' cameras alone: what a draw's own transform moved is found where it would be had it
// stood still, as in the static pass of the published renderers.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stages/counters.h"

namespace beampipe {

// What frames leave for the next one.
struct History {
  std::uint32_t frames = 0;            // rendered so far
  std::int32_t width = 0, height = 0;  // pixels
  std::vector<glm::vec4> color;        // the last picture, rounded to fp16 RGBA
  glm::dmat4 view_projection{1.0};     // world to clip space, of the last picture
};

// One frame by itself; a value per pixel, row by row.
struct CurrentFrame {
  std::int32_t width = 0, height = 0;
  std::vector<glm::vec4> color;      // linear RGB, and A
  std::vector<glm::vec4> low, high;  // the box that the history's colour is clamped to
  std::vector<float> known;          // the part of the pixel that `color` is made from, 0..1
  std::vector<float> depth;          // as in setup_triangle.h; kFarDepth: background, taken for the far plane
  glm::dmat4 view_projection{1.0};   // without jitter

  CurrentFrame(std::uint32_t frame_width, std::uint32_t frame_height);
};

struct TemporalOptions {
  float blend = 0.1f;     // T: weight of the new frame
  double still_px = 0.0;  // the clamp fades in from no motion to this much, in pixels; 0: it is always whole
};

// Sets the box of each pixel to the least and greatest colour of its 3x3 neighbourhood.
void neighborhood_box(CurrentFrame& frame, StageCounters& counters);

// The accumulated picture, which `history` keeps. Where there is no history (first frame, off screen, other size): the
// frame's own colour. A pixel known in part is blended in by that part; one that is not known keeps its history.
std::vector<glm::vec4> temporal(const CurrentFrame& frame, const TemporalOptions& options, StageCounters& counters,
                                History& history);

}  // namespace beampipe
