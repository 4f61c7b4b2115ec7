// What run and compare find out about one frame.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/technique.h"
#include "tools/evaluate/metrics.h"
#include "tools/evaluate/modelled_time.h"

namespace beampipe {

// How long one technique takes for one frame, in milliseconds, over several runs. If the number of runs is even, the
// median is the mean of the two in the middle.
struct WallTime {
  double median = 0, min = 0, max = 0;
  int runs = 0;
  bool with_memory_model = false;  // the timed runs also modelled caches and DRAM
  bool kept = false;               // of an earlier run, whose picture was kept
  // The time of one additional run, which modelled memory and gave all counts. None if the timed runs model memory
  // themselves, or if memory is not modelled.
  std::optional<double> modelling_run = {};
};

// Throws std::invalid_argument if there is no run.
WallTime wall_time(std::vector<double> milliseconds);

// Statistics of one counter over the pixels of a frame.
struct PixelCounterStats {
  double mean = 0, max = 0;
  double share = 0;  // of the pixels: where the counter is not 0
};

PixelCounterStats measure_counter(const std::vector<float>& values);

// The error of pictures whose surfaces vary, in two parts (tools/evaluate/error_split.h), each as RMSE.
struct ErrorParts {
  double visibility = 0;  // who covers how much of a pixel
  double shading = 0;     // what colour it was taken to be
};

struct FrameReport {
  std::size_t index = 0;  // in the trace
  std::string image;      // paths are relative to the report's folder
  std::string picture;    // the image as PNG, for looking at
  std::string counters;   // per-pixel counters; empty if none were written
  std::optional<ErrorStats> error;
  std::optional<ErrorParts> parts;  // none if all surfaces are flat
  std::optional<double> flicker;    // change of the error since the previous frame
  WallTime wall_ms;
  std::uint64_t a_buffer_peak_bytes = 0;
  std::vector<Buffer> buffers;  // all except the A-buffer and the framebuffer
  std::vector<StageCounters> stages;
  std::map<std::string, PixelCounterStats> pixel_counters;  // by name
  std::uint64_t pixels = 0;
  std::uint64_t bin_pixels = 0;  // of the largest bin
  // As in FrameResult.
  std::vector<std::uint64_t> bin_operations, bin_invocations;
  std::vector<ArrayBytes> dram_arrays;
  std::vector<StoppedDraw> stopped;

  // What the pixels of a bin take on chip; 0 if they are in memory.
  double open_pixel_bytes() const { return peak_bytes_of(kOpenPixels); }

  // What triangles take in memory beside the framebuffer: the A-buffer, the layer of translucent ones, and records of
  // beam that found no room on chip.
  double bytes_beside_framebuffer() const {
    return static_cast<double>(a_buffer_peak_bytes) + peak_bytes_of(kTranslucentLayer) + peak_bytes_of(kSpilledRecords);
  }

  BinSize bin_size() const { return {open_pixel_bytes(), static_cast<double>(bin_pixels)}; }

  // By a core, at a time.
  std::uint32_t bins_held(const MemoryParameters& memory) const {
    return memory.bins_held(bin_size().bytes, bin_size().pixels);
  }

  // What the frame's modelled time depends on. This must outlive it.
  FrameWork work() const { return {stages, bin_size(), bin_operations, bin_invocations}; }

  double peak_bytes_of(std::string_view buffer) const;  // 0 if there is none of this name
};

}  // namespace beampipe
