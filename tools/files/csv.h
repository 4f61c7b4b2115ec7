// CSV files, by RFC 4180.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "traces/files/json.h"

namespace beampipe {

// A line of names, and one for each row. Values are in quotes where they have to be; null is empty. Lines end in CR LF.
std::string csv_text(const std::vector<std::string>& names, const std::vector<std::vector<Json>>& rows);

struct CsvRow {
  std::size_t line = 0;  // where it starts, from 1
  std::vector<std::string> fields;
};

// The rows below a header, each with as many fields as that. Empty lines are left out. Throws TraceError, one line that
// names file and line, if the file cannot be read, has another header, or a row has another number of fields or quotes
// that do not end.
std::vector<CsvRow> read_csv(const std::filesystem::path& file, const std::vector<std::string>& header);

}  // namespace beampipe
