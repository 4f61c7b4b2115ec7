#include "tools/report/times_text.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/mean_times.h"
#include "tools/evaluate/modelled_time.h"
#include "tools/evaluate/sensitivity.h"
#include "tools/files/format.h"
#include "tools/report/report_text.h"

namespace beampipe {
namespace {

constexpr std::size_t kRatesShown = 8;  // of the sensitivity's table

// Milliseconds with three decimals, or two significant digits if that is more.
std::string ms_text(double ms) { return format(ms < 0.01 ? "%.2g" : "%.3f", ms); }

std::string interval_text(const Interval& interval, std::string (*text)(double)) {
  return text(interval.low) + " to " + text(interval.high);
}

std::string ratio_text(double ratio) { return format("%.2f", ratio); }

double mean_in_turn_ms(const Hardware& hardware, std::size_t implementation, const TechniqueReport& result) {
  return mean_times(hardware, implementation, result).in_turn_ms;
}

std::vector<double> mean_in_turn_all_ms(const std::vector<Hardware>& all, std::size_t implementation,
                                        const TechniqueReport& result) {
  std::vector<double> sums;
  for (const Hardware& hardware : all) sums.push_back(mean_in_turn_ms(hardware, implementation, result));
  return sums;
}

// A rate at the ends of its range.
struct RateEffect {
  std::string rate;
  double low = 0, high = 0;  // quotients of times

  double size() const { return std::abs(std::log(high / low)); }
};

struct Quotient {
  double value = 0;
  Interval interval;
  std::vector<RateEffect> effects;  // the greatest first
};

// A row of the table.
struct Row {
  const TechniqueReport& result;
  const Implementation& implementation;
  ModelledTime mean = {};  // of the frames; its unit is that of the first
  double times_longer = 0;
  Interval interval = {};
  std::optional<Quotient> quotient = {};
};

// With the value in it, which may be at the end of what its rates allow.
Interval around(double value, const Interval& interval) {
  return {std::min(value, interval.low), std::max(value, interval.high)};
}

// The part of one of several frames. Stages for alpha are not in all of them.
void add_stages(const std::vector<StageTime>& stages, double frames, std::vector<StageTime>& mean) {
  for (const StageTime& stage : stages) {
    const auto is_it = [&](const StageTime& each) { return each.stage == stage.stage; };
    const auto found = std::find_if(mean.begin(), mean.end(), is_it);
    StageTime& of_mean = found == mean.end() ? mean.emplace_back(StageTime{stage.stage, 0, stage.busiest}) : *found;
    of_mean.ms += stage.ms / frames;
  }
}

class Rows {
 public:
  Rows(const Report& report, const TimesOptions& options)
      : report_(report), options_(options), draws_(drawn_hardware(report.hardware)) {
    for (const TechniqueReport& result : report.results)
      if (result.technique == options.over) over_ = &result;
    if (!options.over.empty() && (!over_ || over_->frames.empty()))
      throw std::runtime_error("--over " + options.over + ": expected a technique of the run");
    if (options.sensitivity) ends_ = ends_of_ranges(report.hardware);
  }

  std::vector<Row> all() const {
    std::vector<Row> rows;
    for (const TechniqueReport& result : report_.results)
      for (std::size_t i = 0; i < report_.hardware.implementations.size(); ++i)
        if (result.technique != kReferenceSpec && !result.frames.empty()) rows.push_back(row_of(result, i));
    return rows;
  }

 private:
  Row row_of(const TechniqueReport& result, std::size_t i) const {
    const Hardware& hardware = report_.hardware;
    Row row{result, hardware.implementations[i]};
    const auto frames = static_cast<double>(result.frames.size());
    for (const FrameReport& frame : result.frames) {
      const ModelledTime time = modelled_time(hardware, row.implementation, frame.work());
      if (row.mean.busiest.empty()) row.mean.busiest = time.busiest;
      add_stages(time.stages, frames, row.mean.stages);
      row.mean.in_turn_ms += time.in_turn_ms / frames;
      row.mean.on_cores_ms += time.on_cores_ms / frames;
      row.mean.at_once_ms += time.at_once_ms / frames;
      row.times_longer += imbalance(frame.bin_operations, hardware.memory.cores) / frames;
    }
    const std::vector<double> drawn = mean_in_turn_all_ms(draws_, i, result);
    row.interval = around(row.mean.in_turn_ms, middle_of(drawn));
    if (over_ && over_ != &result) row.quotient = quotient_of(result, i, drawn, row.mean.in_turn_ms);
    return row;
  }

