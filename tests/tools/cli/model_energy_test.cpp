// Energy as a user sees it: in report.json, and from `beampipe model --energy`.

#include "tests/tools/cli/program_fixture.h"
#include "tests/tools/report_frames.h"

namespace beampipe::model_energy_test {

class ModelEnergy : public ProgramTest {
 protected:
  void run(const std::string& hardware) {
    finish({"run", path("trace.json"), "-t", "beam", "msaa:8", "--hardware", hardware, "-o", path("out")});
  }
};

// The mean over the frames of report.json, whose bytes and picojoules give its DRAM.
TEST_F(ModelEnergy, ModelFindsTheEnergyOfTheRun) {
  run("titan_v");
  const Json report = parse_json(path("out/report.json"));
  const std::vector<Json> frames = report.at("results").elements().at(0).at("frames").elements();
  ASSERT_EQ(frames.size(), 2u);
  double low = 0, dram_bytes = 0;
  for (const Json& frame : frames) {
    low += frame.at("energy_mj").at("total").at("shaders").at("low").get<double>() / 2;
    dram_bytes += frame.at("dram_bytes").get<double>() / 2;
  }
  const Json models = parse_json_text(succeed({"model", path("out"), "--energy", "--json"}), "model");
  const std::vector<Json>& rows = models.elements().at(0).at("energy").elements();
  ASSERT_EQ(rows.size(), 4u);
  const Json& energy = rows[0].at("energy_mj");
  EXPECT_NEAR(energy.at("total").elements().at(0).get<double>(), low, 1e-9 * low);
  EXPECT_NEAR(energy.at("dram").elements().at(1).get<double>(), dram_bytes * 48e-9, 1e-9 * dram_bytes * 48e-9);
  const auto instructions = [&](std::size_t row) {
    return rows[row].at("energy_mj").at("instructions").elements().at(0).get<double>();
  };
  EXPECT_GT(instructions(0), instructions(1));
  expect_parts(succeed({"model", path("out"), "--energy"}), {"modelled mJ on titan_v"});
  EXPECT_EQ(succeed({"model", path("out")}).find("mJ"), std::string::npos);
  expect_parts(succeed({"model", path("out"), "--energy", "--over", "msaa:8"}), {"mJ over msaa:8"});
}

TEST_F(ModelEnergy, HardwareWithoutItIsRefused) {
  write_text(folder_ / "plain.json", titan_without_energy().dump());
  run(path("plain.json"));
  EXPECT_EQ(read_text(folder_ / "out" / "report.json").find("energy_mj"), std::string::npos);
  expect_error({"model", path("out"), "--energy"}, 1, "--energy: expected hardware with \"energy\", found none in");
  expect_parts(succeed({"model", path("out"), "--energy", "--hardware", "titan_v"}), {"modelled mJ"});
}

}  // namespace beampipe::model_energy_test
