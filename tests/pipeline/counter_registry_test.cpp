// The registry of counters is complete, and every counter in it moves somewhere.
#include "stages/cost/counter_registry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "pipeline/technique.h"
#include "tests/pipeline/counter_page.h"
#include "tests/pipeline/surface_traces.h"
#include "tests/pipeline/test_traces.h"

namespace beampipe {
namespace {

constexpr const char* kSpecs[] = {"beam",
                                  "beam:order=sorted",
                                  "beam:order=stream",
                                  "beam:rules=paper",
                                  "beam:order=stream,passes=0",
                                  "z3",
                                  "alpha",
                                  "msaa:4,at=centroid",
                                  "msaa:4,prepass",
                                  "msaa:4,prepass,motion,resolve=reinhard",
                                  "msaa:32",
                                  "msaa:256",
                                  "acaa:4,double=stencil",
                                  "acaa:4,double=saturate",
                                  "deferred",
                                  "visibility",
                                  "visibility:4",
                                  "taa:8",
                                  "taa:8,shading=forward",
                                  "taa:8,shading=deferred",
                                  "dvm",
                                  "reference"};

// Two frames of small lit triangles all over the picture, which move by a part of a pixel. The sides of the view cut
// some of them. The width is odd.
Trace test_trace() {
  Trace trace = random_trace(41, 30, 400, 2);
  trace.frames.push_back(trace.frames.front());
  trace.frames.back().draws.front().transform[3][0] += 0.25;
  for (Frame& frame : trace.frames) {
    for (Draw& draw : frame.draws) draw.shading = Shading::lambert;
    frame.lighting.lights = {{glm::vec3(0, 0, 1)}};
  }
  return trace;
}

// One triangle closes the first tile and the left part of the second. Two triangles lie behind it, one of them in both
// tiles. The last tile is empty.
Trace hidden_trace() {
  const glm::vec3 gray(0.5f);
  return pixel_trace(128, 32,
                     {{{{-1, -1, 0.3}, {66, -1, 0.3}, {-1, 66, 0.3}}, gray},
                      {{{2, 2, 0.6}, {9, 2, 0.6}, {2, 9, 0.6}}, gray},
                      {{{20, 2, 0.6}, {50, 2, 0.6}, {20, 9, 0.6}}, gray}});
}

// The counters of each stage, summed over all frames of every technique.
const std::map<std::string, StageCounters>& sums() {
  static const std::map<std::string, StageCounters> all = [] {
    std::map<std::string, StageCounters> by_stage;
    const Trace trace = test_trace();
    for (const char* spec : kSpecs) {
      History history;
      for (std::size_t frame = 0; frame < trace.frames.size(); ++frame) {
        FrameInput run{2};
        run.history = &history;
        for (const StageCounters& stage : parse_technique(spec).render(trace, frame, run).stages)
          by_stage[std::string(without_pass(stage.stage))] += stage;
      }
      for (const Trace& other : {hidden_trace(), random_surfaces(64, 48, 80, 2)})
        for (const StageCounters& stage : parse_technique(spec).render(other, 0, {2}).stages)
          by_stage[std::string(without_pass(stage.stage))] += stage;
    }
    return by_stage;
  }();
  return all;
}

TEST(CounterRegistry, HasEveryStage) {
  std::set<std::string> known, found;
  for (const StageInfo& stage : stage_list()) known.insert(stage.name);
  for (const auto& [name, counters] : sums()) found.insert(name);
  EXPECT_EQ(known, found);
}

TEST(CounterRegistry, EveryCounterMovesWhereItIsListed) {
  for (const StageInfo& stage : stage_list()) {
    for (const CounterInfo& counter : stage_counters()) {
      const std::uint64_t sum = counter.value(sums().at(stage.name));
      if (has_counter(stage, counter)) {
        EXPECT_GT(sum, 0u) << stage.name << " lists " << counter.name << ", which never moves there";
      } else {
        EXPECT_EQ(sum, 0u) << stage.name << " does not list " << counter.name << ", which moves there";
      }
    }
  }
}

// The names of all tests as ctest lists them, without the scene that a name may contain, as in
// "Scenes/TwinCounts.Claim/fence".
std::set<std::string> names_of_tests() {
  const std::string command = std::string(BEAMPIPE_CTEST) + " --test-dir " + BEAMPIPE_BUILD_FOLDER + " -N";
  std::set<std::string> names;
  FILE* const list = popen(command.c_str(), "r");
  char line[4096];
  while (list && std::fgets(line, sizeof line, list)) {
    std::string name = line;
    const std::size_t colon = name.find(": ");
    if (name.find("Test ") == name.npos || colon == name.npos) continue;
    name = name.substr(colon + 2, name.find_first_of(" \n", colon + 2) - colon - 2);
    const std::size_t dot = name.find('.');
    if (dot == name.npos) continue;
    name.erase(std::min(name.find('/', dot), name.size()));
    names.insert(name.substr(name.find('/') + 1));  // the whole name if it has no slash
  }
  if (list) pclose(list);
  return names;
}

TEST(CounterRegistry, NamesTestsThatThereAre) {
  const std::set<std::string> tests = names_of_tests();
  ASSERT_TRUE(tests.contains("CounterRegistry.NamesTestsThatThereAre"));
  const auto expect_test = [&](const std::string& named, const std::string& of) {
    for (std::size_t begin = 0, end = 0; end < named.size(); begin = end + 2) {
      end = std::min(named.find(", ", begin), named.size());
      const std::string test = named.substr(begin, end - begin);
      EXPECT_TRUE(tests.contains(test)) << test << ", which tests/pipeline/counter_page.cpp names for " << of;
    }
  };
  for (const StageInfo& stage : stage_list())
    for (const CounterInfo& counter : stage_counters()) expect_test(tests_of(stage, counter), stage.name);
  for (const PixelCounterInfo& counter : pixel_counters()) expect_test(tests_of(counter), counter.name);
  for (const PixelCounterInfo& counter : error_counters()) expect_test(tests_of(counter), counter.name);
  for (const FrameCounterInfo& counter : frame_counters()) expect_test(tests_of(counter), counter.name);
}

TEST(CounterRegistry, EveryPixelCounterMovesSomewhere) {
  std::map<std::string, float> found;
  const Trace trace = test_trace();
  for (const char* spec : kSpecs) {
    History history;
    for (std::size_t frame = 0; frame < trace.frames.size(); ++frame)
      for (const auto& [name, values] : parse_technique(spec).render(trace, frame, {2, &history}).pixel_counters)
        for (const float value : values) found[name] += value;
  }
  for (const PixelCounterInfo& counter : pixel_counters()) {
    EXPECT_GT(found[counter.name], 0.0f) << counter.name;
    found.erase(counter.name);
  }
  for (const auto& [name, sum] : found) ADD_FAILURE() << name << " is not in the registry";
}

// With BEAMPIPE_WRITE_DOCS=1 the test writes the page first.
TEST(CounterRegistry, ThePageIsWhatTheRegistrySays) {
  const std::filesystem::path page = std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "docs/counters.md";
  const std::string text = counters_page();  // which may throw: the file is opened after that, as this empties it
  if (std::getenv("BEAMPIPE_WRITE_DOCS")) std::ofstream(page, std::ios::binary) << text;
  std::ifstream stream(page, std::ios::binary);
  EXPECT_EQ((std::string{std::istreambuf_iterator<char>(stream), {}}), text);
}

}  // namespace
}  // namespace beampipe
