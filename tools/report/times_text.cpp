#include "tools/report/times_text.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "pipeline/spec.h"
#include "tools/evaluate/hardware_units.h"
#include "tools/evaluate/mean_time.h"
#include "tools/evaluate/memory_system.h"
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
  ModelledTime time = {};
  BinSpread spread = {};                                // the means over the frames
  std::map<std::string_view, Interval> intervals = {};  // by the key of the time
  std::optional<Quotient> quotient = {};
};

// References and functions of a user's own model no memory, and a time without it would mean nothing.
bool has_times(const TechniqueReport& result) {
  if (result.frames.empty()) return false;
  const FrameReport& first = result.frames.front();
  return std::ranges::any_of(first.stages, [](const StageCounters& stage) { return stage.sector_bytes > 0; });
}

BinSpread mean_spread(const Hardware& hardware, const TechniqueReport& result) {
  BinSpread mean{0, 0, 0};
  const auto frames = static_cast<double>(result.frames.size());
  for (const FrameReport& frame : result.frames) {
    const BinSpread spread = bin_spread(hardware, frame.work());
    mean.busiest_core += spread.busiest_core / frames, mean.p99 += spread.p99 / frames;
    mean.most += spread.most / frames;
  }
  return mean;
}

class Rows {
 public:
  Rows(const Report& report, const TimesOptions& options) : report_(report), draws_(drawn_hardware(report.hardware)) {
    std::vector<std::string> modelled;
    for (const TechniqueReport& result : report.results) {
      if (!has_times(result)) continue;
      modelled.push_back(result.technique);
      if (result.technique == options.over) over_ = &result;
    }
    if (!options.over.empty() && !over_)
      throw std::runtime_error("--over " + options.over +
                               ": expected a technique of the run: " + list_of(modelled, "or"));
    if (options.sensitivity) ends_ = ends_of_ranges(report.hardware);
    for (std::size_t i = 0; over_ && i < report.hardware.implementations.size(); ++i)
      of_over_.push_back(drawn_time(report.hardware, draws_, i, *over_));
  }

  std::vector<Row> all() const {
    std::vector<Row> rows;
    for (const TechniqueReport& result : report_.results)
      for (std::size_t i = 0; i < report_.hardware.implementations.size(); ++i)
        if (has_times(result)) rows.push_back(row_of(result, i));
    return rows;
  }

 private:
  Row row_of(const TechniqueReport& result, std::size_t i) const {
    const Hardware& hardware = report_.hardware;
    const DrawnTime times = drawn_time(hardware, draws_, i, result);
    Row row{result, hardware.implementations[i], times.described, mean_spread(hardware, result)};
    for (const TimeKind& kind : kTimes) row.intervals[kind.key] = times.interval(kind.ms);
    if (over_ && over_ != &result) row.quotient = quotient_of(result, i, times);
    return row;
  }

  Quotient quotient_of(const TechniqueReport& result, std::size_t i, const DrawnTime& times) const {
    constexpr auto kMs = &ModelledTime::in_turn_ms;
    const DrawnTime& over = of_over_[i];
    Quotient quotient{times.described.*kMs / over.described.*kMs, times.interval_over(over, kMs), {}};
    for (const RateEnds& ends : ends_) {
      const auto at = [&](const Hardware& end) {
        return mean_time(end, i, result).*kMs / mean_time(end, i, *over_).*kMs;
      };
      quotient.effects.push_back({ends.rate, at(ends.low), at(ends.high)});
    }
    std::stable_sort(quotient.effects.begin(), quotient.effects.end(),
                     [](const RateEffect& a, const RateEffect& b) { return a.size() > b.size(); });
    return quotient;
  }

  const Report& report_;
  std::vector<Hardware> draws_;
  std::vector<RateEnds> ends_;
  const TechniqueReport* over_ = nullptr;
  std::vector<DrawnTime> of_over_;  // by implementation
};

std::string room_text(const Report& report, const TechniqueReport& result) {
  const FrameReport& first = result.frames.front();
  const double bytes = first.open_pixel_bytes();
  if (bytes == 0) {
    const std::string reason = no_room_text(report.memory, parse_technique(result.technique).framebuffer);
    return "in memory" + (reason.empty() ? "" : ": " + reason);
  }
  return format("%.1f KiB, %u of %u bins", bytes / 1024, first.bins_held(report.memory),
                report.memory.most_bins(first.bin_size().pixels));
}

std::string quotient_text(const Quotient& quotient) {
  return ratio_text(quotient.value) + " (" + interval_text(quotient.interval, ratio_text) + ")" +
         (quotient.interval.contains(1) ? ", even" : "");
}

// Rates that change nothing are left out.
std::string effects_text(const Quotient& quotient) {
  const std::string as_described = ratio_text(quotient.value);
  std::vector<std::vector<std::string>> rows = {{"rate", "lowest", "highest"}};
  for (const RateEffect& effect : quotient.effects) {
    const std::string low = ratio_text(effect.low), high = ratio_text(effect.high);
    if (rows.size() <= kRatesShown && (low != as_described || high != as_described))
      rows.push_back({effect.rate, low, high});
  }
  return as_described + (rows.size() > 1 ? "; with one rate at the ends of its range\n" + align_columns(rows, {0})
                                         : ", whatever the rates in their ranges\n");
}

