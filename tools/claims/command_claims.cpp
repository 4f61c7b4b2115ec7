// beampipe claims: what the publications state in numbers, beside what reports have found.

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
    for (const auto& found : report.json.value("claims", Json::array()).elements())
      for (Claim& claim : claims)
        if (!claim.ours && found.at("name") == claim.name && !found.at("ours").is_null())
          claim.ours = found.at("ours").get<double>();
  }
  std::cout << claims_text(claims);
}

}  // namespace

void add_claims_command(CommandLine& line) {
  const auto folders = std::make_shared<std::vector<std::string>>();
  Command command = line.add_command("claims", "Print what publications state in numbers, and ours beside it");
  command.add("DIR", *folders, "folders that run or compare wrote, for the numbers that need rendering");
  command.footer(
      "Prints a Markdown table. Each row names the command whose folder has our number; where there is none, the row\n"
      "says why. Of several folders the first that has a number gives it.\n\nExample:\n"
      "  beampipe make classroom -o classroom.json\n"
      "  beampipe run classroom.json -t msaa:1,prepass -t msaa:8,color=rgba16f,prepass -t acaa:8 -o out/acaa\n"
      "  beampipe claims out/acaa");
  command.set_work([folders] { print_claims(*folders); });
}

}  // namespace beampipe
