// The table of a sweep: one row for each cell and each hardware that its times are modelled for.
#pragma once

#include <string>
#include <vector>

#include "tools/sweep/sweep_results.h"
#include "traces/files/json.h"

namespace beampipe {

struct SweepColumn {
  std::string name;  // such as "dram_bytes" or "memory_system.l2_bytes"
  std::string unit;
  std::string meaning;
  bool is_text = false;
};

struct SweepTable {
  std::vector<SweepColumn> columns;
  std::vector<std::vector<Json>> rows;  // a value for each column: text, number, or null where there is none
  std::size_t missing = 0;              // rows of the plan that are left out, because their results are not stored
};

// Counts are means over the frames.
SweepTable make_table(const SweepPlan& plan, TraceShelf& shelf, const SweepResults& results);

// The columns that such a table has.
std::vector<SweepColumn> columns_of(const SweepPlan& plan);

// RFC 4180: a line of names, then the rows. Lines end in CR LF, and text is quoted where it must be.
std::string csv_text(const SweepTable& table);

}  // namespace beampipe
