// One page over several runs: its tables from reports made by hand, and the command.

#include "tools/report/overview.h"

#include "tests/tools/cli/program_fixture.h"

namespace beampipe::overview_test {

// The members of a result that differ.
std::string result(const std::string& spec, const std::string& emr, double rmse, double dram_bytes) {
  return R"({"technique": ")" + spec + R"(", "framebuffer": [], "peak_bytes_per_pixel": 6, )" + emr +
         R"("error": {"rmse": )" + std::to_string(rmse) +
         R"(}, "frames": [{"index": 0, "wall_ms": {"median": 1}, "stages": [], "dram_bytes": )" +
         std::to_string(dram_bytes) + "}]}";
}

std::string exactly(int samples) { return R"("equivalent_msaa": )" + std::to_string(samples) + ", "; }

class Overviews : public ProgramTest {
 protected:
  // In a folder of this name.
  ReportFile made(const std::string& name, const std::string& scene, const std::string& hardware,
                  const std::string& results, const std::string& metric = "rmse") const {
    std::filesystem::create_directory(folder_ / name);
    write_text(folder_ / name / "report.json",
               R"({"beampipe_report": 2, "trace": ")" + scene + R"(.json", "metric": ")" + metric +
                   R"(", "hardware_named": ")" + hardware + R"(", "hardware": {"name": ")" + hardware +
                   R"(", "clock_mhz": 1, "implementations": {}}, "results": [)" + results + "]}");
    return read_report(path(name));
  }
  Table table(const std::vector<ReportFile>& reports, const std::string& name) const {
    for (const Table& table : overview_of(reports, folder_ / "pages").measures)
      if (table.name == name) return table;
    throw std::runtime_error("no table " + name);
  }
};

Names titles(const Table& table) {
  Names titles;
  for (const Column& column : table.columns) titles.push_back(column.title);
  return titles;
}

void expect_row(const std::vector<Json>& row, const std::vector<Json>& expected) {
  ASSERT_EQ(row.size(), expected.size());
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (expected[i].is_number() && row[i].is_number())
      EXPECT_NEAR(row[i].get<double>(), expected[i].get<double>(), 1e-9) << i;
    else
      EXPECT_EQ(row[i], expected[i]) << i;
  }
}

TEST_F(Overviews, MeansAreThoseOfRunsOnTheSameHardware) {
  const std::string more = "," + result("acaa:8", "", 0.5, 3e6);
  const std::vector<ReportFile> reports = {
      made("a", "fence", "ours", result("beam", "", 0.02, 4e6) + more),
      made("b", "fence", "theirs", result("beam", "", 0.04, 5e6)),
      made("c", "maple", "ours", result("msaa:8", "", 1, 1e6) + "," + result("beam", "", 0.08, 1e6))};
  const Table rmse = table(reports, "rmse");
  EXPECT_EQ(titles(rmse), (Names{"technique", "fence, ours", "maple, ours", "geometric mean, ours", "fence, theirs"}));
  ASSERT_EQ(rmse.rows.size(), 3u);
  expect_row(rmse.rows[0], {"beam", 20, 80, 40, 40});
  expect_row(rmse.rows[1], {"acaa:8", 500, {}, {}, {}});
  expect_row(rmse.rows[2], {"msaa:8", {}, 1000, {}, {}});
  expect_row(table(reports, "dram_bytes").rows[0], {"beam", 4, 1, 2, 5});
  EXPECT_THROW(table(reports, "emr"), std::runtime_error) << "no run has one";
}

TEST_F(Overviews, BoundsHaveNoMean) {
  const std::string bound = R"("equivalent_msaa": 256, "equivalent_msaa_is_lower_bound": true, )";
  const std::string none = R"("equivalent_msaa_does_not_converge": true, )";
  const auto results = [](const std::string& beam, const std::string& casav, const std::string& alpha) {
    return result("beam", beam, 1, 1) + "," + result("casav", casav, 1, 1) + "," + result("alpha", alpha, 1, 1);
  };
  const ReportFile first = made("a", "fence", "ours", results(exactly(4), exactly(8), exactly(2)));
  const std::string second = results(exactly(16), bound, none);
  const Table emr = table({first, made("b", "fence", "ours", second)}, "emr");
  EXPECT_EQ(titles(emr),
            (Names{"technique", "fence (" + path("a") + ")", "fence (" + path("b") + ")", "geometric mean"}));
  expect_row(emr.rows[0], {"beam", 4, 16, 8});
  expect_row(emr.rows[1], {"casav", 8, {{"value", 256.0}, {"text", "≥ 256"}}, {}});
  expect_row(emr.rows[2], {"alpha", 2, {{"text", "does not converge"}}, {}});
  expect_row(table({first, made("b", "maple", "ours", second, "flip")}, "emr").rows[0], {"beam", 4, 16, {}});
}

