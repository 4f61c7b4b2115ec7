// What counting costs: the time of a frame on one thread, with the memory model and without. A build with
// BEAMPIPE_COUNT_NOTHING measures the same without the counters of stages.
#include <benchmark/benchmark.h>

#include <string>

#include "pipeline/technique.h"
#include "traces/scenes.h"

namespace beampipe {
namespace {

void render(benchmark::State& state, const std::string& spec, bool model_memory) {
  static const Trace trace = make_scene("classroom", {.width = 320, .height = 180});
  const Technique technique = parse_technique(spec);
  FrameInput options{.threads = 1};
  options.memory.modelled = model_memory;
  for (auto _ : state) benchmark::DoNotOptimize(technique.render(trace, 0, options));
}

const bool registered = [] {
  for (const std::string spec : {"beam", "beam:order=sorted", "beam:order=stream", "beam:order=stream,passes=0",
                                 "beam:rules=paper", "msaa:8", "msaa:256", "acaa:8"}) {
    for (const bool model : {false, true}) {
      benchmark::RegisterBenchmark((spec + (model ? "/memory_model" : "")).c_str(), render, spec, model)
          ->Unit(benchmark::kMillisecond);
    }
  }
  return true;
}();

}  // namespace
}  // namespace beampipe
