#include "tools/report/report.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <stdexcept>

#include "stages/cost/counter_registry.h"
#include "tools/claims/claims.h"
#include "tools/files/saved_work.h"

namespace beampipe {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const StageCounters& stage) {
  Json json = {{"stage", stage.stage}};
  const std::string group = "ops.";
  for (const CounterInfo& counter : stage_counters()) {
    const std::string name = counter.name;
    const bool grouped = name.starts_with(group);
    (grouped ? json["ops"][name.substr(group.size())] : json[name]) = std::uint64_t{counter.value(stage)};
  }
  return json;
}

// Everything that the frame holds at its peak.
Json buffers_json(const TechniqueReport& result, const FrameReport& frame) {
  std::vector<Buffer> buffers;
  for (const Surface& surface : result.framebuffer)
    buffers.push_back({surface.name, surface.bytes_per_pixel * frame.pixels});
  if (frame.a_buffer_peak_bytes > 0) buffers.push_back({"a_buffer", frame.a_buffer_peak_bytes});
  buffers.insert(buffers.end(), frame.buffers.begin(), frame.buffers.end());
  Json json = Json::array();
  for (const Buffer& buffer : buffers)
    json.push_back(
        {{"name", buffer.name}, {"peak_bytes", buffer.peak_bytes}, {"held", buffer.per_bin ? "bin" : "frame"}});
  return json;
}

Json to_json(const FrameReport& frame, const TechniqueReport& result, const Hardware& hardware) {
  Json json = {{"index", frame.index}, {"image", frame.image}, {"picture", frame.picture}};
  if (!frame.counters.empty()) json["counters"] = frame.counters;
  if (frame.error) json["error"] = beampipe::to_json(*frame.error);
  if (frame.flicker) json["flicker"] = *frame.flicker;
  const WallTime& wall = frame.wall_ms;
  json["wall_ms"] = {{"median", wall.median},
                     {"min", wall.min},
                     {"max", wall.max},
                     {"runs", wall.runs},
                     {"with_memory_model", wall.with_memory_model}};
  if (wall.modelling_run) json["wall_ms"]["modelling_run"] = *wall.modelling_run;
  json["a_buffer_peak_bytes"] = frame.a_buffer_peak_bytes;
  StageCounters all;
  for (const StageCounters& stage : frame.stages) all += stage;
  const Json sums = to_json(all);
  for (const char* column : {"logical_bytes", "sector_bytes", "l2_bytes", "dram_bytes"}) json[column] = sums.at(column);
  json["buffers"] = buffers_json(result, frame);
  for (const auto& [name, stats] : frame.pixel_counters)
    json["pixel_counters"][name] = {{"mean", stats.mean}, {"max", stats.max}};
  for (const SavedWork& saved : saved_work(frame.stages)) json["saved"][saved.name] = saved.amount;
  json["stages"] = Json::array();
  for (const StageCounters& stage : frame.stages) json["stages"].push_back(to_json(stage));
  if (all.sector_bytes == 0) return json;  // without memory, as the reference runs, a time would mean nothing
  for (const Implementation& implementation : hardware.implementations) {
    const ModelledTime time = modelled_time(hardware, implementation, frame.stages);
    json["modelled_ms"][implementation.name] = {
        {"overlap", time.overlap_ms}, {"sum", time.sum_ms}, {"busiest", time.busiest}};
    for (std::size_t i = 0; i < time.stages.size(); ++i)
      json["stages"][i]["modelled_ms"][implementation.name] = time.stages[i];
  }
  return json;
}

