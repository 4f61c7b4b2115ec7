#include "tools/report/energy_text.h"

#include <algorithm>
#include <map>
#include <utility>

#include "tools/evaluate/energy.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/modelled_time.h"
#include "tools/files/format.h"
#include "tools/report/report_text.h"

namespace beampipe {
namespace {

// What units of fixed function compare: positions, or keys of the sorter.
constexpr std::pair<const char*, const char*> kComparing[] = {{"mask_generator", "mask_positions_per_clk"},
                                                              {"sorter", "sort_operations_per_clk"},
                                                              {"composer", "compose_positions_per_clk"},
                                                              {"rop_samples", "rop_samples_per_clk"}};

Interval part_of(const Interval& sum, double parts) { return {sum.low / parts, sum.high / parts}; }

struct EnergyRow {
  const TechniqueReport& result;
  const Implementation& implementation;
  Energy mean = {};                          // of the frames
  std::map<Stage, Energy> stages = {};       // the same
  double scheduled_ms = 0;                   // the same
  double on_chip_bytes = 0;                  // in all cores
  std::map<std::string, double> rates = {};  // of comparisons, by unit

  Interval watts() const { return scheduled_ms > 0 ? part_of(mean.total(), scheduled_ms) : Interval{}; }
};

Energy part_of(const Energy& sum, double parts) {
  Energy part;
  for (const EnergyTerm& term : energy_terms()) part.*term.part = part_of(sum.*term.part, parts);
  return part;
}

EnergyRow energy_row(const Report& report, const TechniqueReport& result, const Implementation& implementation) {
  const Hardware& hardware = report.hardware;
  EnergyRow row{result, implementation};
  const auto frames = static_cast<double>(result.frames.size());
  for (const FrameReport& frame : result.frames) {
    const std::vector<StageEnergy> stages = modelled_energy(hardware, implementation, frame.stages);
    row.mean += part_of(sum_of(stages), frames);
    for (const StageEnergy& each : stages) row.stages[each.stage] += part_of(each.energy, frames);
    row.scheduled_ms += modelled_time(hardware, implementation, frame.work()).scheduled_ms / frames;
  }
  const FrameReport first = result.frames.front();
  if (const double bytes = first.open_pixel_bytes())
    row.on_chip_bytes = bytes * bins_held(report.memory, bytes) * report.memory.cores;
  for (const StageCounters& stage : first.stages)
    if (const auto units = implementation.units.find(stage.stage.id); units != implementation.units.end())
      for (const auto& [unit, rate] : kComparing)
        if (std::find(units->second.begin(), units->second.end(), unit) != units->second.end())
          row.rates[unit] = hardware.rates.at(rate);
  return row;
}

std::vector<EnergyRow> energy_rows(const Report& report) {
  std::vector<EnergyRow> rows;
  for (const TechniqueReport& result : report.results)
    for (const Implementation& implementation : report.hardware.implementations)
      if (result.technique != kReferenceSpec && !result.frames.empty())
        rows.push_back(energy_row(report, result, implementation));
  return rows;
}

// Two significant digits, as energies have at most.
std::string two_digits(double number) { return format(number < 10 ? "%.2g" : "%.0f", number); }

std::string ends_text(const Interval& interval) {
  return two_digits(interval.low) + " to " + two_digits(interval.high);
}

Json ends_json(const Interval& interval) { return Json::array({interval.low, interval.high}); }

Json energy_json(const Energy& energy) {
  Json json = {{"total", ends_json(energy.total())}};
  for (const EnergyTerm& term : energy_terms()) json[term.name] = ends_json(energy.*term.part);
  return json;
}

}  // namespace

std::string energy_text(const Report& report) {
  std::vector<std::vector<std::string>> rows = {{"technique", "implementation", "mJ"}};
  for (const EnergyTerm& term : energy_terms()) rows[0].emplace_back(term.name);
  rows[0].insert(rows[0].end(), {"W", "KiB for bins", "compared per clock"});
  for (const EnergyRow& row : energy_rows(report)) {
    std::vector<std::string>& cells = rows.emplace_back();
    cells = {row.result.technique, row.implementation.name, ends_text(row.mean.total())};
    for (const EnergyTerm& term : energy_terms()) cells.push_back(ends_text(row.mean.*term.part));
    std::string compared;
    for (const auto& [unit, rate] : row.rates)
      compared += (compared.empty() ? "" : ", ") + unit + format(" %.0f", rate);
    cells.insert(cells.end(), {ends_text(row.watts()), format("%.0f", row.on_chip_bytes / 1024), compared});
  }
  return "\nmodelled mJ on " + report.hardware.label + " (" + report.hardware.name + ")\n" +
         align_columns(rows, {0, 1, rows[0].size() - 1});
}

Json energy_json(const Report& report) {
  Json json = Json::array();
  for (const EnergyRow& row : energy_rows(report)) {
    Json stages = Json::object(), rates = Json::object();
    for (const auto& [stage, energy] : row.stages) stages[name_of(stage)] = energy_json(energy);
    for (const auto& [unit, rate] : row.rates) rates[unit] = rate;
    json.push_back({{"technique", row.result.technique},
                    {"hardware", report.hardware.label},
                    {"implementation", row.implementation.name},
                    {"energy_mj", energy_json(row.mean)},
                    {"stages", stages},
                    {"watts", ends_json(row.watts())},
                    {"on_chip_bytes", row.on_chip_bytes},
                    {"compared_per_clk", rates}});
  }
  return json;
}

}  // namespace beampipe
