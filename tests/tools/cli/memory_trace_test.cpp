// --memory-trace: the lines of each format, and the options that it does not go with.
#include <zlib.h>

#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace beampipe::memory_trace_test {

using Json = nlohmann::json;

constexpr const char* kTrace = R"({"beampipe_trace": 1,
  "meshes": {"red": {"positions": [-1,-1,0, 1,1,0, -1,1,0], "indices": [0,1,2], "colors": [1,0.25,0]}},
  "frames": [{"width": 70, "height": 40, "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
              "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "red"}]}]})";

class MemoryTrace : public testing::Test {
 protected:
  MemoryTrace() { write_text(folder_ / "trace.json", kTrace); }

  std::vector<std::string> arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> all = {"run", (folder_ / "trace.json").string(), "-o", (folder_ / "out").string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  // The file of that name after a run.
  std::string written(const std::string& name, const std::vector<std::string>& more) const {
    const std::string file = (folder_ / name).string();
    std::vector<std::string> all = arguments({"--memory-trace", file});
    all.insert(all.end(), more.begin(), more.end());
    const Outcome outcome = run_program(all);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_text(file);
  }

  void expect_error(const std::vector<std::string>& more, const std::string& message) const {
    const Outcome outcome = run_program(arguments(more));
    EXPECT_NE(outcome.exit_code, 0);
    EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "requests"));
  }

  Json stages() const {
    return Json::parse(read_text(folder_ / "out/report.json")).at("results")[0].at("frames")[0].at("stages");
  }

  const TemporaryFolder folder_;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST_F(MemoryTrace, LinesForDramSim3) {
  for (const char* spec : {"beam", "msaa:8"}) {
    const std::vector<std::string> lines = lines_of(written("requests", {"-t", spec}));
    std::uint64_t bytes = 0;
    for (const Json& stage : stages()) bytes += stage.at("dram_bytes").get<std::uint64_t>();
    EXPECT_EQ(lines.size() * 32, bytes) << spec;
    std::uint64_t number = 0;
    for (const std::string& line : lines) {
      std::uint64_t address = 0, cycle = 0;
      std::string access;
      std::istringstream(line) >> std::hex >> address >> access >> std::dec >> cycle;  // as DRAMsim3 reads it
      EXPECT_TRUE(line.starts_with("0x") && (access == "READ" || access == "WRITE")) << line;
      EXPECT_EQ(address % 32, 0u) << line;
      // 448.7 bytes per clock of 1455 MHz are 652.8585 bytes per nanosecond.
      EXPECT_EQ(cycle, number * 320000 / 6528585) << line;
      ++number;
    }
  }
}

TEST_F(MemoryTrace, LinesForRamulator2AreTheSameRequests) {
  const std::vector<std::string> dramsim = lines_of(written("requests", {"-t", "msaa:8", "--threads", "1"}));
  const std::vector<std::string> ramulator =
      lines_of(written("requests", {"-t", "msaa:8", "--memory-trace-format", "ramulator2", "--threads", "2"}));
  ASSERT_EQ(dramsim.size(), ramulator.size());
  for (std::size_t i = 0; i < dramsim.size(); ++i) {
    const std::string address = dramsim[i].substr(0, dramsim[i].find(' '));
    const bool writes = dramsim[i].find(" WRITE ") != std::string::npos;
    EXPECT_EQ(ramulator[i], (writes ? "ST " : "LD ") + address);
  }
}

TEST_F(MemoryTrace, CsvHasTheStages) {
  const std::vector<std::string> lines =
      lines_of(written("requests", {"-t", "msaa:8", "--memory-trace-format", "csv"}));
  ASSERT_EQ(lines.at(0), "cycle,address,access,stage,array");
  std::map<std::string, std::uint64_t> bytes, expected;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    std::vector<std::string> fields;
    std::istringstream stream(lines[i]);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    ASSERT_EQ(fields.size(), 5u) << lines[i];
    bytes[fields[3]] += 32;
  }
  for (const Json& stage : stages())
    if (stage.at("dram_bytes") != 0) expected[stage.at("stage")] = stage.at("dram_bytes");
  EXPECT_EQ(bytes, expected);
}

TEST_F(MemoryTrace, GzipHoldsTheSameText) {
  const std::string plain = written("requests", {"-t", "beam"});
  EXPECT_NE(written("requests.gz", {"-t", "beam"}), plain);
  const gzFile file = gzopen((folder_ / "requests.gz").c_str(), "rb");
  ASSERT_NE(file, nullptr);
  ASSERT_EQ(gzdirect(file), 0);
  std::string text(plain.size() + 1, '\0');
  text.resize(static_cast<std::size_t>(gzread(file, text.data(), static_cast<unsigned>(text.size()))));
  EXPECT_EQ(gzclose(file), Z_OK);
  EXPECT_EQ(text, plain);
}

TEST_F(MemoryTrace, RepeatedFramesAreRecordedOnce) {
  const std::string once = written("requests", {"-t", "beam"});
  EXPECT_EQ(written("requests", {"-t", "beam", "--repeat", "3"}), once);
}

TEST_F(MemoryTrace, SaysWhatItDoesNotGoWith) {
  const std::string file = (folder_ / "requests").string();
  expect_error({"--memory-trace", file, "-t", "beam", "msaa:8"},
               "expected one technique and one frame, found techniques: 2, frames: 1");
  expect_error({"--memory-trace", file, "-t", "beam", "--no-memory-model"}, "leave out --no-memory-model");
  expect_error({"--memory-trace", file, "-t", "beam", "--resume"}, "leave out --resume");
  expect_error({"--memory-trace", file, "-t", "beam", "--memory-trace-format", "dramsim2"}, "dramsim2");
  expect_error({"--memory-trace", (folder_ / "trace.json").string(), "-t", "beam"}, "is the trace itself");
  expect_error({"--memory-trace", (folder_ / "out/requests").string(), "-t", "beam"}, "is in the output folder");
  expect_error({"--memory-trace", (folder_ / "missing/requests").string(), "-t", "beam"}, "No such file or directory");
}

}  // namespace beampipe::memory_trace_test
