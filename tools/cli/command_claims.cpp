// beampipe claims: the numbers that publications state, each with the number that reports have.

#include <iostream>
#include <memory>

#include "tools/claims/claims.h"
#include "tools/cli/commands.h"
#include "tools/report/report_file.h"

namespace beampipe {
namespace {

void print_claims(const std::vector<std::string>& folders) {
  std::vector<Claim> claims = all_claims({});
  for (const std::string& folder : folders) {
    const ReportFile report = read_report(folder);
    const Json answered = report.json.value("claims", Json::array());
    for (const Json& found : answered.elements())
      for (Claim& claim : claims)
        if (!claim.ours && found.at("name") == claim.name && !found.at("ours").is_null())
          claim.ours = found.at("ours").get<double>();
  }
  find_quotients(claims);
  std::cout << claims_text(claims);
}

}  // namespace

void add_claims_command(CommandLine& line) {
  const auto folders = std::make_shared<std::vector<std::string>>();
  Command command = line.add_command("claims", "Compare the numbers that publications state with ours");
  command.add("DIR", *folders,
              "folders that run or compare wrote; the numbers that need rendering come from their reports");
  command.footer(
      "Prints two Markdown tables, of what was rendered and of what is true by definition. Each row names the command whose folder has our number, or says why there is none. If\n"
      "several folders have the number, it comes from the first of them.\n\nExample:\n"
      "  beampipe make classroom -o classroom.json\n"
      "  beampipe run classroom.json -t msaa:1,prepass -t msaa:8,color=rgba16f,prepass -t acaa:8 -o out/acaa\n"
      "  beampipe claims out/acaa");
  command.set_work([folders] { print_claims(*folders); });
}

}  // namespace beampipe
