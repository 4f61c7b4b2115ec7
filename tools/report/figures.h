// The plots of one report, for the page and for files.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tools/report/plot.h"
#include "traces/files/json.h"

namespace beampipe {

using Plot = std::variant<ScatterPlot, BarPlot>;

// A place on the page that shows one of several plots of the same kind.
struct Figure {
  std::string section;  // of the page: "cost", "stages" or "causes"
  std::string title, caption;
  std::vector<std::pair<std::string, Plot>> choices;  // the label of a choice, and its plot
};

// The plot's file in the report's folder: "plots/NAME.svg". Names may come from report.json, so only letters, digits
// and . = - _ of them are kept.
std::string plot_file(const Plot& plot);

// The figures for which the report has numbers. Throws ReportError.
std::vector<Figure> report_figures(const ReportFile& report);

Json to_json(const Figure& figure);

}  // namespace beampipe
