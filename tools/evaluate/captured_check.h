// The depths that a frame's draws leave at the pixels' first samples, compared with those that the captured program's
// depth buffer held there (Frame::capture.pictures.depth).
//
// A frame without errors of its own may differ from the program where draws were left out, and by the roundings of the
// program's depth format.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/surface/surface_shader.h"
#include "traces/trace.h"

namespace beampipe {

inline constexpr std::uint32_t kNoDraw = ~0u;

// One value per pixel, row by row.
struct SampledDepths {
  std::vector<double> depth;        // window depth, 0..1; where nothing was drawn: any
  std::vector<std::uint32_t> draw;  // index into Frame::draws, or kNoDraw
};

// Draws everything in the API's order, at the first of as many samples as the program had: with one, at the pixel's
// centre. Shaders run at the pixel's centre, so that cutouts are tested there. (Which samples alpha to coverage takes
// is the driver's own choice. Here it takes the sample as if there were no others.)
// `textures`: of the trace; may be null if the frame's draws have none.
SampledDepths sampled_depths(const Trace& trace, const Frame& frame, const TextureSet* textures);

// How one draw's pixels differ. kNoDraw: pixels that no draw has here.
struct DrawDifference {
  std::uint32_t draw = kNoDraw;
  std::uint64_t pixels = 0;     // that it has here
  std::uint64_t differing = 0;  // of these: not close to the program's
  double largest = 0;           // difference
};

// Gathers them pixel by pixel.
class DrawDifferences {
 public:
  explicit DrawDifferences(std::size_t draws);
  void add(std::uint32_t draw, bool is_differing, double difference);
  std::vector<DrawDifference> sorted() const;  // those that differ, the one with most differing pixels first

 private:
  std::vector<DrawDifference> draws_;  // the last one: pixels without a draw
};

double part_of(std::uint64_t part, std::uint64_t whole);  // part / whole; 1 if both are 0

struct CapturedCheck {
  static constexpr double kClose = 1e-4, kEqual = 1e-6;  // window depth

  std::uint64_t here = 0, there = 0, both = 0;  // pixels that are covered here, in the program, and in both
  std::uint64_t close = 0, equal = 0;           // of those in both
  double largest = 0;                           // difference, of those in both
  std::vector<DrawDifference> draws;            // those that differ, the one with most differing pixels first

  double coverage() const;    // both / (here or there); 1 if nothing is covered
  double close_part() const;  // of the pixels that are covered in both; 1 if there are none
  double equal_part() const;
};

// Throws std::invalid_argument unless the frame has a captured depth for each pixel.
CapturedCheck check_captured(const Frame& frame, const SampledDepths& found);

// RGB, three bytes per pixel. Grey: nothing. Green: equal. Yellow: close. Red: farther. Blue: only here. Magenta: only
// in the program.
std::vector<std::uint8_t> difference_picture(const Frame& frame, const SampledDepths& found);

}  // namespace beampipe
