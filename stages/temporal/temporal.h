// temporal: this frame's picture, its motion and the history -> the accumulated picture. Reprojection, colour clamp,
// blend.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/tile.h"
#include "stages/temporal/motion.h"

namespace beampipe {

// What frames leave for the next one.
struct History {
  std::uint32_t frames = 0;            // rendered so far
  std::int32_t width = 0, height = 0;  // pixels
  std::vector<glm::vec4> color;        // the last picture, rounded to fp16 RGBA
  std::vector<std::uint32_t> looks;    // of the last frame's pixels
  Poses poses;                         // of the last frame
};

// One frame by itself; a value per pixel, row by row.
struct CurrentFrame {
  std::int32_t width = 0, height = 0;
  std::vector<glm::vec4> color;      // linear RGB, and A
  std::vector<glm::vec4> low, high;  // the box that the history's colour is clamped to
  std::vector<float> known;          // the part of the pixel that `color` is made from, 0..1
  std::vector<glm::vec2> motion;     // pixels, to where it was
  std::vector<std::uint32_t> looks;  // of all that is in the pixel (PixelContents)
  std::vector<float> speeds;

  static constexpr std::uint32_t kPixelBytes =
      3 * sizeof(glm::vec4) + 2 * sizeof(float) + sizeof(glm::vec2) + sizeof(std::uint32_t);

  CurrentFrame(std::uint32_t frame_width, std::uint32_t frame_height);
};

// What `temporal` works in, in this program: the frame by itself, what comes of it, and the picture.
inline constexpr std::uint32_t kTemporalWorkingBytes = CurrentFrame::kPixelBytes + 2 * sizeof(glm::vec4);

// A pixel on its way to `temporal`: the picture as fp16 RGBA; its box, twice as much, and the known part in a byte.
inline constexpr std::uint64_t kCurrentColorBytes = 8, kCurrentBoxBytes = 2 * 8 + 1;

struct TemporalOptions {
  float blend = 0.1f;  // T: weight of the new frame
  // The clamp fades in from no motion to this much, in pixels, of the fastest that is in the pixel. Where anything
  // came, went or looks otherwise than in the last frame, it is whole, and takes the history even of a pixel that is
  // not known. 0: the clamp is always whole.
  float still_px = 0.0f;
};

// Sets the box of each of the tile's pixels to the least and greatest colour of its 3x3 neighbourhood.
void neighborhood_box(const Tile& tile, StageCounters& counters, CurrentFrame& frame);

// Sets the tile's pixels of `image`, which is the frame's and rounded to fp16. Where there is no history (first frame,
// off screen, other size): the frame's own colour. A pixel known in part is blended in by that part; one that is not
// known keeps its history, unless its look has changed.
void temporal(const CurrentFrame& frame, const TemporalOptions& options, const History& history, const Tile& tile,
              StageCounters& counters, std::vector<glm::vec4>& image);

}  // namespace beampipe
