// Plots as data. gnuplot draws them into files, and JavaScript draws them on the report page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/report/report_file.h"

namespace beampipe {

struct PlotPoint {
  double x = 0, y = 0;  // positive, because both axes are logarithmic
  std::string label;    // a short text next to the point; empty for none
  enum class Bound { none, lower, upper, beyond } bound = Bound::none;  // of y; beyond: x is too large to draw
};

struct PlotSeries {
  std::string name;
  std::string color;  // "#rrggbb"
  std::vector<PlotPoint> points = {};
  bool line = false;  // draw a line through the points, in their order
  bool marks = true;  // draw a mark at each point
};

// Points over two logarithmic axes.
struct ScatterPlot {
  std::string name;  // for files: "frontier"
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series = {};
  std::vector<std::string> notes = {};  // what could not be drawn, one line for each
  std::vector<double> x_ticks = {};     // empty: round numbers
};

// Bars of stacked parts, one bar per category. Negative values are stacked on the other side of zero.
struct BarPlot {
  struct Part {
    std::string name;
    std::string color;                     // "#rrggbb"
    std::vector<double> values;            // one per category
    std::vector<std::string> limits = {};  // likewise: what limits it; empty: not known
  };
  std::string name, title, y_label;
  std::vector<std::string> categories = {};
  std::vector<Part> parts = {};
  std::string mark_name = {};      // what `marks` are
  std::vector<double> marks = {};  // a mark on each bar; empty: none
};

// Memory (bytes per pixel off chip, at their peak) against EMR. MSAA is a line through the rungs of its ladder. Throws
// ReportError if no technique has an EMR.
ScatterPlot frontier_plot(const std::vector<ReportFile>& reports);

// The same with all memory, on chip and off chip. MSAA is a line through those of its rates that were rendered, and
// techniques that differ only in their option `pool` are a line as well.
ScatterPlot storage_plot(const std::vector<ReportFile>& reports);

// Milliseconds against RMSE. The times are modelled for the named implementation of the hardware, or, if it is "", the
// wall times of the simulator. Throws ReportError if no technique has an error and such a time.
ScatterPlot speed_plot(const std::vector<ReportFile>& reports, const std::string& implementation = "");

// Modelled milliseconds per frame by stage, one bar per technique, with a mark where all stages at once would end.
// `implementation`: one of the report's.
BarPlot time_plot(const ReportFile& report, const std::string& implementation);

// Megabytes per frame by stage, one bar per technique. `key` is "logical_bytes", "sector_bytes", "l2_bytes" or
// "dram_bytes". Nothing if there are no such bytes.
std::optional<BarPlot> bytes_plot(const ReportFile& report, const std::string& key);

// The mean square error of each technique by cause, in percent, one bar per technique. Nothing if the report has none.
std::optional<BarPlot> causes_plot(const ReportFile& report);

// One point per stage of a technique. If the report has modelled hardware: operations per DRAM byte against operations
// per second, under a roof that the hardware's issue rate and DRAM rate form. Otherwise operations per logical byte
// against operations per frame.
ScatterPlot roofline_plot(const ReportFile& report, const std::string& technique);

}  // namespace beampipe
