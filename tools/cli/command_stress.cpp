// beampipe stress: compares techniques with exact arithmetic in hard cases.

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <set>

#include "pipeline/technique_table.h"
#include "tools/cli/commands.h"
#include "tools/cli/run_arguments.h"
#include "tools/evaluate/progress.h"
#include "tools/files/output.h"
#include "tools/report/report_text.h"
#include "tools/stress/judge.h"
#include "traces/files/atomic_file.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

struct StressArguments {
  std::vector<std::string> specs = stressed_specs();
  std::vector<std::string> cases;
  std::string output;
  int threads = 0;
};

// "exact", "2^-12.3" or "nan", with a star if the limit is larger than that of the format, and a ! beyond the limit.
std::string cell_of(const Verdict& verdict) {
  char text[32] = "exact";
  if (std::isnan(verdict.error)) {
    std::snprintf(text, sizeof text, "nan");
  } else if (verdict.error > 0) {
    std::snprintf(text, sizeof text, "2^%.1f", std::log2(verdict.error));
  }
  const double format = verdict.reason.empty() ? verdict.limit : kFp16Error;
  return text + std::string(!verdict.passes() ? "!" : verdict.error > format ? "*" : "");
}

Json json_of(const HardCase& hard_case, const std::string& spec, const Verdict& verdict) {
  return {{"case", hard_case.name}, {"what", hard_case.what},   {"technique", spec},
          {"error", verdict.error},  // null for NaN
          {"limit", verdict.limit}, {"reason", verdict.reason}, {"passes", verdict.passes()}};
}

bool is_finite(const Trace& trace) {
  for (const Mesh& mesh : trace.meshes)
    for (const glm::vec3& position : mesh.positions)
      if (!std::isfinite(position.x + position.y + position.z)) return false;
  return true;
}

// Saves the case as a trace for `run` and `compare`.
void save_trace(const HardCase& hard_case, const std::filesystem::path& folder, InterruptGate& gate) {
  if (!is_finite(hard_case.trace)) return;  // JSON has no NaN and no infinity
  const std::filesystem::path file = folder / (hard_case.name + ".json");
  {
    const auto held = gate.hold();
    std::filesystem::create_directories(folder);
    gate.set_unfinished({AtomicFile::temporary_of(file)});
  }
  write_trace(hard_case.trace, file);
}

// The cases that are named, or all. Throws UsageError if no case has a name.
std::vector<HardCase> chosen_cases(const StressArguments& arguments) {
  std::vector<HardCase> cases = hard_cases();
  if (arguments.cases.empty()) return cases;
  std::set<std::string> missing(arguments.cases.begin(), arguments.cases.end());
  const std::set<std::string> named = missing;
  for (const HardCase& hard_case : cases) missing.erase(hard_case.name);
  if (!missing.empty()) throw UsageError("there is no hard case named " + *missing.begin());
  std::erase_if(cases, [&](const HardCase& hard_case) { return !named.contains(hard_case.name); });
  return cases;
}

void stress(const StressArguments& arguments, InterruptGate& gate) {
  const std::vector<Technique> techniques = parse_techniques(arguments.specs);
  const std::vector<HardCase> cases = chosen_cases(arguments);
  const std::filesystem::path folder = arguments.output;
  if (!folder.empty()) {
    require_writable_folder(folder / "traces");
    require_writable_file(folder / "stress.json");
  }
  FrameInput options;
  options.threads = arguments.threads;
  options.memory.modelled = false;  // only the pictures are compared
  std::vector<std::vector<std::string>> rows(1, {"case"});
  for (const Technique& technique : techniques) rows[0].push_back(technique.spec);
  std::vector<std::string> notes;
  Json results = Json::array();
  std::uint64_t failures = 0;
  {
    Progress progress;
    for (const HardCase& hard_case : cases) {
      if (!folder.empty()) save_trace(hard_case, folder / "traces", gate);
      Judge judge(hard_case);
      std::vector<std::string>& row = rows.emplace_back(1, hard_case.name);
      notes.push_back(hard_case.name + ": " + hard_case.what);
      for (const Technique& technique : techniques) {
        progress.show(hard_case.name + ": " + technique.spec);
        const Verdict verdict = judge.judge(technique, options);
        row.push_back(cell_of(verdict));
        results.push_back(json_of(hard_case, technique.spec, verdict));
        failures += !verdict.passes();
        if (!verdict.reason.empty() && verdict.error > kFp16Error) {
          char limit[32];
          std::snprintf(limit, sizeof limit, "%.3g", verdict.limit);
          notes.push_back("  " + technique.spec + " up to " + limit + ": " + verdict.reason);
        }
      }
    }
  }
  std::cout << align_columns(rows, {0}) << "\n";
  for (const std::string& note : notes) std::cout << note << "\n";
  if (!folder.empty()) {
    OutputFolder output(folder, gate);
    output.write("stress.json", results.dump(1) + "\n");
    output.keep();
  }
  if (failures > 0) throw std::runtime_error(std::to_string(failures) + " results are beyond their limits");
}

}  // namespace

void add_stress_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<StressArguments>();
  Command command =
      line.add_command("stress", "Compare techniques with exact arithmetic in cases that are numerically hard");
  command.add("-t,--technique", arguments->specs, "the techniques (default: some of each kind)");
  command.add("--case", arguments->cases, "run only these cases (default: all)");
  command.add(
      "-o,--output", arguments->output,
      "a folder for stress.json, with all errors and limits, and for the traces of the cases (except not_finite: JSON "
      "has no NaN)");
  command.add("--threads", arguments->threads, "the number of threads (default: one per processor core)")
      .between(1, 1024);
  command.footer(
      R"(Each cell of the table is the largest error over all pixels and R, G, B, A. Techniques that sample are compared with
exact values at their samples, all others with exact areas. With materials, "exact" means that the picture has only
colours that its textures and lights can give, or that it equals another picture. A star (*) marks an error above the
rounding of fp16 that has a stated reason. An exclamation mark (!) marks one above the stated limit; the exit code is
then 1.)");
  command.set_work([arguments, &gate] { stress(*arguments, gate); });
}

}  // namespace beampipe
