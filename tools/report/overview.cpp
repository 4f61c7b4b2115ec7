#include "tools/report/overview.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "tools/evaluate/modelled_time.h"
#include "tools/files/format.h"
#include "tools/report/colors.h"
#include "tools/report/conditions.h"
#include "tools/report/finished_run.h"
#include "tools/report/report_text.h"
#include "tools/report/times_text.h"

namespace beampipe {
namespace {

struct OverviewRun {
  const ReportFile* report = nullptr;
  std::size_t hardware = 0;    // runs with the same number can be compared
  std::string hardware_label;  // another one for every number
  std::string name;            // in the heads of columns
  Table techniques;
  Json times;  // of times_json; empty if nothing was modelled
};

// A number, or a text that stands for it. Without `number` there is no mean.
struct Cell {
  Json shown;
  std::optional<double> number = {};
};
using CellOf = std::function<Cell(const OverviewRun& run, const std::string& spec)>;

// A column of the table of techniques, in units that suit all runs.
struct Quantity {
  const char *key, *title, *unit;
  double factor;
};
constexpr Quantity kQuantities[] = {
    {"rmse", "RMSE", "linear light × 10⁻³", 1e3},
    {"emr", "Equivalent MSAA rate (EMR)", "samples per pixel", 1},
    {"on_chip_bytes_per_pixel", "Bytes on chip", "bytes per pixel", 1},
    {"peak_bytes_per_pixel", "Bytes off chip", "bytes per pixel", 1},
    {"dram_bytes", "DRAM", "MB per frame", 1e-6},
    {"dram_geometry_bytes", "DRAM, geometry alone", "MB per frame", 1e-6},
};

const Column* find_column(const Table& table, std::string_view key) {
  const auto found = std::ranges::find(table.columns, key, &Column::key);
  return found == table.columns.end() ? nullptr : &*found;
}

// Null if the run does not have it.
Json value_of(const OverviewRun& run, const std::string& spec, std::string_view key) {
  const Column* const column = find_column(run.techniques, key);
  if (!column) return nullptr;
  for (const std::vector<Json>& row : run.techniques.rows)
    if (row.front() == spec) return row.at(static_cast<std::size_t>(column - run.techniques.columns.data()));
  return nullptr;
}

const Json* find_time(const OverviewRun& run, const std::string& spec, const std::string& implementation) {
  for (const Json& row : run.times.elements())
    if (row.at("technique") == spec && row.at("implementation") == implementation) return &row;
  return nullptr;
}

std::vector<OverviewRun> runs_of(const std::vector<ReportFile>& reports) {
  std::vector<OverviewRun> runs;
  std::vector<std::string> descriptions, labels;  // of each hardware
  std::map<std::string, int> same_label;
  for (const ReportFile& report : reports) {
    const std::string description =
        Json::array({report.json.value("hardware", Json()), report.json.value("memory_system", Json())}).dump();
    const auto known = std::ranges::find(descriptions, description);
    const auto number = static_cast<std::size_t>(known - descriptions.begin());
    if (known == descriptions.end()) {
      const std::string named = read_from_report(report.folder, [&] { return hardware_label(report); });
      const std::string label = named.empty() ? "unnamed" : named;
      const int count = ++same_label[label];
      descriptions.push_back(description);
      labels.push_back(count == 1 ? label : label + " (" + std::to_string(count) + ")");
    }
    OverviewRun& run = runs.emplace_back(OverviewRun{&report, number, labels[number], report.scene, {}, Json::array()});
    run.techniques = read_from_report(report.folder, [&] { return report_tables(report).front(); });
    if (!beampipe::implementations_of(report).empty()) run.times = times_json(finished_run(report));
  }
  std::ranges::stable_sort(runs, {}, &OverviewRun::hardware);
  const auto has_twin = [&](const OverviewRun& run) {
    return std::ranges::count_if(runs, [&](const OverviewRun& other) {
             return other.hardware == run.hardware && other.report->scene == run.report->scene;
           }) > 1;
  };
  for (OverviewRun& run : runs) {
    if (has_twin(run)) run.name += " (" + run.report->folder.string() + ")";
    if (labels.size() > 1) run.name += ", " + run.hardware_label;
  }
  return runs;
}

// Of all runs, in the order in which they come.
std::vector<std::string> specs_of(const std::vector<OverviewRun>& runs) {
  std::vector<std::string> specs;
  for (const OverviewRun& run : runs)
    for (const TechniqueSummary& summary : run.report->techniques)
      if (std::ranges::find(specs, summary.spec) == specs.end()) specs.push_back(summary.spec);
  return specs;
}

std::vector<std::string> implementations_of(const std::vector<OverviewRun>& runs) {
  std::vector<std::string> names;
  for (const OverviewRun& run : runs)
    for (const std::string& name : beampipe::implementations_of(*run.report))
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  return names;
}

Table new_table(const std::string& name, const std::string& title, const std::string& note,
                const std::vector<std::string>& specs) {
  Table table{name, title, note, {{"technique", "technique", "", "The technique's spec."}}, {}};
  for (const std::string& spec : specs) table.rows.push_back({spec});
  return table;
}

// Adds a column for each run, and after those on one hardware, if they are several, their means. `head`: of them all.
void add_columns(Table& table, const std::vector<OverviewRun>& runs, const std::vector<std::string>& specs,
                 const Column& head, const CellOf& cell_of) {
  std::vector<std::vector<double>> numbers(specs.size());
  std::size_t of_hardware = 0;  // runs
  for (std::size_t i = 0; i < runs.size(); ++i) {
    table.columns.push_back({head.key + "_" + std::to_string(i), runs[i].name, head.unit, head.definition, head.view});
    for (std::size_t row = 0; row < specs.size(); ++row) {
      const Cell cell = cell_of(runs[i], specs[row]);
      table.rows[row].push_back(cell.shown);
      if (cell.number) numbers[row].push_back(*cell.number);
    }
    ++of_hardware;
    const bool is_last = i + 1 == runs.size() || runs[i + 1].hardware != runs[i].hardware;
    if (!is_last) continue;
    if (of_hardware > 1) {
      const bool is_only = of_hardware == runs.size();
      table.columns.push_back({head.key + "_mean_" + std::to_string(runs[i].hardware),
                               is_only ? "geometric mean" : "geometric mean, " + runs[i].hardware_label, head.unit,
                               "Over the runs on this hardware; a dash where one of them has no number.", head.view});
      for (std::size_t row = 0; row < specs.size(); ++row)
        table.rows[row].push_back(numbers[row].size() == of_hardware ? Json(geometric_mean(numbers[row])) : Json());
    }
    numbers.assign(specs.size(), {});
    of_hardware = 0;
  }
}

Cell number_cell(const Json& value, double factor) {
  if (value.is_null()) return {};
  const double number = value.get<double>() * factor;
  return {number, number};
}

// A bound is no number to take means of, and neither are rates by several metrics.
Cell emr_cell(const OverviewRun& run, const std::string& spec, bool has_one_metric) {
  const Json emr = value_of(run, spec, "emr"), bound = value_of(run, spec, "emr_bound");
  if (emr.is_null()) return {bound.is_null() ? Json() : Json({{"text", bound}})};
  const double samples = emr.get<double>();
  if (bound == "estimate") return {samples, has_one_metric ? std::optional(samples) : std::nullopt};
  return {{{"value", samples}, {"text", emr_text({samples, bound == "at least", bound == "at most"})}}};
}

Cell time_cell(const Json* row, const std::string& kind) {
  if (!row) return {};
  const double ms = row->at(kind).get<double>();
  const Json& interval = row->at(kind + "_interval");
  const std::string text =
      format("%.3g (%.3g to %.3g)", ms, interval.at(0).get<double>(), interval.at(1).get<double>());
  return {{{"value", ms}, {"text", text}}, ms};
}

Table runs_table(const std::vector<OverviewRun>& runs, const std::filesystem::path& folder) {
  Table table{"runs", "Runs", "", {}, {}};
  table.columns = {{"scene", "scene", "", "The name of the trace's file."},
                   {"folder", "folder", "", "The folder of the run, with a link to its page if it has one."},
                   {"picture", "picture", "", "The size of the picture, and how many frames."},
                   {"hardware", "hardware", "", "The GPU whose times are modelled."},
                   {"command", "command", "", "What made the run, without its folder."},
                   {"program", "program", "", "The version that made it, its threads and instruction set."}};
  for (const OverviewRun& run : runs) {
    const std::filesystem::path page = run.report->folder / "report.html";
    Json place = {{"text", run.report->folder.string()}};
    if (std::filesystem::exists(page)) place["href"] = std::filesystem::relative(page, folder).generic_string();
    std::map<std::string, Json> texts;
    const Json conditions = read_from_report(run.report->folder, [&] { return report_conditions(*run.report); });
    for (const Json& each : conditions.elements()) texts[each.at(0).get<std::string>()] = each.at(1);
    table.rows.push_back(
        {run.report->scene, place, texts["picture"], run.hardware_label, texts["command"], texts["program"]});
  }
  return table;
}

std::vector<Table> measure_tables(const std::vector<OverviewRun>& runs, const std::vector<std::string>& specs) {
  std::set<std::string> metrics;
  for (const OverviewRun& run : runs)
    if (const Json* const metric = run.report->json.find("metric")) metrics.insert(metric->dump());
  std::vector<Table> tables;
  for (const Quantity& quantity : kQuantities) {
    const auto has_it = [&](const OverviewRun& run) { return find_column(run.techniques, quantity.key) != nullptr; };
    const auto run = std::ranges::find_if(runs, has_it);
    if (run == runs.end()) continue;
    const std::string definition = find_column(run->techniques, quantity.key)->definition;
    Table& table = tables.emplace_back(new_table(quantity.key, quantity.title, definition, specs));
    add_columns(table, runs, specs, {quantity.key, "", quantity.unit, definition},
                [&](const OverviewRun& each, const std::string& spec) {
                  return quantity.key == std::string("emr")
                             ? emr_cell(each, spec, metrics.size() <= 1)
                             : number_cell(value_of(each, spec, quantity.key), quantity.factor);
                });
  }
  for (const std::string& implementation : implementations_of(runs)) {
    Table& table = tables.emplace_back(
        new_table("time_" + implementation, "Modelled time: " + implementation,
                  "In brackets the range of nine in ten of these times, if rates are drawn from the ranges of the "
                  "hardware. Times follow from the counts of the runs, as in beampipe model.",
                  specs));
    for (const TimeKind& kind : kTimes)
      add_columns(table, runs, specs, {kind.key, "", "ms per frame", kind.meaning, kind.title},
                  [&](const OverviewRun& run, const std::string& spec) {
                    return time_cell(find_time(run, spec, implementation), kind.key);
                  });
  }
  return tables;
}

// A bar for each run and technique, in the colour of the technique.
BarPlot times_plot(const std::vector<OverviewRun>& runs, const std::vector<std::string>& specs,
                   const std::string& implementation) {
  BarPlot plot{"times_" + implementation, "Modelled time in turn: " + implementation,
               "modelled time in turn (" + implementation + "), ms per frame"};
  std::vector<std::pair<std::string, double>> bars;
  for (const OverviewRun& run : runs)
    for (const std::string& spec : specs)
      if (const Json* const time = find_time(run, spec, implementation)) {
        plot.categories.push_back(run.name + ": " + spec);
        bars.emplace_back(spec, time->at("in_turn").get<double>());
      }
  for (const std::string& spec : specs) {
    BarPlot::Part part{spec, technique_color(specs, spec), {}};
    for (const auto& [of_bar, ms] : bars) part.values.push_back(of_bar == spec ? ms : 0);
    plot.parts.push_back(std::move(part));
  }
  return plot;
}

}  // namespace

Overview overview_of(const std::vector<ReportFile>& reports, const std::filesystem::path& folder) {
  const std::vector<OverviewRun> runs = runs_of(reports);
  const std::vector<std::string> specs = specs_of(runs);
  Figure figure{"cost", "Modelled time", "One stage after the other. The tables have the ranges of these times.", {}};
  for (const std::string& implementation : implementations_of(runs))
    figure.choices.emplace_back(implementation, times_plot(runs, specs, implementation));
  Overview overview{runs_table(runs, folder), measure_tables(runs, specs), {}};
  if (!figure.choices.empty()) overview.figures.push_back(std::move(figure));
  return overview;
}

}  // namespace beampipe
