// --trace-events writes every stage of every technique, within its frame.

#include <sys/stat.h>

#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/technique_table.h"
#include "tests/tools/program.h"

namespace beampipe::trace_events_test {

using Json = nlohmann::json;

constexpr const char* kTrace = R"({"beampipe_trace": 1,
  "meshes": {"red": {"positions": [-1,-1,0, 1,1,0, -1,1,0], "indices": [0,1,2], "colors": [1,0.25,0]}},
  "frames": [{"width": 70, "height": 40, "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
              "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "red"}]}]})";

TEST(TraceEvents, HoldEveryStageOfEveryTechnique) {
  const std::vector<std::string> specs = example_specs();
  const TemporaryFolder folder;
  write_text(folder / "trace.json", kTrace);
  std::vector<std::string> arguments = {"run",
                                        (folder / "trace.json").string(),
                                        "-o",
                                        (folder / "out").string(),
                                        "--threads",
                                        "3",
                                        "--trace-events",
                                        (folder / "events.json").string(),
                                        "-t"};
  arguments.insert(arguments.end(), specs.begin(), specs.end());
  const Outcome outcome = run_program(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;

  const Json events = Json::parse(read_text(folder / "events.json")).at("traceEvents");
  const Json report = Json::parse(read_text(folder / "out/report.json"));
  for (const Json& result : report.at("results")) {
    const std::string spec = result.at("technique");
    const auto frame = std::find_if(events.begin(), events.end(),
                                    [&](const Json& event) { return event.at("name") == spec + ", frame 0"; });
    ASSERT_NE(frame, events.end()) << spec;
    const double start = frame->at("ts"), end = start + frame->at("dur").get<double>();
    std::set<std::string> recorded, expected;
    for (const Json& event : events) {
      if (event.at("ph") != "X" || event == *frame) continue;
      const double from = event.at("ts"), to = from + event.at("dur").get<double>();
      if (from >= start && to <= end) recorded.insert(event.at("name"));
    }
    for (const Json& stage : result.at("frames")[0].at("stages")) expected.insert(stage.at("stage"));
    expected.erase("prepass_vertex_setup");  // the program sets triangles up once, for both passes
    EXPECT_EQ(recorded, expected) << spec;
  }
}

TEST(TraceEvents, ComparisonsHaveThemToo) {
  const TemporaryFolder folder;
  write_text(folder / "trace.json", kTrace);
  const Outcome outcome =
      run_program({"compare", (folder / "trace.json").string(), "-o", (folder / "out").string(), "--ladder", "1",
                   "--trace-events", (folder / "events.json").string(), "-t", "beam"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json events = Json::parse(read_text(folder / "events.json"));
  std::set<std::string> names;
  for (const Json& event : events.at("traceEvents")) names.insert(event.at("name"));
  for (const char* name : {"beam, frame 0", "reference, frame 0", "compose", "reference_raster"})
    EXPECT_TRUE(names.contains(name)) << name;
}

class RefusedTraceEvents : public testing::Test {
 protected:
  RefusedTraceEvents() { write_text(folder_ / "trace.json", kTrace); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  void expect_refused(const std::string& file, int exit_code, const std::string& expected) const {
    SCOPED_TRACE(file);
    const std::vector<std::string> before = folder_.list();
    const Outcome refused =
        run_program({"run", path("trace.json"), "-t", "beam", "-o", path("out"), "--trace-events", file});
    EXPECT_EQ(refused.exit_code, exit_code);
    EXPECT_NE(refused.err.find(expected), std::string::npos) << refused.err;
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_EQ(refused.err.find("frame"), std::string::npos) << "checked before anything is rendered: " << refused.err;
    EXPECT_EQ(folder_.list(), before);
    EXPECT_EQ(read_text(folder_ / "trace.json"), kTrace);
  }

  TemporaryFolder folder_;
};

TEST_F(RefusedTraceEvents, WhereNoFileCanBeWritten) {
  std::filesystem::create_directory(folder_ / "events");
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0666), 0);
  for (const std::string& file :
       {path("trace.json/e"), path("events"), path("pipe"), path("new/"), std::string("/dev/full")})
    expect_refused(file, 1, ": expected ");
  expect_refused(path("new/" + std::string(300, 'x')), 1, "too long");
}

TEST_F(RefusedTraceEvents, OverTheTraceOrInTheOutputFolder) {
  std::filesystem::create_symlink("trace.json", folder_ / "link.json");
  for (const char* file : {"trace.json", "new/../trace.json", "link.json"})
    expect_refused(path(file), 2, "is the trace itself");
  for (const char* file : {"out", "out/e.json", "out/report.json/e"}) expect_refused(path(file), 2, "output folder");
  std::filesystem::create_directory(folder_ / "out");
  std::filesystem::create_directory_symlink("out", folder_ / "alias");
  for (const char* file : {"out/report.json", "alias/e.json", "out/beam/picture.png"})
    expect_refused(path(file), 2, "output folder");
}

}  // namespace beampipe::trace_events_test
