// Renders frames with several techniques, times them, and writes the results.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/flip.h"
#include "tools/evaluate/progress.h"
#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "tools/files/output.h"
#include "traces/files/json.h"

namespace beampipe {

// Puts what the frame counted into its report.
void add_counters(const FrameResult& result, FrameReport& report);

// Renders one frame plan.repeat times with every technique of the plan. Techniques take turns (A B A B ...), so that a
// slow moment of the machine does not affect one of them alone. If the plan models memory and repeats frames, one more
// run comes first, which models memory; the timed runs then model nothing. The first result of each technique goes to
// `use` and is freed at once, so that only one result is in memory at a time. `histories` has one entry per technique:
// at the start what earlier frames left, at the end what this frame leaves; every run starts from the former. Returns
// the times, one per technique.
std::vector<WallTime> render_frame(const RunPlan& plan, std::size_t frame, Progress& progress,
                                   std::vector<History>& histories,
                                   const std::function<void(std::size_t technique, FrameResult&&)>& use);

// The histories after the plan's unmeasured frames and the first `frames` ones. Renders those frames with the
// techniques that keep one.
std::vector<History> rebuild_histories(const RunPlan& plan, std::size_t frames, Progress& progress,
                                       SurfaceColors colors = SurfaceColors::by_place);

// Renders a frame once with one technique, or takes it from the plan's kept pictures if it is there; otherwise it is
// kept. Of a technique without history and without pixel counters. If `time` is not null, it becomes the time that the
// rendering took.
FrameResult render_kept(const Technique& technique, const RunPlan& plan, std::size_t frame, Progress& progress,
                        WallTime* time = nullptr);
Image kept_picture(const Technique& technique, const RunPlan& plan, std::size_t frame, Progress& progress,
                   SurfaceColors colors = SurfaceColors::by_place);

// Renders only a picture, without modelling memory. `history` is as in FrameInput.
Image render_picture(const Technique& technique, const RunPlan& plan, std::size_t frame, Progress& progress,
                     SurfaceColors colors = SurfaceColors::by_place, History* history = nullptr);

// As measure_error, or, if it has pixels_per_degree, as measure_all; but what it throws says which technique and frame
// it is about.
ErrorStats measure_named_error(const std::string& spec, std::size_t frame, const Image& image, const Image& reference,
                               std::optional<double> pixels_per_degree = {});

// A frame as one technique has rendered it.
struct RenderedFrame {
  const std::string& spec;
  std::size_t index = 0;
  const FrameResult& result;
  const Image* reference = nullptr;  // what its error is measured against; null: it is not measured
  double pixels_per_degree = kPixelsPerDegree;
};

// Writes a frame's image (EXR), its picture (PNG) and its per-pixel counters, if there are any, into the technique's
// folder. The headers of EXR files name the trace's file, its digest, the technique, the frame and the program's
// version, as maker_form() (tools/evaluate/resume.h) has them. Returns the frame's report, which lacks the times. If
// it has a reference, the error of the image is in the report and in a counter named `error`. Throws as
// OutputFolder::write does and, before anything is written, as measure_named_error does.
FrameReport write_frame(OutputFolder& output, const RunPlan& plan, const Json& made_by, const RenderedFrame& frame);

// Throws std::runtime_error, one line, unless report.json, the folder of every technique and the folder of frame
// records can be written.
void require_writable_folders(const OutputFolder& output, const std::vector<Technique>& techniques);

// The parts of a report that are known before rendering.
Report new_report(const RunPlan& plan, const Json& made_by);

}  // namespace beampipe
