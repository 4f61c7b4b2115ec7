#include "tools/report/figures.h"

#include "tools/evaluate/results.h"

namespace beampipe {
namespace {

constexpr const char* kBounds[] = {"none", "lower", "upper", "beyond"};  // of PlotPoint::Bound

Json to_json(const ScatterPlot& plot) {
  Json json = {{"kind", "scatter"},       {"name", plot.name},       {"title", plot.title},
               {"x_label", plot.x_label}, {"y_label", plot.y_label}, {"notes", plot.notes}};
  json["series"] = Json::array();
  for (const PlotSeries& series : plot.series) {
    Json points = Json::array();
    for (const PlotPoint& point : series.points) {
      points.push_back(
          {{"x", point.x}, {"y", point.y}, {"label", point.label}, {"bound", kBounds[static_cast<int>(point.bound)]}});
    }
    json["series"].push_back({{"name", series.name},
                              {"color", series.color},
                              {"line", series.line},
                              {"marks", series.marks},
                              {"points", points}});
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
    json["parts"].push_back({{"name", part.name}, {"color", part.color}, {"values", part.values}});
    if (!part.limits.empty()) json["parts"].elements().back()["limits"] = part.limits;
  }
  if (!plot.marks.empty()) json["marks"] = {{"name", plot.mark_name}, {"values", plot.marks}};
  return json;
}

}  // namespace

std::string plot_file(const Plot& plot) {
  return "plots/" + spec_folder(std::visit([](const auto& each) { return each.name; }, plot)) + ".svg";
}

std::vector<Figure> report_figures(const ReportFile& report) {
  std::vector<Figure> figures;
  const std::vector<std::string> implementations = implementations_of(report);
  if (!report.msaa_ladder.empty()) {
    figures.push_back(
        {"cost",
         "Memory and accuracy",
         "Up and to the left is better. Above the line a technique needs less memory than MSAA with the same "
         "error. The memory includes A-buffer, translucent layer and spilled records at their peaks. Triangles mark "
         "bounds.",
         {{"on chip and off chip", storage_plot({report})}, {"off chip", frontier_plot({report})}}});
    Figure speed{"cost", "Time and error", "Down and to the left is better.", {}};
    for (const std::string& implementation : implementations)
      speed.choices.emplace_back("modelled time: " + name_of(report, implementation),
                                 speed_plot({report}, implementation));
    speed.choices.emplace_back("wall time of the simulator", speed_plot({report}));
    figures.push_back(std::move(speed));
  }
  Figure time{
      "stages",
      "Time per stage",
      "Modelled time, one stage after the other; pointing at a stage shows what limits it. The black mark is where all "
      "stages at once would end.",
      {}};
  for (const std::string& implementation : implementations)
    time.choices.emplace_back("modelled time: " + name_of(report, implementation), time_plot(report, implementation));
  if (!time.choices.empty()) figures.push_back(std::move(time));
  Figure bytes{"stages", "Bytes per stage", "What each technique reads and writes in a frame.", {}};
  for (const auto& [label, key] :
       {std::pair{"DRAM: beyond the modelled caches", "dram_bytes"}, std::pair{"L2", "l2_bytes"},
        std::pair{"sectors", "sector_bytes"}, std::pair{"logical: what the stage reads and writes", "logical_bytes"}}) {
    if (auto plot = bytes_plot(report, key)) bytes.choices.emplace_back(label, std::move(*plot));
  }
  if (!bytes.choices.empty()) figures.push_back(std::move(bytes));
  Figure roofline{"stages",
                  "Roofline",
                  "How many operations a stage performs, and how many per byte. Stages far to the left are limited by "
                  "memory, stages far to the right by arithmetic.",
                  {}};
  for (const TechniqueSummary& summary : report.techniques) {
    if (ScatterPlot plot = roofline_plot(report, summary.spec); !plot.series.empty())
      roofline.choices.emplace_back(summary.spec, std::move(plot));
  }
  if (!roofline.choices.empty()) figures.push_back(std::move(roofline));
  if (auto causes = causes_plot(report))
    figures.push_back({"causes",
                       "Split of the error",
                       "The mean square error of all frames by cause; where surfaces vary, that in visibility. A cause "
                       "is negative where it makes up for others.",
                       {{"causes", std::move(*causes)}}});
  return figures;
}

Json to_json(const Figure& figure) {
  Json json = {{"section", figure.section}, {"title", figure.title}, {"caption", figure.caption}};
  json["choices"] = Json::array();
  for (const auto& [label, plot] : figure.choices) {
    json["choices"].push_back({{"label", label}, {"plot", std::visit([](const auto& p) { return to_json(p); }, plot)}});
  }
  return json;
}

}  // namespace beampipe
