#include "tools/sweep/sweep_plot.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "tools/report/colors.h"
#include "traces/closest_name.h"

namespace beampipe {
namespace {

std::size_t column_of(const std::string& option, const std::string& name, const std::vector<SweepColumn>& columns,
                      bool holds_numbers) {
  std::vector<std::string> names;
  for (const SweepColumn& column : columns) names.push_back(column.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw std::runtime_error(option + ": the table has no column '" + name + "'" + did_you_mean(name, names));
  const auto index = static_cast<std::size_t>(found - names.begin());
  if (holds_numbers && columns[index].is_text)
    throw std::runtime_error(option + ": expected a column of numbers, found '" + name + "', which holds text");
  return index;
}

std::size_t index_of(const std::string& name, const SweepTable& table) {
  return column_of("--plot", name, table.columns, false);
}

// What numbers of a column are divided by, so that an axis shows few digits.
struct AxisUnit {
  double size = 1;
  std::string name;
};

AxisUnit unit_of(const SweepTable& table, std::size_t column) {
  const SweepColumn& info = table.columns[column];
  double most = 0;
  for (const std::vector<Json>& row : table.rows)
    if (row[column].is_number()) most = std::max(most, row[column].get<double>());
  const bool is_size = info.name.starts_with("memory_system.");
  if (info.unit == "bytes" && is_size && most >= 1024) return {1024, "KiB"};
  if (info.unit == "bytes" && !is_size && most >= 1e6) return {1e6, "MB"};
  return {1, info.unit};
}

std::string title_of(const SweepColumn& column, const AxisUnit& unit) {
  return unit.name.empty() ? column.name : column.name + " (" + unit.name + ")";
}

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

}  // namespace

PlotColumns parse_plot_columns(const std::string& text, const std::vector<SweepColumn>& columns) {
  const std::string option = "--plot " + text;
  const std::size_t first = text.find(','), second = first == text.npos ? first : text.find(',', first + 1);
  if (second == text.npos || text.find(',', second + 1) != text.npos)
    throw std::runtime_error(option + ": expected X,Y,BY, three columns of the table");
  const PlotColumns names{text.substr(0, first), text.substr(first + 1, second - first - 1), text.substr(second + 1)};
  column_of(option, names.x, columns, true);
  column_of(option, names.y, columns, true);
  column_of(option, names.by, columns, false);
  return names;
}

ScatterPlot sweep_plot(const SweepTable& table, const PlotColumns& columns) {
  const std::size_t x = index_of(columns.x, table), y = index_of(columns.y, table), by = index_of(columns.by, table);
  const AxisUnit x_unit = unit_of(table, x), y_unit = unit_of(table, y);
  struct Logarithms {
    double sum = 0;
    int count = 0;
  };
  std::vector<std::string> names;  // of the lines, in the order of the table
  std::map<std::string, std::map<double, Logarithms>> lines;
  std::size_t left_out = 0, most = 1;
  for (const std::vector<Json>& row : table.rows) {
    const bool is_drawn =
        row[x].is_number() && row[y].is_number() && row[x].get<double>() > 0 && row[y].get<double>() > 0;
    if (!is_drawn) {
      ++left_out;
      continue;
    }
    const std::string name = text_of(row[by]);
    if (!lines.contains(name)) names.push_back(name);
    Logarithms& at = lines[name][row[x].get<double>() / x_unit.size];
    at.sum += std::log(row[y].get<double>() / y_unit.size);
    most = std::max<std::size_t>(most, static_cast<std::size_t>(++at.count));
  }
  ScatterPlot plot{
      .name = columns.y + "_against_" + columns.x + "_by_" + columns.by,
      .title = columns.y + " against " + columns.x + ", by " + columns.by + (most > 1 ? " (geometric means)" : ""),
      .x_label = title_of(table.columns[x], x_unit),
      .y_label = title_of(table.columns[y], y_unit),
      .series = {},
      .notes = {}};
  for (const std::string& name : names) {
    PlotSeries& series =
        plot.series.emplace_back(PlotSeries{.name = name, .color = color_at(plot.series.size()), .line = true});
    for (const auto& [at, logarithms] : lines[name])
      series.points.push_back({.x = at, .y = std::exp(logarithms.sum / logarithms.count), .label = ""});
    series.points.back().label = name;
  }
  if (left_out > 0)
    plot.notes.push_back(std::to_string(left_out) + " rows are not drawn, because " + columns.x + " or " + columns.y +
                         " is not above 0");
  return plot;
}

}  // namespace beampipe
