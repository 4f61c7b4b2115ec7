// Modelled time: what a stage did, divided by what the named hardware does per clock.
//
// A description is a JSON file (tools/evaluate/hardware/titan_v.json is the one that is built in, with its sources):
// rates, and implementations that say which units each stage runs on. Every stage uses L2 and DRAM as well. A stage
// takes as long as its busiest unit. Units are taken to be always full: no latency, no divergence within a warp, no
// driver. So times are lower bounds, and ratios between them are what to look at.
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
  std::map<std::string, std::vector<std::string>> units;  // by stage; a stage that is not there uses L2 and DRAM alone
};

struct Hardware {
  std::string name;
  double clock_mhz = 0;
  std::map<std::string, double> rates;  // per clock, by name as in the file
  std::vector<Implementation> implementations;
  Json json;  // the whole file
};

// What is built in.
Hardware titan_v();

// Throws TraceError, one line that names the file, the key, what was expected and what was found.
Hardware read_hardware(const std::filesystem::path& file);
Hardware parse_hardware(const Json& json, const std::string& file);

// Milliseconds by unit ("triangles", "shader", "dram", ...), those that the stage uses.
std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage);

struct ModelledTime {
  double overlap_ms = 0;       // all stages at once: the busiest unit, which stages share
  double sum_ms = 0;           // one stage after the other
  std::string busiest;         // the unit
  std::vector<double> stages;  // milliseconds, one per stage
};

ModelledTime modelled_time(const Hardware& hardware, const Implementation& implementation,
                           const std::vector<StageCounters>& stages);

}  // namespace beampipe
