// The arguments of `run` and `compare`, checked as a whole before anything is rendered.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/cli/command_line.h"
#include "tools/cli/hardware_options.h"
#include "tools/cli/trace_view.h"
#include "tools/evaluate/run_plan.h"

namespace beampipe {

// The arguments as the user wrote them.
struct RunArguments {
  std::string command_line;  // all words, as one text
  std::string trace, output, frames, trace_events;
  HardwareOptions hardware;
  TraceView view;
  std::vector<std::string> specs;
  std::string simd;                 // empty: the best one that this machine has
  std::uint64_t memory_limit = 0;   // bytes; 0: the default
  std::string framebuffer;          // empty: as the hardware says
  std::uint64_t on_chip_bytes = 0;  // 0: as the hardware says
  int threads = 0, repeat = 1;
  std::size_t measure_from = 0;
  bool allow_outside = false, no_memory_model = false, resume = false, force = false;
};

// `arguments` must live until the command line is parsed.
void add_run_arguments(Command& command, RunArguments& arguments);

// Reads the trace and chooses the instruction set. Throws UsageError, SpecError, TraceError, or std::runtime_error if a
// frame needs more memory than the machine has.
RunPlan make_plan(const RunArguments& arguments);

// The full name of a file that an option names, which must be neither the trace nor in the output folder. `option`:
// with the file's name. Throws UsageError if it is, and std::runtime_error, one line, if it cannot be written.
std::filesystem::path file_beside_output(const std::string& option, const std::string& file,
                                         const RunArguments& arguments);

// "A-B" or "A", counted from 0, both ends included. Throws UsageError unless A <= B < frames.
std::vector<std::size_t> parse_frame_range(const std::string& text, std::size_t frames);

// Replaces "msaa:1,8,32" by the three specs msaa:1, msaa:8 and msaa:32, and keeps all other specs.
std::vector<std::string> expand_specs(const std::vector<std::string>& specs);

// Throws UsageError if a spec is given twice or two specs have the same folder, and SpecError if one is unknown.
std::vector<Technique> parse_techniques(const std::vector<std::string>& specs);

}  // namespace beampipe
