// The plots of what each stage cost.

#include <algorithm>

#include "tools/report.h"
#include "tools/report/plot.h"

namespace beampipe {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMega = 1e6;

// Adds a part of that name, still 0 everywhere, unless there is one.
BarPlot::Part& part_named(BarPlot& plot, const std::string& name) {
  const auto is_it = [&](const BarPlot::Part& part) { return part.name == name; };
  const auto found = std::find_if(plot.parts.begin(), plot.parts.end(), is_it);
  if (found != plot.parts.end()) return *found;
  plot.parts.push_back({name, std::vector<double>(plot.categories.size())});
  return plot.parts.back();
}

}  // namespace

std::optional<BarPlot> bytes_plot(const ReportFile& report, const std::string& key) {
  const std::string kind = key.substr(0, key.find('_'));
  BarPlot plot{kind + "_bytes", "Memory traffic by stage: " + report.scene, kind + " bytes, MB per frame", {}, {}};
  for (const TechniqueSummary& summary : report.techniques) plot.categories.push_back(summary.spec);
  for (const Json& stage : stage_records(report)) {
    const auto bar = std::find(plot.categories.begin(), plot.categories.end(), stage.at("technique"));
    if (!stage.contains(key) || bar == plot.categories.end()) continue;
    part_named(plot, stage.at("stage")).values[static_cast<std::size_t>(bar - plot.categories.begin())] +=
        stage[key].get<double>() / stage.at("frames").get<double>() / kMega;
  }
  if (plot.parts.empty()) return std::nullopt;
  return plot;
}

ScatterPlot roofline_plot(const ReportFile& report, const std::string& technique) {
  ScatterPlot plot{"roofline_" + spec_folder(technique),
                   "Operations and bytes of each stage: " + technique + ", " + report.scene,
                   "operations per logical byte",
                   "operations, millions per frame",
                   {},
                   {}};
  for (const Json& stage : stage_records(report)) {
    if (stage.at("technique") != technique) continue;
    const std::string name = stage.at("stage");
    const double per_byte = stage.value("ops_per_byte", 0.0);
    const double ops = stage.at("ops").at("total").get<double>() / stage.at("frames").get<double>() / kMega;
    if (per_byte > 0) {
      plot.series.push_back({name, {{per_byte, ops, name}}});
    } else {
      plot.notes.push_back(name + " is not drawn: it has no operations or no bytes");
    }
  }
  return plot;
}

}  // namespace beampipe
