// Draws plots into picture files with the program gnuplot.
#pragma once

#include <string>

#include "tools/report/plot.h"

namespace beampipe {

enum class PlotFormat { svg, png };

// What gnuplot is told. Names that come from files cannot end their strings or add commands.
std::string gnuplot_script(const ScatterPlot& plot, PlotFormat format);
std::string gnuplot_script(const BarPlot& plot, PlotFormat format);

// The bytes of an SVG or PNG file with a white background. Throws std::runtime_error, one line, if gnuplot cannot be
// run or fails.
std::string draw(const ScatterPlot& plot, PlotFormat format);
std::string draw(const BarPlot& plot, PlotFormat format);

}  // namespace beampipe
