// The plots of one report, as the page shows them and as files.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tools/report/plot.h"
#include "traces/json.h"

namespace beampipe {

using Plot = std::variant<ScatterPlot, BarPlot>;

// One place on the page, which shows one of several plots of the same kind.
struct Figure {
  std::string title, caption;
  std::vector<std::pair<std::string, Plot>> choices;  // what tells them apart, and the plot
};

// Those that the report has the numbers for. Throws ReportError.
std::vector<Figure> report_figures(const ReportFile& report);

Json to_json(const Figure& figure);

}  // namespace beampipe
