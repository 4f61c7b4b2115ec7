#include "tools/evaluate/resume.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>

#include "simd/target.h"
#include "tools/files/digest.h"
#include "traces/json_cursor.h"
#include "traces/trace_io.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = "unfinished";

// Of what made_by holds only as digests.
const std::map<std::string, std::string> kDigested = {
    {"program", "another build of beampipe"}, {"trace", "another trace"}, {"hardware", "another --hardware"}};

constexpr std::uint64_t StageCounters::*kCounters[] = {
    &StageCounters::items_in,      &StageCounters::items_out,        &StageCounters::bytes_read,
    &StageCounters::bytes_written, &StageCounters::lanes_used,       &StageCounters::lanes_issued,
    &StageCounters::sector_bytes,  &StageCounters::l2_bytes,         &StageCounters::dram_bytes,
    &StageCounters::hidden_items,  &StageCounters::hidden_triangles, &StageCounters::empty_tiles};
constexpr std::uint64_t OperationCounts::*kOperations[] = {&OperationCounts::mul_add, &OperationCounts::add,
                                                           &OperationCounts::bit,     &OperationCounts::fetch,
                                                           &OperationCounts::special, &OperationCounts::convert};
static_assert(sizeof(StageCounters) ==
                  sizeof(std::string) + sizeof(std::uint64_t) * (std::size(kCounters) + std::size(kOperations)),
              "a record holds every counter");

Json record_of(const StageCounters& stage) {
  Json json = {stage.stage};
  for (const auto counter : kCounters) json.push_back(stage.*counter);
  for (const auto operation : kOperations) json.push_back(stage.ops.*operation);
  return json;
}

StageCounters stage_of(const Json& json) {
  StageCounters stage{json.at(0)};
  std::size_t at = 1;
  for (const auto counter : kCounters) stage.*counter = json.at(at++);
  for (const auto operation : kOperations) stage.ops.*operation = json.at(at++);
  return stage;
}

Json record_of(const FrameReport& frame) {
  const WallTime& wall = frame.wall_ms;
  Json json = {{"index", frame.index},
               {"image", frame.image},
               {"picture", frame.picture},
               {"counters", frame.counters},
               {"wall_ms", {wall.median, wall.min, wall.max, wall.runs, wall.with_memory_model}},
               {"a_buffer_peak_bytes", frame.a_buffer_peak_bytes},
               {"pixels", frame.pixels},
               {"pixel_counters", Json::object()},
               {"buffers", Json::array()},
               {"stages", Json::array()}};
  for (const auto& [name, stats] : frame.pixel_counters) json["pixel_counters"][name] = {stats.mean, stats.max};
  for (const Buffer& buffer : frame.buffers)
    json["buffers"].push_back({buffer.name, buffer.peak_bytes, buffer.per_bin});
  if (wall.modelling_run) json["modelling_run_ms"] = *wall.modelling_run;
  if (frame.error) json["error"] = to_json(*frame.error);
  if (frame.flicker) json["flicker"] = *frame.flicker;
  for (const StageCounters& stage : frame.stages) json["stages"].push_back(record_of(stage));
  return json;
}

FrameReport report_of(const Json& json) {
  FrameReport frame;
  frame.index = json.at("index");
  frame.image = json.at("image");
  frame.picture = json.at("picture");
  frame.counters = json.at("counters");
  const Json& wall = json.at("wall_ms");
  frame.wall_ms = {wall.at(0), wall.at(1), wall.at(2), wall.at(3), wall.at(4), std::nullopt};
  if (json.contains("modelling_run_ms")) frame.wall_ms.modelling_run = json["modelling_run_ms"].get<double>();
  frame.a_buffer_peak_bytes = json.at("a_buffer_peak_bytes");
  frame.pixels = json.at("pixels");
  for (const auto& [name, stats] : json.at("pixel_counters").items())
    frame.pixel_counters[name] = {stats.at(0), stats.at(1)};
  for (const Json& buffer : json.at("buffers")) frame.buffers.push_back({buffer.at(0), buffer.at(1), buffer.at(2)});
  for (const Json& stage : json.at("stages")) frame.stages.push_back(stage_of(stage));
  if (json.contains("error")) {
    const Json& error = json["error"];
    frame.error = ErrorStats{error.at("rmse"), error.at("bias"), error.at("p99"), error.at("max")};
  }
  if (json.contains("flicker")) frame.flicker = json["flicker"].get<double>();
  return frame;
}

// Null: there is none, or it is not JSON.
Json read_json(const fs::path& path) {
  try {
    Json json = parse_json(path.string());
    return json.is_object() ? json : Json();
  } catch (const TraceError&) {
    return nullptr;
  }
}

Json maker_of(const Json& json) { return json.is_object() ? json.value("made_by", Json()) : Json(); }

// Of those of the frame's files that are there, by name.
Json digests_of_files(const fs::path& folder, const FrameRecord& record) {
  Json digests = Json::object();
  std::error_code ignored;
  for (const FrameReport& report : record.reports)
    for (const std::string& name : {report.image, report.picture, report.counters})
      if (fs::is_regular_file(folder / name, ignored)) digests[name] = digest_of_file(folder / name);
  return digests;
}

Json sealed(Json record) {
  record["digest"] = digest_of(json_text(record));
  return record;
}

// Null: it is not as it was sealed.
Json unsealed(Json record) {
  if (!record.is_object()) return nullptr;
  const Json digest = record["digest"];
  record.erase("digest");
  return digest == digest_of(json_text(record)) ? record : Json();
}

