// Writes a timeline of stages in the Trace Event Format (JSON), which ui.perfetto.dev and chrome://tracing show.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/bins/timeline.h"
#include "tools/cli/run_arguments.h"
#include "tools/files/interrupt.h"

namespace beampipe {

// Each event becomes a slice of its thread, with the name of the stage and the tile. Times are in microseconds since
// the first event.
std::string trace_events_json(const Timeline& timeline);

// What --trace-events asks for. Does nothing if the option was not given.
class TraceEvents {
 public:
  // Makes the plan record its stages here. Throws UsageError if the file is the trace or lies in the output folder, and
  // std::runtime_error, one line, if it cannot be written.
  TraceEvents(const RunArguments& arguments, RunPlan& plan);
  TraceEvents(const TraceEvents&) = delete;
  TraceEvents& operator=(const TraceEvents&) = delete;

  void write(InterruptGate& gate) const;

 private:
  std::filesystem::path file_;
  Timeline timeline_;
};

}  // namespace beampipe
