// Modelled times beside measured ones, as a user sees them.

#include "tests/tools/cli/program_fixture.h"
#include "traces/files/json.h"

namespace beampipe::correlate_test {

constexpr const char* kHeader =
    "name,folder,technique,implementation,over_folder,over_technique,measured,fitted,source\n";

class Correlate : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    finish({"run", path("trace.json"), "-t", "msaa:1", "msaa:8", "-o", path("out")});
    finish({"run", path("trace.json"), "-t", "msaa:8", "--hardware", "rtx_4090", "-o", path("other")});
  }
  std::string write(const std::string& rows) {
    write_text(folder_ / "m.csv", kHeader + rows);
    return path("m.csv");
  }
  // Over the two frames of a technique, by the report of the run.
  double mean_ms(const std::string& folder, std::size_t technique, const std::string& key) {
    double sum = 0;
    const Json report = parse_json(path(folder + "/report.json"));
    for (const Json& frame : report.at("results").elements().at(technique).at("frames").elements())
      sum += frame.at("modelled_ms").at("shaders").at(key).get<double>() / 2;
    return sum;
  }
};

TEST_F(Correlate, ModelledTimesAreThoseOfTheRuns) {
  const std::string file = write(
      "\"one, alone\",out,msaa:1,shaders,,,2,,card\n"
      "within,out,msaa:8,shaders,,msaa:1,3,,card\n"
      "chosen,out,msaa:8,shaders,,,1,fitted,card\n"
      "across,out,msaa:8,shaders,other,msaa:8,4,,card\n");
  const Json json = parse_json_text(succeed({"correlate", file, "--json"}), "correlate");
  const std::vector<Json>& rows = json.at("rows").elements();
  ASSERT_EQ(rows.size(), 4u);
  for (const auto& [name, key] : {std::pair{"in_turn", "in_turn"}, {"at_once", "at_once"}}) {
    const double one = mean_ms("out", 0, key), eight = mean_ms("out", 1, key), other = mean_ms("other", 0, key);
    const double expected[] = {one, eight / one, eight, eight / other}, measured[] = {2, 3, 1, 4};
    double error = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Json& number = rows[i].at(name);
      EXPECT_NEAR(number.at("modelled").get<double>(), expected[i], 1e-9 * expected[i]) << i;
      EXPECT_NEAR(number.at("over_measured").get<double>(), expected[i] / measured[i], 1e-9 * expected[i]);
      EXPECT_LE(number.at("interval").elements().at(0).get<double>(),
                number.at("interval").elements().at(1).get<double>());
      if (i != 2) error += std::abs(expected[i] / measured[i] - 1) / 3;
    }
    EXPECT_EQ(json.at(name).at("rows").get<int>(), 3) << "without the fitted one";
    EXPECT_NEAR(json.at(name).at("mape").get<double>(), error, 1e-9);
  }
  EXPECT_TRUE(rows[2].at("fitted").get<bool>());
  const std::string text = succeed({"correlate", file, "-o", path("m.svg")});
  expect_parts(text, {"one, alone", "fitted\n"});
  const std::string picture = read_text(folder_ / "m.svg");
  expect_parts(picture, {"<svg", "across"});
}

TEST_F(Correlate, FewRows) {
  expect_parts(succeed({"correlate", write("a,out,msaa:1,shaders,,,2,,card\n")}), {"at once"});
  const std::string none = write("");
  expect_parts(succeed({"correlate", none}), {"in turn                 0     -"});
  expect_error({"correlate", none, "-o", path("m.svg")}, 1, "expected rows to draw, found none");
}

TEST_F(Correlate, MistakesNameFileLineAndField) {
  const struct {
    std::string row, message;
  } cases[] = {
      {",out,msaa:1,shaders,,,2,,card",
       "m.csv, line 2, name: expected a name without control characters, found nothing"},
      {"\"a\nb\",out,msaa:1,shaders,,,2,,card", "line 2, name: expected a name without control characters"},
      {"a,,msaa:1,shaders,,,2,,card", "line 2, folder: expected a folder that run wrote, found nothing"},
      {"a,nowhere,msaa:1,shaders,,,2,,card", "nowhere: no such folder"},
      {"a,out,msaa:2,shaders,,,2,,card", "line 2, technique: expected a technique of"},
      {"a,out,msaa:1,lasers,,,2,,card", "line 2, implementation: expected one of the hardware of"},
      {"a,out,msaa:1,shaders,other,,2,,card", "line 2, over_technique: expected a technique beside over_folder"},
      {"a,out,msaa:1,shaders,other,msaa:1,2,,card", "line 2, over_technique: expected a technique of"},
      {"a,out,msaa:1,shaders,,,2,maybe,card", "line 2, fitted: expected fitted or nothing, found \"maybe\""},
      {"a,out,msaa:1,shaders,,,2,,", "line 2, source: expected where the number is from, found nothing"},
  };
  for (const auto& [row, message] : cases) expect_error({"correlate", write(row + "\n")}, 1, message);
  for (const std::string measured : {"", "0", "-1", "nan", "inf", "1e99", "2 ms", "0x2"})
    expect_error({"correlate", write("a,out,msaa:1,shaders,,," + measured + ",,card\n")}, 1,
                 "line 2, measured: expected milliseconds or a quotient, 1e-9 to 1e9, found");
  EXPECT_LT(run_program({"correlate", write(std::string(1 << 20, 'x'))}).err.size(), 500u);
  EXPECT_LT(run_program({"correlate", write("a,out," + std::string(1 << 20, 'x') + ",shaders,,,2,,card\n")}).err.size(),
            500u);
  expect_error({"correlate", path("none.csv")}, 1, "none.csv");
  expect_error({"correlate", path("out")}, 1, "out");
  expect_error({"correlate", write(""), "-o", path("m.pdf")}, 2, "expected a name that ends in .svg or .png");
}

}  // namespace beampipe::correlate_test
