// beampipe model: the modelled times and energy of finished runs, with other rates or at other costs of shading.

#include <iostream>
#include <memory>
#include <optional>

#include "tools/cli/commands.h"
#include "tools/cli/hardware_options.h"
#include "tools/evaluate/energy.h"
#include "tools/report/energy_text.h"
#include "tools/report/finished_run.h"
#include "tools/report/report_file.h"
#include "tools/report/times_text.h"

namespace beampipe {
namespace {

struct ModelArguments {
  std::vector<std::string> folders;
  HardwareOptions hardware;
  TimesOptions times;
  bool energy = false, json = false;
};

Report model(const std::string& folder, const Hardware* other, const ModelArguments& arguments) {
  Report report = finished_run(folder, other);
  report.hardware = with_costs(report.hardware, arguments.hardware);
  if (arguments.energy && !has_energy(report.hardware))
    throw ReportError((std::filesystem::path(folder) / "report.json").string() +
                      ": --energy: expected hardware with \"energy\", found none in " + report.hardware.named);
  return report;
}

void model(const ModelArguments& arguments) {
  if (arguments.times.sensitivity && arguments.times.over.empty())
    throw UsageError("--sensitivity: expected --over TECHNIQUE beside it");
  std::optional<Hardware> other;
  if (!arguments.hardware.hardware.empty()) other = read_hardware(arguments.hardware);
  Json json = Json::array();
  for (const std::string& folder : arguments.folders) {
    const Report report = model(folder, other ? &*other : nullptr, arguments);
    if (arguments.json) {
      json.push_back({{"folder", folder}, {"times", times_json(report, arguments.times)}});
      if (arguments.energy) json.elements().back()["energy"] = energy_json(report, arguments.times.over);
    } else {
      const std::string times = times_text(report, arguments.times);  // which may fail
      std::cout << folder << ":" << times
                << (arguments.energy ? energy_text(report, arguments.times.over) : std::string());
    }
  }
  if (arguments.json) std::cout << json_text(json);
}

}  // namespace

void add_model_command(CommandLine& line) {
  const auto arguments = std::make_shared<ModelArguments>();
  Command command = line.add_command("model", "Model the times of finished runs again");
  command.add("DIR", arguments->folders, "folders that run or compare wrote").required();
  add_hardware_options(command, arguments->hardware, "that of the run");
  command.add("--over", arguments->times.over,
              "a technique of the run: also print times and energies of the others over its own, with intervals");
  command.add_flag("--sensitivity", arguments->times.sensitivity,
                   "with --over: also print what each rate makes of the quotients at the ends of its range");
  command.add_flag("--stages", arguments->times.stages,
                   "also print the stages that take at least 1 % of the time, and what limits each");
  command.add_flag("--energy", arguments->energy, "also print modelled energy, and what stands for area");
  command.add_flag("--json", arguments->json,
                   "print JSON, with the time, the busiest unit and the energy of each stage");
  command.footer(
      "Renders nothing: times follow from the counts in report.json. Hardware with another memory system than that of "
      "the\nrun counts other bytes and is refused.\n\n"
      "in turn       one stage after the other\n"
      "nine in ten   the range of nine in ten of these times, if rates are drawn from the ranges in the description\n"
      "on cores      the geometry, and then bins in their order, each on the core that is free first\n"
      "at once       all units at once and evenly: the time of the busiest\n"
      "busiest       its unit, and the rate of the description that limits it where that is not the unit's own\n"
      "uneven        how much longer the busiest core works than the mean, by operations that shaders can do\n"
      "on chip       what the pixels of a bin take, and how many bins a core has room for\n"
      "even          after a quotient: the interval contains 1\n\n"
      "mJ            energy of switching, lowest to highest; in what follows, by where it goes\n"
      "W             this energy over the time on cores\n"
      "KiB for bins  memory on chip for the pixels of all bins that all cores hold: it stands for area, as what the\n"
      "              units compare per clock does\n\n"
      "Example:\n"
      "  beampipe run fence.json -t beam msaa:8 -o out\n"
      "  beampipe model out --material-cost 200,4 --over msaa:8 --sensitivity");
  command.set_work([arguments] { model(*arguments); });
}

}  // namespace beampipe
