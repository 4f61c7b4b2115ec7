// Several finished runs on one page: techniques as rows, runs as columns.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/report/figures.h"
#include "tools/report/report_file.h"
#include "tools/report/tables.h"

namespace beampipe {

struct Overview {
  Table runs;                   // one row for each
  std::vector<Table> measures;  // those that a run has: errors, bytes, and modelled times with nine-in-ten ranges
  std::vector<Figure> figures;  // modelled times in turn, if there are any
};

// Of at least one report. Runs on the same hardware, with the same memory system and costs of shading, stand side by
// side, and only these have a geometric mean. `folder`: of the page; links to the runs' pages are relative to it.
// Throws ReportError or TraceError, one line that names the report.
Overview overview_of(const std::vector<ReportFile>& reports, const std::filesystem::path& folder);

}  // namespace beampipe
