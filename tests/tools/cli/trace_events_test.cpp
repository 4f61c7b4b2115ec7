// --trace-events writes every stage of every technique, within its frame.

#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "pipeline/technique_table.h"
#include "tests/tools/cli/program_fixture.h"

namespace beampipe::trace_events_test {

using Json = nlohmann::json;

class TraceEvents : public RunInFolder {
 protected:
  TraceEvents() { write_text(folder_ / "trace.json", kHalfFrame); }

  // The events of a run with these options.
  Json events(const std::string& command, const Names& options) const {
    finish(joined({command, path("trace.json"), "-o", path("out"), "--trace-events", path("events.json")}, options));
    return Json::parse(read_text(folder_ / "events.json")).at("traceEvents");
  }

  void expect_refused(const std::string& file, int exit_code, const std::string& expected) const {
    SCOPED_TRACE(file);
    const Names before = folder_.list();
    const Outcome refused =
        run_program({"run", path("trace.json"), "-t", "beam", "-o", path("out"), "--trace-events", file});
    expect_one_error_line(refused, exit_code, expected);
    EXPECT_EQ(refused.err.find("frame"), std::string::npos) << "checked before anything is rendered: " << refused.err;
    EXPECT_EQ(folder_.list(), before);
    EXPECT_EQ(read_text(folder_ / "trace.json"), kHalfFrame);
  }
};

TEST_F(TraceEvents, HoldEveryStageOfEveryTechnique) {
  const Json events = this->events("run", joined({"--threads", "3", "-t"}, example_specs()));
  const Json report = Json::parse(read_text(folder_ / "out/report.json"));
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

TEST_F(TraceEvents, ComparisonsHaveThemToo) {
  std::set<std::string> names;
  for (const Json& event : events("compare", {"--ladder", "1", "-t", "beam"})) names.insert(event.at("name"));
  for (const char* name : {"beam, frame 0", "reference, frame 0", "compose", "reference_raster"})
    EXPECT_TRUE(names.contains(name)) << name;
}

TEST_F(TraceEvents, AreRefusedWhereNoFileCanBeWritten) {
  std::filesystem::create_directory(folder_ / "events");
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0666), 0);
  for (const std::string& file :
       {path("trace.json/e"), path("events"), path("pipe"), path("new/"), std::string("/dev/full")})
    expect_refused(file, 1, ": expected ");
  expect_refused(path("new/" + std::string(300, 'x')), 1, "too long");
}

TEST_F(TraceEvents, AreRefusedOverTheTraceOrInTheOutputFolder) {
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
