// The plots of the cost of stages.

#include <algorithm>
#include <functional>

#include "stages/cost/stage.h"
#include "tools/evaluate/hardware_units.h"
#include "tools/evaluate/results.h"
#include "tools/report/colors.h"
#include "tools/report/plot.h"

namespace beampipe {
namespace {

constexpr double kMega = 1e6;

// The part of that name. If there is none, adds one in this colour that is 0 everywhere.
BarPlot::Part& part_named(BarPlot& plot, const std::string& name, const std::string& color) {
  const auto is_it = [&](const BarPlot::Part& part) { return part.name == name; };
  const auto found = std::find_if(plot.parts.begin(), plot.parts.end(), is_it);
  if (found != plot.parts.end()) return *found;
  plot.parts.push_back({name, color, std::vector<double>(plot.categories.size())});
  return plot.parts.back();
}

// A bar for each technique that has stages, with a part for each stage for which `value` has one.
BarPlot bars_of_stages(const ReportFile& report, BarPlot plot,
                       const std::function<std::optional<double>(const Json& stage)>& value) {
  const std::vector<Json> stages = stage_records(report);
  for (const TechniqueSummary& summary : report.techniques)
    if (std::ranges::any_of(stages, [&](const Json& stage) { return stage.at("technique") == summary.spec; }))
      plot.categories.push_back(summary.spec);
  for (const Json& stage : stages) {
    const auto bar =
        std::find(plot.categories.begin(), plot.categories.end(), stage.at("technique").get<std::string>());
    const std::optional<double> amount = value(stage);
    if (!amount || bar == plot.categories.end()) continue;
    const std::string name = stage.at("stage").get<std::string>();
    part_named(plot, name, stage_color(name)).values[static_cast<std::size_t>(bar - plot.categories.begin())] +=
        *amount;
  }
  std::ranges::stable_sort(plot.parts, {}, [](const BarPlot::Part& part) {
    const std::optional<Stage> stage = find_stage(part.name);
    return stage ? stage->number() : kStageNumbers;  // in the order of the pipeline
  });
  return plot;
}

bool is_zero(const BarPlot::Part& part) {
  return std::all_of(part.values.begin(), part.values.end(), [](double value) { return value == 0; });
}

// The highest rates of the modelled hardware.
struct Roof {
  std::string implementation;             // the first in the description
  double operations = 0, dram_bytes = 0;  // billions per second
};

// Nothing if no hardware was modelled.
std::optional<Roof> roof_of(const ReportFile& report) {
  if (!report.json.contains("hardware") || implementations_of(report).empty()) return std::nullopt;
  const Json& hardware = report.json.at("hardware");
  const Json& rates = hardware.at("rates");
  const double cores = report.json.at("memory_system").at("cores").get<double>();
  const double gigahertz = hardware.at("clock_mhz").get<double>() / 1000;
  const Json::Object& implementations = hardware.at("implementations").members();
  if (implementations.empty()) throw JsonError("expected hardware with an implementation, found none");
  return Roof{implementations.front().key, gigahertz * cores * rates.at("core_issue_per_clk").get<double>(),
              gigahertz * rates.at("dram_bytes_per_clk").get<double>() * rates.value(kDramEfficiency, 1.0)};
}

// Do fixed functions do the stage? The roof is that of shaders.
bool is_of_fixed_functions(const ReportFile& report, const std::string& implementation, const std::string& stage) {
  const std::optional<Stage> known = find_stage(stage);
  if (!known) return false;
  const Json& described = report.json.at("hardware").at("implementations").at(implementation);
  const Json units = described.value("units", Json::object());
  const Json list = units.value(std::string(info_of(known->id).name), Json::array());
  return std::ranges::any_of(list.elements(), [](const Json& name) {
    return std::ranges::any_of(hardware_units(), [&](const HardwareUnit& unit) {
      return unit.kind == HardwareUnit::Kind::fixed_function && name == unit.name;
    });
  });
}

// Puts stages that move no DRAM bytes to the right of all others.
void place_beyond(const Roof& roof, ScatterPlot& plot) {
  double right = roof.operations / roof.dram_bytes;
  for (const PlotSeries& series : plot.series) right = std::max(right, series.points.front().x);
  for (PlotSeries& series : plot.series)
    if (series.points.front().bound == PlotPoint::Bound::beyond) series.points.front().x = 2 * right;
}

// A line that rises from left of the leftmost stage, as long as DRAM is the limit, and then runs flat until right of
// the rightmost stage.
PlotSeries roof_line(const Roof& roof, const ScatterPlot& plot) {
  const double ridge = roof.operations / roof.dram_bytes;
  double left = ridge, right = ridge;
  for (const PlotSeries& series : plot.series) {
    left = std::min(left, series.points.front().x);
    right = std::max(right, series.points.front().x);
  }
  PlotSeries line{"roof: DRAM, then issue", "#888888", {}, true, false};
  for (const double x : {left / 2, ridge, right * 2}) {
    line.points.push_back({x, std::min(roof.operations, x * roof.dram_bytes), ""});
  }
  return line;
}

}  // namespace

BarPlot time_plot(const ReportFile& report, const std::string& implementation) {
  BarPlot plot = bars_of_stages(report,
                                {"time_" + implementation, "Modelled time by stage: " + report.scene,
                                 "modelled time (" + name_of(report, implementation) + "), ms per frame"},
                                [&](const Json& stage) -> std::optional<double> {
                                  const Json* const times = stage.find("modelled_ms");
                                  return times ? std::optional(times->at(implementation).get<double>()) : std::nullopt;
                                });
  for (const Json& stage : stage_records(report)) {
    const auto bar =
        std::find(plot.categories.begin(), plot.categories.end(), stage.at("technique").get<std::string>());
    const auto part = std::ranges::find(plot.parts, stage.at("stage").get<std::string>(), &BarPlot::Part::name);
    const Json* const limits = stage.find("busiest");
    if (!limits || bar == plot.categories.end() || part == plot.parts.end()) continue;
    part->limits.resize(plot.categories.size());
    part->limits[static_cast<std::size_t>(bar - plot.categories.begin())] =
        limits->value(implementation, std::string());
  }
  plot.mark_name = "all stages at once";
  for (const TechniqueSummary& summary : report.techniques)
    if (const auto ms = summary.modelled_ms.find(implementation); ms != summary.modelled_ms.end())
      plot.marks.push_back(ms->second.at_once);
  return plot;
}

std::optional<BarPlot> bytes_plot(const ReportFile& report, const std::string& key) {
  const std::string kind = key.substr(0, key.find('_')), label = kind == "dram" ? "DRAM" : kind == "l2" ? "L2" : kind;
  BarPlot plot = bars_of_stages(
      report, {kind + "_bytes", "Memory traffic by stage: " + report.scene, label + " bytes, MB per frame"},
      [&](const Json& stage) -> std::optional<double> {
        const Json* const bytes = stage.find(key);
        return bytes ? std::optional(bytes->get<double>() / kMega) : std::nullopt;
      });
  std::erase_if(plot.parts, is_zero);
  if (plot.parts.empty()) return std::nullopt;
  return plot;
}

std::optional<BarPlot> causes_plot(const ReportFile& report) {
  BarPlot plot{"causes", "Error by cause: " + report.scene, "part of the mean square error, percent"};
  std::vector<const Json*> found;
  for (const Json& result : report.json.at("results").elements()) {
    const Json* const causes = result.find("error_causes");
    if (!causes) continue;
    plot.categories.push_back(result.at("technique").get<std::string>());
    found.push_back(causes);
  }
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const auto& [cause, part] : found[i]->members())
      part_named(plot, cause, cause_color(cause)).values[i] = 100 * part.get<double>();
  if (plot.parts.empty()) return std::nullopt;
  return plot;
}

