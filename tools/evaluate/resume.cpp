#include "tools/evaluate/resume.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "simd/target.h"
#include "tools/evaluate/frame_json.h"
#include "tools/evaluate/memory_system.h"
#include "tools/files/digest.h"
#include "tools/files/sealed_json.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = "unfinished";

// How messages name what made_by holds only as a digest.
const std::map<std::string, std::string> kDigested = {{"program", "another build of beampipe"},
                                                      {"trace", "another trace"},
                                                      {"hardware", "another --hardware"},
                                                      {"memory_system", "another memory system"}};

// Null if there is no such file, or if it holds no JSON object.
Json read_json(const fs::path& path) {
  try {
    Json json = parse_json(path.string());
    return json.is_object() ? json : Json();
  } catch (const TraceError&) {
    return nullptr;
  }
}

Json maker_of(const Json& json) { return json.is_object() ? json.value("made_by", Json()) : Json(); }

// Digests of the frame's files that exist, by name.
Json digests_of_files(const fs::path& folder, const FrameRecord& record) {
  Json digests = Json::object();
  std::error_code ignored;
  for (const FrameReport& report : record.reports)
    for (const std::string& name : {report.image, report.picture, report.counters})
      if (fs::is_regular_file(folder / name, ignored)) digests[name] = digest_of_file(folder / name);
  return digests;
}

// Whether the report is about this frame and technique.
bool is_of(const FrameReport& report, std::size_t frame, const std::string& spec) {
  const std::string stem = frame_stem(spec, frame);
  return report.index == frame && report.image == stem + ".exr" && report.picture == stem + ".png" &&
         (report.counters.empty() || report.counters == stem + "_counters.exr");
}

Json with_all_numbers_0(Json json) {
  if (json.is_number()) return 0;
  if (json.is_array())
    for (Json& element : json.elements()) element = with_all_numbers_0(element);
  if (json.is_object())
    for (auto& [key, value] : json.members()) value = with_all_numbers_0(value);
  return json;
}

std::string range_text(const std::vector<std::size_t>& frames) {
  return std::to_string(frames.front()) + "-" + std::to_string(frames.back());
}

}  // namespace

Form<Maker> maker_form() {
  const Form<std::string> digest{
      {{"type", "string"}, {"pattern", "^[0-9a-f]{16}$"}}, {}, [](const std::string& text) { return Json(text); }};
  const Form<std::string> command = form::one_of({"run", "compare"}), text = form::text();
  return ObjectForm<Maker>()
      .written("command", &Maker::command, command, "The command.")
      .written(
          "version", [](const Maker&) { return program_version(); }, text, "Of the program.")
      .written(
          "program", [](const Maker&) { return program_digest(); }, digest,
          "Digest of the program's file, and of the code of techniques that are not in it.")
      .written(
          "trace", [](const Maker& maker) { return digest_of(maker.plan.trace); }, digest,
          "Digest of the trace's content. Published figures belong to a trace by it.")
      .written(
          "techniques", [](const Maker& maker) { return specs_of(maker.plan.techniques); }, form::list(text),
          "The specs.")
      .written(
          "frames", [](const Maker& maker) { return range_text(maker.plan.frames); }, text,
          "The first and the last frame, with \"-\" between them.")
      .written(
          "unmeasured_frames",
          [](const Maker& maker) {
            return maker.plan.unmeasured.empty() ? std::nullopt : std::optional(range_text(maker.plan.unmeasured));
          },
          text, "Those that were drawn before them and not measured, likewise.")
      .written(
          "repeat", [](const Maker& maker) { return maker.plan.repeat; }, form::count(1), "Timed runs of each frame.")
      .written(
          "threads", [](const Maker& maker) { return maker.plan.options.threads; }, form::count(1),
          "That worked at once.")
      .written(
          "simd", [](const Maker&) { return simd_target(); }, text, "The instruction set.")
      .written(
          "memory_model", [](const Maker& maker) { return maker.plan.options.memory.modelled; }, form::boolean(),
          "Whether caches and DRAM were modelled.")
      .written(
          "memory_system",
          [](const Maker& maker) { return digest_of(parameters_json(maker.plan.options.memory).dump()); }, digest,
          "Digest of the parameters.")
      .written(
          "hardware", [](const Maker& maker) { return digest_of(maker.plan.hardware.json.dump()); }, digest,
          "Digest of the description.")
      .written(
          "shading_options",
          [](const Maker& maker) {
            return maker.plan.shading_options.empty() ? std::nullopt : std::optional(maker.plan.shading_options);
          },
          text, "Options that add to what shading costs.")
      .written("ladder", &Maker::ladder, form::list(form::count(1)),
               "compare: the MSAA rates of --ladder; empty: the default ones.")
      .written("causes", &Maker::causes, form::boolean(), "compare: --causes.")
      .written("orders", &Maker::orders, form::boolean(), "compare: --orders.")
      .written("metric", &Maker::metric, text, "compare: --metric.")
      .written("pixels_per_degree", &Maker::pixels_per_degree, form::amount(), "compare: --pixels-per-degree.");
}

