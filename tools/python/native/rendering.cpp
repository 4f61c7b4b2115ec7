// Techniques, what they render, and pixels explained.
#include <pybind11/stl.h>

#include "pipeline/techniques/msaa.h"
#include "tools/evaluate/hardware.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/machine_memory.h"
#include "tools/evaluate/memory_system.h"
#include "tools/evaluate/modelled_time.h"
#include "tools/evaluate/msaa_ladder.h"
#include "tools/evaluate/render.h"
#include "tools/evaluate/results.h"
#include "tools/inspect/inspection.h"
#include "tools/inspect/inspection_json.h"
#include "tools/inspect/inspection_text.h"
#include "tools/python/native/bindings.h"
#include "tools/python/native/interruptible.h"
#include "tools/python/native/trace_handle.h"

namespace beampipe {
namespace {

namespace py = pybind11;

FrameInput input_of(const TraceHandle& trace, std::size_t frame, const Technique& technique, int threads,
                    const MemoryParameters& memory) {
  if (threads < 0 || threads > 1024)
    throw std::runtime_error("threads: expected 1 to 1024, or 0 for one per core, found " + std::to_string(threads));
  require_memory(trace.trace(), frame_of(trace, frame), technique.working_bytes_per_pixel,
                 "frame " + std::to_string(frame) + " with " + technique.spec, machine_memory());
  return {.threads = threads, .memory = memory, .memory_limit = machine_memory() / 2, .textures = &trace.textures()};
}

py::dict counters_of(const StageCounters& stage) {
  py::dict counters;
  for (const CounterInfo& counter : stage_counters())
    if (has_counter(info_of(stage.stage.id), counter)) counters[counter.name] = counter.value(stage);
  return counters;
}

// By implementation.
py::dict times_of(const FrameReport& counted, const Hardware& hardware) {
  py::dict all;
  for (const Implementation& implementation : hardware.implementations) {
    const ModelledTime time = modelled_time(hardware, implementation, counted.work());
    py::dict one;
    for (const TimeKind& kind : kTimes) one[kind.key] = time.*kind.ms;
    one["busiest"] = time.busiest;
    all[implementation.name.c_str()] = one;
  }
  return all;
}

py::dict to_python(const FrameResult& result) {
  const Image& image = result.image;
  const py::ssize_t width = image.width, height = image.height;
  py::dict counters, stages, buffers;
  for (const auto& [name, values] : result.pixel_counters) counters[name.c_str()] = array_of(values, {height, width});
  for (const StageCounters& stage : result.stages)
    stages[std::string(name_of(stage.stage)).c_str()] = counters_of(stage);
  for (const Buffer& buffer : result.buffers) buffers[buffer.name.c_str()] = buffer.peak_bytes;
  if (result.a_buffer_peak_bytes > 0) buffers["a_buffer"] = result.a_buffer_peak_bytes;
  py::dict all;
  all["rgba"] = array_of(image.rgba, {height, width, 4});
  all["counters"] = counters;
  all["stages"] = stages;
  all["buffers"] = buffers;
  return all;
}

py::dict render(const TraceHandle& trace, const Technique& technique, std::size_t frame, int threads, bool memory_model,
                const std::string& named, History* history) {
  const Hardware hardware = read_hardware(named);
  MemoryParameters memory = hardware.memory;
  memory.modelled = memory_model;
  if (lacks_bins(memory, technique))
    throw std::runtime_error(technique.spec + " needs bins, and " + hardware.named + " has none");
  FrameInput input = input_of(trace, frame, technique, threads, memory);
  input.history = history;
  const FrameResult result = interruptible([&](const std::atomic<bool>& cancelled) {
    input.cancelled = &cancelled;
    return technique.render(trace.trace(), frame, input);
  });
  TechniqueReport report = new_technique_report(technique, memory);
  FrameReport counted;
  add_counters(result, counted);
  report.frames.push_back(counted);
  py::dict all = to_python(result);
  all["times"] = memory_model && !is_reference(technique.spec) ? times_of(counted, hardware) : py::dict();
  all["on_chip_bytes_per_pixel"] = report.on_chip_bytes_per_pixel();
  all["off_chip_bytes_per_pixel"] = report.peak_bytes_per_pixel();
  return all;
}

// The inspection as JSON and as text.
py::tuple inspect_pixel(const TraceHandle& trace, const Technique& technique, std::uint32_t x, std::uint32_t y,
                        std::size_t frame, int threads) {
  require_inspectable(technique);
  MemoryParameters memory = titan_v().memory;
  memory.modelled = false;
  FrameInput input = input_of(trace, frame, technique, threads, memory);
  const Frame& of = frame_of(trace, frame);
  if (x >= of.width || y >= of.height)
    throw std::runtime_error("pixel " + std::to_string(x) + "," + std::to_string(y) + ": expected x from 0 to " +
                             std::to_string(of.width - 1) + " and y from 0 to " + std::to_string(of.height - 1));
  const std::vector<PixelInspection> found = interruptible([&](const std::atomic<bool>& cancelled) {
    input.cancelled = &cancelled;
    return inspect(trace.trace(), frame, technique, {{x, y}}, input);
  });
  return py::make_tuple(to_json(found.front()).dump(), inspection_text(found.front(), trace.name(), true));
}

}  // namespace

void add_rendering(py::module_& module) {
  py::class_<History>(module, "History").def(py::init<>());
  py::class_<Technique>(module, "Technique")
      .def(py::init([](const std::string& spec) { return parse_technique(spec); }))
      .def_readonly("spec", &Technique::spec)
      .def_property_readonly("rung", [](const Technique& self) { return is_rung(self) ? self.samples : 0; })
      .def_readonly("keeps_history", &Technique::keeps_history);
  module.def("msaa_at", [](const std::string& name, const std::vector<std::array<int, 2>>& places) {
    std::vector<glm::ivec2> converted;
    for (const auto& [x, y] : places) converted.emplace_back(x, y);
    Technique technique = msaa_at(converted);
    technique.spec = name;
    return technique;
  });
  module.def("techniques", &technique_help);
  module.def("check_hardware", [](const std::string& named) { read_hardware(named); });
  module.def("render", &render);
  module.def("inspect", &inspect_pixel);
  module.attr("reference_spec") = kReferenceSpec;
  module.attr("second_reference_spec") = kSecondReferenceSpec;
}

}  // namespace beampipe