Json to_json(const TechniqueReport& result, const Hardware& hardware) {
  Json json = {{"technique", result.technique},
               {"framebuffer_bytes_per_pixel", result.framebuffer_bytes_per_pixel},
               {"peak_bytes_per_pixel", result.peak_bytes_per_pixel()}};
  json["framebuffer"] = Json::array();
  for (const Surface& surface : result.framebuffer) {
    json["framebuffer"].push_back(
        {{"name", surface.name}, {"format", surface.format}, {"bytes_per_pixel", surface.bytes_per_pixel}});
  }
  std::uint64_t peak = 0;
  for (const FrameReport& frame : result.frames) peak = std::max(peak, frame.a_buffer_peak_bytes);
  json["a_buffer_peak_bytes"] = peak;
  if (result.error) json["error"] = beampipe::to_json(*result.error);
  if (result.equivalent_msaa) {
    json["equivalent_msaa"] = result.equivalent_msaa->samples;
    json["equivalent_msaa_is_lower_bound"] = result.equivalent_msaa->is_lower_bound;
    if (result.equivalent_msaa->is_upper_bound) json["equivalent_msaa_is_upper_bound"] = true;
  }
  if (result.flicker) json["flicker"] = *result.flicker;
  for (const auto& [cause, part] : result.causes) json["error_causes"][cause] = part;
  if (!result.orders.empty()) {
    for (const OrderReport& order : result.orders) json["orders"][order.order] = {{"rmse", order.rmse}};
    json["orders"]["largest_difference"] = result.order_difference;
  }
  json["frames"] = Json::array();
  for (const FrameReport& frame : result.frames) json["frames"].push_back(to_json(frame, result, hardware));
  return json;
}

Json to_json(const CacheParameters& cache) {
  return {{"bytes", cache.bytes}, {"ways", cache.ways}, {"line_bytes", cache.line_bytes}};
}

Json to_json(const MemoryParameters& memory) {
  return {{"modelled", memory.modelled},         {"compression", memory.compression},
          {"sector_bytes", memory.sector_bytes}, {"rop_cache", to_json(memory.rop)},
          {"l1_cache", to_json(memory.l1)},      {"l2_cache", to_json(memory.l2)},
          {"plane_bytes", memory.plane_bytes},   {"bin_pixels", kBinSize}};
}

