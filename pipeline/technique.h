// Techniques by spec string, and what rendering one frame with one of them yields.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/memory/parameters.h"
#include "stages/cost/counters.h"
#include "stages/temporal/temporal.h"
#include "traces/trace.h"

namespace beampipe {

class Timeline;

struct RunOptions {
  int threads = 0;  // 0: all that the machine has. The result does not depend on it.
  // What earlier frames left, for techniques that accumulate over time: read, and made ready for the next frame. One
  // per technique; frames in order. Null: the frame is a first one.
  History* history = nullptr;
  MemoryParameters memory{};  // of the system that counts sectors and DRAM bytes
  // Bytes for what is kept per triangle and pixel, all threads together; 0: no limit. Beyond it, a frame is rendered in
  // bands of tiles, with the same result; where a single tile needs more, rendering throws std::runtime_error.
  std::uint64_t memory_limit = 0;
  int tile_size = 0;             // pixels on each side, even; 0: the technique's own. Pictures do not depend on it.
  Timeline* timeline = nullptr;  // where each stage call is recorded with its times; null: nowhere
};

// Linear RGB plus A (the part of the pixel that geometry covers, 0..1); row 0 on top; 4 floats per pixel.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgba;
};

// One surface of the framebuffer that is modelled: its bytes are what the named format takes, per pixel.
struct Surface {
  std::string name;    // "depth", "color", "mask", ...
  std::string format;  // "D32F x 8", "RGB16F", ...
  std::uint32_t bytes_per_pixel = 0;
};

// What is held beside the framebuffer: the most items at once, in the bytes that the modelled hardware has for one.
struct Buffer {
  std::string name;
  std::uint64_t peak_bytes = 0;
  bool per_bin = false;  // on chip, while a bin is worked on: of the bin that needs the most; else of the whole frame
  bool operator==(const Buffer&) const = default;
};

struct FrameResult {
  Image image;
  std::map<std::string, std::vector<float>> pixel_counters;  // name -> width x height values ("fragments", ...)
  std::vector<StageCounters> stages;                         // in pipeline order
  std::uint64_t a_buffer_peak_bytes = 0;
  std::vector<Buffer> buffers;  // all but the A-buffer
};

// What one triangle is worth in one pixel: the pixel is the sum of weight times the triangle's colour, and the
// background has what the weights leave of 1.
struct SurfaceWeight {
  std::uint32_t triangle;  // as vertex_setup numbers them
  float weight;
  std::uint32_t order;  // when it was merged, where that decides about depth; else the same for all
  bool tiny;            // covers no mask position of the technique
};
using PixelWeights = std::vector<SurfaceWeight>;

struct Technique {
  std::string spec = {};  // as the user wrote it
  std::vector<Surface> framebuffer;
  std::uint32_t samples = 0;  // N of msaa:N, else 0
  std::function<FrameResult(const Trace&, std::size_t frame, const RunOptions&)> render;
  // How `render` weighs what it sees, for each pixel of the frame, row by row. Null where that is not known.
  std::function<std::vector<PixelWeights>(const Trace&, std::size_t frame, const RunOptions&)> weights = {};
  bool keeps_history = false;  // a frame's picture depends on the frames before it (RunOptions::history)
  // What the program itself holds of a frame, in bytes per pixel, at the very least: the picture, and what stages leave
  // there for each other.
  std::uint32_t working_bytes_per_pixel = sizeof(glm::vec4);

  std::uint32_t framebuffer_bytes_per_pixel() const {
    std::uint32_t bytes = 0;
    for (const Surface& surface : framebuffer) bytes += surface.bytes_per_pixel;
    return bytes;
  }
};

// One line, "technique 'SPEC': bits must be 32, 64, 128 or 256": the spec, and what would have been right.
struct SpecError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Of a spec such as "beam", "msaa:8" or "acaa:8,double=stencil"; technique_help() lists all. Throws SpecError.
Technique parse_technique(std::string_view spec);

// All techniques and their options, for --help.
std::string technique_help();

}  // namespace beampipe
