// --memory-trace: the lines of each format, and the options that it does not go with.
#include <zlib.h>

#include <nlohmann/json.hpp>

#include "tests/tools/cli/program_fixture.h"

namespace beampipe::memory_trace_test {

using Json = nlohmann::json;

class MemoryTrace : public RunInFolder {
 protected:
  MemoryTrace() { write_text(folder_ / "trace.json", kHalfFrame); }

  Names arguments(const Names& more) const { return joined({"run", path("trace.json"), "-o", path("out")}, more); }

  // The file of that name after a run.
  std::string written(const std::string& name, const Names& more) const {
    finish(joined(arguments({"--memory-trace", path(name)}), more));
    return read_text(path(name));
  }

  void expect_refused(const std::string& file, const Names& more, int exit_code, const std::string& message) const {
    expect_error(joined(arguments({"--memory-trace", file, "-t", "beam"}), more), exit_code, message);
    EXPECT_EQ(folder_.list(), Names{"trace.json"});
  }

  Json stages() const {
    return Json::parse(read_text(folder_ / "out/report.json")).at("results")[0].at("frames")[0].at("stages");
  }
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
  const std::string file = path("requests");
  expect_refused(file, {"msaa:8"}, 2, "expected one technique and one frame, found techniques: 2, frames: 1");
  expect_refused(file, {"--no-memory-model"}, 2, "leave out --no-memory-model");
  expect_refused(file, {"--resume"}, 2, "leave out --resume");
  expect_refused(file, {"--memory-trace-format", "dramsim2"}, 2, "dramsim2");
  expect_refused(path("trace.json"), {}, 2, "is the trace itself");
  expect_refused(path("out/requests"), {}, 2, "is in the output folder");
  expect_refused(path("missing/requests"), {}, 1, "No such file or directory");
}

}  // namespace beampipe::memory_trace_test
