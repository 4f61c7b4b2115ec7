// Writes the DRAM requests of a frame, one a line, for simulators of DRAM.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/memory/dram_trace.h"
#include "tools/cli/run_arguments.h"
#include "tools/files/interrupt.h"

namespace beampipe {

// Of each request, which is a sector (32 bytes by default), the format has:
//   dramsim3    0x1f20 READ 12           address, READ or WRITE, cycle
//   ramulator2  LD 0x1f20                LD or ST, address (its LoadStoreTrace)
//   csv         12,0x1f20,READ,shade,attributes   cycle, address, READ or WRITE, stage, array; below a line of titles
// A cycle is a nanosecond, as in DRAMsim3's HBM2 configurations: the whole nanosecond in which the described hardware's
// DRAM begins to move the request if it moves all requests at its full rate, without a pause.
inline constexpr const char* kDramSim3 = "dramsim3";
inline constexpr const char* kRamulator2 = "ramulator2";
inline constexpr const char* kCsv = "csv";

struct MemoryTraceArguments {
  std::string file, format = kDramSim3;
};

// `arguments` must live until the command line is parsed.
void add_memory_trace_arguments(Command& command, MemoryTraceArguments& arguments);

// What --memory-trace asks for. Does nothing if the option was not given.
class MemoryTrace {
 public:
  // Makes the plan record its DRAM requests here. Throws UsageError if there is more than one frame or technique, if
  // memory is not modelled, if the run resumes another one, or if the file is the trace or lies in the output folder;
  // and std::runtime_error, one line, if it cannot be written.
  MemoryTrace(const MemoryTraceArguments& arguments, const RunArguments& run, RunPlan& plan);
  MemoryTrace(const MemoryTrace&) = delete;
  MemoryTrace& operator=(const MemoryTrace&) = delete;

  void write(InterruptGate& gate) const;

 private:
  std::filesystem::path file_;
  std::string format_;
  double bytes_per_cycle_ = 0;
  std::uint32_t sector_bytes_ = 0;
  std::optional<DramTrace> trace_;
};

}  // namespace beampipe
