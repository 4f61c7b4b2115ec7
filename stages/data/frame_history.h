// What techniques that accumulate over time keep of a frame, and what they work on in the current one.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stages/data/draw_placement.h"

namespace beampipe {

// The transforms that place a frame's draws on its screen.
struct Poses {
  struct Pose {
    std::uint32_t mesh;
    glm::dmat4 transform;
    DrawPlacement placement{};
  };
  glm::dmat4 view_projection{1.0};  // without jitter
  std::vector<Pose> draws;
};

// What a frame leaves for the next one.
struct History {
  std::uint32_t frames = 0;               // rendered so far
  std::int32_t width = 0, height = 0;     // pixels
  std::vector<glm::vec4> color = {};      // the last picture, rounded to fp16 RGBA
  std::vector<glm::vec4> deviation = {};  // of its pixels' past values (temporal.h); empty if nothing follows it
  std::vector<std::uint32_t> looks = {};  // of the last frame's pixels
  Poses poses = {};                       // of the last frame
};

// The current frame alone: one value per pixel, row by row.
struct CurrentFrame {
  std::int32_t width = 0, height = 0;
  std::vector<glm::vec4> color;      // linear RGB, and A
  std::vector<glm::vec4> low, high;  // the box that the history's colour is clamped to
  std::vector<float> known;          // the part of the pixel that `color` represents, 0..1
  std::vector<glm::vec2> motion;     // vector to where the surface was in the last frame, pixels
  std::vector<std::uint32_t> looks;  // of everything in the pixel (PixelContents)
  std::vector<float> speeds;         // pixels per frame: of everything in the pixel, or of the camera

  static constexpr std::uint32_t kPixelBytes =
      3 * sizeof(glm::vec4) + 2 * sizeof(float) + sizeof(glm::vec2) + sizeof(std::uint32_t);

  CurrentFrame(std::uint32_t frame_width, std::uint32_t frame_height)
      : width(static_cast<std::int32_t>(frame_width)), height(static_cast<std::int32_t>(frame_height)) {
    const std::size_t pixels = std::size_t{frame_width} * frame_height;
    color.resize(pixels), low.resize(pixels), high.resize(pixels), motion.resize(pixels);
    looks.resize(pixels), speeds.resize(pixels);
    known.assign(pixels, 1.0f);
  }
};

// Working memory of this program per pixel: the current frame, the accumulated colours and the picture.
inline constexpr std::uint32_t kTemporalWorkingBytes = CurrentFrame::kPixelBytes + 2 * sizeof(glm::vec4);

// Sizes in the modelled machine, per pixel: the current picture as fp16 RGBA; the box as two such colours, and the
// known part in a byte; two fp16 numbers of motion; a look; an fp16 speed; the deviation of each channel as fp16.
inline constexpr std::uint64_t kCurrentColorBytes = 8, kCurrentBoxBytes = 2 * 8 + 1;
inline constexpr std::uint32_t kMotionBytes = 4;
inline constexpr std::uint32_t kLookBytes = 4;
inline constexpr std::uint32_t kSpeedBytes = 2;
inline constexpr std::uint32_t kDeviationBytes = 8;

}  // namespace beampipe
