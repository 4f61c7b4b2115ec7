// beampipe run: pictures, counters and times of one or more techniques.

#include <memory>
#include <utility>

#include "tools/cli/commands.h"
#include "tools/cli/memory_trace.h"
#include "tools/cli/run_arguments.h"
#include "tools/cli/run_report.h"
#include "tools/cli/trace_events.h"
#include "tools/evaluate/draw_notes.h"
#include "tools/evaluate/render.h"
#include "tools/evaluate/resume.h"

namespace beampipe {
namespace {

void run(const RunArguments& arguments, const MemoryTraceArguments& trace_arguments, InterruptGate& gate) {
  RunPlan plan = make_plan(arguments);
  tell_notes(plan.notes);
  const TraceEvents events(arguments, plan);
  const MemoryTrace memory_trace(trace_arguments, arguments, plan);
  OutputFolder output(arguments.output, gate);
  output.lock();
  require_writable_folders(output, plan.techniques);
  const Json maker = maker_form().write({.command = "run", .plan = plan});
  FrameRecords records(output, maker);
  if (!arguments.force && !arguments.resume) records.require_own_folder();

  Report report = new_report(plan, maker);
  for (const Technique& technique : plan.techniques)
    report.results.push_back(new_technique_report(technique, plan.options.memory, kFramesInMemory));
  const auto add = [&](const FrameRecord& record) {
    for (std::size_t i = 0; i < record.reports.size(); ++i) report.results[i].frames.push_back(record.reports[i]);
    return true;
  };
  std::size_t finished = 0;
  if (arguments.resume) {
    if (records.is_finished()) return tell_finished(output);
    finished = records.read(plan.frames, specs_of(plan.techniques), nullptr, add);
    tell_resumption(plan, finished);
  }
  if (finished < plan.frames.size()) {
    Progress progress;
    std::vector<History> histories = rebuild_histories(plan, finished, progress);
    for (std::size_t at = finished; at < plan.frames.size(); ++at) {
      const std::size_t frame = plan.frames[at];
      FrameRecord record;
      const std::vector<WallTime> times =
          render_frame(plan, frame, progress, histories, [&](std::size_t i, FrameResult&& result) {
            record.reports.push_back(write_frame(output, plan, maker, {plan.techniques[i].spec, frame, result}));
          });
      for (std::size_t i = 0; i < times.size(); ++i) record.reports[i].wall_ms = times[i];
      add(record);
      records.write(record, at + 1, plan.frames.size());
      output.keep();
    }
  }
  finish_report(output, plan.trace, std::move(report));
  events.write(gate);
  memory_trace.write(gate);
}

}  // namespace

void add_run_command(CommandLine& line, const std::string& command_line, InterruptGate& gate) {
  const auto arguments = std::make_shared<RunArguments>();
  arguments->command_line = command_line;
  const auto trace_arguments = std::make_shared<MemoryTraceArguments>();
  Command command = line.add_command("run", "Render a trace: pictures, what every stage cost, times");
  add_run_arguments(command, *arguments);
  add_memory_trace_arguments(command, *trace_arguments);
  command.footer(
      "Writes into the folder: a picture of each frame and technique (EXR and PNG), counters per pixel (EXR), and\n"
      "report.json with the cost of every stage. `beampipe report` makes a page of it.\n\nExample:\n  beampipe run "
      "fence.json -t beam msaa:1,8 --repeat 5 -o out\n\nTechniques:\n" +
      technique_help());
  command.set_work([arguments, trace_arguments, &gate] { run(*arguments, *trace_arguments, gate); });
}

}  // namespace beampipe
