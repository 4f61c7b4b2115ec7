// Reads any bytes as a sweep plan and, after a NUL, as the hardware h.json that the plan may name. Each gives an error
// of one line, or a sound value.
#include <cmath>
#include <functional>

#include "pipeline/technique.h"
#include "tests/fuzz/fuzz_input.h"
#include "tools/evaluate/memory_system.h"
#include "tools/evaluate/modelled_time.h"
#include "tools/sweep/sweep_plan.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

// Calls read(), which may throw what the readers say that they throw.
void expect_value_or_line(const std::function<void()>& read) {
  try {
    read();
  } catch (const TraceError& error) {
    require_one_line(error.what());
  } catch (const SpecError& error) {
    require_one_line(error.what());
  }
}

// Its parameters make the same system again.
void check(const MemoryParameters& memory) {
  MemoryParameters again;
  const Json json = parameters_json(memory);
  const std::string file = "again";
  set_parameters(again, JsonCursor(json, file));
  require(again == memory);
}

// However much work there is, it takes a finite time.
void check(const Hardware& hardware) {
  std::vector<StageCounters> stages;
  for (const StageInfo& info : stage_list()) {
    StageCounters& stage = stages.emplace_back(StageCounters{info.id});
    for (const CounterInfo& counter : stage_counters())
      if (std::uint64_t* stored = counter.stored(stage)) *stored = std::uint64_t{1} << 40;
  }
  check(hardware.memory);
  require(!find_conflict(hardware.memory) && !hardware.implementations.empty());
  const std::vector<std::uint64_t> bins = {1, std::uint64_t{1} << 40};
  for (const Implementation& implementation : hardware.implementations)
    for (const double bin_bytes : {0.0, 1e6}) {
      const ModelledTime time = modelled_time(hardware, implementation, {stages, bin_bytes, 256, bins, bins});
      require(std::isfinite(time.in_turn_ms) && std::isfinite(time.on_cores_ms));
      require(time.at_once_ms > 0 && time.at_once_ms <= time.in_turn_ms * (1 + 1e-9));
    }
}

void check(const SweepPlan& plan) {
  require(!plan.rows.empty() && plan.rows.size() <= kMostRows && plan.hardware.size() <= kMostHardware);
  for (const SweepRow& row : plan.rows) {
    require(row.cell < plan.cells.size() && row.hardware < plan.hardware.size());
    require(row.implementation < plan.hardware[row.hardware].implementations.size());
  }
  for (const SweepCell& cell : plan.cells) {
    require(cell.trace < plan.traces.size() && cell.size < plan.sizes.size());
    require(cell.technique < plan.techniques.size() && cell.memory < plan.memory.size());
  }
  for (std::size_t i = 1; i < plan.frames.size(); ++i) require(plan.frames[i - 1] < plan.frames[i]);
  for (const std::string& spec : plan.techniques) parse_technique(spec);
  for (const MemoryParameters& memory : plan.memory) require(!find_conflict(memory));
  for (std::size_t i = 0; i < plan.hardware.size(); i += 100) check(plan.hardware[i]);
}

}  // namespace
}  // namespace beampipe

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  static const FuzzFolder folder;
  const std::vector<std::string_view> parts = parts_of(text_of(data, size), 2);
  const std::string plan = folder.write("plan.json", parts[0]).string(),
                    hardware = folder.write("h.json", parts[1]).string();
  expect_value_or_line([&] { check(read_hardware(hardware)); });
  expect_value_or_line([&] { check(read_sweep_plan(plan)); });
  return 0;
}
