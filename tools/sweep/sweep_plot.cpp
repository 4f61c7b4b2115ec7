#include "tools/sweep/sweep_plot.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "tools/evaluate/results.h"
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

// Indices of the plot's columns.
struct Chosen {
  std::size_t x, y, by;
};

bool is_axis(const std::string& name) {
  return name == "technique" || name == "implementation" || name == "hardware" || name.starts_with("hardware.") ||
         name.starts_with("memory_system.");
}

bool varies(const SweepTable& table, std::size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [&](const auto& row) { return row[column] != table.rows.front()[column]; });
}

// Hardware, because a line would join what several GPUs have; and the axes in which rows differ that have the same
// trace, size, x and line, but not the same y: each of them only if those before it do not tell these rows apart.
std::vector<std::size_t> facet_columns(const SweepTable& table, const Chosen& chosen) {
  std::vector<std::size_t> same = {chosen.x, chosen.by}, facets;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    if (table.columns[i].name == "hardware" && i != chosen.by && varies(table, i))
      facets.push_back(i), same.push_back(i);
  std::vector<std::size_t> axes;
  for (std::size_t i = 0; i < table.columns.size(); ++i) (is_axis(table.columns[i].name) ? axes : same).push_back(i);
  std::erase_if(same, [&](std::size_t column) {
    const std::string& name = table.columns[column].name;
    return column != chosen.x && column != chosen.by && name != "trace" && name != "width" && name != "height";
  });
  // What is not text goes with hardware rather than the other way round.
  std::stable_partition(axes.begin(), axes.end(), [&](std::size_t axis) { return table.columns[axis].is_text; });
  for (const std::size_t axis : axes) {
    std::map<std::string, std::pair<Json, Json>> found;  // the axis' value and y, by the values of `same`
    const bool differs = std::any_of(table.rows.begin(), table.rows.end(), [&](const std::vector<Json>& row) {
      std::string key;
      for (const std::size_t column : same) key += text_of(row[column]) + "\n";
      const auto& [value, y] = found.emplace(key, std::pair(row[axis], row[chosen.y])).first->second;
      return value != row[axis] && y != row[chosen.y];
    });
    if (!differs || std::find(facets.begin(), facets.end(), axis) != facets.end()) continue;
    facets.push_back(axis);
    same.push_back(axis);
  }
  return facets;
}

// `facet`: "implementation shaders", or "" if there is one plot.
ScatterPlot plot_of(const SweepTable& table, const PlotColumns& columns, const Chosen& chosen,
                    const std::string& facet) {
  constexpr std::size_t kMostTicks = 10;
  const auto [x, y, by] = chosen;
  const AxisUnit x_unit = unit_of(table, x), y_unit = unit_of(table, y);
  struct Logarithms {
    double sum = 0;
    int count = 0;
  };
  std::vector<std::string> names;  // of the lines, in the order of the table
  std::map<std::string, std::map<double, Logarithms>> lines;
  std::set<double> all_x;
  int left_out = 0, most = 1;
  for (const std::vector<Json>& row : table.rows) {
    const bool is_drawn =
        row[x].is_number() && row[y].is_number() && row[x].get<double>() > 0 && row[y].get<double>() > 0;
    if (!is_drawn) {
      ++left_out;
      continue;
    }
    const std::string name = text_of(row[by]);
    if (!lines.contains(name)) names.push_back(name);
    Logarithms& at = lines[name][*all_x.insert(row[x].get<double>() / x_unit.size).first];
    at.sum += std::log(row[y].get<double>() / y_unit.size);
    most = std::max(most, ++at.count);
  }
  std::string file = columns.y + "_against_" + columns.x + "_by_" + columns.by;
  if (!facet.empty()) file += "_" + spec_folder(facet);
  ScatterPlot plot{.name = file,
                   .title = (facet.empty() ? columns.y + " by " + columns.by : facet) +
                            (most > 1 ? " (geometric means of " + std::to_string(most) + ")" : ""),
                   .x_label = title_of(table.columns[x], x_unit),
                   .y_label = title_of(table.columns[y], y_unit)};
  if (all_x.size() <= kMostTicks) plot.x_ticks.assign(all_x.begin(), all_x.end());
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

std::vector<ScatterPlot> sweep_plots(const SweepTable& table, const PlotColumns& columns) {
  const Chosen chosen{index_of(columns.x, table), index_of(columns.y, table), index_of(columns.by, table)};
  const std::vector<std::size_t> facets = facet_columns(table, chosen);
  std::vector<std::pair<std::string, SweepTable>> parts;  // by the values of the facets, in the order of the table
  for (const std::vector<Json>& row : table.rows) {
    std::string name;
    for (const std::size_t column : facets)
      name += (name.empty() ? "" : ", ") + table.columns[column].name + " " + text_of(row[column]);
    const auto is_it = [&](const auto& part) { return part.first == name; };
    auto found = std::find_if(parts.begin(), parts.end(), is_it);
    if (found == parts.end()) found = parts.insert(found, {name, SweepTable{table.columns, {}, 0}});
    found->second.rows.push_back(row);
  }
  std::vector<ScatterPlot> plots;
  for (const auto& [name, part] : parts) {
    plots.push_back(plot_of(part, columns, chosen, name));
    const auto same_file = [&](const ScatterPlot& plot) { return plot.name == plots.back().name; };
    if (std::count_if(plots.begin(), plots.end(), same_file) > 1)
      plots.back().name += "_" + std::to_string(plots.size());
  }
  return plots;
}

}  // namespace beampipe
