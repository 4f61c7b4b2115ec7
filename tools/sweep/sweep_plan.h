// What a sweep varies: a JSON file, read and checked as a whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/memory/parameters.h"
#include "tools/evaluate/hardware.h"
#include "tools/evaluate/picture_size.h"

namespace beampipe {

// What is rendered: one technique, one trace, one memory system. Indices into the plan's lists.
struct SweepCell {
  std::size_t trace, size, technique, memory;
  auto operator<=>(const SweepCell&) const = default;
};

// A row of the table: a cell, and the hardware whose times are modelled for it.
struct SweepRow {
  std::size_t cell, hardware, implementation;
};

struct SweepPlan {
  std::string file;
  std::vector<std::string> traces;      // files, relative to the plan's folder
  std::vector<std::string> techniques;  // specs
  std::vector<PictureSize> sizes;
  std::vector<MemoryParameters> memory;
  std::vector<Hardware> hardware;         // without `json`
  std::vector<std::string> varied_rates;  // of the hardware, by name
  std::vector<std::size_t> frames;        // rising; empty: all of each trace
  bool errors = false;                    // whether pictures are compared with the reference
  std::vector<SweepCell> cells;           // each once, in the order of the table
  std::vector<SweepRow> rows;             // of the table
};

// The most rows of a table, and the most kinds of hardware.
inline constexpr std::uint64_t kMostRows = 100'000, kMostHardware = 1'000;

// The path of a file that the plan names, which is relative to the plan's folder.
std::string file_beside_plan(const SweepPlan& plan, const std::string& name);

// Traces and other files that the plan names are relative to its folder. Traces are not read. Throws TraceError, one
// line that names the file and the key, or SpecError.
SweepPlan read_sweep_plan(const std::string& file);

// The JSON Schema of plans.
Json sweep_plan_schema();

}  // namespace beampipe
