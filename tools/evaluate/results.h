// What run and compare find out about techniques.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/technique.h"
#include "stages/geometry/draw_notes.h"
#include "tools/evaluate/frame_reports.h"
#include "tools/evaluate/hardware.h"
#include "tools/evaluate/metrics.h"
#include "traces/files/json.h"

namespace beampipe {

// The same frames with their triangles in another order.
struct OrderReport {
  std::string order;  // "given", "shuffled", ...
  double rmse = 0;    // against the reference in the same order
};

struct TechniqueReport {
  std::string technique;
  std::vector<Surface> framebuffer;  // in memory
  bool pixels_on_chip = false;       // what else a pixel has is on chip while its bin is drawn
  std::uint32_t framebuffer_bytes_per_pixel = 0;
  std::optional<ErrorStats> error;  // pooled over the frames
  std::optional<EquivalentMsaa> equivalent_msaa;
  std::optional<ErrorParts> parts;                // pooled over the frames; none if all surfaces are flat
  std::optional<EquivalentMsaa> visibility_msaa;  // equivalent rate for visibility alone
  FrameReports frames;
  std::optional<double> flicker;  // pooled over all frames except the first
  std::vector<std::pair<std::string, double>>
      causes;                       // share of the mean square error by cause; empty without --causes
  std::vector<OrderReport> orders;  // empty without --orders
  double order_difference = 0;      // RMS difference between the two orders whose pictures differ most
  std::string inspections;          // file with the histories of some pixels; empty if there are none

  // Bytes of the framebuffer, and of A-buffer, translucent layer and spilled records in the frame where these are
  // largest.
  double peak_bytes_per_pixel() const;

  // All buffers that a bin has on chip at their peaks, over the pixels of a bin; in the frame where that is largest.
  double on_chip_bytes_per_pixel() const;
};

// What a frame of the trace asks to be drawn.
struct FrameContent {
  std::size_t index = 0;                // in the trace
  std::uint32_t width = 0, height = 0;  // pixels
  std::uint64_t triangles = 0;          // of all draws, before clipping and culling
  std::size_t draws = 0, lights = 0;
};

struct Report {
  std::string trace, version, simd;
  std::string command_line = {};  // the one that made it; empty if none did
  int threads = 0;
  MemoryParameters memory = {};
  Hardware hardware = {};  // whose times are modelled; nothing is modelled if it has no implementations
  std::vector<TechniqueReport> results = {};
  std::string metric = {};                         // what equivalent rates compare; empty if they are not measured
  std::optional<double> reference_error = {};      // its RMSE, if it was measured
  std::vector<LadderRung> msaa_ladder = {};        // RMSE; empty if not measured
  std::vector<LadderRung> metric_ladder = {};      // errors by the metric; empty if that is the RMSE
  std::vector<LadderRung> visibility_ladder = {};  // of visibility alone; empty if all surfaces are flat
  std::vector<DrawNote> notes = {};                // what the frames ask for and no technique does
  Json made_by = {};                      // what the results depend on: maker_form() in tools/evaluate/resume.h
  std::size_t trace_frames = 0;           // of the whole trace; 0: unknown
  std::vector<FrameContent> frames = {};  // those that were rendered
};

// Such as "0.1.0".
std::string program_version();

// Tells programs apart: a digest of the file that this code was loaded from, an executable or a module of Python, and
// of the code of techniques that are not in it (TechniqueKind::code).
std::string program_digest();

// The report of a technique of which no frame has been rendered yet. `memory`: the system that it runs on.
// `frames_in_memory`: as for FrameReports.
TechniqueReport new_technique_report(const Technique& technique, const MemoryParameters& memory,
                                     std::size_t frames_in_memory = FrameReports::kAll);

// Of each technique, for commands that render traces of any length.
inline constexpr std::size_t kFramesInMemory = 64;

// The name of a technique's folder: its spec, with _ for every character outside [A-Za-z0-9.=-].
std::string spec_folder(std::string_view spec);

// What the names of a frame's files start with, in the output folder: "msaa_8/frame_0007".
std::string frame_stem(std::string_view spec, std::size_t frame);

}  // namespace beampipe
