#include "tools/cli/run_report.h"

#include <iostream>

#include "tools/evaluate/draw_notes.h"
#include "tools/evaluate/resume.h"
#include "tools/report/report_json.h"
#include "tools/report/report_text.h"
#include "tools/report/times_text.h"

namespace beampipe {

void tell_resumption(const RunPlan& plan, std::size_t finished_frames) {
  if (finished_frames == 0 || finished_frames == plan.frames.size()) return;
  std::string text = "beampipe: " + std::to_string(finished_frames) + " of " + std::to_string(plan.frames.size()) +
                     " frames are finished; continuing with frame " + std::to_string(plan.frames[finished_frames]);
  std::string accumulating;
  for (const Technique& technique : plan.techniques)
    if (technique.keeps_history) accumulating += (accumulating.empty() ? "" : ", ") + technique.spec;
  if (!accumulating.empty())
    text += " (" + accumulating + ": earlier frames are rendered again, because the next ones depend on them)";
  std::cerr << text << std::endl;
}

void tell_finished(const OutputFolder& output) {
  std::cout << "already finished\nreport: " << (output.path() / "report.json").string() << "\n";
}

void finish_report(OutputFolder& output, const Trace& trace, Report report) {
  std::vector<DrawNote> notes;
  for (const TechniqueReport& result : report.results)
    for (const FrameReport& frame : result.frames)
      add_stopped(trace, frame.index, result.technique, frame.stopped, notes);
  tell_notes(notes);
  report.notes.insert(report.notes.end(), notes.begin(), notes.end());
  output.write("report.json", [&](const OutputFolder::WriteBytes& write) { write_json(report, write); });
  output.keep();
  FrameRecords(output, report.made_by).remove();
  std::cout << table_text(report, output.path().string()) << measures_text(report) << causes_text(report)
            << orders_text(report) << (report.memory.modelled ? times_text(report) : "")
            << "report: " << (output.path() / "report.json").string() << "\n";
  const std::filesystem::path page = output.path() / "report.html";
  if (std::error_code ignored; std::filesystem::exists(page, ignored))
    std::cerr << "beampipe: note: " << page.string() << " is of earlier results; `beampipe report` makes it again\n";
}

}  // namespace beampipe
