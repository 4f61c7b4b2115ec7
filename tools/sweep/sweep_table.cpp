#include "tools/sweep/sweep_table.h"

#include <algorithm>
#include <map>
#include <optional>

#include "tools/evaluate/energy.h"
#include "tools/evaluate/mean_time.h"
#include "tools/evaluate/measures.h"
#include "tools/evaluate/memory_system.h"
#include "tools/files/csv.h"

namespace beampipe {
namespace {

// By which DRAM bytes are added up.
constexpr StageGroup kGroups[] = {StageGroup::geometry,   StageGroup::raster,  StageGroup::fragments,
                                  StageGroup::visibility, StageGroup::shading, StageGroup::picture};

// What all rows of a cell have in common.
struct Cell {
  const SweepPlan& plan;
  const SweepCell& cell;
  const TraceInfo& trace;
  const TechniqueReport& report;
  const PictureErrors* errors;  // null: not asked for, or not stored
};

// The mean over the frames: an integer if it is one.
template <class Count>
Json mean_of(const Cell& cell, Count&& count) {
  std::uint64_t sum = 0;
  for (const FrameReport& frame : cell.report.frames)
    for (const StageCounters& stage : frame.stages) sum += count(stage);
  const std::size_t frames = std::max<std::size_t>(cell.report.frames.size(), 1);
  return sum % frames == 0 ? Json(sum / frames) : Json(static_cast<double>(sum) / static_cast<double>(frames));
}

Json number_or_none(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

struct Column {
  SweepColumn info;
  std::function<Json(const Cell&)> value;
};

std::vector<Column> cell_columns() {
  std::vector<Column> columns = {
      {{"trace", "", "the trace, as the plan names it", true},
       [](const Cell& c) { return c.plan.traces[c.cell.trace]; }},
      {{"frames", "", "frames over which the counts are means"},
       [](const Cell& c) { return Json(c.report.frames.size()); }},
      {{"width", "px", "of the first frame that is rendered"}, [](const Cell& c) { return Json(c.trace.size.width); }},
      {{"height", "px", "of the first frame that is rendered"},
       [](const Cell& c) { return Json(c.trace.size.height); }},
      {{"technique", "", "the spec", true}, [](const Cell& c) { return c.plan.techniques[c.cell.technique]; }},
  };
  for (const MemoryParameter& parameter : memory_parameters()) {
    const bool is_text = parameter.get({}).is_string();
    columns.push_back({{std::string("memory_system.") + parameter.key, parameter.unit, parameter.meaning, is_text},
                       [&parameter](const Cell& c) {
                         const Json value = parameter.get(c.plan.memory[c.cell.memory]);
                         return value.is_boolean() ? Json(value.get<bool>() ? 1 : 0) : value;
                       }});
  }
  columns.push_back({{"pixels_on_chip", "", "1 if the pixels of a bin are on chip, else 0"},
                     [](const Cell& c) { return Json(c.report.pixels_on_chip ? 1 : 0); }});
  columns.push_back({{"pixels_per_bin", "px", "of the largest bin, in the first frame"}, [](const Cell& c) {
                       return c.report.frames.empty() ? Json() : Json(c.report.frames.front().bin_pixels);
                     }});
  columns.push_back(
      {{"bins_held", "bins", "that a core has room for; only where pixels are on chip"}, [](const Cell& c) {
         const bool is_known = c.report.pixels_on_chip && !c.report.frames.empty();
         return is_known ? Json(c.report.frames.front().bins_held(c.plan.memory[c.cell.memory])) : Json();
       }});
  columns.push_back({{"on_chip_bytes_per_pixel", "bytes", "all that a bin has on chip, at its peak, over its pixels"},
                     [](const Cell& c) { return Json(c.report.on_chip_bytes_per_pixel()); }});
  columns.push_back({{"off_chip_bytes_per_pixel", "bytes",
                      "the framebuffer, and A-buffer, translucent layer and spilled records at their peaks"},
                     [](const Cell& c) { return Json(c.report.peak_bytes_per_pixel()); }});
  columns.push_back({{"operations", "", "operations of all stages"},
                     [](const Cell& c) { return mean_of(c, [](const auto& s) { return s.ops.total(); }); }});
  columns.push_back({{"logical_bytes", "bytes", "read and written by all stages, queues included"},
                     [](const Cell& c) { return mean_of(c, [](const auto& s) { return s.logical_bytes(); }); }});
  columns.push_back({{"sector_bytes", "bytes", "asked of the memory system"},
                     [](const Cell& c) { return mean_of(c, [](const auto& s) { return s.sector_bytes; }); }});
  columns.push_back({{"l2_bytes", "bytes", "asked of L2"},
                     [](const Cell& c) { return mean_of(c, [](const auto& s) { return s.l2_bytes; }); }});
  columns.push_back({{"dram_bytes", "bytes", "moved to and from DRAM"},
                     [](const Cell& c) { return mean_of(c, [](const auto& s) { return s.dram_bytes; }); }});
  for (const StageGroup group : kGroups) {
    const std::string name(name_of(group));
    columns.push_back({{"dram_bytes." + name, "bytes", "those of the stages of " + name}, [group](const Cell& c) {
                         return mean_of(c, [&](const auto& s) -> std::uint64_t {
                           return info_of(s.stage.id).group == group ? std::uint64_t{s.dram_bytes} : 0;
                         });
                       }});
  }
  for (const Measure& measure : measures())
    columns.push_back(
        {{measure.key, measure.unit, std::string(measure.meaning) + " Only with errors."}, [&measure](const Cell& c) {
           return number_or_none(c.errors ? measure.value(c.errors->error) : std::nullopt);
         }});
  const auto rate_column = [&](const char* name, const char* meaning, auto value) {
    columns.push_back({{name, "samples", meaning}, [value](const Cell& c) {
                         return number_or_none(c.errors ? value(c.errors->equivalent_msaa) : std::nullopt);
                       }});
  };
  rate_column("emr", "equivalent MSAA rate; only with errors", [](const EquivalentMsaa& emr) {
    return emr.does_not_converge ? std::nullopt : std::optional(emr.samples);
  });
  rate_column("emr_low", "lower end of its range", [](const EquivalentMsaa& emr) { return emr.low; });
  rate_column("emr_high", "upper end of its range", [](const EquivalentMsaa& emr) { return emr.high; });
  columns.push_back(
      {{"emr_bound", "", "lower or upper if that rate is only a bound; none if MSAA does not converge", true},
       [](const Cell& c) {
         if (!c.errors) return Json();
         const EquivalentMsaa& emr = c.errors->equivalent_msaa;
         return Json(emr.does_not_converge ? "none" : emr.is_lower_bound ? "lower" : emr.is_upper_bound ? "upper" : "");
       }});
  return columns;
}

std::vector<SweepColumn> hardware_columns(const SweepPlan& plan) {
  std::vector<SweepColumn> columns = {{"hardware", "", "the described hardware", true}};
  for (const std::string& rate : plan.varied_rates) columns.push_back({"hardware." + rate, "", "as the plan sets it"});
  columns.push_back({"implementation", "", "which units do the work of a stage", true});
  for (const TimeKind& kind : kTimes) {
    const std::string name = kind.key;
    columns.push_back({name + "_ms", "ms", "modelled time " + std::string(kind.title) + "; the mean over the frames"});
    columns.push_back({name + "_ms_low", "ms", "the least of nine in ten, by the ranges of rates"});
    columns.push_back({name + "_ms_high", "ms", "the most of them"});
  }
  columns.push_back({"bottleneck", "", "the busiest unit, of the frame that takes longest", true});
  columns.push_back({"bottleneck_rate", "", "the rate at which most of its time goes", true});
  columns.push_back({"energy_mj_low", "mJ", "modelled energy, the least; the mean over the frames"});
  columns.push_back({"energy_mj_high", "mJ", "the same, the most"});
  return columns;
}

void add_times(const Hardware& hardware, std::size_t implementation, const TechniqueReport& report,
               std::vector<Json>& values) {
  const DrawnTime times = drawn_time(hardware, drawn_hardware(hardware), implementation, report);
  for (const TimeKind& kind : kTimes) {
    const Interval interval = times.interval(kind.ms);
    for (const double ms : {times.described.*kind.ms, interval.low, interval.high}) values.emplace_back(ms);
  }
}

void add_hardware(const SweepPlan& plan, const SweepRow& row, const TechniqueReport& report,
                  std::vector<Json>& values) {
  Hardware hardware = plan.hardware[row.hardware];
  hardware.memory = plan.memory[plan.cells[row.cell].memory];
  const Implementation& implementation = hardware.implementations[row.implementation];
  values.emplace_back(hardware.label);
  for (const std::string& rate : plan.varied_rates)
    values.emplace_back(rate == "clock_mhz" ? hardware.clock_mhz : hardware.rates.at(rate));
  values.emplace_back(implementation.name);
  Energy energy;
  double longest = -1;
  std::string busiest, busiest_rate;
  for (const FrameReport& frame : report.frames) {
    const ModelledTime time = modelled_time(hardware, implementation, frame.work());
    if (time.at_once_ms > longest) longest = time.at_once_ms, busiest = time.busiest, busiest_rate = time.busiest_rate;
    if (has_energy(hardware)) energy += sum_of(modelled_energy(hardware, implementation, frame.stages));
  }
  const auto frames = static_cast<double>(std::max<std::size_t>(report.frames.size(), 1));
  add_times(hardware, row.implementation, report, values);
  values.emplace_back(busiest);
  values.emplace_back(busiest_rate);
  for (const double mj : {energy.total().low, energy.total().high})
    values.push_back(has_energy(hardware) ? Json(mj / frames) : Json());
}

// The errors of all pictures of the plan, each read once.
class ErrorTable {
 public:
  ErrorTable(const SweepPlan& plan, const SweepResults& results) : plan_(plan), results_(results) {}

  const PictureErrors* of(const SweepCell& cell) {
    const std::pair key(cell.trace, cell.size);
    auto found = known_.find(key);
    if (found == known_.end()) {
      std::map<PictureVariant, PictureErrors> errors;
      if (const auto stored = results_.errors(cell.trace, cell.size)) {
        const std::vector<PictureVariant> variants = results_.variants(cell.trace, cell.size);
        for (std::size_t i = 0; i < variants.size(); ++i) errors.emplace(variants[i], (*stored)[i]);
      }
      found = known_.emplace(key, std::move(errors)).first;
    }
    const auto errors = found->second.find(PictureVariant(cell.technique, plan_.memory[cell.memory]));
    return errors == found->second.end() ? nullptr : &errors->second;
  }

 private:
  const SweepPlan& plan_;
  const SweepResults& results_;
  std::map<std::pair<std::size_t, std::size_t>, std::map<PictureVariant, PictureErrors>> known_;
};

}  // namespace

std::vector<SweepColumn> columns_of(const SweepPlan& plan) {
  std::vector<SweepColumn> columns;
  for (const Column& column : cell_columns()) columns.push_back(column.info);
  for (const SweepColumn& column : hardware_columns(plan)) columns.push_back(column);
  return columns;
}

SweepTable make_table(const SweepPlan& plan, TraceShelf& shelf, const SweepResults& results) {
  SweepTable table;
  table.columns = columns_of(plan);
  const std::vector<Column> columns = cell_columns();
  ErrorTable errors(plan, results);
  std::optional<std::size_t> last;  // the cell whose counts and values these are: rows of a cell follow each other
  std::optional<CountedCell> counts;
  std::vector<Json> values;
  for (const SweepRow& row : plan.rows) {
    const SweepCell& cell = plan.cells[row.cell];
    if (last != row.cell) {
      last = row.cell;
      counts = results.counts(cell);
      const PictureErrors* const of_pictures = plan.errors ? errors.of(cell) : nullptr;
      if (plan.errors && !of_pictures) counts.reset();
      values.clear();
      if (counts) {
        const Cell all{plan, cell, shelf.info(cell.trace, cell.size), counts->report, of_pictures};
        for (const Column& column : columns) values.push_back(column.value(all));
      }
    }
    if (!counts) {
      ++table.missing;
      continue;
    }
    add_hardware(plan, row, counts->report, table.rows.emplace_back(values));
  }
  return table;
}

std::string csv_text(const SweepTable& table) {
  std::vector<std::string> names;
  for (const SweepColumn& column : table.columns) names.push_back(column.name);
  return csv_text(names, table.rows);
}

}  // namespace beampipe
