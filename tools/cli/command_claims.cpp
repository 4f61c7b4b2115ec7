// beampipe claims: the numbers that publications state, each with the number that reports have.

#include <iostream>
#include <memory>

#include "tools/claims/claims.h"
#include "tools/cli/commands.h"
#include "tools/cli/hardware_options.h"
#include "tools/evaluate/remodel.h"
#include "tools/report/report_file.h"

namespace beampipe {
namespace {

struct ClaimsArguments {
  std::vector<std::string> folders;
  HardwareOptions hardware;
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
  if (!arguments.hardware.hardware.empty())
    std::cout << "Times are modelled with " << all.front().name << ", also where a row names another GPU.\n\n";
  std::cout << claims_text(claims);
}

}  // namespace

void add_claims_command(CommandLine& line) {
  const auto arguments = std::make_shared<ClaimsArguments>();
  Command command = line.add_command("claims", "Compare the numbers that publications state with ours");
  command.add("DIR", arguments->folders,
              "folders that run or compare wrote; the numbers that need rendering come from their reports");
  add_hardware_options(command, arguments->hardware, HardwareCount::one);
  command.footer(
      "Prints two Markdown tables, of what was rendered and of what is true by definition. Each row\n"
      "names the command whose folder has our number, or says why there is none. If several folders\n"
      "have the number, it comes from the first of them. A folder counts if its trace has the content that\n"
      "the command makes; names of files do not matter.\n\nExample:\n"
      "  beampipe make classroom -o classroom.json\n"
      "  beampipe run classroom.json -t msaa:1,prepass -t msaa:8,color=rgba16f,prepass -t acaa:8 -o out/acaa\n"
      "  beampipe claims out/acaa");
  command.set_work([arguments] { print_claims(*arguments); });
}

}  // namespace beampipe
