#include "tools/cli/memory_trace.h"

#include <charconv>

#include "tools/evaluate/known_specs.h"
#include "tools/files/text_stream.h"

namespace beampipe {
namespace {

void append_number(std::string& line, std::uint64_t number, int base) {
  char digits[24];
  const auto end = std::to_chars(digits, digits + sizeof digits, number, base).ptr;
  line.append(digits, end);
}

void append_address(std::string& line, std::uint64_t address) {
  line += "0x";
  append_number(line, address, 16);
}

void append_line(std::string& text, const std::string& format, const DramRequest& request, std::uint64_t cycle) {
  const bool writes = request.access == DramAccess::write;
  if (format == kRamulator2) {
    text += writes ? "ST " : "LD ";
    append_address(text, request.address);
  } else if (format == kCsv) {
    append_number(text, cycle, 10);
    text += ',';
    append_address(text, request.address);
    text += writes ? ",WRITE," : ",READ,";
    text.append(request.stage).append(1, ',').append(request.array);
  } else {
    append_address(text, request.address);
    text += writes ? " WRITE " : " READ ";
    append_number(text, cycle, 10);
  }
  text += '\n';
}

}  // namespace

void add_memory_trace_arguments(Command& command, MemoryTraceArguments& arguments) {
  const Option file = command.add(
      "--memory-trace", arguments.file,
      "write the DRAM requests of one frame of one technique to this file, one a line, for simulators of DRAM; a name "
      "that ends in .gz is compressed");
  command
      .add("--memory-trace-format", arguments.format,
           "the lines: for DRAMsim3, for Ramulator 2, or CSV with the stage and the array")
      .one_of({kDramSim3, kRamulator2, kCsv})
      .shows_default()
      .needs(file);
}

MemoryTrace::MemoryTrace(const MemoryTraceArguments& arguments, const RunArguments& run, RunPlan& plan) {
  if (arguments.file.empty()) return;
  const std::string option = "--memory-trace " + arguments.file;
  if (plan.techniques.size() != 1 || plan.frames.size() != 1)
    throw UsageError(option + ": expected one technique and one frame, found techniques: " +
                     std::to_string(plan.techniques.size()) + ", frames: " + std::to_string(plan.frames.size()));
  if (!plan.options.memory.modelled)
    throw UsageError(option + ": without a model of memory there are no requests; leave out --no-memory-model");
  if (is_reference(plan.techniques.front().spec))
    throw UsageError(option + ": the reference makes no requests; name another technique");
  if (run.resume) throw UsageError(option + ": a resumed run does not draw its frames again; leave out --resume");
  file_ = file_beside_output(option, arguments.file, run);
  if (!run.trace_events.empty() && file_ == file_beside_output("--trace-events", run.trace_events, run))
    throw UsageError(option + " and --trace-events name the same file");
  format_ = arguments.format;
  constexpr double kCyclesPerSecond = 1e9;
  bytes_per_cycle_ = plan.hardware.rates.at("dram_bytes_per_clk") * plan.hardware.clock_mhz * 1e6 / kCyclesPerSecond;
  sector_bytes_ = plan.options.memory.sector_bytes;
  trace_.emplace(file_.parent_path(), sector_bytes_);
  plan.sinks.dram_trace = &*trace_;
}

void MemoryTrace::write(InterruptGate& gate) const {
  if (!trace_) return;
  TextStream out(file_, gate);
  if (format_ == kCsv) out.write("cycle,address,access,stage,array\n");
  std::string text;
  std::uint64_t moved = 0;
  trace_->for_each([&](const DramRequest& request) {
    text.clear();
    append_line(text, format_, request, static_cast<std::uint64_t>(static_cast<double>(moved) / bytes_per_cycle_));
    out.write(text);
    moved += sector_bytes_;
  });
  out.commit();
}

}  // namespace beampipe
