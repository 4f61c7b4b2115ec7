// The command `beampipe claims`: its table takes the numbers that need rendering from reports.
#include <sstream>

#include "tests/tools/cli/program_fixture.h"
#include "traces/files/json.h"

namespace beampipe::command_claims_test {

class ClaimsCommandTest : public ProgramTest {
 protected:
  // The column of our number in the row of this claim.
  static std::string ours(const std::string& table, const std::string& name) {
    std::istringstream rows(table);
    for (std::string row; std::getline(rows, row);) {
      if (!row.starts_with("| " + name + " |")) continue;
      std::size_t at = 0;
      for (int column = 0; column < 4; ++column) at = row.find('|', at) + 1;
      return row.substr(at + 1, row.find(" |", at) - at - 1);
    }
    ADD_FAILURE() << "no row " << name;
    return "";
  }
};

TEST_F(ClaimsCommandTest, TakesEachNumberFromTheFirstReportThatHasIt) {
  const std::string name = "ACAA, part of MSAA's off-chip traffic that is saved (abstract)";
  succeed({"make", "classroom", "-o", path("room.json")});
  const auto run = [&](std::vector<std::string> options) {
    std::vector<std::string> arguments = {
        "run", path("room.json"), "-t", "msaa:1,prepass", "-t", "msaa:8,color=rgba16f,prepass", "-t", "acaa:8"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    succeed(arguments);
  };
  run({"-o", path("out")});
  run({"--no-memory-model", "-o", path("no_model")});
  EXPECT_EQ(ours(succeed({"claims"}), name), "");
  EXPECT_EQ(ours(succeed({"claims"}), "beam, mask"), "4");
  EXPECT_EQ(ours(succeed({"claims", path("no_model")}), name), "");
  succeed({"run", path("trace.json"), "-t", "msaa:1,prepass", "-t", "msaa:8,color=rgba16f,prepass", "-t", "acaa:8",
           "-o", path("other")});
  EXPECT_EQ(ours(succeed({"claims", path("other")}), name), "") << "the claim is about another trace";
  EXPECT_EQ(ours(succeed({"claims", path("other"), "--hardware", "rtx_4090"}), name), "");
  double saved = 0;
  const Json report = parse_json(path("out/report.json"));
  for (const Json& claim : report.at("claims").elements())
    if (claim.at("name") == name) saved = claim.at("ours").get<double>();
  ASSERT_NE(saved, 0);
  const std::string found = ours(succeed({"claims", path("no_model"), path("out")}), name);
  ASSERT_NE(found, "");
  EXPECT_NEAR(std::stod(found), saved, 1e-3 * saved);
  const std::string remodelled = ours(succeed({"claims", path("out"), "--hardware", "rtx_4090"}), name);
  EXPECT_EQ(remodelled, found) << "bytes do not depend on the hardware";
}

}  // namespace beampipe::command_claims_test
