// The record of DRAM requests: what the counters say, in one address space, in the order of passes and bins.
#include "pipeline/memory/dram_trace.h"

#include "pipeline/technique_table.h"
#include "tests/message_of.h"
#include "tests/pipeline/surface_traces.h"
#include "tests/test.h"

namespace beampipe::dram_trace_test {

struct Recorded {
  std::uint64_t address;
  bool is_write;
  std::string stage, array;
  bool operator==(const Recorded&) const = default;
};

struct Frame0 {
  std::vector<StageCounters> stages;
  std::vector<Recorded> requests;
  std::vector<DramTrace::Range> ranges;
};

Frame0 record(const std::string& spec, const Trace& trace, const FrameInput& run = {2}) {
  DramTrace dram(testing::TempDir());
  Frame0 frame;
  frame.stages = parse_technique(spec).render(trace, 0, run, {.dram_trace = &dram}).stages;
  dram.for_each([&](const DramRequest& request) {
    frame.requests.push_back(
        {request.address, request.access == DramAccess::write, std::string(request.stage), request.array});
  });
  frame.ranges = dram.ranges();
  return frame;
}

void expect_bytes_of_counters(const Frame0& frame, const std::string& name) {
  std::map<std::string, std::uint64_t> bytes, expected;
  for (const Recorded& request : frame.requests) bytes[request.stage] += 32;
  for (const StageCounters& stage : frame.stages)
    if (stage.dram_bytes > 0) expected[std::string(name_of(stage.stage))] += stage.dram_bytes;
  EXPECT_EQ(bytes, expected) << name;
}

void expect_disjoint_arrays(const Frame0& frame, const std::string& name) {
  std::map<std::string, DramTrace::Range> by_name;
  std::uint64_t end = 0;
  for (const DramTrace::Range& range : frame.ranges) {
    EXPECT_GE(range.begin, end) << name << ", " << range.name;
    EXPECT_LT(range.begin, range.end) << name << ", " << range.name;
    EXPECT_EQ(range.begin % 256, 0u) << name << ", " << range.name;
    EXPECT_TRUE(by_name.emplace(range.name, range).second) << name << ", " << range.name;
    end = range.end;
  }
  for (const Recorded& request : frame.requests) {
    const auto range = by_name.find(request.array);
    ASSERT_NE(range, by_name.end()) << name << ", " << request.array;
    EXPECT_EQ(request.address % 32, 0u);
    ASSERT_GE(request.address, range->second.begin) << name << ", " << request.array;
    ASSERT_LT(request.address, range->second.end) << name << ", " << request.array;
  }
}

// Two bins by two, those at the border smaller.
std::vector<std::pair<std::string, Trace>> scenes() {
  return {{"flat", random_trace(52, 40, 150, 5)}, {"materials", random_surfaces(52, 40, 60, 2)}};
}

std::vector<std::pair<std::string, FrameInput>> machines() {
  std::vector<std::pair<std::string, FrameInput>> machines = {
      {"by technique", {2}}, {"on chip", {2}}, {"in memory", {2}}, {"raw", {2}}, {"small caches", {2}}};
  machines[1].second.memory.framebuffer = Place::on_chip;
  machines[2].second.memory.framebuffer = Place::in_memory;
  machines[3].second.memory.compression = false;
  // A list and its copy larger than this L2 go through DRAM in every pass of the sort.
  MemoryParameters& small = machines[4].second.memory;
  small.l2 = {2048, 2, 128}, small.l1 = {1024, 2, 128}, small.rop = {2048, 2, 256};
  small.framebuffer = Place::in_memory;
  return machines;
}

TEST(DramTrace, HasTheBytesOfEveryStage) {
  for (const auto& [scene, trace] : scenes())
    for (const auto& [machine, run] : machines())
      for (const std::string& spec : example_specs()) {
        const Frame0 frame = record(spec, trace, run);
        expect_bytes_of_counters(frame, spec + ", " + scene + ", " + machine);
        expect_disjoint_arrays(frame, spec + ", " + scene + ", " + machine);
      }
}

TEST(DramTrace, ContinuesAHistory) {
  Trace trace = random_surfaces(52, 40, 60, 2);
  trace.frames.push_back(trace.frames[0]);
  for (const char* spec : {"taa:4", "dvm"}) {
    History history;
    FrameInput run{2};
    run.history = &history;
    parse_technique(spec).render(trace, 0, run);
    expect_bytes_of_counters(record(spec, trace, run), spec);
  }
}

TEST(DramTrace, DoesNotDependOnThreadsOrBands) {
  for (const auto& [scene, trace] : scenes())
    for (const std::string& spec : example_specs()) {
      const std::vector<Recorded> expected = record(spec, trace, {1}).requests;
      EXPECT_EQ(record(spec, trace, {3}).requests, expected) << spec << ", " << scene;
    }
  FrameInput banded{4};
  banded.memory_limit = 2 << 20;  // too little for the pairs of four bins at once
  const Trace trace = random_trace(52, 40, 150, 5);
  for (const char* spec : {"beam:order=sorted", "msaa:4"})
    EXPECT_EQ(record(spec, trace, banded).requests, record(spec, trace).requests) << spec;
}

// What is read has been written, where nothing else can have left it there.
TEST(DramTrace, ReadsWhatWasWrittenEarlier) {
  FrameInput run{2};
  run.memory.framebuffer = Place::in_memory;
  const std::set<std::string> arrays = {"setup_triangles", "attributes", "bin_lists", "bin_keys",    "depth",
                                        "samples",         "coverage",   "mask",      "accumulator", "a_buffer_heads"};
  for (const std::string& spec : example_specs()) {
    if (spec.starts_with("reference")) continue;  // its samples are in no memory
    std::set<std::uint64_t> written;
    std::size_t early = 0, found = 0;
    for (const Recorded& request : record(spec, random_trace(52, 40, 150, 5), run).requests) {
      if (request.is_write) written.insert(request.address);
      if (request.is_write || !arrays.contains(request.array)) continue;
      ++found;
      early += !written.contains(request.address);
    }
    EXPECT_GT(found, 0u) << spec;
    EXPECT_EQ(early, 0u) << spec;
  }
}

// A pass over the frame begins in its first bin when the earlier one is finished in the last.
TEST(DramTrace, ComesPassByPass) {
  const auto last = [](const std::vector<Recorded>& requests, const std::string& stage) {
    return std::find_if(requests.rbegin(), requests.rend(), [&](const auto& r) { return r.stage == stage; }).base();
  };
  const auto first = [](const std::vector<Recorded>& requests, const std::string& stage) {
    return std::find_if(requests.begin(), requests.end(), [&](const auto& r) { return r.stage == stage; });
  };
  const Trace trace = random_trace(52, 40, 150, 5);
  const std::vector<Recorded> msaa = record("msaa:4", trace).requests;
  EXPECT_LE(last(msaa, "vertex_setup"), first(msaa, "sample_raster"));
  EXPECT_LT(first(msaa, "depth_test"), last(msaa, "sample_raster")) << "one bin after the other";
  EXPECT_LE(last(msaa, "depth_test"), first(msaa, "resolve"));
  const std::vector<Recorded> taa = record("taa:4", trace).requests;
  EXPECT_LE(last(taa, "motion"), first(taa, "temporal"));
  const std::vector<Recorded> acaa = record("acaa:32", trace).requests;  // setup runs again in the second round
  EXPECT_LT(first(acaa, "accumulate"), last(acaa, "vertex_setup"));
  const std::vector<Recorded> beam = record("beam", trace).requests;
  EXPECT_LT(first(beam, "resolve"), last(beam, "conservative_raster")) << "pixels on chip: one bin after the other";
}

TEST(DramTrace, WithoutAModelNothingIsRecorded) {
  FrameInput run{2};
  run.memory.modelled = false;
  EXPECT_TRUE(record("beam:order=sorted", random_trace(52, 40, 150, 5), run).requests.empty());
}

TEST(DramTrace, TheFolderOfItsFileMustBeThere) {
  const std::string missing = testing::TempDir() + "no-such-folder";
  EXPECT_EQ(message_of<std::runtime_error>([&] { DramTrace trace(missing); }),
            missing + ": cannot create a temporary file in this folder: No such file or directory");
}

}  // namespace beampipe::dram_trace_test
