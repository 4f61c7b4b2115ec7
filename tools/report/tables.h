// The numbers of a report as tables, for the page and for CSV files.
#pragma once

#include <string>
#include <vector>

#include "tools/report/report_file.h"
#include "traces/files/json.h"

namespace beampipe {

struct Column {
  std::string key;         // in CSV files: "rmse"
  std::string title;       // on the page: "RMSE"
  std::string unit;        // "bytes"; empty for names
  std::string definition;  // one or two sentences
  std::string view = {};   // the page shows the columns of one view at a time; empty: those that are always shown
};

struct Table {
  std::string name;   // for files: "techniques"
  std::string title;  // on the page
  std::string note;   // what its numbers are
  std::vector<Column> columns;
  std::vector<std::vector<Json>> rows;  // one value per column: a number, a string or null; or, on
  // overviews, {"text", "value", "href"}: what is read, the number for it, a file
};

// The tables of techniques, of their framebuffers' surfaces, of stages, of saved work, of frames (if there are several)
// and of the published figures about this trace (if there are any). All numbers are means over the frames, except those
// of a single frame. So the sums of bytes and modelled times over a technique's stages are the numbers of the
// technique, and its numbers are the means over its frames. A column for which the report has no value is left out.
// Throws JsonError.
std::vector<Table> report_tables(const ReportFile& report);

// Makes a sentence of a definition of the registry of counters: a capital letter and a full stop.
std::string sentence(std::string definition);

// CSV (RFC 4180). The first line has the keys; null is an empty field.
std::string csv_text(const Table& table);

}  // namespace beampipe
