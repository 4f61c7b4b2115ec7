// Descriptions of hardware: one file describes one GPU.
//
// A description is a JSON file. It holds the memory system, with which bytes are counted, the rates of the units per
// clock and what their work takes in picojoules, each with its source or marked as a choice, and implementations, which
// say on which units each stage runs; every stage uses L2 and DRAM too. Rates whose names start with core_ are those of
// one core, and all others those of the GPU. The descriptions in tools/evaluate/hardware/ are built in.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/memory/parameters.h"
#include "stages/cost/counters.h"
#include "traces/files/json_form.h"

namespace beampipe {

struct Implementation {
  std::string name;
  std::map<StageId, std::vector<std::string>> units;  // of every stage but that of the reference
};

inline constexpr const char* kDramEfficiency = "dram_efficiency";  // a rate: up to 1
inline constexpr double kLeastRate = 1e-6, kMostRate = 1e12;       // so that no time becomes infinite

// What each invocation of a fragment shader costs beside what the trace's materials cost.
struct ShadingCost {
  double operations = 0;
  double fetches = 0;    // bilinear probes of a texture
  double registers = 0;  // that an invocation takes; the fewer fit, the less latency they hide
};

// Where a rate or an energy lies, as far as its source tells.
struct RateRange {
  double low = 0, high = 0;
  bool operator==(const RateRange&) const = default;
};

struct Hardware {
  std::string named;  // as the user named it: a built-in name, or a file
  std::string label;  // the built-in name, or that of the file without folder and extension
  std::string name;
  double clock_mhz = 0;
  MemoryParameters memory = {};
  std::map<std::string, double> rates;          // under the names in the file
  std::map<std::string, RateRange> ranges;      // of some of them; others are taken as exact
  std::map<std::string, RateRange> picojoules;  // of operations and bytes, under the names in the file; or none
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

// A rate that is out of range, or does not fit to another one.
struct RateConflict {
  const char* rate;
  std::string expected;
};
std::optional<RateConflict> find_conflict(const Hardware& hardware);

// The energies, in the order of the file.
const std::vector<form::Key>& hardware_energies();

// The JSON Schema of descriptions.
Json hardware_schema();

// A built-in name or a file. Throws TraceError, one line that names the file, the key, what was expected and what was
// found.
Hardware read_hardware(const std::string& name_or_file);
Hardware parse_hardware(const Json& json, const std::string& file);

// Of the hardware that a user named so.
std::string label_of(const std::string& named);

// The same hardware with these costs, in its `json` too.
Hardware with_shading_costs(const Hardware& hardware, const ShadingCost& material, const ShadingCost& light);

}  // namespace beampipe