// The numbers that a page carries.
Json data_of(const std::string& page) {
  const std::string start = R"(id="data">)";
  const std::size_t at = page.find(start) + start.size();
  return parse_json_text(page.substr(at, page.find("</script>", at) - at), "page");
}

TEST_F(Overviews, ThePageHasAllRunsTheirTimesAndLinks) {
  write_text(folder_ / "half.json", kHalfFrame);
  for (const std::string scene : {"trace", "half"})
    finish({"run", path(scene + ".json"), "-t", "beam", "msaa:8", "-o", path("out/" + scene)});
  std::filesystem::create_directory(folder_ / "pages");
  write_text(folder_ / "out/half/report.html", "its page");
  const std::string file = path("pages/all.html");
  EXPECT_EQ(succeed({"report", path("out/trace"), path("out/half"), "-o", file}), "page:   " + file + "\n");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_ / "pages"), {}), 1);
  const Json data = data_of(read_text(file));
  expect_parts(data.at("conditions").dump(), {"beampipe report "});
  const Json& rows = data.at("runs").at("rows");
  EXPECT_EQ(rows[0][0], "trace");
  EXPECT_EQ(rows[1][0], "half");
  EXPECT_EQ(rows[0][1], (Json{{"text", path("out/trace")}})) << "it has no page";
  EXPECT_EQ(rows[1][1].at("href"), "../out/half/report.html");
  EXPECT_EQ(rows[1][2], "70 × 40 pixels, 1 frame");

  const Json half = parse_json(path("out/half/report.json"));
  const Json& ms = half.at("results")[0].at("frames")[0].at("modelled_ms").at("shaders");
  const Json& table = data.at("tables")[data.at("tables").size() - 2];
  EXPECT_EQ(table.at("name"), "time_shaders");
  const Json& beam = table.at("rows")[0];
  ASSERT_EQ(beam.size(), 10u) << "two runs and their mean, in turn, on cores and at once";
  EXPECT_NEAR(beam[2].at("value").get<double>(), ms.at("in_turn").get<double>(), 1e-12);
  EXPECT_NEAR(beam[8].at("value").get<double>(), ms.at("at_once").get<double>(), 1e-12);
  EXPECT_NEAR(beam[3].get<double>(), std::sqrt(beam[1].at("value").get<double>() * beam[2].at("value").get<double>()),
              1e-12);
  const Json models = parse_json_text(succeed({"model", path("out/half"), "--json"}), "model");
  const Json& range = models[0].at("times")[0].at("in_turn_interval");
  char text[64];
  std::snprintf(text, sizeof text, " (%.3g to %.3g)", range[0].get<double>(), range[1].get<double>());
  EXPECT_TRUE(beam[2].at("text").get<std::string>().ends_with(text)) << beam[2].dump() << text;

  const Json& plot = data.at("figures")[0].at("choices")[0].at("plot");
  EXPECT_EQ(plot.at("categories"), Json::array({"trace: beam", "trace: msaa:8", "half: beam", "half: msaa:8"}));
  EXPECT_EQ(plot.at("parts")[0].at("values")[2], beam[2].at("value"));
  EXPECT_EQ(plot.at("parts")[0].at("values")[3], 0.0) << "that bar is msaa:8";
  write_text(folder_ / "out/half/report.json", replaced(half.dump(), R"("clock_mhz":)", R"("clock_mhz":-)"));
  expect_error({"report", path("out/trace"), path("out/half"), "-o", file}, 1, path("out/half/report.json"));
}

}  // namespace beampipe::overview_test
