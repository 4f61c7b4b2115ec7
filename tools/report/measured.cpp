#include "tools/report/measured.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "tools/evaluate/mean_time.h"
#include "tools/files/csv.h"
#include "tools/files/format.h"
#include "tools/report/colors.h"
#include "tools/report/finished_run.h"
#include "tools/report/report_text.h"
#include "traces/files/input_file.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kHeader = {"name",           "folder",   "technique", "implementation", "over_folder",
                                          "over_technique", "measured", "fitted",    "source"};
constexpr double kLeast = 1e-9, kMost = 1e9;  // measured; so that no quotient becomes infinite

class Reader {
 public:
  explicit Reader(fs::path file) : file_(std::move(file)) {}

  std::vector<MeasuredRow> rows() {
    std::vector<MeasuredRow> rows;
    for (const CsvRow& row : read_csv(file_, kHeader)) {
      row_ = &row;
      rows.push_back(row_of_fields());
    }
    return rows;
  }

 private:
  const std::string& field(const std::string& name) const {
    return row_->fields[static_cast<std::size_t>(std::find(kHeader.begin(), kHeader.end(), name) - kHeader.begin())];
  }
  [[noreturn]] void fail(const std::string& name, const std::string& expected, const std::string& found) const {
    fail_trace(file_.string() + ", line " + std::to_string(row_->line) + ", " + name, expected,
               found.empty() ? "nothing" : in_quotes(found));
  }

  MeasuredRow row_of_fields() {
    MeasuredRow row{.name = field("name"), .source = field("source"), .measured = measured()};
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
    if (row.name.empty() || std::any_of(row.name.begin(), row.name.end(), is_control))
      fail("name", "a name without control characters", row.name);
    if (row.source.empty()) fail("source", "where the number is from", "");
    row.is_fitted = !field("fitted").empty();
    if (row.is_fitted && field("fitted") != "fitted") fail("fitted", "fitted or nothing", field("fitted"));
    if (field("folder").empty()) fail("folder", "a folder that run wrote", "");
    const std::string& over = field("over_folder");
    if (field("over_technique").empty() && !over.empty()) fail("over_technique", "a technique beside over_folder", "");
    const DrawnTime times = times_of(field("folder"), "technique");
    std::optional<DrawnTime> by;
    if (!field("over_technique").empty()) by = times_of(over.empty() ? field("folder") : over, "over_technique");
    row.in_turn = number(times, by, &ModelledTime::in_turn_ms);
    row.at_once = number(times, by, &ModelledTime::at_once_ms);
    return row;
  }

  double measured() const {
    const std::string& text = field("measured");
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value >= kLeast && value <= kMost))
      fail("measured", "milliseconds or a quotient, 1e-9 to 1e9", text);
    return value;
  }

  // `key`: of the field that has the technique.
  DrawnTime times_of(const std::string& folder, const std::string& key) {
    const fs::path path = file_.parent_path() / folder;
    if (!reports_.contains(path)) reports_.emplace(path, finished_run(path));
    const Report& report = reports_.at(path);
    const auto result = std::find_if(report.results.begin(), report.results.end(),
                                     [&](const TechniqueReport& each) { return each.technique == field(key); });
    if (result == report.results.end() || result->frames.empty())
      fail(key, "a technique of " + path.string(), field(key));
    const std::vector<Implementation>& all = report.hardware.implementations;
    const auto way = std::find_if(all.begin(), all.end(),
                                  [&](const Implementation& each) { return each.name == field("implementation"); });
    if (way == all.end()) fail("implementation", "one of the hardware of " + path.string(), field("implementation"));
    const auto number = static_cast<std::size_t>(way - all.begin());
    return drawn_time(report.hardware, drawn_hardware(report.hardware), number, *result);
  }

  ModelledNumber number(const DrawnTime& times, const std::optional<DrawnTime>& over, double ModelledTime::*ms) const {
    const double value = over ? times.described.*ms / over->described.*ms : times.described.*ms;
    const Interval interval = over ? times.interval_over(*over, ms) : times.interval(ms);
    for (const double each : {value, interval.low, interval.high})
      if (!(each > 0 && std::isfinite(each))) fail("technique", "a modelled time above 0", format("%g", each));
    return {value, interval};
  }

  fs::path file_;
  const CsvRow* row_ = nullptr;
  std::map<fs::path, Report> reports_;
};

