// What a trace that was captured from a program says about its origin. Of this, only clear_depth and samples change what
// is drawn.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace beampipe {

// Where a trace comes from; each text is free, and empty where it is not known.
struct Source {
  std::string program, api, driver, date, tool;
  std::string shading;  // where the colours come from
  std::optional<std::uint32_t> frame{};
  bool operator==(const Source&) const = default;
};

// A render pass of the program: draws into the same targets.
struct RenderPass {
  std::string name;
  std::uint32_t width = 0, height = 0;  // pixels
  std::uint32_t draws = 0, triangles = 0;
  bool kept = false;   // are its draws in the trace?
  std::string reason;  // why it is kept or not
  bool operator==(const RenderPass&) const = default;
};

// What the program drew into a kept pass and the trace lacks.
struct LeftOut {
  std::string reason;
  std::uint32_t draws = 0, primitives = 0;
  bool operator==(const LeftOut&) const = default;
};

// The pictures that the program itself made of a frame.
struct CapturedPictures {
  std::optional<std::uint32_t> color{};  // index into Trace::images, of the frame's size
  std::vector<float> depth;   // window depth of each pixel's first sample, row by row; empty or of the frame's size
  float clear_depth = 1;      // where nothing was drawn
  std::uint32_t samples = 1;  // of each pixel: 1, 2, 4, 8 or 16
  bool operator==(const CapturedPictures&) const = default;
};

struct CaptureRecord {
  std::vector<RenderPass> passes;
  std::vector<LeftOut> left_out;
  CapturedPictures pictures{};
  bool operator==(const CaptureRecord&) const = default;
};

}  // namespace beampipe