ScatterPlot roofline_plot(const ReportFile& report, const std::string& technique) {
  const std::optional<Roof> roof = roof_of(report);
  ScatterPlot plot{.name = "roofline_" + spec_folder(technique),
                   .title = "Operations and bytes of each stage: " + technique + ", " + report.scene,
                   .x_label = roof ? "operations per DRAM byte" : "operations per logical byte",
                   .y_label = roof ? "operations per second (" + name_of(report, roof->implementation) + "), billions"
                                   : "operations, millions per frame"};
  std::string left_out, of_fixed_functions, beyond;
  const auto add_name = [](std::string& names, const std::string& name) {
    names += (names.empty() ? "" : ", ") + name;
  };
  for (const Json& stage : stage_records(report)) {
    const Json* const times = stage.find("modelled_ms");  // those of references have none
    if (stage.at("technique") != technique || (roof && !times)) continue;
    const std::string name = stage.at("stage").get<std::string>();
    if (roof && is_of_fixed_functions(report, roof->implementation, name)) {
      add_name(of_fixed_functions, name);
      continue;
    }
    const double ops = stage.at("ops").at("total").get<double>(),
                 bytes = stage.at(roof ? "dram_bytes" : "logical_bytes").get<double>();
    const double ms = roof ? times->at(roof->implementation).get<double>() : 1;
    const double height = roof ? ops / ms / 1e6 : ops / kMega;
    if (ops > 0 && bytes > 0 && ms > 0) {
      plot.series.push_back({name, stage_color(name), {{ops / bytes, height, name}}});
    } else if (roof && ops > 0 && ms > 0) {
      add_name(beyond, name);
      plot.series.push_back({name, stage_color(name), {{0, height, name, PlotPoint::Bound::beyond}}});
    } else {
      add_name(left_out, name);
    }
  }
  if (roof) place_beyond(*roof, plot);
  if (!beyond.empty()) plot.notes.push_back("At the right edge, as they move no DRAM bytes: " + beyond + ".");
  if (!of_fixed_functions.empty())
    plot.notes.push_back(
        "Not drawn, because the roof is that of shaders, and fixed functions do the work: " + of_fixed_functions + ".");
  if (!left_out.empty())
    plot.notes.push_back(std::string("Not drawn, because they have no operations") + (roof ? "" : " or no bytes") +
                         ": " + left_out + ".");
  if (roof && !plot.series.empty()) plot.series.push_back(roof_line(*roof, plot));
  return plot;
}

}  // namespace beampipe
