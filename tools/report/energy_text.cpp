#include "tools/report/energy_text.h"

#include <algorithm>
#include <map>
#include <optional>
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
  double on_cores_ms = 0;                    // the same
  double on_chip_bytes = 0;                  // in all cores
  std::map<std::string, double> rates = {};  // of comparisons, by unit
  std::optional<Interval> quotient = {};

  Interval watts() const { return on_cores_ms > 0 ? part_of(mean.total(), on_cores_ms) : Interval{}; }
};

Energy part_of(const Energy& sum, double parts) {
  Energy part;
  for (const EnergyTerm& term : energy_terms()) part.*term.part = part_of(sum.*term.part, parts);
  return part;
}

PricedWork work_of(const Hardware& hardware, const Implementation& implementation, const TechniqueReport& result) {
  PricedWork sum;
  for (const FrameReport& frame : result.frames)
    for (const auto& [name, count] : priced_work(hardware, implementation, frame.stages)) sum[name] += count;
  return sum;
}

EnergyRow energy_row(const Report& report, const TechniqueReport& result, const Implementation& implementation,
                     const TechniqueReport* over) {
  const Hardware& hardware = report.hardware;
  EnergyRow row{result, implementation};
  const auto frames = static_cast<double>(result.frames.size());
  for (const FrameReport& frame : result.frames) {
    const std::vector<StageEnergy> stages = modelled_energy(hardware, implementation, frame.stages);
    row.mean += part_of(sum_of(stages), frames);
    for (const StageEnergy& each : stages) row.stages[each.stage] += part_of(each.energy, frames);
    row.on_cores_ms += modelled_time(hardware, implementation, frame.work()).on_cores_ms / frames;
  }
  if (over && over != &result)
    row.quotient =
        quotient_of(hardware, work_of(hardware, implementation, result), work_of(hardware, implementation, *over));
  const FrameReport first = result.frames.front();
  if (const double bytes = first.open_pixel_bytes())
    row.on_chip_bytes = bytes * first.bins_held(report.memory) * report.memory.cores;
  for (const StageCounters& stage : first.stages)
    if (const auto units = implementation.units.find(stage.stage.id); units != implementation.units.end())
      for (const auto& [unit, rate] : kComparing)
        if (std::find(units->second.begin(), units->second.end(), unit) != units->second.end())
          row.rates[unit] = hardware.rates.at(rate);
  return row;
}

std::vector<EnergyRow> energy_rows(const Report& report, const std::string& over) {
  const TechniqueReport* of_over = nullptr;
  for (const TechniqueReport& result : report.results)
    if (result.technique == over) of_over = &result;
  std::vector<EnergyRow> rows;
  for (const TechniqueReport& result : report.results)
    for (const Implementation& implementation : report.hardware.implementations)
      if (!is_reference(result.technique) && !result.frames.empty())
        rows.push_back(energy_row(report, result, implementation, of_over));
  return rows;
}

// Two significant digits, as energies have at most.
std::string two_digits(double number) { return format(number < 10 ? "%.2g" : "%.0f", number); }

std::string ends_text(const Interval& interval) {
  return two_digits(interval.low) + " to " + two_digits(interval.high);
}

std::string quotient_text(const Interval& interval) {
  return ends_text(interval) + (interval.contains(1) ? ", even" : "");
}

Json energy_json(const Energy& energy) {
  Json json = {{"total", energy.total().json()}};
  for (const EnergyTerm& term : energy_terms()) json[term.name] = (energy.*term.part).json();
  return json;
}

}  // namespace

std::string energy_text(const Report& report, const std::string& over) {
  std::vector<std::vector<std::string>> rows = {{"technique", "implementation", "mJ"}};
  for (const EnergyTerm& term : energy_terms()) rows[0].emplace_back(term.name);
  rows[0].insert(rows[0].end(), {"W", "KiB for bins", "compared per clock"});
  if (!over.empty()) rows[0].push_back("mJ over " + over);
  for (const EnergyRow& row : energy_rows(report, over)) {
    std::vector<std::string>& cells = rows.emplace_back();
    cells = {row.result.technique, row.implementation.name, ends_text(row.mean.total())};
    for (const EnergyTerm& term : energy_terms()) cells.push_back(ends_text(row.mean.*term.part));
    std::string compared;
    for (const auto& [unit, rate] : row.rates)
      compared += (compared.empty() ? "" : ", ") + unit + format(" %.0f", rate);
    cells.insert(cells.end(), {ends_text(row.watts()), format("%.0f", row.on_chip_bytes / 1024), compared});
    if (!over.empty()) cells.push_back(row.quotient ? quotient_text(*row.quotient) : "");
  }
  return "\nmodelled mJ on " + report.hardware.label + " (" + report.hardware.name + ")\n" +
         align_columns(joined_rows(rows, 1), {0, 1, rows[0].size() - 1, rows[0].size() - (over.empty() ? 1 : 2)});
}

Json energy_json(const Report& report, const std::string& over) {
  Json json = Json::array();
  for (const EnergyRow& row : energy_rows(report, over)) {
    Json stages = Json::object(), rates = Json::object();
    for (const auto& [stage, energy] : row.stages) stages[name_of(stage)] = energy_json(energy);
    for (const auto& [unit, rate] : row.rates) rates[unit] = rate;
    json.push_back({{"technique", row.result.technique},
                    {"hardware", report.hardware.label},
                    {"implementation", row.implementation.name},
                    {"energy_mj", energy_json(row.mean)},
                    {"stages", stages},
                    {"watts", row.watts().json()},
                    {"on_chip_bytes", row.on_chip_bytes},
                    {"compared_per_clk", rates}});
    if (row.quotient) json.elements().back()["ratio_interval"] = row.quotient->json();
  }
  return json;
}

}  // namespace beampipe
