// The command `beampipe claims`: it takes the numbers that need rendering from reports.
#include "tests/tools/cli/program_fixture.h"
#include "traces/files/json.h"

namespace beampipe::command_claims_test {

class ClaimsCommandTest : public ProgramTest {
 protected:
  // Our number for this claim, as text; empty if there is none.
  std::string ours(const std::vector<std::string>& folders, const std::string& name) {
    std::vector<std::string> arguments = {"claims", "--all", "--json"};
    arguments.insert(arguments.end(), folders.begin(), folders.end());
    const Json claims = parse_json_text(succeed(arguments), "claims");
    for (const Json& claim : claims.elements())
      if (claim.at("name") == name) return claim.at("ours").is_null() ? "" : claim.at("ours").dump();
    ADD_FAILURE() << "no claim " << name;
    return "";
  }
};

TEST_F(ClaimsCommandTest, TakesEachNumberFromTheFirstReportThatHasIt) {
  const std::string name = "ACAA, part of MSAA's off-chip traffic that is saved (abstract)";
  succeed({"make", "classroom", "--width", "1280", "--height", "720", "-o", path("room.json")});
  const auto run = [&](std::vector<std::string> options) {
    std::vector<std::string> arguments = {
        "run", path("room.json"), "-t", "msaa:1,prepass", "-t", "msaa:8,color=rgba16f,prepass", "-t", "acaa:8"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    succeed(arguments);
  };
  run({"-o", path("out")});
  run({"--no-memory-model", "-o", path("no_model")});
  EXPECT_EQ(ours({}, name), "");
  EXPECT_EQ(ours({}, "casav, mask"), "4.0");
  EXPECT_EQ(ours({path("no_model")}, name), "");
  succeed({"run", path("trace.json"), "-t", "msaa:1,prepass", "-t", "msaa:8,color=rgba16f,prepass", "-t", "acaa:8",
           "-o", path("other")});
  EXPECT_EQ(ours({path("other")}, name), "") << "the claim is about another trace";
  double saved = 0;
  const Json report = parse_json(path("out/report.json"));
  for (const Json& claim : report.at("claims").elements())
    if (claim.at("name") == name) saved = claim.at("ours").get<double>();
  ASSERT_NE(saved, 0);
  const std::string found = ours({path("no_model"), path("out")}, name);
  ASSERT_NE(found, "");
  EXPECT_NEAR(std::stod(found), saved, 1e-9 * saved);
  EXPECT_EQ(ours({path("out"), "--hardware", "titan_v"}, name), found) << "the same hardware again";
  expect_parts(run_program({"claims", path("out"), "--hardware", "rtx_4090"}).err, {"counted with l1_bytes 32768"});
  char cell[32];
  std::snprintf(cell, sizeof cell, "  %.4g  ", saved);
  EXPECT_NE(succeed({"claims", path("out")}).find(cell), std::string::npos) << "the text has the number too";
}

}  // namespace beampipe::command_claims_test
