#include "tools/report/cards.h"

#include <algorithm>
#include <cmath>

#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/modelled_time.h"
#include "tools/report/colors.h"
#include "tools/report/finished_run.h"
#include "tools/report/times_text.h"

namespace beampipe {
namespace {

// The modelled times, with their ranges and those of their quotients; none if nothing was modelled, or another version
// counted other things.
Json times_of(const ReportFile& report, const std::string& baseline) {
  try {
    return times_json(finished_run(report), {.over = baseline});
  } catch (const ReportError&) {
    return Json::array();
  }
}

Json card_of(const TechniqueSummary& summary, const std::string& color) {
  Json card = {{"technique", summary.spec},
               {"color", color},
               {"on_chip_bytes_per_pixel", summary.on_chip_bytes_per_pixel},
               {"on_chip_bytes", summary.on_chip_bytes_per_pixel * static_cast<double>(summary.bin_pixels)},
               {"bin_pixels", summary.bin_pixels},
               {"pixels_on_chip", summary.pixels_on_chip},
               {"bytes_per_pixel", summary.bytes_per_pixel},
               {"off_chip", summary.off_chip}};
  if (summary.dram_bytes > 0) card["dram_bytes"] = summary.dram_bytes;  // otherwise no memory was modelled
  for (const auto& [implementation, ms] : summary.modelled_ms)
    card["modelled_ms"][implementation] = {
        {"at_once", ms.at_once}, {"on_cores", ms.on_cores}, {"in_turn", ms.in_turn}, {"busiest", ms.busiest}};
  if (summary.rmse) card["rmse"] = *summary.rmse;
  if (summary.emr) {
    card["emr"] = summary.emr->samples;
    card["emr_bound"] = bound_text(*summary.emr);
  }
  return card;
}

Json with_ranges(Json card, const Json& times) {
  for (const Json& row : times.elements())
    if (row.at("technique") == card.at("technique")) {
      Json& time = card["modelled_ms"][row.at("implementation").get<std::string>()];
      const double stored = time.at("in_turn").get<double>(), again = row.at("in_turn").get<double>();
      if (std::abs(again - stored) > 1e-9 * stored) continue;  // another version modelled it
      for (const TimeKind& kind : kTimes) {
        const std::string key = std::string(kind.key) + "_interval";
        time[key] = row.at(key);
      }
      for (const char* key : {"ratio", "ratio_interval"})
        if (const Json* const found = row.find(key)) time[key] = *found;
    }
  return card;
}

}  // namespace

std::string baseline_of(const ReportFile& report) {
  const auto find = [&](const auto& is_it) {
    return std::find_if(report.techniques.begin(), report.techniques.end(), is_it);
  };
  const auto eight = find([](const TechniqueSummary& each) { return each.spec == msaa_spec(8); });
  if (eight != report.techniques.end()) return eight->spec;
  const auto first = find([](const TechniqueSummary& each) { return is_msaa(each.spec); });
  return first != report.techniques.end() ? first->spec : report.techniques.front().spec;
}

Json report_cards(const ReportFile& report) {
  const std::string baseline = baseline_of(report);
  Json json = {{"baseline", baseline}, {"implementations", implementations_of(report)}, {"cards", Json::array()}};
  const Json times = times_of(report, baseline);
  std::vector<std::string> specs;
  for (const TechniqueSummary& summary : report.techniques) specs.push_back(summary.spec);
  for (const bool is_baseline : {true, false})
    for (const TechniqueSummary& summary : report.techniques)
      if ((summary.spec == baseline) == is_baseline)
        json["cards"].push_back(with_ranges(card_of(summary, technique_color(specs, summary.spec)), times));
  return json;
}

}  // namespace beampipe
