// Runs that are killed and continued.

#include "tools/evaluate/resume.h"

#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/simd/random.h"
#include "tests/thorough.h"
#include "tests/tools/program.h"
#include "tests/tools/varying_trace.h"
#include "tools/files/digest.h"

namespace beampipe::resume_test {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Removes the times, which differ between any two runs, and the command, which names the folder.
void drop_times(Json& json) {
  if (json.is_object()) json.erase("wall_ms"), json.erase("command_line");
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

class ResumeTest : public RunInFolder {
 protected:
  void make_trace(int frames, int triangles = 200) {
    finish({"make", "soup", "--triangles", std::to_string(triangles), "--width", "16", "--height", "10", "--frames",
            std::to_string(frames), "--orbit", "20", "-o", path("trace.json")});
  }
  Names command(const std::string& verb, const std::string& out, const Names& more) const {
    return joined({verb, path("trace.json"), "-o", path(out), "--threads", "1", "-t"}, more);
  }
  Names resume(const std::string& verb, const std::string& out, const Names& more) const {
    return command(verb, out, joined(more, {"--resume"}));
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
  static std::string refused(const Names& arguments, const std::string& why = "cannot resume") {
    const Outcome outcome = run_program(arguments);
    expect_one_error_line(outcome, 1, why);
    return outcome.err;
  }
  // Leaves a run that stopped after its first frame, because a picture of the second could not be written.
  void leave_unfinished(const std::string& verb, const std::string& out, const Names& more) {
    const fs::path in_the_way = folder_ / (out + "/msaa_2/frame_0001.png");
    fs::create_directories(in_the_way);
    const Outcome outcome = run_program(command(verb, out, more));  // it may have notes too
    EXPECT_EQ(outcome.exit_code, 1);
    expect_parts(outcome.err, {"frame_0001.png"});
    fs::remove(in_the_way);
  }
  // The same as an undisturbed run after the first frame.
  void expect_to_go_on(const std::string& verb, const Names& specs) {
    finish(command(verb, "whole", specs));
    leave_unfinished(verb, "out", specs);
    EXPECT_TRUE(fs::exists(folder_ / "out" / frame_record_name(0)));
    finish(resume(verb, "out", specs));
    EXPECT_EQ(differences("out", "whole"), std::set<std::string>{});
  }
  // Kills the program (kill -9) `times` at random moments, of which each comes within this part of the time that an
  // undisturbed run takes, and continues each time.
  void expect_to_outlive_kills(const std::string& verb, const Names& specs, int times, double part) {
    const std::string whole = verb + "_whole", torn = verb + "_killed";
    const auto start = std::chrono::steady_clock::now();
    finish(command(verb, whole, specs));
    const double whole_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    Random random(std::random_device{}());
    int killed = 0;
    std::string finished;  // the number of finished frames at each kill
    for (int i = 0; i < times * thoroughness(); ++i) {
      Program program(resume(verb, torn, specs));
      pause(random.real(0, part * whole_ms));
      program.signal(SIGKILL);
      killed += program.wait().exit_code == -1;
      finished += ' ' + std::to_string(frames_finished(torn));
    }
    EXPECT_GT(killed, 0);
    finish(resume(verb, torn, specs));
    EXPECT_EQ(differences(whole, torn), std::set<std::string>{});
    std::printf("%s: killed %d times; frames finished by then:%s; %zu files the same as undisturbed\n", verb.c_str(),
                killed, finished.c_str(), contents(folder_ / whole).size());
  }
  // Each change to the first frame's record makes `compare` start from the beginning. The record has the digest of its
  // contents, or that of the contents before the change.
  enum class Digest { right, old };
  void expect_not_believed(const Names& specs, Digest digest, const std::vector<std::function<void(Json&)>>& changes) {
    finish(command("compare", "whole", specs));
    leave_unfinished("compare", "out", specs);
    for (std::size_t i = 0; i < changes.size(); ++i) {
      SCOPED_TRACE(i);
      const std::string out = "out_" + std::to_string(i);
      fs::copy(folder_ / "out", folder_ / out, fs::copy_options::recursive);
      Json json = Json::parse(read_text(folder_ / "out" / frame_record_name(0)));
      if (digest == Digest::right) json.erase("digest");
      changes[i](json);
      if (digest == Digest::right) json["digest"] = digest_of(json.dump(2) + "\n");
      write_text(folder_ / out / frame_record_name(0), json.dump(2) + "\n");
      EXPECT_EQ(finish(resume("compare", out, specs)).err, "") << "the run starts from the beginning";
      EXPECT_EQ(differences(out, "whole"), std::set<std::string>{});
    }
  }
};

// taa and dvm carry a history from frame to frame, and compare keeps sums.
TEST_F(ResumeTest, TwentyFramesKilledTenTimesAreTheSameAsUndisturbed) {
  make_trace(20);
  const Names specs = {"msaa:2", "beam", "taa:4", "dvm"};
  expect_to_outlive_kills("run", specs, 10, 0.3);
  expect_to_outlive_kills("compare", joined(specs, {"--ladder", "1,2", "--causes"}), 10, 0.3);
}

TEST_F(ResumeTest, AnErrorInALaterFrameLosesNothingThatWasFinished) {
  make_trace(3);
  const Names specs = {"taa:4", "msaa:2"};
  finish(command("run", "whole", specs));
  leave_unfinished("run", "out", specs);
  EXPECT_FALSE(fs::exists(folder_ / "out/msaa_2/frame_0001.exr"));
  EXPECT_TRUE(fs::exists(folder_ / "out/unfinished/frame_0000.json"));
  const auto first = fs::last_write_time(folder_ / "out/msaa_2/frame_0000.exr");
  const Outcome outcome = finish(resume("run", "out", specs));
  EXPECT_EQ(outcome.err,
            "beampipe: 1 of 3 frames are finished; continuing with frame 1 (taa:4: earlier frames are rendered again, "
            "because the next "
            "ones depend on them)\n");
  EXPECT_EQ(fs::last_write_time(folder_ / "out/msaa_2/frame_0000.exr"), first) << "it is not written again";
  EXPECT_EQ(differences("out", "whole"), std::set<std::string>{});
}

// Files can be damaged or removed by a power failure or by another program.
TEST_F(ResumeTest, DamagedFilesOfAFinishedFrameAreMadeAgain) {
  make_trace(2);
  for (const std::string verb : {"run", "compare"}) {
    Names specs = {"msaa:2"};
    if (verb == "compare") specs.insert(specs.end(), {"--ladder", "1"});
    finish(command(verb, verb + "_whole", specs));
    enum Damage { changed, emptied, removed };
    for (const auto& [file, damage] : {std::pair<std::string, Damage>{"frame_0000.exr", emptied},
                                       {"frame_0000.png", changed},
                                       {"frame_0000.png", removed},
                                       {"frame_0000_counters.exr", changed}}) {
      const std::string out = verb + "_" + file + std::to_string(damage);
      SCOPED_TRACE(out);
      leave_unfinished(verb, out, specs);
      const fs::path damaged = folder_ / out / "msaa_2" / file;
      std::string bytes = read_text(damaged);
      ++bytes.at(bytes.size() / 2);
      write_text(damaged, damage == emptied ? "" : bytes);
      if (damage == removed) fs::remove(damaged);
      EXPECT_EQ(finish(resume(verb, out, specs)).err, "") << "the run starts from the beginning";
      EXPECT_EQ(differences(out, verb + "_whole"), std::set<std::string>{});
    }
  }
}

TEST_F(ResumeTest, AFrameWhoseRecordIsDamagedIsMadeAgain) {
  make_trace(2);
  expect_not_believed(
      {"msaa:2", "--ladder", "1"}, Digest::old,
      {[](Json& json) { json.erase("sums"); }, [](Json& json) { json["sums"]["ladder"] = "none"; },
       [](Json& json) { json["techniques"] = Json::array(); }, [](Json& json) { json["techniques"][0]["image"] = 7; },
       [](Json& json) { json["techniques"][0]["stages"].clear(); }, [](Json& json) { json.erase("digest"); },
       [](Json& json) { json = Json::array({json}); }});
}

// The digest of the record is correct, but it belongs to another frame or another program.
TEST_F(ResumeTest, ARecordThatSpeaksOfSomethingElseIsNotBelieved) {
  make_trace(2);
  const Names specs = {"msaa:2", "--ladder", "1", "--causes", "--orders"};
  expect_not_believed(
      specs, Digest::right,
      {[](Json& json) { json["techniques"].erase(1); },
       [](Json& json) { json["techniques"].push_back(json["techniques"][0]); },
       [](Json& json) { std::swap(json["techniques"][0], json["techniques"][1]); },
       [](Json& json) { json["techniques"] = json["files"] = nullptr; },
       [](Json& json) { json["techniques"][0]["index"] = 1; },
       [](Json& json) { json["techniques"][0]["image"] = "../trace.json"; },
       [](Json& json) { json["techniques"][0]["picture"] = 7; },
       [](Json& json) { json["techniques"][0].erase("stages"); }, [](Json& json) { json.erase("files"); },
       [](Json& json) { json["techniques"][0]["error"].erase("hdr_flip"); },
       [](Json& json) { json["techniques"][0]["error"].erase("mae"); },
       [](Json& json) { json["techniques"][0].erase("error"); }, [](Json& json) { json.erase("sums"); },
       [](Json& json) { json["sums"]["ladder"].clear(); }, [](Json& json) { json["sums"]["causes"][0][0].clear(); },
       [](Json& json) { json["sums"]["orders"]["techniques"][0][0].push_back(1); },
       [](Json& json) { json["sums"]["orders"]["values"] = "many"; }});
  fs::copy(folder_ / "out" / frame_record_name(0), folder_ / "out" / frame_record_name(1));
  finish(resume("compare", "out", specs));
  EXPECT_EQ(differences("out", "whole"), std::set<std::string>{});
}

TEST_F(ResumeTest, OrdersCausesAndRatesByAnotherMetricGoOnToTheSameSums) {
  make_trace(3, 40);
  expect_to_go_on("compare", {"msaa:2", "alpha", "--ladder", "1,4", "--orders", "--causes", "--metric", "ssim"});
}

const std::vector<std::string> kVaryingFrames = {R"({"mesh": "wall"}, {"mesh": "flat"})",
                                                 R"({"mesh": "left"}, {"mesh": "sliver"})",
                                                 R"({"mesh": "sliver"}, {"mesh": "flat"}, {"mesh": "left"})"};

// taa keeps two histories here, and the ladder for visibility grows, for which references are rendered again.
TEST_F(ResumeTest, PartsOfTheErrorGoOnToTheSameSums) {
  write_varying_trace(folder_, kVaryingFrames);
  expect_to_go_on("compare", {"beam", "taa:4", "msaa:2", "--causes"});
}

TEST_F(ResumeTest, KilledWhileErrorsAreSplit) {
  write_varying_trace(folder_, kVaryingFrames);
  expect_to_outlive_kills("compare", {"beam", "taa:4", "msaa:2", "--causes", "--ladder", "1,64"}, 5, 0.5);
}

TEST_F(ResumeTest, ARecordWithoutThePartsOfAnErrorIsNotBelieved) {
  write_varying_trace(folder_, kVaryingFrames);
  expect_not_believed({"msaa:2", "--ladder", "1"}, Digest::right,
                      {[](Json& json) { json["techniques"][0].erase("visibility"); },
                       [](Json& json) { json["techniques"][0].erase("shading"); },
                       [](Json& json) { json["techniques"][0]["shading"]["rmse"] = "none"; },
                       [](Json& json) { json["sums"].erase("visibility_ladder"); }});
}

TEST_F(ResumeTest, WhatAnotherTraceOrOptionLeftIsRefused) {
  make_trace(2);
  leave_unfinished("run", "out", {"msaa:2"});
  const auto before = contents(folder_ / "out");
  expect_parts(refused(resume("run", "out", {"msaa:2", "msaa:4"})), {"techniques [\"msaa:2\"], not"});
  expect_parts(refused(resume("run", "out", {"msaa:2", "--frames", "0"})), {"frames \"0-1\""});
  expect_parts(refused(resume("run", "out", {"msaa:2", "--no-memory-model"})), {"memory_model"});
  expect_parts(refused(resume("compare", "out", {"msaa:2"})), {"command \"run\""});
  make_trace(2, 201);
  expect_parts(refused(resume("run", "out", {"msaa:2"})), {"another trace"});
  EXPECT_EQ(contents(folder_ / "out"), before);
  refused(command("run", "out", {"msaa:2"}), "found those of another trace; --force writes over them");
  EXPECT_EQ(contents(folder_ / "out"), before);
  finish(command("run", "out", {"msaa:2", "--force"}));  // it starts from the beginning
  finish(command("run", "fresh", {"msaa:2"}));
  EXPECT_EQ(differences("out", "fresh"), std::set<std::string>{});
}

TEST_F(ResumeTest, RunDoesNotWriteOverErrorsUnlessForced) {
  make_trace(2);
  finish(command("run", "out", {"msaa:2"}));
  finish(command("run", "out", {"msaa:4"}));
  finish(command("compare", "out", {"msaa:2", "--ladder", "1"}));
  const auto before = contents(folder_ / "out");
  refused(command("run", "out", {"msaa:2"}), "found those of beampipe compare; --force writes over them");
  EXPECT_EQ(contents(folder_ / "out"), before);
  finish(command("run", "out", {"msaa:2", "--force"}));
}

TEST_F(ResumeTest, WhatIsFinishedStaysAsItIs) {
  make_trace(2);
  finish(command("run", "out", {"msaa:2"}));
  EXPECT_FALSE(fs::exists(folder_ / "out/unfinished"));
  const std::string report = read_text(folder_ / "out/report.json");
  EXPECT_EQ(finish(resume("run", "out", {"msaa:2"})).out.find("already finished\n"), 0u);
  EXPECT_EQ(read_text(folder_ / "out/report.json"), report) << "the old report with its times";
  refused(resume("run", "out", {"msaa:2", "--repeat", "2"}));
}

// The program was killed after it had written the report, but before it had removed the records.
TEST_F(ResumeTest, RecordsBesideAReportAreRemoved) {
  make_trace(2);
  finish(command("run", "out", {"msaa:2"}));
  fs::create_directory(folder_ / "out/unfinished");
  write_text(folder_ / "out/unfinished/frame_0001.json", "{}");
  finish(resume("run", "out", {"msaa:2"}));
  EXPECT_FALSE(fs::exists(folder_ / "out/unfinished"));
}

}  // namespace beampipe::resume_test
