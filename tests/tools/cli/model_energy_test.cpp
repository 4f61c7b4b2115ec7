// Energy as a user sees it: in report.json, from `beampipe model --energy`, and in the table of a sweep.

#include "tests/tools/cli/program_fixture.h"
#include "tools/evaluate/hardware.h"

namespace beampipe::model_energy_test {

class ModelEnergy : public ProgramTest {
 protected:
  void run(const std::string& hardware) {
    finish({"run", path("trace.json"), "-t", "beam", "msaa:8", "--hardware", hardware, "-o", path("out")});
  }
  std::string without_energy() {
    const Json whole = titan_v().json;
    Json json = Json::object();
    for (const auto& [key, value] : whole.members())
      if (key != "energy") json[key] = value;
    write_text(folder_ / "plain.json", json.dump());
    return path("plain.json");
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
  EXPECT_NE(succeed({"model", path("out"), "--energy"}).find("modelled mJ on titan_v"), std::string::npos);
  EXPECT_EQ(succeed({"model", path("out")}).find("mJ"), std::string::npos);
  EXPECT_NE(succeed({"model", path("out"), "--energy", "--over", "msaa:8"}).find("mJ over msaa:8"), std::string::npos);
}

TEST_F(ModelEnergy, HardwareWithoutItIsRefused) {
  run(without_energy());
  EXPECT_EQ(read_text(folder_ / "out" / "report.json").find("energy_mj"), std::string::npos);
  expect_error({"model", path("out"), "--energy"}, 1, "--energy: expected hardware with \"energy\", found none in");
  EXPECT_NE(succeed({"model", path("out"), "--energy", "--hardware", "titan_v"}).find("modelled mJ"),
            std::string::npos);
}

// Both rows of the cell of `beam`: the high end is above the low one, and shaders take more. No energy, no numbers.
TEST_F(ModelEnergy, SweepsHaveIt) {
  write_text(folder_ / "plan.json", R"({"beampipe_sweep": 1, "traces": ["trace.json"], "techniques": ["beam"],
                                        "hardware": ["titan_v", ")" +
                                        without_energy() + R"("]})");
  succeed({"sweep", path("plan.json"), "-o", path("sweep")});
  std::istringstream lines(read_text(folder_ / "sweep" / "table.csv"));
  std::vector<std::string> ends;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells(1);
    for (const char c : line) c == ',' ? static_cast<void>(cells.emplace_back()) : cells.back().push_back(c);
    ends.push_back(cells.at(cells.size() - 2) + " " + cells.back().substr(0, cells.back().find('\r')));
  }
  ASSERT_EQ(ends.size(), 5u);
  EXPECT_EQ(ends[0], "energy_mj_low energy_mj_high");
  const auto numbers = [&](std::size_t row) {
    std::pair<double, double> found;
    std::istringstream(ends[row]) >> found.first >> found.second;
    return found;
  };
  EXPECT_GT(numbers(1).first, 0);
  EXPECT_GT(numbers(1).second, numbers(1).first);
  EXPECT_GT(numbers(1).first, numbers(2).first);
  EXPECT_EQ(ends[3], " ");
  EXPECT_EQ(ends[4], " ");
}

}  // namespace beampipe::model_energy_test