[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...) {
  char text[64];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

// Over the frames, the median of their medians.
double median_ms(const TechniqueReport& result) {
  std::vector<double> medians;
  for (const FrameReport& frame : result.frames) medians.push_back(frame.wall_ms.median);
  return wall_time(std::move(medians)).median;
}

std::string pictures(const TechniqueReport& result, const std::string& folder) {
  std::string text = folder + "/" + result.frames.front().picture;
  if (result.frames.size() > 1) text += " and " + std::to_string(result.frames.size() - 1) + " more";
  return text;
}

// Of UTF-8 text, in characters.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

WallTime wall_time(std::vector<double> milliseconds) {
  if (milliseconds.empty()) throw std::invalid_argument("no run was timed");
  std::sort(milliseconds.begin(), milliseconds.end());
  const std::size_t runs = milliseconds.size();
  const double median = (milliseconds[(runs - 1) / 2] + milliseconds[runs / 2]) / 2;
  return {.median = median, .min = milliseconds.front(), .max = milliseconds.back(), .runs = static_cast<int>(runs)};
}

PixelCounterStats measure_counter(const std::vector<float>& values) {
  PixelCounterStats stats;
  for (const float value : values) {
    stats.mean += value / static_cast<double>(values.size());
    stats.max = std::max<double>(stats.max, value);
  }
  return stats;
}

std::string program_version() { return BEAMPIPE_VERSION; }

double TechniqueReport::peak_bytes_per_pixel() const {
  double most = 0;
  for (const FrameReport& frame : frames)
    if (frame.pixels > 0)
      most = std::max(most, static_cast<double>(frame.a_buffer_peak_bytes) / static_cast<double>(frame.pixels));
  return framebuffer_bytes_per_pixel + most;
}

TechniqueReport new_technique_report(const Technique& technique) {
  TechniqueReport report;
  report.technique = technique.spec;
  report.framebuffer = technique.framebuffer;
  report.framebuffer_bytes_per_pixel = technique.framebuffer_bytes_per_pixel();
  return report;
}

Json to_json(const ErrorStats& stats) {
  return {{"rmse", stats.rmse}, {"bias", stats.bias}, {"p99", stats.p99}, {"max", stats.max}};
}

Json to_json(const Report& report) {
  Json json = {{"beampipe_report", 1}, {"trace", report.trace},     {"version", report.version},
               {"simd", report.simd},  {"threads", report.threads}, {"memory_system", to_json(report.memory)}};
  if (!report.made_by.is_null()) json["made_by"] = report.made_by;
  if (!report.hardware.implementations.empty()) json["hardware"] = report.hardware.json;
  if (!report.msaa_ladder.empty()) {
    json["msaa_ladder"] = Json::array();
    for (const LadderRung& rung : report.msaa_ladder) {
      json["msaa_ladder"].push_back({{"samples", rung.samples}, {"rmse", rung.rmse}});
    }
  }
  json["results"] = Json::array();
  for (const TechniqueReport& result : report.results) json["results"].push_back(to_json(result, report.hardware));
  json["claims"] = Json::array();
  for (const Claim& claim : answered_claims(report)) json["claims"].push_back(to_json(claim));
  return json;
}

std::string json_text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

std::string spec_folder(std::string_view spec) {
  std::string folder(spec);
  for (char& c : folder) {
    const bool kept =
        (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '=' || c == '-';
    if (!kept) c = '_';
  }
  return folder;
}

std::string frame_stem(std::string_view spec, std::size_t frame) {
  char number[32];
  std::snprintf(number, sizeof number, "/frame_%04zu", frame);
  return spec_folder(spec) + number;
}

std::string emr_text(const EquivalentMsaa& emr) {
  const std::string samples = emr.samples < 100 ? format("%.3g", emr.samples) : format("%.0f", emr.samples);
  return (emr.is_lower_bound ? "≥ " : emr.is_upper_bound ? "< " : "") + samples;
}

std::string table_text(const Report& report, const std::string& folder) {
  const bool compared = !report.results.empty() && report.results.front().error.has_value();
  std::vector<std::vector<std::string>> rows(1);
  rows[0] = {"technique", "bytes/pixel", "with A-buffer"};
  if (compared) rows[0].insert(rows[0].end(), {"RMSE", "bias", "p99", "max", "EMR"});
  const bool moves = compared && report.results.front().flicker.has_value();
  if (moves) rows[0].push_back("flicker");
  const bool with_model = !report.results.empty() && report.results.front().frames.front().wall_ms.with_memory_model;
  rows[0].insert(rows[0].end(), {with_model ? "ms with model" : "ms", "picture"});
  for (const TechniqueReport& result : report.results) {
    std::vector<std::string>& row = rows.emplace_back();
    row = {result.technique, std::to_string(result.framebuffer_bytes_per_pixel),
           format("%.0f", result.peak_bytes_per_pixel())};
    if (compared) {
      const ErrorStats& error = result.error.value();
      row.insert(row.end(), {format("%.6f", error.rmse), format("%+.6f", error.bias), format("%.5f", error.p99),
                             format("%.5f", error.max), emr_text(result.equivalent_msaa.value())});
    }
    if (moves) row.push_back(format("%.6f", result.flicker.value_or(0.0)));
    row.insert(row.end(), {format("%.1f", median_ms(result)), pictures(result, folder)});
  }
  return align_columns(rows, {0, rows[0].size() - 1});
}

std::string causes_text(const Report& report) {
  std::vector<std::vector<std::string>> rows(1);
  for (const TechniqueReport& result : report.results) {
    if (result.causes.empty()) continue;
    std::vector<std::string>& row = rows.emplace_back(std::vector{result.technique});
    rows[0] = {"part of the mean square error"};
    for (const auto& [cause, part] : result.causes) {
      rows[0].push_back(cause);
      row.push_back(format("%.1f %%", 100 * part));
    }
  }
  return rows.size() > 1 ? std::string("\n").append(align_columns(rows, {0})) : std::string();
}

std::string orders_text(const Report& report) {
  std::vector<std::vector<std::string>> rows(1);
  for (const TechniqueReport& result : report.results) {
    if (result.orders.empty()) continue;
    std::vector<std::string>& row = rows.emplace_back(std::vector{result.technique});
    rows[0] = {"RMSE by order of triangles"};
    for (const OrderReport& order : result.orders) {
      rows[0].push_back(order.order);
      row.push_back(format("%.6f", order.rmse));
    }
    rows[0].push_back("largest difference");
    row.push_back(format("%.6f", result.order_difference));
  }
  return rows.size() > 1 ? std::string("\n").append(align_columns(rows, {0})) : std::string();
}

std::string align_columns(const std::vector<std::vector<std::string>>& rows, const std::vector<std::size_t>& left) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string blanks(widths[i] - width_of(row[i]), ' ');
      const bool at_left = std::find(left.begin(), left.end(), i) != left.end();
      line += (i > 0 ? "  " : "") + (at_left ? row[i] + blanks : blanks + row[i]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace beampipe
