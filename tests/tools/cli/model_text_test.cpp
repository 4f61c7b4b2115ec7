// What `beampipe model` prints for people: rows that say the same are one, and what limits each stage.

#include "tests/tools/cli/program_fixture.h"
#include "traces/files/json.h"

namespace beampipe::model_text_test {

class ModelText : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    finish({"run", path("trace.json"), "-t", "beam", "msaa:4", "msaa:8", "-o", path("out")});
  }
  std::vector<std::string> lines_of(const Names& options) const {
    std::istringstream text(succeed(joined({"model", path("out")}, options)));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  }
};

std::size_t count_starts(const std::vector<std::string>& lines, const std::string& start) {
  return static_cast<std::size_t>(
      std::ranges::count_if(lines, [&](const std::string& line) { return line.starts_with(start); }));
}

// 448.7 bytes a clock are 653 GB/s; the description has 30 rates, 12 of them with ranges.
TEST_F(ModelText, TheTitleHasWhatWrongUnitsWouldChange) {
  EXPECT_EQ(count_starts(lines_of({}),
                         "modelled ms on titan_v (Titan V class): 80 cores at 1455 MHz, 96 KiB on chip "
                         "each, DRAM 653 GB/s; 12 of 30 rates have a range"),
            1u);
}

// Both implementations of a Titan V draw msaa alike; those of `beam` differ.
TEST_F(ModelText, ImplementationsThatAgreeAreOneRow) {
  const auto times = lines_of({"--energy"});
  EXPECT_EQ(count_starts(times, "msaa:4     shaders, fixed_function  "), 2u) << "of times and of energy";
  EXPECT_EQ(count_starts(times, "beam       shaders  "), 2u);
  EXPECT_EQ(count_starts(times, "beam       fixed_function  "), 2u);
}

TEST_F(ModelText, SensitivityLeavesOutWhatChangesNothing) {
  const auto lines = lines_of({"--over", "msaa:8", "--sensitivity"});
  EXPECT_EQ(count_starts(lines, "msaa:4 over msaa:8, shaders, fixed_function: "), 1u);
  std::string quotient;
  int rates = 0;
  for (const std::string& line : lines) {
    std::istringstream words(line);
    std::string first, low, high, more;
    if (line.find(" over msaa:8, ") != line.npos) quotient = line.substr(line.rfind(": ") + 2, 4);
    if (quotient.empty() || !(words >> first >> low >> high) || words >> more || first == "rate") continue;
    ++rates;
    EXPECT_TRUE(low != quotient || high != quotient) << line;
  }
  EXPECT_GT(rates, 0);
}

TEST_F(ModelText, StagesNameTheirUnitsOnRequest) {
  EXPECT_EQ(count_starts(lines_of({}), "stages of"), 0u);
  const auto lines = lines_of({"--stages"});
  const auto title = std::ranges::find(lines, "stages of at least 1 % of the time in turn");
  ASSERT_NE(title, lines.end());
  const std::vector<std::string> rows(title + 2, lines.end());
  EXPECT_GT(rows.size(), 6u);
  const Json models = parse_json_text(succeed({"model", path("out"), "--json"}), "model");
  for (const Json& row : models.at(0).at("times").elements())
    for (const auto& [stage, ms] : row.at("stages").members()) {
      const bool is_shown = ms.get<double>() >= 0.01 * row.at("in_turn").get<double>();
      const auto is_it = [&, name = stage](const std::string& line) {
        return line.starts_with(row.at("technique").get<std::string>() + " ") &&
               line.find(row.at("implementation").get<std::string>()) != line.npos &&
               line.find(" " + name + " ") != line.npos &&
               line.find(row.at("busiest_units").at(name).get<std::string>()) != line.npos;
      };
      EXPECT_EQ(std::ranges::any_of(rows, is_it), is_shown) << row.at("technique").dump() << stage;
    }
}

TEST_F(ModelText, AnUnknownTechniqueToDivideByIsToldTheOthers) {
  expect_error({"model", path("out"), "--over", "msaa:16"}, 1,
               "--over msaa:16: expected a technique of the run: beam, msaa:4 or msaa:8");
}

}  // namespace beampipe::model_text_test
