#include "tools/report/report_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tools/evaluate/frame_json.h"
#include "tools/evaluate/hardware_units.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/remodel.h"
#include "tools/evaluate/results.h"
#include "traces/files/json.h"

namespace beampipe {
namespace {

TechniqueSummary mean_summary(const std::vector<TechniqueSummary>& of_one_technique) {
  TechniqueSummary mean = of_one_technique.front();
  std::vector<double> bytes, all_bytes, ms, rmse, emr;
  for (const TechniqueSummary& summary : of_one_technique) {
    bytes.push_back(summary.bytes_per_pixel);
    all_bytes.push_back(summary.all_bytes_per_pixel);
    ms.push_back(summary.wall_ms);
    if (summary.rmse) rmse.push_back(*summary.rmse);
    if (!summary.emr) continue;
    emr.push_back(summary.emr->samples);
    if (!mean.emr) continue;
    mean.emr->is_lower_bound |= summary.emr->is_lower_bound;
    mean.emr->is_upper_bound |= summary.emr->is_upper_bound;
  }
  std::erase_if(mean.modelled_ms, [&](const auto& modelled) {
    return std::any_of(of_one_technique.begin(), of_one_technique.end(),
                       [&](const TechniqueSummary& summary) { return !summary.modelled_ms.contains(modelled.first); });
  });
  for (auto& [implementation, mean_ms] : mean.modelled_ms) {
    std::vector<double> at_once, on_cores, in_turn;
    for (const TechniqueSummary& summary : of_one_technique) {
      at_once.push_back(summary.modelled_ms.at(implementation).at_once);
      on_cores.push_back(summary.modelled_ms.at(implementation).on_cores);
      in_turn.push_back(summary.modelled_ms.at(implementation).in_turn);
    }
    mean_ms.at_once = geometric_mean(at_once);
    mean_ms.on_cores = geometric_mean(on_cores);
    mean_ms.in_turn = geometric_mean(in_turn);
  }
  mean.bytes_per_pixel = geometric_mean(bytes);
  mean.all_bytes_per_pixel = geometric_mean(all_bytes);
  mean.wall_ms = geometric_mean(ms);
  if (rmse.size() < of_one_technique.size()) {
    mean.rmse.reset();
  } else {
    mean.rmse = geometric_mean(rmse);
  }
  if (emr.size() < of_one_technique.size()) {
    mean.emr.reset();
  } else {
    mean.emr->samples = geometric_mean(emr);
  }
  return mean;
}

void add_ratios(Json& stage) {
  const double bytes = stage.at("logical_bytes").get<double>();
  const double issued = stage.value("lanes_issued", 0.0);
  if (bytes > 0) stage["ops_per_byte"] = stage.at("ops").at("total").get<double>() / bytes;
  if (issued > 0) stage["lane_use"] = stage.value("lanes_used", 0.0) / issued;
}

// Adds a name to a list with commas, unless it is in it.
void add_name(std::string& names, const std::string& name) {
  if ((", " + names + ",").find(", " + name + ",") == names.npos) names += (names.empty() ? "" : ", ") + name;
}

}  // namespace

double geometric_mean(const std::vector<double>& values) {
  if (std::count(values.begin(), values.end(), values.front()) == std::ssize(values)) return values.front();
  double sum = 0;
  for (const double value : values) sum += std::log(value);
  return std::exp(sum / static_cast<double>(values.size()));
}

void add_numbers(Json& sum, const Json& other) {
  if (sum.is_null()) sum = Json::object();
  for (const auto& [key, value] : other.members()) {
    if (value.is_object()) {
      add_numbers(sum[key], value);
    } else if (value.is_unsigned()) {
      sum[key] = sum.value(key, std::uint64_t{0}) + value.get<std::uint64_t>();
    } else if (value.is_number()) {
      sum[key] = sum.value(key, 0.0) + value.get<double>();
    } else {
      sum[key] = value;
    }
  }
}

void divide_numbers(Json& sum, std::uint64_t count) {
  for (auto& [key, value] : sum.members()) {
    if (value.is_object()) {
      divide_numbers(value, count);
    } else if (value.is_unsigned() && value.get<std::uint64_t>() % count == 0) {
      value = value.get<std::uint64_t>() / count;
    } else if (value.is_number()) {
      value = value.get<double>() / static_cast<double>(count);
    }
  }
}

std::optional<EquivalentMsaa> read_emr(const Json& json) {
  const Json* samples = json.find("equivalent_msaa");
  if (!samples) return std::nullopt;
  return EquivalentMsaa{samples->get<double>(), json.value("equivalent_msaa_is_lower_bound", false),
                        json.value("equivalent_msaa_is_upper_bound", false)};
}

std::string bound_text(const EquivalentMsaa& emr) {
  return emr.is_lower_bound ? "at least" : emr.is_upper_bound ? "at most" : "estimate";
}

// "color, depth, A-buffer, spilled records"
std::string off_chip_text(const Json& result) {
  std::string names;
  const auto add = [&](const Json& named) {
    auto name = named.at("name").get<std::string>();
    if (name == kABuffer) name = "A-buffer";
    std::ranges::replace(name, '_', ' ');
    add_name(names, name);
  };
  const Json surfaces = result.value("framebuffer", Json::array());
  for (const Json& surface : surfaces.elements()) add(surface);
  for (const Json& frame : result.at("frames").elements()) {
    const Json buffers = frame.value("buffers", Json::array());
    for (const Json& buffer : buffers.elements())
      for (const std::string_view name : {kABuffer, kTranslucentLayer, kSpilledRecords})
        if (buffer.at("name") == name) add(buffer);
  }
  return names;
}

TechniqueSummary read_summary(const Json& result) {
  TechniqueSummary summary;
  summary.spec = result.at("technique").get<std::string>();
  summary.bytes_per_pixel = result.at("peak_bytes_per_pixel").get<double>();
  summary.off_chip = off_chip_text(result);
  summary.on_chip_bytes_per_pixel = result.value("on_chip_bytes_per_pixel", 0.0);
  summary.pixels_on_chip = result.value("pixels_on_chip", false);
  summary.all_bytes_per_pixel = summary.bytes_per_pixel + summary.on_chip_bytes_per_pixel;
  std::vector<double> medians;
  const std::vector<Json>& frames = result.at("frames").elements();
  if (frames.empty())
    throw JsonError("expected a technique with at least one frame, found none of " + in_quotes(summary.spec));
  for (const Json& frame : frames) medians.push_back(frame.at("wall_ms").at("median").get<double>());
  summary.wall_ms = wall_time(std::move(medians)).median;
  for (const Json& frame : frames) {
    const auto count = static_cast<double>(frames.size());
    summary.bin_pixels = std::max(summary.bin_pixels, frame.value("bin_pixels", std::uint64_t{0}));
    summary.dram_bytes += frame.value("dram_bytes", 0.0) / count;
    const Json times = frame.value("modelled_ms", Json::object());
    for (const auto& [implementation, time] : times.members()) {
      ModelledMs& mean = summary.modelled_ms[implementation];
      mean.at_once += time.at("at_once").get<double>() / count;
      mean.on_cores += time.value("on_cores", 0.0) / count;
      mean.in_turn += time.at("in_turn").get<double>() / count;
      add_name(mean.busiest,
               limit_text(time.value("busiest", std::string()), time.value("busiest_rate", std::string())));
    }
  }
  if (const Json* error = result.find("error")) summary.rmse = error->at("rmse").get<double>();
  summary.emr = read_emr(result);
  return summary;
}

std::vector<std::string> implementations_of(const ReportFile& report) {
  std::set<std::string> modelled;
  for (const TechniqueSummary& summary : report.techniques)
    for (const auto& [name, ms] : summary.modelled_ms) modelled.insert(name);
  std::vector<std::string> names;
  if (const Json* const hardware = report.json.find("hardware"))
    for (const auto& [name, units] : hardware->at("implementations").members())
      if (modelled.erase(name) > 0) names.push_back(name);
  names.insert(names.end(), modelled.begin(), modelled.end());
  return names;
}

std::string hardware_label(const ReportFile& report) {
  return label_of(report.json.value("hardware_named", std::string()));
}

std::string name_of(const ReportFile& report, const std::string& implementation) {
  const std::string label = hardware_label(report);
  return label.empty() ? implementation : label + "." + implementation;
}

std::vector<Json> stage_records(const ReportFile& report) {
  std::vector<Json> records;
  for (const Json& result : report.json.at("results").elements()) {
    const std::vector<Json>& frames = result.at("frames").elements();
    std::vector<Json> stages;  // those for alpha are not in every frame
    for (const Json& frame : frames) {
      for (const Json& stage : frame.at("stages").elements()) {
        Json* const sum = find_stage(stages, stage.at("stage").get<std::string>());
        add_numbers(sum ? *sum : stages.emplace_back(), stage);
      }
    }
    for (Json& stage : stages) {
      stage["logical_bytes"] =
          stage.at("bytes_read").get<std::uint64_t>() + stage.at("bytes_written").get<std::uint64_t>();
      divide_numbers(stage, frames.size());
      add_ratios(stage);
      stage["technique"] = result.at("technique");
      const Json units = stage.value("busiest_unit", Json::object()),
                 rates = stage.value("busiest_rate", Json::object());
      for (const auto& [implementation, unit] : units.members())
        stage["busiest"][implementation] =
            limit_text(unit.get<std::string>(), rates.value(implementation, std::string()));
      records.push_back(std::move(stage));
    }
  }
  return records;
}

ReportFile read_report(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "report.json";
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw ReportError(folder.string() +
                      (std::filesystem::exists(folder, ignored) ? ": not a folder" : ": no such folder") +
                      "; expected one that `beampipe compare` or `run` has written");
  }
  ReportFile report{.folder = folder};
  report.json = parse_json(file.string());
  read_from_report(folder, [&] {
    if (report.json.at("beampipe_report") != 2) throw JsonError("its beampipe_report is not 2");
    if (report.json.contains("memory_system")) report.memory = memory_of(report.json, file.string());
    report.scene = std::filesystem::path(report.json.at("trace").get<std::string>()).stem().string();
    for (const Json& result : report.json.at("results").elements()) {
      TechniqueSummary summary = read_summary(result);
      if (summary.spec != kReferenceSpec) report.techniques.push_back(std::move(summary));
    }
    const Json ladder = report.json.value("msaa_ladder", Json::array());
    for (const Json& rung : ladder.elements()) {
      report.msaa_ladder.push_back({rung.at("samples").get<std::uint32_t>(), rung.at("rmse").get<double>()});
    }
  });
  if (report.techniques.empty()) throw ReportError(file.string() + ": it has no technique except the reference");
  return report;
}

std::vector<TechniqueSummary> mean_summaries(const std::vector<ReportFile>& reports) {
  if (reports.empty()) throw std::invalid_argument("no report to take means of");
  std::map<std::string, std::vector<TechniqueSummary>> by_spec;
  for (const ReportFile& report : reports) {
    for (const TechniqueSummary& summary : report.techniques) by_spec[summary.spec].push_back(summary);
  }
  std::vector<TechniqueSummary> means;
  for (const TechniqueSummary& summary : reports.front().techniques) {
    const std::vector<TechniqueSummary>& all = by_spec.at(summary.spec);
    if (all.size() == reports.size()) means.push_back(mean_summary(all));
  }
  if (means.empty()) {
    throw ReportError(reports.front().folder.string() + " and the other folders have no technique in common");
  }
  return means;
}

}  // namespace beampipe
