// Plots of a sweep's table.
#pragma once

#include <string>

#include "tools/report/plot.h"
#include "tools/sweep/sweep_table.h"

namespace beampipe {

// The columns of a plot: "x,y,by".
struct PlotColumns {
  std::string x, y, by;
};

// Throws std::runtime_error, one line, unless the text names three columns, of which x and y hold numbers.
PlotColumns parse_plot_columns(const std::string& text, const std::vector<SweepColumn>& columns);

// A line for each value of `by`. Where several rows of a line have the same x, it goes through the geometric mean of
// their y. Sizes of memory are drawn in KiB, and bytes that move in MB. Rows whose x or y is not above 0 are left out,
// with a note.
ScatterPlot sweep_plot(const SweepTable& table, const PlotColumns& columns);

}  // namespace beampipe
