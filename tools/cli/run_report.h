// What `run` and `compare` tell the user, and the report that they leave.
#pragma once

#include <cstddef>

#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "tools/files/output.h"

namespace beampipe {

// What --resume found: how many frames are done, on stderr; that none is left to do, on stdout.
void tell_resumption(const RunPlan& plan, std::size_t finished_frames);
void tell_finished(const OutputFolder& output);

// Writes report.json, removes the records of single frames and prints the table.
void finish_report(OutputFolder& output, const Report& report);

}  // namespace beampipe
