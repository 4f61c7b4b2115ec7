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

// How far the clamp of the history applies.
enum class Clamp {
  whole,     // fully
  rest,      // in proportion to the pixel's speed, and fully from `still_px` on; fully also where the pixel's look is
             // another than in the last frame, even to the history of a pixel that is not known
  camera,    // in proportion to the pixel's speed alone
  variance,  // fully, to a box that is wider on both sides by `deviations` standard deviations of the pixel's past
};

struct TemporalOptions {
  float blend = 0.1f;  // weight of the new frame (T in the publication)
  Clamp clamp = Clamp::whole;
  float still_px = 0.05f;   // pixels per frame, more than 0
  float deviations = 1.0f;  // at least 0
};

// The frame and its past, one value per pixel, row by row.
struct Accumulated {
  std::vector<glm::vec4> color;      // rounded to fp16
  std::vector<glm::vec4> deviation;  // Clamp::variance: of the channels' past values, rounded to fp16; else empty

  Accumulated(std::size_t pixels, Clamp clamp) : color(pixels), deviation(clamp == Clamp::variance ? pixels : 0) {}
};

// Sets the box of each of the tile's pixels to the range of colours in its 3x3 neighbourhood.
void neighborhood_box(const Tile& tile, StageCounters& counters, CurrentFrame& frame);

// Sets the tile's pixels of `to`, which has the size of the frame. If there is no history (in the first frame, off the
// screen, or after a change of size), a pixel takes the frame's own colour. A pixel that is known in part is blended in
// by that part. One that is not known has no box and keeps its history, unless Clamp::rest finds another look.
//
// Clamp::variance follows the deviation of a pixel's past values from their mean, the history, with the weights of the
// blend (Tony Finch, Incremental calculation of weighted mean and variance, 2009). The mean of the past is the history
// itself, so the deviation cannot bound that; it widens the box of the new frame instead. Bounds in standard deviations
// are those of Marco Salvi (An Excursion in Temporal Supersampling, GDC 2016), who takes them of the neighbourhood.
void temporal(const CurrentFrame& frame, const TemporalOptions& options, const History& history, const Tile& tile,
              StageCounters& counters, Accumulated& to);

}  // namespace beampipe
