// The registry of counters says what there is: nothing is missing in it, and nothing in it is dead.
#include "stages/counter_registry.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "pipeline/technique.h"
#include "test_traces.h"

namespace beampipe {
namespace {

constexpr const char* kSpecs[] = {"beam",
                                  "beam:rules=paper",
                                  "beam:order=stream",
                                  "z3",
                                  "alpha",
                                  "msaa:4",
                                  "acaa:4,double=stencil",
                                  "acaa:4,double=saturate",
                                  "deferred",
                                  "visibility",
                                  "taa:8",
                                  "dvm",
                                  "reference"};

// Sums over two frames of every technique, by stage.
const std::map<std::string, StageCounters>& sums() {
  static const std::map<std::string, StageCounters> all = [] {
    std::map<std::string, StageCounters> by_stage;
    const Trace trace = random_trace(40, 30, 400, 2);
    for (const char* spec : kSpecs) {
      History history;
      for (int frame = 0; frame < 2; ++frame) {
        RunOptions run{2};
        run.history = &history;
        for (const StageCounters& stage : parse_technique(spec).render(trace, 0, run).stages)
          by_stage[stage.stage] += stage;
      }
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

TEST(CounterRegistry, EveryCounterMovesSomewhere) {
  for (const CounterInfo& counter : stage_counters()) {
    std::uint64_t sum = 0;
    for (const auto& [name, counters] : sums()) sum += counter.value(counters);
    EXPECT_GT(sum, 0u) << counter.name;
  }
  for (const auto& [name, counters] : sums()) {  // these, in every stage
    EXPECT_GT(counters.items_in, 0u) << name;
    EXPECT_GT(counters.items_out, 0u) << name;
    EXPECT_GT(counters.ops.total(), 0u) << name;
    EXPECT_GT(counters.logical_bytes(), 0u) << name;
  }
}

TEST(CounterRegistry, EveryPixelCounterMovesSomewhere) {
  std::map<std::string, float> found;
  const Trace trace = random_trace(40, 30, 400, 2);
  for (const char* spec : kSpecs)
    for (const auto& [name, values] : parse_technique(spec).render(trace, 0, {2}).pixel_counters)
      for (const float value : values) found[name] += value;
  for (const PixelCounterInfo& counter : pixel_counters()) {
    EXPECT_GT(found[counter.name], 0.0f) << counter.name;
    found.erase(counter.name);
  }
  for (const auto& [name, sum] : found) ADD_FAILURE() << name << " is not in the registry";
}

// BEAMPIPE_WRITE_DOCS=1 writes the page in place of comparing it.
TEST(CounterRegistry, ThePageIsWhatTheRegistrySays) {
  const std::filesystem::path page = std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "docs/counters.md";
  if (std::getenv("BEAMPIPE_WRITE_DOCS")) std::ofstream(page, std::ios::binary) << counters_page();
  std::ifstream stream(page, std::ios::binary);
  EXPECT_EQ((std::string{std::istreambuf_iterator<char>(stream), {}}), counters_page());
}

}  // namespace
}  // namespace beampipe