// Whether it is of this frame and technique.
bool is_of(const FrameReport& report, std::size_t frame, const std::string& spec) {
  const std::string stem = frame_stem(spec, frame);
  return report.index == frame && report.image == stem + ".exr" && report.picture == stem + ".png" &&
         (report.counters.empty() || report.counters == stem + "_counters.exr");
}

Json with_all_numbers_0(Json json) {
  if (json.is_number()) return 0;
  for (Json& child : json)
    if (json.is_structured()) child = with_all_numbers_0(child);
  return json;
}

std::string range_text(const std::vector<std::size_t>& frames) {
  return std::to_string(frames.front()) + "-" + std::to_string(frames.back());
}

}  // namespace

Json made_by(const std::string& command, const RunPlan& plan, const Json& more) {
  Json json = {{"command", command},
               {"version", program_version()},
               {"program", digest_of_file("/proc/self/exe")},
               {"trace", digest_of(plan.trace)},
               {"techniques", specs_of(plan.techniques)},
               {"frames", range_text(plan.frames)},
               {"repeat", plan.repeat},
               {"threads", plan.options.threads},
               {"simd", simd_target()},
               {"memory_model", plan.options.memory.modelled},
               {"compression", plan.options.memory.compression},
               {"hardware", digest_of(plan.hardware.json.dump())}};
  json.update(more);
  return json;
}

std::string frame_record_name(std::size_t frame) { return frame_stem(kFolder, frame) + ".json"; }

bool FrameRecords::is_finished() {
  const Json report = read_json(output_.path() / "report.json");
  if (!report.is_object()) return false;
  if (maker_of(report) != maker_) refuse(maker_of(report));
  remove();
  return true;
}

std::vector<FrameRecord> FrameRecords::read(const std::vector<std::size_t>& frames,
                                            const std::vector<std::string>& specs, const Json& no_sums) const {
  bool some_are_ours = false;
  Json other;
  for (const fs::path& path : list()) {
    Json maker = maker_of(read_json(path));
    some_are_ours |= maker == maker_;
    if (maker.is_object()) other = std::move(maker);
  }
  if (!some_are_ours && other.is_object()) refuse(other);

  std::vector<FrameRecord> records;
  for (const std::size_t frame : frames) {
    std::optional<FrameRecord> record = read(frame, specs, no_sums);
    if (!record) break;
    records.push_back(std::move(*record));
  }
  return records;
}

std::optional<FrameRecord> FrameRecords::read(std::size_t frame, const std::vector<std::string>& specs,
                                              const Json& no_sums) const {
  try {
    const Json json = unsealed(read_json(output_.path() / frame_record_name(frame)));
    if (maker_of(json) != maker_) return std::nullopt;
    FrameRecord record;
    for (const Json& technique : json.at("techniques")) record.reports.push_back(report_of(technique));
    record.sums = json.at("sums");
    const bool is_ours = std::equal(record.reports.begin(), record.reports.end(), specs.begin(), specs.end(),
                                    [&](const auto& report, const auto& spec) { return is_of(report, frame, spec); });
    if (!is_ours || with_all_numbers_0(record.sums) != with_all_numbers_0(no_sums) ||
        json.at("files") != digests_of_files(output_.path(), record))
      return std::nullopt;
    return record;
  } catch (const Json::exception&) {  // something in it is missing, or of another type
    return std::nullopt;
  }
}

void FrameRecords::write(const FrameRecord& record) {
  Json json = {{"beampipe_frame", 1}, {"made_by", maker_}, {"sums", record.sums}, {"techniques", Json::array()}};
  for (const FrameReport& report : record.reports) json["techniques"].push_back(record_of(report));
  json["files"] = digests_of_files(output_.path(), record);
  output_.write(frame_record_name(record.reports.front().index), json_text(sealed(std::move(json))));
}

void FrameRecords::remove() {
  for (const fs::path& path : list()) output_.remove(path.lexically_relative(output_.path()));
  output_.remove(kFolder);  // unless something else is in it
}

std::vector<fs::path> FrameRecords::list() const {
  std::vector<fs::path> paths;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(output_.path() / kFolder, ignored))
    if (entry.path().filename().string().starts_with("frame_")) paths.push_back(entry.path());
  return paths;
}

void FrameRecords::refuse(const Json& other) const {
  std::string what = "something else";
  for (const auto& [name, value] : maker_.items()) {
    if (!other.contains(name) || other[name] == value) continue;
    const auto digested = kDigested.find(name);
    what = digested != kDigested.end() ? digested->second : name + " " + other[name].dump() + ", not " + value.dump();
    break;
  }
  throw std::runtime_error(output_.path().string() + ": cannot resume: what is there was made with " + what +
                           "; start again without --resume, or in another folder");
}

void tell_resumption(const RunPlan& plan, std::size_t finished_frames) {
  if (finished_frames == 0 || finished_frames == plan.frames.size()) return;
  std::string text = "beampipe: " + std::to_string(finished_frames) + " of " + std::to_string(plan.frames.size()) +
                     " frames are there; going on at frame " + std::to_string(plan.frames[finished_frames]);
  std::string accumulating;
  for (const Technique& technique : plan.techniques)
    if (technique.keeps_history) accumulating += (accumulating.empty() ? "" : ", ") + technique.spec;
  if (!accumulating.empty()) text += " (" + accumulating + ": earlier frames are rendered again for their history)";
  std::cerr << text << std::endl;
}

void tell_finished(const OutputFolder& output) {
  std::cout << "finished already\nreport: " << (output.path() / "report.json").string() << "\n";
}

}  // namespace beampipe
