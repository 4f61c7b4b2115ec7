// A technique by its spec string, and what rendering a frame with it gives. Most tools need nothing else; a
// few also use a technique's own header, such as pipeline/techniques/msaa.h.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/memory/dram_tally.h"
#include "pipeline/memory/framebuffer.h"
#include "pipeline/memory/parameters.h"
#include "stages/cost/counters.h"
#include "stages/data/frame_history.h"
#include "stages/data/pixel_history.h"
#include "stages/surface/surface_shader.h"
#include "traces/trace.h"

namespace beampipe {

class DramTrace;
class Timeline;

// How a frame is to be rendered.
struct FrameInput {
  int threads = 0;  // 0: all that the machine has. Results do not depend on it.
  // For techniques that accumulate over time: what earlier frames left. `render` reads it and prepares it for the next
  // frame. Each technique needs its own, and frames must come in order. Null: the frame is a first one.
  History* history = nullptr;
  MemoryParameters memory{};  // the system that counts sectors, L2 and DRAM bytes
  // The most bytes that all threads together may keep per triangle and pair; 0: no limit. A frame that needs more is
  // rendered in bands of tiles, with the same result. When a single tile needs more, rendering throws
  // std::runtime_error.
  std::uint64_t memory_limit = 0;
  int tile_size = 0;  // pixels on each side, even; 0: the technique's own. It does not change pictures.
  // The trace's textures, which frames share; null: the frame prepares its own.
  const TextureSet* textures = nullptr;
  SurfaceColors colors = SurfaceColors::by_place;
  int texture_taps = 0;  // as ShadingRules::texture_taps
  // If not null, only the bins that hold one of these pixels are rendered; the rest of the picture is black.
  const std::vector<PixelAddress>* pixels = nullptr;
  // If not null, it is read before every bin, from any thread; once it is true, `render` throws Cancelled.
  const std::atomic<bool>* cancelled = nullptr;
};

struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("rendering was cancelled") {}
};

// Of the bins of a frame.
struct Completion {
  std::atomic<std::size_t> finished = 0, all = 0;
};

// Where to collect what a result does not have; null: nowhere. It changes nothing that is rendered or counted.
struct FrameSinks {
  Timeline* timeline = nullptr;  // stage calls with their times
  // Of each pixel of the frame, row by row. Only techniques with has_weights fill it.
  std::vector<PixelWeights>* weights = nullptr;
  // What happened in each of FrameInput::pixels. Only techniques that are observable fill it.
  std::vector<PixelHistory>* histories = nullptr;
  DramTrace* dram_trace = nullptr;   // DRAM requests, if memory is modelled
  Completion* completion = nullptr;  // how much of the frame is rendered; other threads may read it

  bool operator==(const FrameSinks&) const = default;
};

// A frame to render. `frame` is one of the trace's.
struct FrameJob {
  const Trace& trace;
  const Frame& frame;
  const FrameInput& run;
  const FrameSinks& sinks;
};

// Linear RGB and A, the part of the pixel that geometry covers (0..1). Row 0 is on top; 4 floats per pixel.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgba;
};

// A buffer beside the framebuffer: the most items that it held at once, in bytes of the modelled hardware.
struct Buffer {
  std::string name;
  std::uint64_t peak_bytes = 0;
  bool per_bin =
      false;  // on chip while a bin is rendered, for the bin that needs the most; else in memory, for the frame
  bool operator==(const Buffer&) const = default;
};

// Invocations of a draw's program that took too many steps (stages/surface/program_shader.h).
struct StoppedDraw {
  std::uint64_t draw = 0, invocations = 0;
  bool operator==(const StoppedDraw&) const = default;
};

struct FrameResult {
  Image image;
  std::map<std::string, std::vector<float>> pixel_counters;  // name -> width x height values ("fragments", ...)
  std::vector<StageCounters> stages;                         // in pipeline order
  std::uint64_t a_buffer_peak_bytes = 0;
  std::vector<Buffer> buffers;   // all but the A-buffer
  std::uint32_t bin_pixels = 0;  // of the largest bin
  // Of each bin, in the order in which bins are drawn, row by row, operations of the stages that can be done in shaders
  // and invocations of fragment shaders: how unevenly the work of cores is spread.
  std::vector<std::uint64_t> bin_operations, bin_invocations;
  CacheReach cache_reach;
  std::vector<ArrayBytes> dram_arrays;  // of each stage, they add up to its dram_bytes
  std::vector<StoppedDraw> stopped;     // only draws that have any
};

// Of colours up to 1: two roundings of half a unit in the last place, which is 2^-12.
inline constexpr double kFp16Error = 0x1p-11;

// Why a picture may be farther from the exact one than roundings explain. tools/stress says how far, case by case.
enum class ErrorSource {
  sampled_depth,           // at samples, surfaces that are closer than the rounding of 32-bit depth change places
  counted_positions,       // Technique::counted_positions limits areas and colours
  estimated_areas,         // areas of partly hidden triangles are estimated from mask positions
  independent_fragments,   // OVER: fragments cover a pixel independently of each other
  published_merges,        // the published rules: an area is spread evenly over its mask
  merges_one_by_one,       // into one area and mask, by one depth of each fragment
  merges_in_fp16,          // of colours: small shares are lost
  merges_of_half_slopes,   // slopes of 16 bits turn equal planes into a slab
  merges_of_layers,        // a few layers per pixel, with slopes of 8 bits
  double_counting,         // triangles at equal depth count twice
  sums_in_fp16,            // of shares
  sums_in_unorm8,          // of shares
  one_translucent_sample,  // translucent triangles cover a pixel, or do not, as they cover one of its samples
  gbuffer_of_8_bits,       // as sRGB
  quads_over_the_border,   // 2x2 quads that extend beyond the frame
  shared_shading_samples,  // between triangles of different colours
};

struct Technique {
  std::string spec = {};  // as the user wrote it
  Framebuffer framebuffer;
  std::uint32_t samples = 0;                // N of msaa:N, else 0
  std::vector<glm::ivec2> sampled_at = {};  // in a pixel's first frame, as in pipeline/sampling.h; empty: areas count
  int positions = 0;                        // of a mask that says where in the pixel an area is; 0: there is none
  int counted_positions = 0;                // of a mask that limits areas to what counting its positions gives; or 0
  std::vector<ErrorSource> errs_by = {};    // without counted_positions, which says so itself
  double rounding_error = kFp16Error;       // of colours up to 1
  std::function<FrameResult(const Trace&, std::size_t frame, const FrameInput&, const FrameSinks&)> renderer;
  bool is_observable = false;    // `render` can fill FrameSinks::histories
  bool has_weights = false;      // `render` can fill FrameSinks::weights
  bool keeps_api_order = false;  // it draws frames that need it in the API's order (stages/geometry/draw_plan.h)
  bool keeps_history = false;    // a frame's picture depends on earlier frames (FrameInput::history)
  // The least memory that this program needs for a frame, in bytes per pixel: the picture, and what its stages hand to
  // each other.
  std::uint32_t working_bytes_per_pixel = sizeof(glm::vec4);

  FrameResult render(const Trace& trace, std::size_t frame, const FrameInput& run = {},
                     const FrameSinks& sinks = {}) const;

  // In memory.
  std::uint32_t framebuffer_bytes_per_pixel(const MemoryParameters& memory = {}) const {
    return bytes_per_pixel(framebuffer.in_memory(memory));
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