std::string frame_record_name(std::size_t frame) { return frame_stem(kFolder, frame) + ".json"; }

void FrameRecords::require_own_folder() const {
  std::vector<fs::path> files = list();
  files.push_back(output_.path() / "report.json");
  for (const fs::path& file : files) {
    const Json other = maker_of(read_json(file));
    if (!other.is_object() || !other.contains("trace") || !other.contains("command")) continue;
    std::string found;
    if (other.at("trace") != maker_.at("trace")) found = "another trace";
    if (other.at("command") == "compare" && maker_.at("command") == "run") found = "beampipe compare";
    if (!found.empty())
      throw std::runtime_error(output_.path().string() + ": expected a folder without other results, found those of " +
                               found + "; --force writes over them");
  }
}

bool FrameRecords::is_finished() {
  const Json report = read_json(output_.path() / "report.json");
  if (!report.is_object()) return false;
  if (maker_of(report) != maker_) refuse(maker_of(report));
  remove();
  return true;
}

std::size_t FrameRecords::read(const std::vector<std::size_t>& frames, const std::vector<std::string>& specs,
                               const Json& no_sums, const std::function<bool(const FrameRecord&)>& take) const {
  bool some_are_ours = false;
  Json other;
  for (const fs::path& path : list()) {
    Json maker = maker_of(read_json(path));
    some_are_ours |= maker == maker_;
    if (maker.is_object()) other = std::move(maker);
  }
  if (!some_are_ours && other.is_object()) refuse(other);

  std::size_t taken = 0;
  for (; taken < frames.size(); ++taken) {
    const std::optional<FrameRecord> record = read(frames[taken], specs, no_sums);
    if (!record || !take(*record)) break;
  }
  set_kept(taken, frames.size());
  return taken;
}

std::optional<FrameRecord> FrameRecords::read(std::size_t frame, const std::vector<std::string>& specs,
                                              const Json& no_sums) const {
  try {
    const Json json = unsealed(read_json(output_.path() / frame_record_name(frame)));
    if (maker_of(json) != maker_) return std::nullopt;
    FrameRecord record;
    for (const Json& technique : json.at("techniques").elements()) record.reports.push_back(stored_frame(technique));
    record.sums = json.at("sums");
    const bool is_ours = std::equal(record.reports.begin(), record.reports.end(), specs.begin(), specs.end(),
                                    [&](const auto& report, const auto& spec) { return is_of(report, frame, spec); });
    if (!is_ours || with_all_numbers_0(record.sums) != with_all_numbers_0(no_sums) ||
        json.at("files") != digests_of_files(output_.path(), record))
      return std::nullopt;
    return record;
  } catch (const JsonError&) {  // a key is missing, or a value has another type
    return std::nullopt;
  }
}

void FrameRecords::write(const FrameRecord& record, std::size_t finished, std::size_t all) {
  Json json = {{"beampipe_frame", 1}, {"made_by", maker_}, {"sums", record.sums}, {"techniques", Json::array()}};
  for (const FrameReport& report : record.reports) json["techniques"].push_back(stored_json(report));
  json["files"] = digests_of_files(output_.path(), record);
  output_.write(frame_record_name(record.reports.front().index), json_text(sealed(std::move(json))));
  set_kept(finished, all);
}

void FrameRecords::remove() {
  output_.set_kept("");
  for (const fs::path& path : list()) output_.remove(path.lexically_relative(output_.path()));
  output_.remove(kFolder);  // stays if something else is in it
}

void FrameRecords::set_kept(std::size_t finished, std::size_t all) const {
  output_.set_kept(finished == 0 ? "no frame is complete"
                                 : std::to_string(finished) + " of " + std::to_string(all) +
                                       " frames are kept, and the same command with --resume goes on from there");
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
  for (const auto& [name, value] : maker_.members()) {
    if (!other.contains(name) || other.at(name) == value) continue;
    const auto digested = kDigested.find(name);
    what =
        digested != kDigested.end() ? digested->second : name + " " + other.at(name).dump() + ", not " + value.dump();
    break;
  }
  throw std::runtime_error(output_.path().string() + ": cannot resume, because the files there were made with " + what +
                           "; start again without --resume, or use another folder");
}

}  // namespace beampipe