  Quotient quotient_of(const TechniqueReport& result, std::size_t i, std::vector<double> drawn, double ms) const {
    const std::vector<double> of_over = mean_in_turn_all_ms(draws_, i, *over_);
    for (std::size_t k = 0; k < drawn.size(); ++k) drawn[k] /= of_over[k];
    const double value = ms / mean_in_turn_ms(report_.hardware, i, *over_);
    Quotient quotient{value, around(value, middle_of(drawn)), {}};
    for (const RateEnds& ends : ends_) {
      const auto at = [&](const Hardware& end) {
        return mean_in_turn_ms(end, i, result) / mean_in_turn_ms(end, i, *over_);
      };
      quotient.effects.push_back({ends.rate, at(ends.low), at(ends.high)});
    }
    std::stable_sort(quotient.effects.begin(), quotient.effects.end(),
                     [](const RateEffect& a, const RateEffect& b) { return a.size() > b.size(); });
    return quotient;
  }

  const Report& report_;
  const TimesOptions& options_;
  std::vector<Hardware> draws_;
  std::vector<RateEnds> ends_;
  const TechniqueReport* over_ = nullptr;
};

std::string room_text(const Report& report, const TechniqueReport& result) {
  const double bytes = result.frames.front().open_pixel_bytes();
  if (!result.pixels_on_chip || bytes == 0) return "in memory";
  return format("%.1f KiB, %u of %u bins", bytes / 1024, bins_held(report.memory, bytes), report.memory.bins_per_core);
}

std::string quotient_text(const Quotient& quotient) {
  const bool is_even = quotient.interval.low <= 1 && quotient.interval.high >= 1;
  return ratio_text(quotient.value) + " (" + interval_text(quotient.interval, ratio_text) + ")" +
         (is_even ? ", even" : "");
}

std::string sensitivity_text(const std::vector<Row>& all, const std::string& over) {
  std::string text;
  for (const Row& row : all) {
    if (!row.quotient || row.quotient->effects.empty()) continue;
    std::vector<std::vector<std::string>> rows = {{"rate", "lowest", "highest"}};
    for (const RateEffect& effect : row.quotient->effects)
      if (rows.size() <= kRatesShown) rows.push_back({effect.rate, ratio_text(effect.low), ratio_text(effect.high)});
    text += "\n" + row.result.technique + " over " + over + ", " + row.implementation.name + ": " +
            ratio_text(row.quotient->value) + "; with one rate at the ends of its range\n" + align_columns(rows, {0});
  }
  return text;
}

Json interval_json(const Interval& interval) { return Json::array({interval.low, interval.high}); }

}  // namespace

std::string times_text(const Report& report, const TimesOptions& options) {
  const std::vector<Row> all = Rows(report, options).all();
  std::vector<std::vector<std::string>> rows = {
      {"technique", "implementation", "in turn", "nine in ten", "on cores", "at once", "busiest", "uneven", "on chip"}};
  if (!options.over.empty()) rows.front().push_back("in turn over " + options.over);
  for (const Row& row : all) {
    rows.push_back({row.result.technique, row.implementation.name, ms_text(row.mean.in_turn_ms),
                    interval_text(row.interval, ms_text), ms_text(row.mean.on_cores_ms), ms_text(row.mean.at_once_ms),
                    row.mean.busiest, ratio_text(row.times_longer), room_text(report, row.result)});
    if (!options.over.empty()) rows.back().push_back(row.quotient ? quotient_text(*row.quotient) : "");
  }
  const std::string title = "\nmodelled ms on " + report.hardware.label + " (" + report.hardware.name + ")\n";
  return title + align_columns(rows, {0, 1, 6, 8, 9}) +
         (options.sensitivity ? sensitivity_text(all, options.over) : "");
}

Json times_json(const Report& report, const TimesOptions& options) {
  Json json = Json::array();
  for (const Row& row : Rows(report, options).all()) {
    Json stages, units;
    for (const StageTime& each : row.mean.stages) {
      stages[name_of(each.stage)] = each.ms;
      units[name_of(each.stage)] = each.busiest;
    }
    Json of_row = {{"technique", row.result.technique},
                   {"hardware", report.hardware.label},
                   {"implementation", row.implementation.name},
                   {"in_turn", row.mean.in_turn_ms},
                   {"in_turn_interval", interval_json(row.interval)},
                   {"on_cores", row.mean.on_cores_ms},
                   {"at_once", row.mean.at_once_ms},
                   {"busiest", row.mean.busiest},
                   {"imbalance", row.times_longer},
                   {"stages", stages},
                   {"busiest_units", units}};
    const double bytes = row.result.frames.front().open_pixel_bytes();
    of_row["bin_bytes"] = bytes;
    if (bytes > 0) of_row["bins_held"] = bins_held(report.memory, bytes);
    if (row.quotient) {
      of_row["ratio"] = row.quotient->value;
      of_row["ratio_interval"] = interval_json(row.quotient->interval);
      for (const RateEffect& effect : row.quotient->effects)
        of_row["ratio_at_ends"][effect.rate] = Json::array({effect.low, effect.high});
    }
    json.push_back(of_row);
  }
  return json;
}

}  // namespace beampipe
