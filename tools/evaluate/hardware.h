// Modelled time: the work of each stage, divided by the rates of described hardware.
//
// A description is a JSON file. It holds the rates of the hardware's units per clock, each with its source or marked as
// a choice, and implementations, which say on which units each stage runs; every stage uses L2 and DRAM too. Those in
// tools/evaluate/hardware/ are built in. A stage takes as long as its busiest unit. The model assumes that units are
// never idle, except where bins do not fit on chip: it knows no latency, no divergence within warps and no driver. Its
// times are therefore lower bounds, and the ratios between them say more than the times themselves.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "stages/cost/counters.h"
#include "traces/files/json_form.h"

namespace beampipe {

struct Implementation {
  std::string name;
  std::map<StageId, std::vector<std::string>> units;  // a stage that is not listed uses only L2 and DRAM
};

// What each invocation of a fragment shader costs beside what the trace's materials cost.
struct ShadingCost {
  double operations = 0;
  double fetches = 0;    // bilinear probes of a texture
  double registers = 0;  // that an invocation takes; the fewer invocations fit, the slower they are
};

struct Hardware {
  std::string label;  // its built-in name, or the name of its file
  std::string name;
  double clock_mhz = 0;
  std::map<std::string, double> rates;  // under the names in the file
  std::vector<Implementation> implementations;
  // `light` is what lighting costs: in `light` where a technique has this stage, else in `shade` beside `material`.
  ShadingCost material, light;
  Json json;  // the whole file
};

// The names of the built-in descriptions, the default one first.
std::vector<std::string> hardware_names();
Hardware titan_v();

// The rates, in the order of the file.
const std::vector<form::Key>& hardware_rates();

// The JSON Schema of descriptions.
Json hardware_schema();

// A built-in name or a file. Throws TraceError, one line that names the file, the key, what was expected and what was
// found.
Hardware read_hardware(const std::string& name_or_file);
Hardware parse_hardware(const Json& json, const std::string& file);

// Names or files, with commas between them. Throws std::runtime_error if two have the same label.
std::vector<Hardware> read_hardware_list(const std::string& list);

// The same hardware with these costs, in its `json` too.
Hardware with_shading_costs(const Hardware& hardware, const ShadingCost& material, const ShadingCost& light);

// Milliseconds of each unit that the stage uses, by name ("triangles", "shader", "dram", ...). `bin_bytes`: what the
// pixels of a bin take on chip; 0 if they are in memory. A core holds as many bins as its memory has room for. If these
// are fewer than it works on at a time, the stages that work on pixels wait as much longer (stall); if not even one has
// room, the part that has none is read and written in L2 (spill).
std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage, double bin_bytes = 0);

struct StageTime {
  Stage stage;
  double ms = 0;
};

struct ModelledTime {
  double overlap_ms = 0;          // all stages at once: the time of the busiest unit, over all stages
  double sum_ms = 0;              // one stage after the other: the sum of `stages`
  std::string busiest;            // the name of that unit
  std::vector<StageTime> stages;  // in the order of the stages
};

ModelledTime modelled_time(const Hardware& hardware, const Implementation& implementation,
                           const std::vector<StageCounters>& stages, double bin_bytes = 0);

}  // namespace beampipe
