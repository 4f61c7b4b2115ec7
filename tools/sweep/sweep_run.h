// Does the jobs of a sweep, several at a time, as far as the machine has memory.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/files/interrupt.h"
#include "tools/sweep/sweep_jobs.h"

namespace beampipe {

struct SweepWorkers {
  int jobs = 0;                    // at a time; 0: one per processor core
  int threads = 0;                 // of each job; 0: the cores that are left to it
  std::filesystem::path pictures;  // as in JobLimits
};

struct SweepOutcome {
  std::size_t stored = 0, shared = 0, rendered = 0;  // cells, and the errors of a trace in a size
  std::vector<std::string> failures;                 // one line each
};

// A job that fails does not stop the others. Shows progress on a terminal. Ctrl-C tells what is kept.
SweepOutcome run_jobs(const SweepPlan& plan, const std::vector<SweepJob>& jobs, TraceShelf& shelf,
                      SweepResults& results, const SweepWorkers& workers, InterruptGate& gate);

}  // namespace beampipe
