// beampipe stress: hard cases against exact arithmetic.

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <set>

#include "tools/commands.h"
#include "tools/machine_memory.h"
#include "tools/progress.h"
#include "tools/report.h"
#include "tools/run_plan.h"
#include "tools/stress/judge.h"

namespace beampipe {
namespace {

struct StressArguments {
  std::vector<std::string> specs = {"beam",
                                    "beam:storage=float32",
                                    "beam:bits=32",
                                    "beam:order=stream",
                                    "beam:order=stream,bits=64,layers=1",
                                    "z3",
                                    "z3:shape=128x3",
                                    "beam:rules=paper",
                                    "beam:rules=paper,storage=text",
                                    "beam:rules=paper,storage=float32",
                                    "alpha",
                                    "msaa:1,8,16,256",
                                    "acaa:8",
                                    "acaa:8,double=stencil",
                                    "acaa:8,color=unorm8",
                                    "acaa:8,color=fp32",
                                    "acaa:256",
                                    "deferred",
                                    "visibility",
                                    "taa:8",
                                    "dvm",
                                    "reference"};
  std::vector<std::string> cases;
  int threads = 0;
  bool heavy = false;
};

// "exact", "2^-12.3" or "nan"; with a star where the limit is not the format's, and a ! beyond the limit.
std::string cell_of(const Verdict& verdict) {
  char text[32] = "exact";
  if (std::isnan(verdict.error)) {
    std::snprintf(text, sizeof text, "nan");
  } else if (verdict.error > 0) {
    std::snprintf(text, sizeof text, "2^%.1f", std::log2(verdict.error));
  }
  const double format = verdict.reason.empty() ? verdict.limit : kFormatError;
  return text + std::string(!verdict.passes() ? "!" : verdict.error > format ? "*" : "");
}

void stress(const StressArguments& arguments) {
  const std::vector<Technique> techniques = parse_techniques(arguments.specs);
  RunOptions options;
  options.threads = arguments.threads;
  options.memory.modelled = false;  // pictures alone are judged
  std::vector<std::vector<std::string>> rows(1, {"case"});
  for (const Technique& technique : techniques) rows[0].push_back(technique.spec);
  std::vector<std::string> notes;
  std::set<std::string> unknown(arguments.cases.begin(), arguments.cases.end());
  std::uint64_t failures = 0;
  {
    Progress progress;
    for (const HardCase& hard_case : hard_cases(arguments.heavy)) {
      if (!arguments.cases.empty() && !unknown.erase(hard_case.name)) continue;
      Judge judge(hard_case);
      std::vector<std::string>& row = rows.emplace_back(1, hard_case.name);
      notes.push_back(hard_case.name + ": " + hard_case.what);
      for (const Technique& technique : techniques) {
        progress.show(hard_case.name + ": " + technique.spec);
        require_memory(technique, hard_case.trace.frames[0], hard_case.name, machine_memory());
        const Verdict verdict = judge.judge(technique, options);
        row.push_back(cell_of(verdict));
        failures += !verdict.passes();
        if (!verdict.reason.empty() && verdict.error > kFormatError) {
          char limit[32];
          std::snprintf(limit, sizeof limit, "%.3g", verdict.limit);
          notes.push_back("  " + technique.spec + " up to " + limit + ": " + verdict.reason);
        }
      }
    }
  }
  if (!unknown.empty()) throw UsageError("there is no hard case named " + *unknown.begin());
  std::cout << align_columns(rows, {0}) << "\n";
  for (const std::string& note : notes) std::cout << note << "\n";
  if (failures > 0) throw std::runtime_error(std::to_string(failures) + " results are beyond their limits");
}

}  // namespace

void add_stress_command(CLI::App& app) {
  const auto arguments = std::make_shared<StressArguments>();
  CLI::App* command =
      app.add_subcommand("stress", "Hold the techniques to exact arithmetic in cases that are hard on numbers");
  command->add_option("-t,--technique", arguments->specs, "techniques (default: one or more of each kind)");
  command->add_option("--case", arguments->cases, "only these cases (default: all)");
  command->add_option("--threads", arguments->threads, "threads to use (default: all that the machine has)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--heavy", arguments->heavy,
                    "also a pixel with a million fragments, a gigabyte and a minute, and 16384 x 16384 pixels, for "
                    "techniques that are named: 5 to 9 GB and a minute or two each; taa and dvm need 32 GB");
  command->footer(
      "Each cell is the largest error over all pixels and R, G, B, A against rational arithmetic: of the areas, or, "
      "for\n"
      "techniques that sample, of their samples. *: more than fp16 rounding, for a stated reason. !: beyond the "
      "stated\n"
      "limit; then the exit code is 1.");
  command->callback([arguments] { stress(*arguments); });
}

}  // namespace beampipe
