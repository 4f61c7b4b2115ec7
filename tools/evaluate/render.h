// Rendering frames with several techniques, timing them, and writing what comes out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/evaluate/progress.h"
#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "tools/files/output.h"
#include "traces/json.h"

namespace beampipe {

// Renders one frame with every technique of the plan, plan.repeat times, one technique after the other (A B A B ...) so
// that a slow moment of the machine does not fall on one alone. Where memory is modelled and there is more than one
// run, one more comes first, for the counts, and those that are timed model nothing. The first result of each is handed
// to `use` at once and then freed, so that memory holds one result at a time. `histories`, one per technique, are what
// earlier frames left, and then what this one leaves; every run starts from the same. Returns the times, one per
// technique.
std::vector<WallTime> render_frame(const RunPlan& plan, std::size_t frame, Progress& progress,
                                   std::vector<History>& histories,
                                   const std::function<void(std::size_t technique, FrameResult&&)>& use);

// What the plan's first `frames` frames leave for the next: renders them again with the techniques that keep a history.
std::vector<History> rebuild_histories(const RunPlan& plan, std::size_t frames, Progress& progress);

// Renders with one technique, once.
FrameResult render_once(const Technique& technique, const RunPlan& plan, std::size_t frame, Progress& progress,
                        WallTime* time = nullptr);

// The same for the picture alone: memory is not modelled.
Image render_picture(const Technique& technique, const RunPlan& plan, std::size_t frame, Progress& progress);

// Writes a frame's image, its picture and, if there are any, its per-pixel counters into the technique's folder;
// returns the report, still without times. With a reference, the image's error is in the report and in a counter named
// `error`. Throws OutputError, and as measure_error does before anything is written.
FrameReport write_frame(OutputFolder& output, const std::string& spec, std::size_t frame, const FrameResult& result,
                        const Image* reference);

// Throws std::runtime_error, one line, unless every technique's folder, that of the frames' records and report.json can
// be written.
void require_writable_folders(const OutputFolder& output, const std::vector<Technique>& techniques);

// The parts of a report that are known before rendering.
Report new_report(const RunPlan& plan, const Json& made_by);

}  // namespace beampipe
