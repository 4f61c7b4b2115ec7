// A timeline as a file for ui.perfetto.dev or chrome://tracing (the Trace Event Format, JSON).
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/timeline.h"
#include "tools/cli/run_arguments.h"
#include "tools/files/interrupt.h"

namespace beampipe {

// Each event is a slice on its thread, named after the stage and told its tile; times are microseconds since the first.
std::string trace_events_json(const Timeline& timeline);

// What --trace-events asks for; nothing when it was not given.
class TraceEvents {
 public:
  // Lets the plan record its stages here. Throws, one line, before anything is rendered: UsageError when the file is
  // the trace or in the output folder, std::runtime_error unless it can be written.
  TraceEvents(const RunArguments& arguments, RunPlan& plan);
  TraceEvents(const TraceEvents&) = delete;
  TraceEvents& operator=(const TraceEvents&) = delete;

  void write(InterruptGate& gate) const;

 private:
  std::filesystem::path file_;
  Timeline timeline_;
};

}  // namespace beampipe
