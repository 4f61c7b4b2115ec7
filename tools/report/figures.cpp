#include "tools/report/figures.h"

#include "tools/evaluate/results.h"

namespace beampipe {
namespace {

constexpr const char* kBounds[] = {"none", "lower", "upper"};  // of PlotPoint::Bound

Json to_json(const ScatterPlot& plot) {
  Json json = {{"kind", "scatter"},       {"name", plot.name},       {"title", plot.title},
               {"x_label", plot.x_label}, {"y_label", plot.y_label}, {"notes", plot.notes}};
  json["series"] = Json::array();
  for (const PlotSeries& series : plot.series) {
    Json points = Json::array();
    for (const PlotPoint& point : series.points) {
      points.push_back({{"x", point.x},
                        {"y", point.y},
                        {"label", point.label},
                        {"bound", kBounds[static_cast<int>(point.y_bound)]}});
    }
    json["series"].push_back(
        {{"name", series.name}, {"line", series.line}, {"marks", series.marks}, {"points", points}});
  }
  return json;
}

Json to_json(const BarPlot& plot) {
  Json json = {{"kind", "bars"},
               {"name", plot.name},
               {"title", plot.title},
               {"y_label", plot.y_label},
               {"categories", plot.categories}};
  json["parts"] = Json::array();
  for (const BarPlot::Part& part : plot.parts) {
    json["parts"].push_back({{"name", part.name}, {"values", part.values}});
  }
  return json;
}

}  // namespace

std::string plot_file(const Plot& plot) {
  return "plots/" + spec_folder(std::visit([](const auto& each) { return each.name; }, plot)) + ".svg";
}

std::vector<Figure> report_figures(const ReportFile& report) {
  std::vector<Figure> figures;
  if (!report.msaa_ladder.empty()) {
    figures.push_back(
        {"Memory and accuracy",
         "Up and to the left is better. Above the line a technique needs less memory than MSAA with the same "
         "error. The memory includes the A-buffer at its peak. Triangles mark bounds.",
         {{"frontier", frontier_plot({report})}}});
    Figure speed{"Time and error", "Down and to the left is better.", {{"wall time", speed_plot({report})}}};
    for (const auto& [implementation, ms] : report.techniques.front().modelled_ms) {
      speed.choices.emplace_back("modelled time: " + implementation, speed_plot({report}, implementation));
    }
    figures.push_back(std::move(speed));
  }
  Figure bytes{"Bytes per stage", "What each technique reads and writes in a frame, by stage.", {}};
  for (const auto& [label, key] : {std::pair{"logical: what the stage reads and writes", "logical_bytes"},
                                   std::pair{"sectors of 32 bytes", "sector_bytes"},
                                   std::pair{"DRAM: beyond the modelled caches", "dram_bytes"}}) {
    if (auto plot = bytes_plot(report, key)) bytes.choices.emplace_back(label, std::move(*plot));
  }
  if (!bytes.choices.empty()) figures.push_back(std::move(bytes));
  Figure roofline{"Roofline",
                  "How many operations a stage performs, and how many per byte. Stages far to the left are limited by "
                  "memory, stages "
                  "far to the right by arithmetic.",
                  {}};
  for (const TechniqueSummary& summary : report.techniques) {
    roofline.choices.emplace_back(summary.spec, roofline_plot(report, summary.spec));
  }
  figures.push_back(std::move(roofline));
  return figures;
}

Json to_json(const Figure& figure) {
  Json json = {{"title", figure.title}, {"caption", figure.caption}};
  json["choices"] = Json::array();
  for (const auto& [label, plot] : figure.choices) {
    json["choices"].push_back({{"label", label}, {"plot", std::visit([](const auto& p) { return to_json(p); }, plot)}});
  }
  return json;
}

}  // namespace beampipe
