// The numbers of a report as tables: for the page, and as CSV files.
#pragma once

#include <string>
#include <vector>

#include "tools/report/report_file.h"
#include "traces/json.h"

namespace beampipe {

struct Column {
  std::string key;         // in CSV files: "rmse"
  std::string title;       // on the page: "RMSE"
  std::string unit;        // "bytes"; empty for names
  std::string definition;  // one or two sentences
};

struct Table {
  std::string name;   // for files: "techniques"
  std::string title;  // on the page
  std::vector<Column> columns;
  std::vector<std::vector<Json>> rows;  // beside columns: a number, a string, or null
};

// Techniques, surfaces of their framebuffers, stages, frames (when there are several), claims (when there are some).
// A column of which the report has no value is left out. Throws ReportError.
std::vector<Table> report_tables(const ReportFile& report);

// A definition as the registry of counters has it, as a sentence.
std::string sentence(std::string definition);

// RFC 4180, one line of keys in front; null is an empty field.
std::string csv_text(const Table& table);

}  // namespace beampipe
