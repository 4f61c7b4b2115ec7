// Plots as data: gnuplot draws them into files, JavaScript draws them on the report page.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tools/report/report_file.h"

namespace beampipe {

struct PlotPoint {
  double x = 0, y = 0;                                            // positive: both axes are logarithmic
  std::string label;                                              // short, beside the point; empty: none
  enum class Bound { none, lower, upper } y_bound = Bound::none;  // y is at least (at most) this
};

struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;
  bool line = false;  // a line through the points, in their order
  bool marks = true;  // a mark at each point
};

// Points over two logarithmic axes.
struct ScatterPlot {
  std::string name;  // for files: "frontier"
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;
  std::vector<std::string> notes;  // what could not be drawn, one line each
};

// Bars of stacked parts, one bar per category.
struct BarPlot {
  struct Part {
    std::string name;
    std::vector<double> values;  // beside categories
  };
  std::string name, title, y_label;
  std::vector<std::string> categories;
  std::vector<Part> parts;
};

// Colours of series and parts, in order: Tableau's ten, which most eyes can tell apart, then their light twins.
extern const std::array<const char*, 20> kPlotColors;

// Peak bytes of framebuffer and A-buffer per pixel against EMR; MSAA is a line through the rungs of the ladder. Throws
// ReportError when no technique has an EMR.
ScatterPlot frontier_plot(const std::vector<ReportFile>& reports);

// Milliseconds against RMSE. `implementation` names a way in which the modelled hardware runs the techniques, "" stands
// for the wall time of the simulator. Throws ReportError when no technique has an error or such a time.
ScatterPlot speed_plot(const std::vector<ReportFile>& reports, const std::string& implementation = "");

// Megabytes per frame by stage, one bar per technique. `key`: "logical_bytes", "sector_bytes" or "dram_bytes"; nothing
// when the report's stages do not have it.
std::optional<BarPlot> bytes_plot(const ReportFile& report, const std::string& key);

// A point per stage of a technique. With modelled hardware: operations per DRAM byte against operations per second,
// under the roof of what the hardware issues and its DRAM moves; else operations per logical byte against operations
// per frame.
ScatterPlot roofline_plot(const ReportFile& report, const std::string& technique);

}  // namespace beampipe
