#include "tools/evaluate/frame_json.h"

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "stages/cost/counters.h"
#include "tools/evaluate/saved_work.h"

namespace beampipe {
namespace {

// In "buffers".
constexpr const char *kABuffer = "a_buffer", *kHeldByBin = "bin";

// Where a counter stands in the JSON of a stage: "ops.add" is the key "add" of the object "ops".
std::pair<std::string_view, std::string_view> keys_of(const CounterInfo& counter) {
  const std::string_view name = counter.name;
  const std::size_t dot = name.find('.');
  return dot == name.npos ? std::pair(std::string_view(), name) : std::pair(name.substr(0, dot), name.substr(dot + 1));
}

Json to_json(const StageCounters& stage) {
  Json json = {{"stage", name_of(stage.stage)}};
  for (const CounterInfo& counter : stage_counters()) {
    const auto [group, key] = keys_of(counter);
    Json& object = group.empty() ? json : json[group];
    object[key] = std::uint64_t{counter.value(stage)};
  }
  return json;
}

StageCounters stage_of(const Json& json) {
  const std::string name = json.at("stage").get<std::string>();
  const std::optional<Stage> known = find_stage(name);
  if (!known) throw std::runtime_error("\"stage\": expected the name of a stage, found \"" + name + '"');
  StageCounters stage{*known};
  for (const CounterInfo& counter : stage_counters()) {
    const auto [group, key] = keys_of(counter);
    const Json& object = group.empty() ? json : json.at(group);
    if (std::uint64_t* stored = counter.stored(stage)) *stored = object.at(key).get<std::uint64_t>();
  }
  return stage;
}

Json to_json(const WallTime& wall) {
  Json json = {{"median", wall.median},
               {"min", wall.min},
               {"max", wall.max},
               {"runs", wall.runs},
               {"with_memory_model", wall.with_memory_model}};
  if (wall.modelling_run) json["modelling_run"] = *wall.modelling_run;
  return json;
}

WallTime wall_time_of(const Json& json) {
  WallTime wall{.median = json.at("median").get<double>(),
                .min = json.at("min").get<double>(),
                .max = json.at("max").get<double>(),
                .runs = json.at("runs").get<int>(),
                .with_memory_model = json.at("with_memory_model").get<bool>()};
  if (const Json* modelling_run = json.find("modelling_run")) wall.modelling_run = modelling_run->get<double>();
  return wall;
}

// All buffers of the frame at their peak: the framebuffer's surfaces, the A-buffer and others.
Json buffers_json(const TechniqueReport& result, const FrameReport& frame) {
  std::vector<Buffer> buffers;
  for (const Surface& surface : result.framebuffer)
    buffers.push_back({surface.name, surface.bytes_per_pixel * frame.pixels});
  if (frame.a_buffer_peak_bytes > 0) buffers.push_back({kABuffer, frame.a_buffer_peak_bytes});
  buffers.insert(buffers.end(), frame.buffers.begin(), frame.buffers.end());
  Json json = Json::array();
  for (const Buffer& buffer : buffers)
    json.push_back(
        {{"name", buffer.name}, {"peak_bytes", buffer.peak_bytes}, {"held", buffer.per_bin ? kHeldByBin : "frame"}});
  return json;
}

}  // namespace

Json to_json(const ErrorStats& stats) {
  return {{"rmse", stats.rmse}, {"bias", stats.bias}, {"p99", stats.p99}, {"max", stats.max}};
}

Json to_json(const FrameReport& frame, const TechniqueReport& result, const Hardware& hardware,
             const std::vector<Hardware>& more) {
  Json json = {{"index", frame.index}, {"image", frame.image}, {"picture", frame.picture}};
  if (!frame.counters.empty()) json["counters"] = frame.counters;
  if (frame.error) json["error"] = beampipe::to_json(*frame.error);
  if (frame.parts) {
    json["visibility"]["rmse"] = frame.parts->visibility;
    json["shading"]["rmse"] = frame.parts->shading;
  }
  if (frame.flicker) json["flicker"] = *frame.flicker;
  json["wall_ms"] = to_json(frame.wall_ms);
  json["a_buffer_peak_bytes"] = frame.a_buffer_peak_bytes;
  json["bin_pixels"] = frame.bin_pixels;
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
  if (all.sector_bytes == 0) return json;  // the reference models no memory, and times without it would mean nothing
  const auto add = [&](const Hardware& each, const std::string& prefix) {
    for (const Implementation& implementation : each.implementations) {
      const ModelledTime time = modelled_time(each, implementation, frame.stages, frame.open_pixel_bytes());
      const std::string name = prefix + implementation.name;
      json["modelled_ms"][name] = {{"overlap", time.overlap_ms}, {"sum", time.sum_ms}, {"busiest", time.busiest}};
      for (std::size_t i = 0; i < time.stages.size(); ++i) json["stages"][i]["modelled_ms"][name] = time.stages[i];
    }
  };
  add(hardware, "");
  for (const Hardware& each : more) add(each, each.label + ".");
  return json;
}

FrameReport frame_of(const Json& json) {
  FrameReport frame;
  frame.index = json.at("index").get<std::size_t>();
  frame.image = json.at("image").get<std::string>();
  frame.picture = json.at("picture").get<std::string>();
  frame.counters = json.value("counters", std::string());
  if (const Json* error = json.find("error"))
    frame.error = {error->at("rmse").get<double>(), error->at("bias").get<double>(), error->at("p99").get<double>(),
                   error->at("max").get<double>()};
  if (const Json* visibility = json.find("visibility"))
    frame.parts = {visibility->at("rmse").get<double>(), json.at("shading").at("rmse").get<double>()};
  if (const Json* flicker = json.find("flicker")) frame.flicker = flicker->get<double>();
  frame.wall_ms = wall_time_of(json.at("wall_ms"));
  frame.a_buffer_peak_bytes = json.at("a_buffer_peak_bytes").get<std::uint64_t>();
  frame.bin_pixels = json.at("bin_pixels").get<std::uint64_t>();
  for (const Json& buffer : json.at("buffers").elements())
    if (buffer.at("name") != kABuffer)
      frame.buffers.push_back({buffer.at("name").get<std::string>(), buffer.at("peak_bytes").get<std::uint64_t>(),
                               buffer.at("held") == kHeldByBin});
  if (const Json* counters = json.find("pixel_counters"))
    for (const auto& [name, stats] : counters->members())
      frame.pixel_counters[name] = {stats.at("mean").get<double>(), stats.at("max").get<double>()};
  for (const Json& stage : json.at("stages").elements()) frame.stages.push_back(stage_of(stage));
  return frame;
}

Json stored_json(const FrameReport& frame) {
  Json json = to_json(frame, TechniqueReport{}, Hardware{});
  json["pixels"] = frame.pixels;
  return json;
}

FrameReport stored_frame(const Json& json) {
  FrameReport frame = frame_of(json);
  frame.pixels = json.at("pixels").get<std::uint64_t>();
  return frame;
}

}  // namespace beampipe
