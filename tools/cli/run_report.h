// What `run` and `compare` tell the user, and the report that they leave.
#pragma once

#include <cstddef>

#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "tools/files/output.h"

namespace beampipe {

// Messages of --resume: which frame comes next (stderr; nothing if all or none are finished), and that the whole run is
// already finished (stdout).
void tell_resumption(const RunPlan& plan, std::size_t finished_frames);
void tell_finished(const OutputFolder& output);

// Notes what the frames have shown, writes report.json, removes the records of the frames and prints the tables.
void finish_report(OutputFolder& output, const Trace& trace, Report report);

}  // namespace beampipe
