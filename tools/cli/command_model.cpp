// beampipe model: the modelled times of finished runs, on other hardware or at other costs of shading.

#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/hardware_options.h"
#include "tools/evaluate/remodel.h"
#include "tools/report/report_file.h"
#include "tools/report/report_text.h"

namespace beampipe {
namespace {

struct ModelArguments {
  std::vector<std::string> folders;
  HardwareOptions hardware;
  bool json = false;
};

void model(const ModelArguments& arguments) {
  const std::vector<Hardware> all = read_hardware(arguments.hardware);
  Json json = Json::array();
  for (const std::string& folder : arguments.folders) {
    const ReportFile file = read_report(folder);
    const Report report = read_from_report(file.folder, [&] { return remodelled(file.json, all); });
    if (!report.memory.modelled)
      throw ReportError(folder + "/report.json: expected a run that modelled memory, found one with --no-memory-model");
    if (arguments.json)
      json.push_back({{"folder", folder}, {"times", times_json(report)}});
    else
      std::cout << folder << ":" << times_text(report);
  }
  if (arguments.json) std::cout << json_text(json);
}

}  // namespace

void add_model_command(CommandLine& line) {
  const auto arguments = std::make_shared<ModelArguments>();
  Command command = line.add_command("model", "Model the times of finished runs on other hardware");
  command.add("DIR", arguments->folders, "folders that run or compare wrote").required();
  add_hardware_options(command, arguments->hardware);
  command.add_flag("--json", arguments->json, "print JSON, with the time of each stage");
  command.footer(
      "Renders nothing: times follow from the counts in report.json.\n\nExample:\n"
      "  beampipe run fence.json -t beam msaa:8 -o out\n"
      "  beampipe model out --hardware titan_v,rtx_4090,mali_g710 --material-cost 200,4");
  command.set_work([arguments] { model(*arguments); });
}

}  // namespace beampipe
