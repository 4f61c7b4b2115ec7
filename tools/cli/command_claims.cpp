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
  bool json = false, all = false, statements = false;
};

// Takes those of our numbers that `claims` lacks.
void take(const Json& found, std::vector<Claim>& claims) {
  for (Claim& claim : claims)
    if (!claim.ours && found.at("name") == claim.name && !found.at("ours").is_null())
      claim.ours = found.at("ours").get<double>();
}

void print_statements(bool as_json) {
  const std::vector<Statement> statements = published_statements();
  if (!as_json) {
    std::cout << statements_text(statements);
    return;
  }
  Json all = Json::array();
  for (const Statement& each : statements)
    all.push_back(
        {{"publication", each.publication}, {"source", each.source}, {"text", each.text}, {"answer", each.answer}});
  std::cout << json_text(all);
}

void print_claims(const ClaimsArguments& arguments) {
  if (arguments.statements) return print_statements(arguments.json);
  const Hardware hardware = read_hardware(arguments.hardware);
  std::vector<Claim> claims = all_claims({});
  for (const std::string& folder : arguments.folders) {
    const ReportFile report = read_report(folder);
    read_from_report(report.folder, [&] {
      if (arguments.hardware != HardwareOptions{})
        for (const Claim& claim : answered_claims(remodelled(report.json, &hardware)))
          take(claim_form().write(claim), claims);
      const Json answered = report.json.value("claims", Json::array());
      for (const Json& found : answered.elements()) take(found, claims);
    });
  }
  find_quotients(claims);
  if (!arguments.all) std::erase_if(claims, [](const Claim& claim) { return !claim.ours; });
  if (arguments.json) {
    Json all_json = Json::array();
    for (const Claim& claim : claims) all_json.push_back(claim_form().write(claim));
    std::cout << json_text(all_json);
    return;
  }
  if (!arguments.hardware.hardware.empty())
    std::cout << "Times are modelled with " << hardware.name << ", also where a row names another GPU.\n\n";
  std::cout << claims_text(claims);
  if (!arguments.all) std::cout << "The others, with the commands that make their reports: beampipe claims --all\n";
}

}  // namespace

void add_claims_command(CommandLine& line) {
  const auto arguments = std::make_shared<ClaimsArguments>();
  Command command = line.add_command("claims", "Compare the numbers that publications state with ours");
  command.add("DIR", arguments->folders,
              "folders that run or compare wrote; they hold the numbers that need rendering");
  add_hardware_options(command, arguments->hardware);
  command.add_flag("--all", arguments->all, "also list claims for which there is no number of ours");
  command.add_flag("--statements", arguments->statements,
                   "list instead what the publications say in words, and whether it can be had here");
  command.add_flag("--json", arguments->json, "print JSON");
  command.footer(
      "Prints a table for each command, with the published number and ours, and by how many per cent ours is off the\n"
      "nearer end of the published range. A claim holds if these are at most 10. Notes say what our number is and why\n"
      "it differs. The command makes the folder that has our number; without the folder, the number is missing. A\n"
      "folder counts only if its trace is the one that the command makes; names of files do not matter. If several\n"
      "folders have a number, the first one is used.\n\n"
      "Times are modelled. The article on DVM names five ways to render; ours are taa:8,shading=forward (Forward),\n"
      "msaa:N,prepass,motion,resolve=reinhard (Msaa), taa:8,shading=deferred (Deferred), taa:8 (Visibility) and\n"
      "dvm:clamp=camera (DVM).\n"
      "Their numbers are those of the second frame, which has a history.\n\nExample:\n"
      "  beampipe make classroom --width 1280 --height 720 -o classroom.json\n"
      "  beampipe run classroom.json -t msaa:1,prepass -t msaa:8,color=rgba16f,prepass -t acaa:8 -o out/acaa\n"
      "  beampipe claims out/acaa");
  command.set_work([arguments] { print_claims(*arguments); });
}

}  // namespace beampipe
