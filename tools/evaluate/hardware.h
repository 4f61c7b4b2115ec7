// Modelled time: the work of each stage, divided by the rates of described hardware.
//
// A description is a JSON file. It holds the rates of the hardware's units per clock, with their sources, and
// implementations, which say on which units each stage runs; every stage uses L2 and DRAM too. The description
// tools/evaluate/hardware/titan_v.json is built in. A stage takes as long as its busiest unit. The model assumes that
// units are never idle: it knows no latency, no divergence within warps and no driver. Its times are therefore lower
// bounds, and the ratios between them say more than the times themselves.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "stages/cost/counters.h"
#include "traces/json.h"

namespace beampipe {

struct Implementation {
  std::string name;
  std::map<std::string, std::vector<std::string>> units;  // by stage; a stage that is not listed uses only L2 and DRAM
};

struct Hardware {
  std::string name;
  double clock_mhz = 0;
  std::map<std::string, double> rates;  // per clock, under the names in the file
  std::vector<Implementation> implementations;
  Json json;  // the whole file
};

// The built-in description.
Hardware titan_v();

// Throws TraceError, one line that names the file, the key, what was expected and what was found.
Hardware read_hardware(const std::filesystem::path& file);
Hardware parse_hardware(const Json& json, const std::string& file);

// Milliseconds of each unit that the stage uses, by name ("triangles", "shader", "dram", ...).
std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage);

struct ModelledTime {
  double overlap_ms = 0;       // all stages at once: the time of the busiest unit, over all stages
  double sum_ms = 0;           // one stage after the other: the sum of `stages`
  std::string busiest;         // the name of that unit
  std::vector<double> stages;  // milliseconds, in the order of the stages
};

ModelledTime modelled_time(const Hardware& hardware, const Implementation& implementation,
                           const std::vector<StageCounters>& stages);

}  // namespace beampipe
