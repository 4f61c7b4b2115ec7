// Runs that are killed and continued.

#include "tools/evaluate/resume.h"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <thread>

#include "tests/simd/random.h"
#include "tests/thorough.h"
#include "tests/tools/program.h"
#include "tests/tools/varying_trace.h"
#include "tools/files/digest.h"

namespace beampipe::resume_test {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;
namespace fs = std::filesystem;

void pause(double milliseconds) {
  std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(milliseconds));
}

// Removes the times, which differ between any two runs.
void drop_times(Json& json) {
  if (json.is_object()) json.erase("wall_ms");
  for (Json& child : json)
    if (child.is_structured()) drop_times(child);
}

// The contents of every file under the folder, JSON without times.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory()) continue;
    std::string text = read_text(entry.path());
    if (entry.path().extension() == ".json") {
      Json json = Json::parse(text);
      drop_times(json);
      text = json.dump();
    }
    files[entry.path().lexically_relative(folder).string()] = std::move(text);
  }
  return files;
}

class ResumeTest : public testing::Test {
 protected:
  void make_trace(int frames, int triangles = 200) {
    succeed({"make", "soup", "--triangles", std::to_string(triangles), "--width", "32", "--height", "18", "--frames",
             std::to_string(frames), "--orbit", "20", "-o", path("trace.json")});
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  Names command(const std::string& verb, const std::string& out, const Names& more) const {
    Names arguments = {verb, path("trace.json"), "-o", path(out), "--threads", "1", "-t"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  Names resume(const std::string& verb, const std::string& out, Names more) const {
    more.push_back("--resume");
    return command(verb, out, more);
  }
  int frames_finished(const std::string& out) const {
    if (fs::exists(folder_ / out / "report.json")) return 20;
    int records = 0;
    if (fs::exists(folder_ / out / "unfinished"))
      for (const auto& entry : fs::directory_iterator(folder_ / out / "unfinished"))
        records += entry.path().extension() == ".json";
    return records;
  }
  // The files that are only in one of the folders or have different contents.
  std::set<std::string> differences(const std::string& a, const std::string& b) const {
    const auto left = contents(folder_ / a), right = contents(folder_ / b);
    std::set<std::string> names;
    for (const auto& [name, text] : left)
      if (!right.contains(name) || right.at(name) != text) names.insert(name);
    for (const auto& [name, text] : right)
      if (!left.contains(name)) names.insert(name);
    return names;
  }
  static Outcome succeed(const Names& arguments) {
    Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome;
  }
  static std::string refused(const Names& arguments, const std::string& why = "cannot resume") {
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(why), std::string::npos) << outcome.err;
    return outcome.err;
  }
  // Leaves a run that stopped after its first frame, because a picture of the second could not be written.
  void leave_unfinished(const std::string& verb, const std::string& out, const Names& more) {
    const fs::path in_the_way = folder_ / (out + "/msaa_2/frame_0001.png");
    fs::create_directories(in_the_way);
    const Outcome outcome = run_program(command(verb, out, more));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find("frame_0001.png"), std::string::npos) << outcome.err;
    fs::remove(in_the_way);
  }
  // Makes each of the changes in a copy of the folder `out`, in the record of the first frame. The run cannot go on
  // from it, and ends like the one in the folder `whole`.
  void expect_restarts(const std::vector<std::function<void(Json&)>>& changes, const Names& specs) {
    for (std::size_t i = 0; i < changes.size(); ++i) {
      SCOPED_TRACE(i);
      const std::string out = "out_" + std::to_string(i);
      fs::copy(folder_ / "out", folder_ / out, fs::copy_options::recursive);
      const fs::path record = folder_ / out / frame_record_name(0);
      Json json = Json::parse(read_text(record));
      json.erase("digest");
      changes[i](json);
      json["digest"] = digest_of(json.dump(2) + "\n");
      write_text(record, json.dump(2) + "\n");
      EXPECT_EQ(succeed(resume("compare", out, specs)).err, "") << "the run starts from the beginning";
      EXPECT_EQ(differences(out, "whole"), std::set<std::string>{});
    }
  }

  TemporaryFolder folder_;
};

// Kills the program (kill -9) at random moments and continues each time. taa and dvm carry a history from frame to
// frame, and compare keeps sums.
TEST_F(ResumeTest, TwentyFramesKilledTenTimesAreTheSameAsUndisturbed) {
  make_trace(20);
  for (const std::string verb : {"run", "compare"}) {
    SCOPED_TRACE(verb);
    Names specs = {"msaa:2", "beam", "taa:4", "dvm"};
    if (verb == "compare") specs.insert(specs.end(), {"--ladder", "1,2", "--causes"});
    const auto start = std::chrono::steady_clock::now();
    succeed(command(verb, verb + "_whole", specs));
    const double whole_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    Random random(std::random_device{}());
    SCOPED_TRACE(random.name());
    int killed = 0;
    std::string finished;  // the number of finished frames at each kill
    for (int i = 0; i < 10 * thoroughness(); ++i) {
      Program program(resume(verb, verb + "_killed", specs));
      pause(random.real(0, 0.3 * whole_ms));
      program.signal(SIGKILL);
      killed += program.wait().exit_code == -1;
      finished += ' ' + std::to_string(frames_finished(verb + "_killed"));
    }
    EXPECT_GT(killed, 0);
    succeed(resume(verb, verb + "_killed", specs));
    EXPECT_EQ(differences(verb + "_whole", verb + "_killed"), std::set<std::string>{});
    std::printf("%s: killed %d times; frames finished by then:%s; %zu files the same as undisturbed\n", verb.c_str(),
                killed, finished.c_str(), contents(folder_ / (verb + "_whole")).size());
  }
}

TEST_F(ResumeTest, AnErrorInALaterFrameLosesNothingThatWasFinished) {
  make_trace(3);
  const Names specs = {"taa:4", "msaa:2"};
  succeed(command("run", "whole", specs));
  leave_unfinished("run", "out", specs);
  EXPECT_FALSE(fs::exists(folder_ / "out/msaa_2/frame_0001.exr"));
  EXPECT_TRUE(fs::exists(folder_ / "out/unfinished/frame_0000.json"));
  const auto first = fs::last_write_time(folder_ / "out/msaa_2/frame_0000.exr");
  const Outcome outcome = succeed(resume("run", "out", specs));
  EXPECT_EQ(outcome.err,
            "beampipe: 1 of 3 frames are finished; continuing with frame 1 (taa:4: earlier frames are rendered again, "
            "because the next "
            "ones depend on them)\n");
  EXPECT_EQ(fs::last_write_time(folder_ / "out/msaa_2/frame_0000.exr"), first) << "it is not written again";
  EXPECT_EQ(differences("out", "whole"), std::set<std::string>{});
}

TEST_F(ResumeTest, GoesOnAtTheFirstFrameThatLacksAPicture) {
  make_trace(2);
  leave_unfinished("run", "out", {"msaa:2"});
  fs::remove(folder_ / "out/msaa_2/frame_0000.png");
  EXPECT_EQ(succeed(resume("run", "out", {"msaa:2"})).err, "");
  succeed(command("run", "whole", {"msaa:2"}));
  EXPECT_EQ(differences("out", "whole"), std::set<std::string>{});
}

// Files can be damaged by a power failure or by another program.
TEST_F(ResumeTest, DamagedFilesOfAFinishedFrameAreMadeAgain) {
  make_trace(2);
  for (const std::string verb : {"run", "compare"}) {
    Names specs = {"msaa:2"};
    if (verb == "compare") specs.insert(specs.end(), {"--ladder", "1"});
    succeed(command(verb, verb + "_whole", specs));
    for (const std::string file : {"frame_0000.exr", "frame_0000.png", "frame_0000_counters.exr"}) {
      SCOPED_TRACE(verb + " " + file);
      const std::string out = verb + "_" + file;
      leave_unfinished(verb, out, specs);
      const fs::path damaged = folder_ / out / "msaa_2" / file;
      std::string bytes = read_text(damaged);
      ++bytes.at(bytes.size() / 2);
      write_text(damaged, file == "frame_0000.exr" ? "" : bytes);
      succeed(resume(verb, out, specs));
      EXPECT_EQ(differences(out, verb + "_whole"), std::set<std::string>{});
    }
  }
}

TEST_F(ResumeTest, AFrameWhoseRecordIsDamagedIsMadeAgain) {
  make_trace(2);
  const Names specs = {"msaa:2", "--ladder", "1"};
  succeed(command("compare", "whole", specs));
  leave_unfinished("compare", "out", specs);
  const fs::path record = folder_ / "out" / frame_record_name(0);
  const std::vector<std::function<void(Json&)>> damages = {[](Json& json) { json.erase("sums"); },
                                                           [](Json& json) { json["sums"]["ladder"] = "none"; },
                                                           [](Json& json) { json["techniques"] = Json::array(); },
                                                           [](Json& json) { json["techniques"][0]["image"] = 7; },
                                                           [](Json& json) { json["techniques"][0]["stages"].clear(); },
                                                           [](Json& json) { json.erase("digest"); },
                                                           [](Json& json) { json = Json::array({json}); }};
  for (std::size_t i = 0; i < damages.size(); ++i) {
    SCOPED_TRACE(i);
    const std::string out = "out_" + std::to_string(i);
    fs::copy(folder_ / "out", folder_ / out, fs::copy_options::recursive);
    Json json = Json::parse(read_text(record));
    damages[i](json);
    write_text(folder_ / out / frame_record_name(0), json.dump());
    EXPECT_EQ(succeed(resume("compare", out, specs)).err, "") << "the run starts from the beginning";
    EXPECT_EQ(differences(out, "whole"), std::set<std::string>{});
  }
}

// The digest of the record is correct, but it belongs to another frame or another program.
TEST_F(ResumeTest, ARecordThatSpeaksOfSomethingElseIsNotBelieved) {
  make_trace(2);
  const Names specs = {"msaa:2", "--ladder", "1", "--causes", "--orders"};
  succeed(command("compare", "whole", specs));
  leave_unfinished("compare", "out", specs);
  const fs::path record = folder_ / "out" / frame_record_name(0);
  fs::copy(folder_ / "out", folder_ / "copied", fs::copy_options::recursive);
  fs::copy(record, folder_ / "copied" / frame_record_name(1));
  succeed(resume("compare", "copied", specs));
  EXPECT_EQ(differences("copied", "whole"), std::set<std::string>{});

  const std::vector<std::function<void(Json&)>> changes = {
      [](Json& json) { json["techniques"].erase(1); },
      [](Json& json) { json["techniques"].push_back(json["techniques"][0]); },
      [](Json& json) { std::swap(json["techniques"][0], json["techniques"][1]); },
      [](Json& json) { json["techniques"] = json["files"] = nullptr; },
      [](Json& json) { json["techniques"][0]["index"] = 1; },
      [](Json& json) { json["techniques"][0]["image"] = "../trace.json"; },
      [](Json& json) { json["techniques"][0]["picture"] = 7; },
      [](Json& json) { json["techniques"][0].erase("stages"); },
      [](Json& json) { json.erase("files"); },
      [](Json& json) { json.erase("sums"); },
      [](Json& json) { json["sums"]["ladder"].clear(); },
      [](Json& json) { json["sums"]["causes"][0][0].clear(); },
      [](Json& json) { json["sums"]["orders"]["techniques"][0][0].push_back(1); },
      [](Json& json) { json["sums"]["orders"]["values"] = "many"; }};
  expect_restarts(changes, specs);
}

TEST_F(ResumeTest, OrdersAndCausesGoOnToTheSameSums) {
  make_trace(3, 40);
  const Names specs = {"msaa:2", "alpha", "--ladder", "1", "--orders", "--causes"};
  succeed(command("compare", "whole", specs));
  leave_unfinished("compare", "out", specs);
  succeed(resume("compare", "out", specs));
  EXPECT_EQ(differences("out", "whole"), std::set<std::string>{});
}

const std::vector<std::string> kVaryingFrames = {R"({"mesh": "wall"}, {"mesh": "flat"})",
                                                 R"({"mesh": "left"}, {"mesh": "sliver"})",
                                                 R"({"mesh": "sliver"}, {"mesh": "flat"}, {"mesh": "left"})"};

// taa keeps two histories here, and the ladder for visibility grows, for which references are rendered again.
TEST_F(ResumeTest, PartsOfTheErrorGoOnToTheSameSums) {
  write_varying_trace(folder_, kVaryingFrames);
  const Names specs = {"beam", "taa:4", "msaa:2", "--causes"};
  succeed(command("compare", "whole", specs));
  leave_unfinished("compare", "out", specs);
  EXPECT_TRUE(fs::exists(folder_ / "out" / frame_record_name(0)));
  succeed(resume("compare", "out", specs));
  EXPECT_EQ(differences("out", "whole"), std::set<std::string>{});
}

TEST_F(ResumeTest, KilledWhileErrorsAreSplit) {
  write_varying_trace(folder_, kVaryingFrames);
  const Names specs = {"beam", "taa:4", "msaa:2", "--causes", "--ladder", "1,64"};
  const auto start = std::chrono::steady_clock::now();
  succeed(command("compare", "whole", specs));
  const double whole_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  Random random(std::random_device{}());
  SCOPED_TRACE(random.name());
  for (int i = 0; i < 5 * thoroughness(); ++i) {
    Program program(resume("compare", "killed", specs));
    pause(random.real(0, 0.5 * whole_ms));
    program.signal(SIGKILL);
    program.wait();
  }
  succeed(resume("compare", "killed", specs));
  EXPECT_EQ(differences("whole", "killed"), std::set<std::string>{});
}

TEST_F(ResumeTest, ARecordWithoutThePartsOfAnErrorIsNotBelieved) {
  write_varying_trace(folder_, kVaryingFrames);
  const Names specs = {"msaa:2", "--ladder", "1"};
  succeed(command("compare", "whole", specs));
  leave_unfinished("compare", "out", specs);
  const std::vector<std::function<void(Json&)>> changes = {
      [](Json& json) { json["techniques"][0].erase("visibility"); },
      [](Json& json) { json["techniques"][0].erase("shading"); },
      [](Json& json) { json["techniques"][0]["shading"]["rmse"] = "none"; },
      [](Json& json) { json["sums"].erase("visibility_ladder"); }};
  expect_restarts(changes, specs);
}

TEST_F(ResumeTest, WhatAnotherTraceOrOptionLeftIsRefused) {
  make_trace(2);
  leave_unfinished("run", "out", {"msaa:2"});
  const auto before = contents(folder_ / "out");
  EXPECT_NE(refused(resume("run", "out", {"msaa:2", "msaa:4"})).find("techniques [\"msaa:2\"], not"),
            std::string::npos);
  EXPECT_NE(refused(resume("run", "out", {"msaa:2", "--frames", "0"})).find("frames \"0-1\""), std::string::npos);
  EXPECT_NE(refused(resume("run", "out", {"msaa:2", "--no-memory-model"})).find("memory_model"), std::string::npos);
  EXPECT_NE(refused(resume("compare", "out", {"msaa:2"})).find("command \"run\""), std::string::npos);
  make_trace(2, 201);
  EXPECT_NE(refused(resume("run", "out", {"msaa:2"})).find("another trace"), std::string::npos);
  EXPECT_EQ(contents(folder_ / "out"), before);
  refused(command("run", "out", {"msaa:2"}), "found those of another trace; --force writes over them");
  EXPECT_EQ(contents(folder_ / "out"), before);
  succeed(command("run", "out", {"msaa:2", "--force"}));  // it starts from the beginning
  succeed(command("run", "fresh", {"msaa:2"}));
  EXPECT_EQ(differences("out", "fresh"), std::set<std::string>{});
}

TEST_F(ResumeTest, RunDoesNotWriteOverErrorsUnlessForced) {
  make_trace(2);
  succeed(command("run", "out", {"msaa:2"}));
  succeed(command("run", "out", {"msaa:4"}));
  succeed(command("compare", "out", {"msaa:2", "--ladder", "1"}));
  const auto before = contents(folder_ / "out");
  refused(command("run", "out", {"msaa:2"}), "found those of beampipe compare; --force writes over them");
  EXPECT_EQ(contents(folder_ / "out"), before);
  succeed(command("run", "out", {"msaa:2", "--force"}));
}

TEST_F(ResumeTest, WhatIsFinishedStaysAsItIs) {
  make_trace(2);
  succeed(command("run", "out", {"msaa:2"}));
  EXPECT_FALSE(fs::exists(folder_ / "out/unfinished"));
  const std::string report = read_text(folder_ / "out/report.json");
  EXPECT_EQ(succeed(resume("run", "out", {"msaa:2"})).out.find("already finished\n"), 0u);
  EXPECT_EQ(read_text(folder_ / "out/report.json"), report) << "the old report with its times";
  refused(resume("run", "out", {"msaa:2", "--repeat", "2"}));
}

// The program was killed after it had written the report, but before it had removed the records.
TEST_F(ResumeTest, RecordsBesideAReportAreRemoved) {
  make_trace(2);
  succeed(command("run", "out", {"msaa:2"}));
  fs::create_directory(folder_ / "out/unfinished");
  write_text(folder_ / "out/unfinished/frame_0001.json", "{}");
  succeed(resume("run", "out", {"msaa:2"}));
  EXPECT_FALSE(fs::exists(folder_ / "out/unfinished"));
}

}  // namespace beampipe::resume_test