Agreement agreement(const std::vector<MeasuredRow>& rows, ModelledNumber MeasuredRow::*modelled) {
  std::vector<MeasuredAndModelled> numbers;
  for (const MeasuredRow& row : rows)
    if (!row.is_fitted) numbers.push_back({row.measured, (row.*modelled).value});
  return agreement_of(numbers);
}

std::string number_text(const ModelledNumber& number) {
  return format("%.3g", number.value) + " (" + format("%.3g", number.interval.low) + " to " +
         format("%.3g", number.interval.high) + ")";
}

std::string statistic(const std::optional<double>& value, const char* form, double times = 1) {
  return value ? format(form, *value * times) : "-";
}

std::vector<std::string> statistics_row(const std::string& name, const Agreement& of) {
  return {name,
          std::to_string(of.count),
          statistic(of.mape, "%.0f %%", 100),
          statistic(of.geometric_mean, "%.2f"),
          statistic(of.spread, "%.2f"),
          statistic(of.spearman, "%.2f")};
}

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json json_of(const Agreement& of) {
  return {{"rows", of.count},
          {"mape", json_of(of.mape)},
          {"geometric_mean", json_of(of.geometric_mean)},
          {"spread", json_of(of.spread)},
          {"spearman", json_of(of.spearman)}};
}

Json json_of(const ModelledNumber& number, double measured) {
  return {{"modelled", number.value},
          {"interval", Json::array({number.interval.low, number.interval.high})},
          {"over_measured", number.value / measured}};
}

}  // namespace

std::vector<MeasuredRow> read_measured(const fs::path& file) { return Reader(file).rows(); }

Agreement in_turn_agreement(const std::vector<MeasuredRow>& rows) { return agreement(rows, &MeasuredRow::in_turn); }
Agreement at_once_agreement(const std::vector<MeasuredRow>& rows) { return agreement(rows, &MeasuredRow::at_once); }

std::string measured_text(const std::vector<MeasuredRow>& all) {
  std::vector<std::vector<std::string>> rows = {
      {"name", "measured", "in turn (nine in ten)", "over measured", "at once (nine in ten)", "over measured", ""}};
  for (const MeasuredRow& row : all)
    rows.push_back({row.name, format("%.3g", row.measured), number_text(row.in_turn),
                    format("%.2f", row.in_turn.value / row.measured), number_text(row.at_once),
                    format("%.2f", row.at_once.value / row.measured), row.is_fitted ? "fitted" : ""});
  return align_columns(rows, {0, 6}) + "\n" +
         align_columns({{"without fitted rows", "rows", "MAPE", "geometric mean", "spread", "rank correlation"},
                        statistics_row("in turn", in_turn_agreement(all)),
                        statistics_row("at once", at_once_agreement(all))},
                       {0});
}

Json measured_json(const std::vector<MeasuredRow>& all) {
  Json rows = Json::array();
  for (const MeasuredRow& row : all)
    rows.push_back({{"name", row.name},
                    {"source", row.source},
                    {"fitted", row.is_fitted},
                    {"measured", row.measured},
                    {"in_turn", json_of(row.in_turn, row.measured)},
                    {"at_once", json_of(row.at_once, row.measured)}});
  return {{"rows", rows}, {"in_turn", json_of(in_turn_agreement(all))}, {"at_once", json_of(at_once_agreement(all))}};
}

ScatterPlot measured_plot(const std::vector<MeasuredRow>& rows) {
  constexpr const char *kGrey = "#a0a0a0", *kLine = "#606060";
  PlotSeries line{.name = "diagonal", .color = kLine, .line = true, .marks = false};
  PlotSeries in_turn{"in turn", color_at(1)}, at_once{"at once", color_at(0)}, fitted{"fitted", kGrey};
  double low = HUGE_VAL, high = 0;
  for (const MeasuredRow& row : rows) {
    for (const double value : {row.measured, row.in_turn.value, row.at_once.value})
      low = std::min(low, value), high = std::max(high, value);
    (row.is_fitted ? fitted : in_turn).points.push_back({row.measured, row.in_turn.value, ""});
    (row.is_fitted ? fitted : at_once).points.push_back({row.measured, row.at_once.value, row.name});
  }
  if (!rows.empty()) line.points = {{low, low, ""}, {high, high, ""}};
  return {.name = "measured",
          .title = "Modelled and measured: one stage after the other (unnamed points), all at once (named)",
          .x_label = "measured, ms or quotient",
          .y_label = "modelled",
          .series = {line, in_turn, at_once, fitted}};
}

}  // namespace beampipe