// Implementations of a technique that give the same are one.
std::string sensitivity_text(const std::vector<Row>& all, const std::string& over) {
  struct Effects {
    const TechniqueReport* result;
    std::string implementations, text;
  };
  std::vector<Effects> effects;
  for (const Row& row : all) {
    if (!row.quotient || row.quotient->effects.empty()) continue;
    const std::string text = effects_text(*row.quotient), &name = row.implementation.name;
    const auto same = std::ranges::find_if(
        effects, [&](const Effects& each) { return each.result == &row.result && each.text == text; });
    if (same == effects.end())
      effects.push_back({&row.result, name, text});
    else
      same->implementations += ", " + name;
  }
  std::string text;
  for (const Effects& each : effects)
    text += "\n" + each.result->technique + " over " + over + ", " + each.implementations + ": " + each.text;
  return text;
}

// Of each technique, and unit and rate of the stages that take at least one per cent of its time.
std::string stages_text(const std::vector<Row>& all) {
  std::vector<std::vector<std::string>> rows = {{"technique", "implementation", "stage", "ms", "busiest"}};
  for (const Row& row : all)
    for (const StageTime& stage : row.time.stages)
      if (stage.ms >= 0.01 * row.time.in_turn_ms)
        rows.push_back({row.result.technique, row.implementation.name, std::string(name_of(stage.stage)),
                        ms_text(stage.ms), limit_text(stage.busiest, stage.busiest_rate)});
  return "\nstages of at least 1 % of the time in turn\n" + align_columns(joined_rows(rows, 1), {0, 1, 2, 4});
}

// What wrong units would change, and how much the intervals know.
std::string title_text(const Hardware& hardware) {
  return "\nmodelled ms on " + hardware.label + " (" + hardware.name + "): " +
         format("%u cores at %g MHz, %g KiB on chip each, DRAM %g GB/s; %zu of %zu rates have a range\n",
                hardware.memory.cores, hardware.clock_mhz, static_cast<double>(hardware.memory.on_chip_bytes) / 1024.0,
                std::round(hardware.rates.at("dram_bytes_per_clk") * hardware.clock_mhz / 1000), hardware.ranges.size(),
                hardware.rates.size());
}

}  // namespace

std::string times_text(const Report& report, const TimesOptions& options) {
  const std::vector<Row> all = Rows(report, options).all();
  std::vector<std::vector<std::string>> rows = {
      {"technique", "implementation", "in turn", "nine in ten", "on cores", "at once", "busiest", "uneven", "on chip"}};
  if (!options.over.empty()) rows.front().push_back("in turn over " + options.over);
  for (const Row& row : all) {
    rows.push_back({row.result.technique, row.implementation.name, ms_text(row.time.in_turn_ms),
                    interval_text(row.intervals.at(kTimes[0].key), ms_text), ms_text(row.time.on_cores_ms),
                    ms_text(row.time.at_once_ms), limit_text(row.time.busiest, row.time.busiest_rate),
                    ratio_text(row.spread.busiest_core), room_text(report, row.result)});
    if (!options.over.empty()) rows.back().push_back(row.quotient ? quotient_text(*row.quotient) : "");
  }
  return title_text(report.hardware) + align_columns(joined_rows(rows, 1), {0, 1, 6, 8, 9}) +
         (options.stages ? stages_text(all) : "") + (options.sensitivity ? sensitivity_text(all, options.over) : "");
}

Json times_json(const Report& report, const TimesOptions& options) {
  Json json = Json::array();
  for (const Row& row : Rows(report, options).all()) {
    Json stages, units, rates;
    for (const StageTime& each : row.time.stages) {
      stages[name_of(each.stage)] = each.ms;
      units[name_of(each.stage)] = each.busiest;
      rates[name_of(each.stage)] = each.busiest_rate;
    }
    Json of_row = {{"technique", row.result.technique},
                   {"hardware", report.hardware.label},
                   {"implementation", row.implementation.name}};
    for (const TimeKind& kind : kTimes) {
      of_row[kind.key] = row.time.*kind.ms;
      of_row[std::string(kind.key) + "_interval"] = row.intervals.at(kind.key).json();
    }
    of_row["busiest"] = row.time.busiest;
    of_row["busiest_rate"] = row.time.busiest_rate;
    of_row["bin_spread"] = {
        {"busiest_core", row.spread.busiest_core}, {"p99", row.spread.p99}, {"most", row.spread.most}};
    of_row["stages"] = stages;
    of_row["busiest_units"] = units;
    of_row["busiest_rates"] = rates;
    const FrameReport& first = row.result.frames.front();
    of_row["bin_bytes"] = first.open_pixel_bytes();
    if (first.open_pixel_bytes() > 0) of_row["bins_held"] = first.bins_held(report.memory);
    if (row.quotient) {
      of_row["ratio"] = row.quotient->value;
      of_row["ratio_interval"] = row.quotient->interval.json();
      for (const RateEffect& effect : row.quotient->effects)
        of_row["ratio_at_ends"][effect.rate] = Json::array({effect.low, effect.high});
    }
    json.push_back(of_row);
  }
  return json;
}

}  // namespace beampipe
