// beampipe claims: the numbers that publications state, each with the number that reports have.

#include <iostream>
#include <memory>

#include "tools/claims/claims.h"
#include "tools/cli/commands.h"
#include "tools/cli/hardware_options.h"
#include "tools/evaluate/remodel.h"
#include "tools/report/claims_text.h"
#include "tools/report/report_file.h"

namespace beampipe {
namespace {

struct ClaimsArguments {
  std::vector<std::string> folders;
  HardwareOptions hardware;
  bool json = false;
};

// Takes those of our numbers that `claims` lacks.
void take(const Json& found, std::vector<Claim>& claims) {
  for (Claim& claim : claims)
    if (!claim.ours && found.at("name") == claim.name && !found.at("ours").is_null())
      claim.ours = found.at("ours").get<double>();
}

void print_claims(const ClaimsArguments& arguments) {
  const std::vector<Hardware> all = read_hardware(arguments.hardware);
  if (all.size() > 1) throw UsageError("--hardware " + arguments.hardware.hardware + ": expected one");
  std::vector<Claim> claims = all_claims({});
  for (const std::string& folder : arguments.folders) {
    const ReportFile report = read_report(folder);
    read_from_report(report.folder, [&] {
      if (arguments.hardware != HardwareOptions{})
        for (const Claim& claim : answered_claims(remodelled(report.json, all)))
          take(claim_form().write(claim), claims);
      const Json answered = report.json.value("claims", Json::array());
      for (const Json& found : answered.elements()) take(found, claims);
    });
  }
  find_quotients(claims);
  if (arguments.json) {
    Json all_json = Json::array();
    for (const Claim& claim : claims) all_json.push_back(claim_form().write(claim));
    std::cout << json_text(all_json);
    return;
  }
  if (!arguments.hardware.hardware.empty())
    std::cout << "Times are modelled with " << all.front().name << ", also where a row names another GPU.\n\n";
  std::cout << claims_text(claims);
}

}  // namespace

void add_claims_command(CommandLine& line) {
  const auto arguments = std::make_shared<ClaimsArguments>();
  Command command = line.add_command("claims", "Compare the numbers that publications state with ours");
  command.add("DIR", arguments->folders,
              "folders that run or compare wrote; they hold the numbers that need rendering");
  add_hardware_options(command, arguments->hardware, HardwareCount::one);
  command.add_flag("--json", arguments->json, "print JSON");
  command.footer(
      "Prints a table for each command, with the published number, ours, and the difference: ours minus the nearer "
      "end\n"
      "of the published range. Notes say what our number is and why it differs. The command makes the folder that has\n"
      "our number; without the folder, the number is missing. A folder counts only if its trace is the one that the\n"
      "command makes; names of files do not matter. If several folders have a number, the first one is used.\n\n"
      "Times are modelled. The article on DVM names five ways to render; ours are taa:8,shading=forward (Forward),\n"
      "msaa:N,prepass,motion,resolve=reinhard (Msaa), taa:8,shading=deferred (Deferred), taa:8 (Visibility) and dvm.\n"
      "Their numbers are those of the second frame, which has a history.\n\nExample:\n"
      "  beampipe make classroom --width 1280 --height 720 -o classroom.json\n"
      "  beampipe run classroom.json -t msaa:1,prepass -t msaa:8,color=rgba16f,prepass -t acaa:8 -o out/acaa\n"
      "  beampipe claims out/acaa");
  command.set_work([arguments] { print_claims(*arguments); });
}

}  // namespace beampipe
