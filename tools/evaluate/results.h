// What run and compare find out about frames and techniques.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/technique.h"
#include "tools/evaluate/hardware.h"
#include "tools/evaluate/metrics.h"
#include "traces/json.h"

namespace beampipe {

// Of the runs of one technique on one frame, in milliseconds. With an even number of runs the median is the mean of the
// two in the middle.
struct WallTime {
  double median = 0, min = 0, max = 0;
  int runs = 0;
  bool with_memory_model = false;  // the runs also modelled caches and DRAM
  // What one rendering more took, which did, and which all counts are from. None: the runs themselves did, or nothing.
  std::optional<double> modelling_run = {};
};

// Throws std::invalid_argument when there is none.
WallTime wall_time(std::vector<double> milliseconds);

// Of one counter, over the pixels of a frame.
struct PixelCounterStats {
  double mean = 0, max = 0;
};

PixelCounterStats measure_counter(const std::vector<float>& values);

struct FrameReport {
  std::size_t index = 0;  // in the trace
  std::string image;      // paths are relative to the report's folder
  std::string picture;    // the image tonemapped, as PNG
  std::string counters;   // empty: none were written
  std::optional<ErrorStats> error;
  std::optional<double> flicker;  // of the error, since the frame before
  WallTime wall_ms;
  std::uint64_t a_buffer_peak_bytes = 0;
  std::vector<Buffer> buffers;  // all but the A-buffer
  std::vector<StageCounters> stages;
  std::map<std::string, PixelCounterStats> pixel_counters;  // by name
  std::uint64_t pixels = 0;
};

// The same frames with their triangles in another order.
struct OrderReport {
  std::string order;  // "given", "shuffled", ...
  double rmse = 0;    // against the reference of the same order
};

struct TechniqueReport {
  std::string technique;
  std::vector<Surface> framebuffer;
  std::uint32_t framebuffer_bytes_per_pixel = 0;
  std::optional<ErrorStats> error;  // pooled over the frames
  std::optional<EquivalentMsaa> equivalent_msaa;
  std::vector<FrameReport> frames;
  std::optional<double> flicker;                       // pooled over the frames but the first
  std::vector<std::pair<std::string, double>> causes;  // part of the mean square error, by cause; empty: not asked for
  std::vector<OrderReport> orders;                     // empty: not asked for
  double order_difference = 0;  // RMS between the pictures of the two orders that differ the most

  // Of the framebuffer and, in the frame where it is largest, the A-buffer.
  double peak_bytes_per_pixel() const;
};

struct Report {
  std::string trace, version, simd;
  int threads = 0;
  MemoryParameters memory;
  Hardware hardware;  // whose times are modelled; without implementations: none
  std::vector<TechniqueReport> results;
  std::vector<LadderRung> msaa_ladder;  // empty: not measured
  Json made_by = {};                    // what the results depend on (tools/evaluate/resume.h)
};

// For instance "0.1.0".
std::string program_version();

// The report of a technique of which no frame has been rendered yet.
TechniqueReport new_technique_report(const Technique& technique);

// The folder of a technique's images: the spec, every character outside [A-Za-z0-9.=-] turned into _.
std::string spec_folder(std::string_view spec);

// "msaa_8/frame_0007": how the names of a frame's files begin, in the output folder.
std::string frame_stem(std::string_view spec, std::size_t frame);

}  // namespace beampipe
