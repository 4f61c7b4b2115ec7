// The registry of counters is complete, and every counter in it moves somewhere.
#include "stages/cost/counter_registry.h"

#include "pipeline/technique_table.h"
#include "tests/pipeline/surface_traces.h"
#include "tests/stages/surface_scene.h"
#include "tests/test.h"

namespace beampipe::counter_registry_test {

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
const std::map<StageId, StageCounters>& sums() {
  static const std::map<StageId, StageCounters> all = [] {
    std::map<StageId, StageCounters> by_stage;
    const Trace trace = test_trace();
    for (const std::string& spec : example_specs()) {
      History history;
      for (std::size_t frame = 0; frame < trace.frames.size(); ++frame) {
        FrameInput run{2};
        run.history = &history;
        for (const StageCounters& stage : parse_technique(spec).render(trace, frame, run).stages)
          by_stage[stage.stage.id] += stage;
      }
      for (const Trace& other : {hidden_trace(), random_surfaces(64, 48, 80, 2)})
        for (const StageCounters& stage : parse_technique(spec).render(other, 0, {2}).stages)
          by_stage[stage.stage.id] += stage;
    }
    return by_stage;
  }();
  return all;
}

TEST(CounterRegistry, HasEveryStage) {
  std::set<StageId> known, found;
  for (const StageInfo& stage : stage_list()) known.insert(stage.id);
  for (const auto& [id, counters] : sums()) found.insert(id);
  EXPECT_EQ(known, found);
}

TEST(CounterRegistry, EveryCounterMovesWhereItIsListed) {
  for (const StageInfo& stage : stage_list()) {
    for (const CounterInfo& counter : stage_counters()) {
      const std::uint64_t sum = counter.value(sums().at(stage.id));
      if (has_counter(stage, counter)) {
        EXPECT_GT(sum, 0u) << stage.name << " lists " << counter.name << ", which never moves there";
      } else {
        EXPECT_EQ(sum, 0u) << stage.name << " does not list " << counter.name << ", which moves there";
      }
    }
  }
}

// A surface with a material.
Trace lit_trace() {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(0, 0, 8, 8, 0.5, Material{});
  return scene.trace;
}

// So many small parts that a frame's pool runs out, also for small fragments.
Trace full_trace() { return parts_of_pixels(2, 20, 5); }

TEST(CounterRegistry, EveryPixelCounterMovesSomewhere) {
  std::map<std::string, float> found;
  const std::vector<Trace> traces = {test_trace(), lit_trace(), full_trace()};
  for (const TechniqueKind& kind : technique_kinds()) {
    std::set<std::string> of_kind;
    for (const Trace& trace : traces)
      for (const std::string& spec : kind.examples) {
        History history;
        for (std::size_t frame = 0; frame < trace.frames.size(); ++frame)
          for (const auto& [name, values] : parse_technique(spec).render(trace, frame, {2, &history}).pixel_counters) {
            of_kind.insert(name);
            for (const float value : values) found[name] += value;
          }
      }
    of_kind.erase("fragments"), of_kind.erase("bytes");
    EXPECT_EQ(of_kind, std::set<std::string>(kind.counters.begin(), kind.counters.end())) << title_of(kind);
  }
  for (const PixelCounterInfo& counter : pixel_counters()) {
    EXPECT_GT(found[counter.name], 0.0f) << counter.name;
    found.erase(counter.name);
  }
  for (const auto& [name, sum] : found) ADD_FAILURE() << name << " is not in the registry";
}

}  // namespace beampipe::counter_registry_test
