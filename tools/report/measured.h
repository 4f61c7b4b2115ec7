// Measured times beside those that are modelled for finished runs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/evaluate/agreement.h"
#include "tools/evaluate/sensitivity.h"
#include "tools/report/plot.h"

namespace beampipe {

// A modelled time, or a quotient of two, with the interval that the ranges of the rates leave.
struct ModelledNumber {
  double value = 0;
  Interval interval = {};
};

struct MeasuredRow {
  std::string name = {}, source = {};
  double measured = 0;     // milliseconds, or a quotient of times
  bool is_fitted = false;  // it was used to choose rates, so that it says nothing about the model
  ModelledNumber in_turn = {}, at_once = {};
};

// A CSV file with the header name,folder,technique,implementation,over_folder,over_technique,measured,fitted,source.
// Folders are those of `run` or `compare`, relative to the file. With `over_technique`, a row is the quotient of both
// times; its folder is the same one unless it is given. `fitted` is empty or the word. Throws TraceError or
// ReportError, one line that names the file and the line, or the report.
std::vector<MeasuredRow> read_measured(const std::filesystem::path& file);

// Of the rows that are not fitted.
Agreement in_turn_agreement(const std::vector<MeasuredRow>& rows);
Agreement at_once_agreement(const std::vector<MeasuredRow>& rows);

// A table of the rows, and one of the statistics.
std::string measured_text(const std::vector<MeasuredRow>& rows);
Json measured_json(const std::vector<MeasuredRow>& rows);

// Modelled against measured, with the diagonal. Fitted rows are grey.
ScatterPlot measured_plot(const std::vector<MeasuredRow>& rows);

}  // namespace beampipe
