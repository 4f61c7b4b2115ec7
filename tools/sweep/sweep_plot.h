// Plots of a sweep's table.
#pragma once

#include <string>
#include <vector>

#include "tools/report/plot.h"
#include "tools/sweep/sweep_table.h"

namespace beampipe {

// The columns of a plot: "x,y,by".
struct PlotColumns {
  std::string x, y, by;
};

// Throws std::runtime_error, one line, unless the text names three columns, of which x and y hold numbers.
PlotColumns parse_plot_columns(const std::string& text, const std::vector<SweepColumn>& columns);

// A plot for each combination of what else the plan varies, except traces and sizes: it is in the plot's title and
// name. A line for each value of `by`. Where traces or sizes give several rows the same x, it goes through the
// geometric mean of their y, and the title says of how many. Sizes of memory are drawn in KiB, and bytes that move in
// MB. Rows whose x or y is not above 0 are left out, with a note.
std::vector<ScatterPlot> sweep_plots(const SweepTable& table, const PlotColumns& columns);

}  // namespace beampipe
