// temporal: this frame's picture, its motion and the history -> the accumulated picture.
//
// The history is reprojected, clamped to the colours around the pixel, and blended with the new picture.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/frame_history.h"
#include "stages/data/tile.h"

namespace beampipe {

struct TemporalOptions {
  float blend = 0.1f;  // weight of the new frame (T in the publication)
  // The clamp applies in proportion to the speed of the fastest thing in the pixel, and fully from this speed on, in
  // pixels per frame. If anything in the pixel appeared, disappeared or changed its look since the last frame, it
  // applies fully, even to the history of a pixel that is not known. 0: it always applies fully.
  float still_px = 0.0f;
};

// Sets the box of each of the tile's pixels to the range of colours in its 3x3 neighbourhood.
void neighborhood_box(const Tile& tile, StageCounters& counters, CurrentFrame& frame);

// Sets the tile's pixels of `image`, which has the size of the frame, rounded to fp16. If there is no history (in the
// first frame, off the screen, or after a change of size), a pixel takes the frame's own colour. A pixel that is known
// in part is blended in by that part. One that is not known keeps its history, unless its look has changed.
void temporal(const CurrentFrame& frame, const TemporalOptions& options, const History& history, const Tile& tile,
              StageCounters& counters, std::vector<glm::vec4>& image);

}  // namespace beampipe
