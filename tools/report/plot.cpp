#include "tools/report/plot.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "pipeline/technique.h"
#include "tools/evaluate/known_specs.h"
#include "tools/report/colors.h"

namespace beampipe {
namespace {

constexpr const char* kEmrLabel = "equivalent MSAA rate (EMR), samples";

std::vector<std::string> specs_of(const std::vector<ReportFile>& reports) {
  std::vector<std::string> specs;
  for (const TechniqueSummary& summary : reports.front().techniques) specs.push_back(summary.spec);
  return specs;
}

// The series of that name; if there is none, adds one in the colour of `spec`.
PlotSeries& series_named(ScatterPlot& plot, const std::vector<ReportFile>& reports, const std::string& name,
                         const std::string& spec) {
  const auto is_it = [&](const PlotSeries& series) { return series.name == name; };
  const auto found = std::find_if(plot.series.begin(), plot.series.end(), is_it);
  if (found != plot.series.end()) return *found;
  plot.series.push_back({name, technique_color(specs_of(reports), spec), {}, name == kMsaaName});
  return plot.series.back();
}

void add_point(ScatterPlot& plot, const std::vector<ReportFile>& reports, const std::string& series,
               const std::string& spec, PlotPoint point) {
  if (point.x > 0 && point.y > 0) {
    series_named(plot, reports, series, spec).points.push_back(std::move(point));
  } else {
    plot.notes.push_back(spec + " is not drawn: " + (point.x > 0 ? plot.y_label : plot.x_label) +
                         " is 0, which a logarithmic axis cannot show");
  }
}

// All of msaa without options are one series, and each other technique is one of its own.
void add_point(ScatterPlot& plot, const std::vector<ReportFile>& reports, const std::string& spec, PlotPoint point) {
  add_point(plot, reports, is_msaa(spec) && spec.find(',') == spec.npos ? kMsaaName : spec, spec, std::move(point));
}

PlotSeries msaa_line() { return {kMsaaName, technique_color({}, kMsaaName), {}, true}; }

PlotPoint::Bound bound_of(const EquivalentMsaa& emr) {
  if (emr.is_lower_bound == emr.is_upper_bound) return PlotPoint::Bound::none;
  return emr.is_lower_bound ? PlotPoint::Bound::lower : PlotPoint::Bound::upper;
}

std::string scenes_text(const std::vector<ReportFile>& reports) {
  if (reports.size() == 1) return reports.front().scene;
  return "geometric mean over " + std::to_string(reports.size()) + " runs";
}

// The rungs of the longest ladder.
std::vector<LadderRung> longest_ladder(const std::vector<ReportFile>& reports) {
  const auto is_shorter = [](const ReportFile& a, const ReportFile& b) {
    return a.msaa_ladder.size() < b.msaa_ladder.size();
  };
  return std::max_element(reports.begin(), reports.end(), is_shorter)->msaa_ladder;
}

// The spec without its option `pool`, and the value of that option: "beam:bits=64,pool=24" gives "beam:bits=64" and
// "24".
std::pair<std::string, std::string> split_pool(const std::string& spec) {
  constexpr std::string_view kPool = "pool=";
  const std::size_t at = spec.find(kPool);
  if (at == spec.npos) return {spec, ""};
  const std::size_t end = std::min(spec.find(',', at), spec.size()), value = at + kPool.size();
  const std::string before = spec.substr(0, at - 1), after = end < spec.size() ? spec.substr(end + 1) : "";
  const std::string joined = after.empty() ? before : before + spec[at - 1] + after;
  return {joined, spec.substr(value, end - value)};
}

// Makes a line of a series, by increasing memory. Where its points differ in the pool, the first one alone has a full
// label.
void make_line(PlotSeries& series) {
  series.line = true;
  std::sort(series.points.begin(), series.points.end(),
            [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  for (std::size_t i = 1; i < series.points.size(); ++i)
    if (const std::string pool = split_pool(series.points[i].label).second; !pool.empty())
      series.points[i].label = pool;
}

// Of reports that have equivalent rates: others have no metric.
void require_one_metric(const std::vector<ReportFile>& reports) {
  const ReportFile* first = nullptr;
  for (const ReportFile& report : reports) {
    const std::string metric = report.json.value("metric", std::string());
    if (metric.empty()) continue;
    if (!first) first = &report;
    if (const std::string wanted = first->json.at("metric").get<std::string>(); metric != wanted)
      throw ReportError(report.folder.string() + ": expected equivalent rates by " + wanted + ", as in " +
                        first->folder.string() + ", found rates by " + metric);
  }
}

[[noreturn]] void throw_not_compared(const std::vector<ReportFile>& reports) {
  throw ReportError((reports.front().folder / "report.json").string() +
                    ": it has no errors; expected a report of `beampipe compare`, or --kind traffic for one of `run`");
}

}  // namespace

ScatterPlot frontier_plot(const std::vector<ReportFile>& reports) {
  require_one_metric(reports);
  ScatterPlot plot{.name = "frontier",
                   .title = "Memory and accuracy: " + scenes_text(reports),
                   .x_label = "memory with the A-buffer, bytes per pixel",
                   .y_label = kEmrLabel,
                   .series = {msaa_line()}};
  for (const LadderRung& rung : longest_ladder(reports)) {
    const std::string spec = msaa_spec(rung.samples);
    const double bytes = parse_technique(spec).framebuffer_bytes_per_pixel(reports.front().memory);
    add_point(plot, reports, spec, {bytes, static_cast<double>(rung.samples), spec});
  }
  bool compared = false;
  for (const TechniqueSummary& summary : mean_summaries(reports)) {
    if (!summary.emr) continue;
    compared = true;
    const bool is_on_the_line = is_msaa(summary.spec);
    if (is_on_the_line) continue;
    add_point(plot, reports, summary.spec,
              {summary.bytes_per_pixel, summary.emr->samples, summary.spec, bound_of(*summary.emr)});
  }
  if (!compared) throw_not_compared(reports);
  return plot;
}

ScatterPlot storage_plot(const std::vector<ReportFile>& reports) {
  require_one_metric(reports);
  ScatterPlot plot{.name = "storage",
                   .title = "All memory and accuracy: " + scenes_text(reports),
                   .x_label = "memory on chip and off chip, with the A-buffer, bytes per pixel",
                   .y_label = kEmrLabel,
                   .series = {msaa_line()}};
  bool compared = false;
  for (const TechniqueSummary& summary : mean_summaries(reports)) {
    if (!summary.emr) continue;
    compared = true;
    const std::string series = is_msaa(summary.spec) ? kMsaaName : split_pool(summary.spec).first;
    add_point(plot, reports, series, summary.spec,
              {summary.all_bytes_per_pixel, summary.emr->samples, summary.spec, bound_of(*summary.emr)});
  }
  if (!compared) throw_not_compared(reports);
  for (PlotSeries& series : plot.series)
    if (series.points.size() > 1) make_line(series);
  return plot;
}

ScatterPlot speed_plot(const std::vector<ReportFile>& reports, const std::string& implementation) {
  const bool modelled = !implementation.empty();
  ScatterPlot plot{.name = modelled ? "speed_" + implementation : "speed",
                   .title = "Time and error: " + scenes_text(reports),
                   .x_label = modelled ? "modelled time (" + name_of(reports.front(), implementation) +
                                             ", all stages at once), ms per frame"
                                       : "wall time of the simulator, ms per frame",
                   .y_label = "RMSE, linear light (lower is better)",
                   .series = {msaa_line()}};
  bool compared = false;
  for (const TechniqueSummary& summary : mean_summaries(reports)) {
    if (!summary.rmse || (modelled && !summary.modelled_ms.contains(implementation))) continue;
    compared = true;
    const double ms = modelled ? summary.modelled_ms.at(implementation).at_once : summary.wall_ms;
    add_point(plot, reports, summary.spec, {ms, *summary.rmse, summary.spec});
  }
  if (!compared) throw_not_compared(reports);
  std::vector<PlotPoint>& msaa = plot.series.front().points;
  std::sort(msaa.begin(), msaa.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.y > b.y; });
  return plot;
}

}  // namespace beampipe
