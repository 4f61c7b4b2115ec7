#include "tools/report/tables.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <map>

#include "pipeline/technique.h"
#include "tools/evaluate/energy.h"
#include "tools/evaluate/frame_json.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/measures.h"
#include "tools/evaluate/modelled_time.h"
#include "tools/evaluate/saved_work.h"
#include "tools/files/csv.h"

namespace beampipe {
namespace {

struct Source {
  Column column;
  std::string pointer;  // the keys to the value in a row's record, each after a "/"
};

// Views of the tables of techniques and frames, stages, and claims.
constexpr const char *kAccuracy = "accuracy", *kMeasures = "measures", *kMemory = "memory", *kTime = "time";
constexpr const char *kLeast = "least energy", *kMost = "most energy";
constexpr const char *kItems = "items", *kOperations = "operations", *kBytes = "bytes", *kTexels = "texels";
constexpr const char *kNumbers = "numbers", *kSources = "sources";

// From a record's "error".
Source column_of(const Measure& measure, const char* view) {
  return {{measure.key, measure.title, measure.unit, measure.meaning, view}, std::string("/error/") + measure.key};
}

// Adds the measures that are not among the columns.
std::vector<Source> with_measures(std::vector<Source> sources) {
  for (const Measure& measure : measures()) {
    const auto is_it = [&](const Source& source) { return source.column.key == measure.key; };
    if (std::none_of(sources.begin(), sources.end(), is_it)) sources.push_back(column_of(measure, kMeasures));
  }
  return sources;
}

const std::vector<Source> kTechniqueColumns = {
    {{"technique", "technique", "", "The technique's spec, as `beampipe run -t` takes it."}, "/technique"},
    column_of(find_metric("rmse"), kAccuracy),
    {{"emr", "EMR", "samples per pixel",
      "Equivalent MSAA rate: the number N at which msaa:N has the same RMSE on the same frames, or the same error by "
      "the "
      "metric of `beampipe compare --metric`.",
      kAccuracy},
     "/equivalent_msaa"},
    {{"emr_bound", "EMR is", "",
      "Whether the EMR is an estimate or a bound: at least that of the best rung of the MSAA ladder, or at most that "
      "of the worst. It does not converge if the last rungs are worse and fall no more.",
      kAccuracy},
     "/emr_bound"},
    {{"emr_low", "EMR from", "samples per pixel",
      "The lower end of the range of the EMR, about a standard deviation away: by the unevenness of the MSAA "
      "ladder, by blocks of pixels drawn again, and by the reference's own error, if that was measured.",
      kAccuracy},
     "/equivalent_msaa_low"},
    {{"emr_high", "EMR to", "samples per pixel", "The upper end of that range.", kAccuracy}, "/equivalent_msaa_high"},
    {{"visibility_rmse", "visibility", "linear light, 0..1",
      "Root mean square error in visibility, where surfaces vary: against the reference, with one colour for a "
      "triangle "
      "in a pixel in both pictures.",
      kAccuracy},
     "/visibility/rmse"},
    {{"visibility_emr", "EMR of visibility", "samples per pixel",
      "Equivalent MSAA rate for visibility alone: the number N at which msaa:N has the same error in visibility.",
      kAccuracy},
     "/visibility/equivalent_msaa"},
    {{"visibility_emr_bound", "EMR of visibility is", "", "Whether this EMR is an estimate or a bound.", kAccuracy},
     "/visibility/emr_bound"},
    {{"shading_rmse", "shading", "linear light, 0..1",
      "Root mean square error in shading, where surfaces vary: what the error has beyond that in visibility.",
      kAccuracy},
     "/shading/rmse"},
    {{"framebuffer_bytes_per_pixel", "framebuffer", "bytes per pixel",
      "Size of the technique's framebuffer per pixel, all surfaces together.", kMemory},
     "/framebuffer_bytes_per_pixel"},
    {{"peak_bytes_per_pixel", "with A-buffer", "bytes per pixel",
      "Size of framebuffer, A-buffer, translucent layer and spilled records per pixel, in the frame where these are "
      "largest.",
      kMemory},
     "/peak_bytes_per_pixel"},
    {{"msaa_bytes_per_pixel", "as MSAA", "bytes per pixel",
      "Size in memory per pixel of MSAA with the same error: EMR times the bytes of msaa:1, or less if samples are on "
      "chip.",
      kMemory},
     "/msaa_bytes_per_pixel"},
    {{"a_buffer_peak_bytes", "A-buffer", "bytes",
      "The largest size of the A-buffer at any time of a frame; 0 if there is none.", kMemory},
     "/a_buffer_peak_bytes"},
    {{"on_chip_bytes_per_pixel", "on chip", "bytes per pixel",
      "All buffers that a bin has on chip, at their peaks, over the pixels of the largest bin.", kMemory},
     "/on_chip_bytes_per_pixel"},
    {{"logical_bytes", "logical", "bytes per frame",
      "Bytes that all stages read and write, counted at every access: the mean over the frames.", kMemory},
     "/logical_bytes"},
    {{"sector_bytes", "sectors", "bytes per frame",
      "Bytes that all stages request from the memory system, in sectors: the mean over the frames.", kMemory},
     "/sector_bytes"},
    {{"l2_bytes", "L2", "bytes per frame", "Bytes requested from L2: the mean over the frames.", kMemory}, "/l2_bytes"},
    {{"dram_bytes", "DRAM", "bytes per frame",
      "Bytes that move between the modelled caches and DRAM, in either direction: the mean over the frames.", kMemory},
     "/dram_bytes"},
    {{"dram_geometry_bytes", "of it, geometry", "bytes per frame",
      "The part of the DRAM bytes that triangles take: their setup and lists, and in the raster stage their reads.",
      kMemory},
     "/dram_geometry_bytes"},
    {{"bin_bytes", "pixels of a bin", "bytes on chip",
      "What the pixels of a bin take on chip; a dash if they are in memory.", kMemory},
     "/bin_bytes"},
    {{"bins_held", "bins held", "bins", "How many bins a core has room for, at most as many as it works on.", kMemory},
     "/bins_held"},
    {{"busiest_core", "busiest core", "ratio",
      "Work of the busiest core over the mean, if bins start in their order on the core that is free first.", kTime},
     "/bin_spread/busiest_core"},
    {{"bin_most", "fullest bin", "ratio", "Work of the fullest bin, over the mean of bins.", kTime},
     "/bin_spread/most"},
    {{"hardware", "hardware", "", "The GPU whose times are modelled.", kTime}, "/hardware"},
    {{"wall_ms", "wall time", "ms per frame",
      "The time of the simulator on the machine that ran it, which says nothing about hardware: the median over the "
      "frames. If each frame was run only once, this includes the time for modelling memory.",
      kTime},
     "/wall_ms"},
    {{"flicker", "flicker", "linear light, 0..1",
      "Root mean square, over pixels, of the change of the error from one frame to the next, pooled over all frames "
      "except the first.",
      kAccuracy},
     "/flicker"},
};

const std::vector<Source> kSurfaceColumns = {
    {{"technique", "technique", "", "The technique's spec."}, "/technique"},
    {{"surface", "surface", "", "One surface of the framebuffer."}, "/name"},
    {{"format", "format", "", "What is stored per pixel; \"x N\" means N times."}, "/format"},
    {{"bytes_per_pixel", "bytes/pixel", "bytes", "Size of this surface per pixel."}, "/bytes_per_pixel"},
};

const char* view_of(const CounterInfo& counter) {
  const std::string_view name = counter.name;
  if (name.starts_with("ops.")) return kOperations;
  if (name.starts_with("texture_")) return kTexels;
  return std::string_view(counter.unit) == "bytes" ? kBytes : kItems;
}

// Two columns for each part of the modelled energy: the least and the most of it, each with a view of its own.
void add_energy(std::vector<Source>& columns, const ReportFile& report, const std::string& unit) {
  const auto add = [&](const std::string& name, const std::string& meaning, const std::string& implementation) {
    const bool is_of_one = !implementation.empty();
    const std::string key = "energy_mj_" + name + (is_of_one ? "_" + implementation : "");
    const std::string pointer = "/energy_mj/" + name + (is_of_one ? "/" + implementation : "");
    const std::string title = name + (is_of_one ? ", " + implementation : "");
    columns.push_back({{key + "_low", title + ", least", unit, "The least modelled energy: " + meaning + ".", kLeast},
                       pointer + "/low"});
    columns.push_back({{key + "_high", title + ", most", unit, "The most modelled energy: " + meaning + ".", kMost},
                       pointer + "/high"});
  };
  for (const EnergyTerm& term : energy_terms())
    if (!term.by_implementation) add(term.name, term.meaning, "");
  for (const std::string& implementation : implementations_of(report)) {
    for (const EnergyTerm& term : energy_terms())
      if (term.by_implementation) add(term.name, term.meaning, implementation);
    add("total", "all of these", implementation);
  }
}

// The counters of the registry, two ratios, modelled times and energy.
std::vector<Source> stage_columns(const ReportFile& report) {
  std::vector<Source> columns = {
      {{"technique", "technique", "", "The technique's spec."}, "/technique"},
      {{"stage", "stage", "", "A stage of the technique's pipeline, in pipeline order."}, "/stage"}};
  for (const CounterInfo& counter : stage_counters()) {
    std::string key = counter.name, pointer = "/" + key;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    if (const std::size_t dot = key.find('.'); dot != key.npos) key.erase(0, dot + 1);
    columns.push_back(
        {{key == "total" ? "ops" : key, counter.title, counter.unit, sentence(counter.meaning), view_of(counter)},
         pointer});
  }
  columns.push_back(
      {{"ops_per_byte", "op/byte", "operations per byte", "Operations per logical byte read or written.", kOperations},
       "/ops_per_byte"});
  columns.push_back(
      {{"lane_use", "lane use", "part, 0..1", "Lanes with work, divided by lanes issued.", kItems}, "/lane_use"});
  for (const std::string& implementation : implementations_of(report))
    columns.push_back(
        {{"modelled_ms_" + implementation, "modelled, " + implementation, "ms",
          "Time that the modelled hardware takes for this stage, which is that of its busiest unit.", kTime},
         "/modelled_ms/" + implementation});
  for (const std::string& implementation : implementations_of(report))
    columns.push_back({{"busiest_unit_" + implementation, "busiest, " + implementation, "",
                        "The unit that takes so long, and the rate that limits it where that is not the unit's own; in "
                        "the last frame.",
                        kTime},
                       "/busiest/" + implementation});
  add_energy(columns, report, "mJ");
  return columns;
}

const std::vector<Source> kFrameColumns = {
    {{"technique", "technique", "", "The technique's spec."}, "/technique"},
    {{"frame", "frame", "index", "The frame's index in the trace; the first is 0."}, "/index"},
    {{"wall_ms", "wall time", "ms", "Median time of the runs of this frame.", kTime}, "/wall_ms/median"},
    {{"wall_ms_min", "fastest", "ms", "Time of the fastest run of this frame.", kTime}, "/wall_ms/min"},
    {{"wall_ms_max", "slowest", "ms", "Time of the slowest run of this frame.", kTime}, "/wall_ms/max"},
    {{"runs", "runs", "runs", "Number of timed runs of this frame.", kTime}, "/wall_ms/runs"},
    {{"modelling_ms", "with memory model", "ms",
      "Time of the additional run that modelled caches and DRAM and gave the counts. If there is none, the wall time "
      "includes the modelling.",
      kTime},
     "/wall_ms/modelling_run"},
    {{"a_buffer_peak_bytes", "A-buffer", "bytes", "The largest size of the A-buffer.", kMemory},
     "/a_buffer_peak_bytes"},
    {{"logical_bytes", "logical", "bytes", "Bytes that all stages read and write, counted at every access.", kMemory},
     "/logical_bytes"},
    {{"sector_bytes", "sectors", "bytes", "Bytes that all stages request from the memory system, in sectors.", kMemory},
     "/sector_bytes"},
    {{"l2_bytes", "L2", "bytes",
      "Bytes requested from L2, in sectors: what the caches closer to the stages miss or write back.", kMemory},
     "/l2_bytes"},
    {{"dram_bytes", "DRAM", "bytes", "Bytes that move between the modelled caches and DRAM, in either direction.",
      kMemory},
     "/dram_bytes"},
    {{"rmse", "RMSE", "linear light, 0..1", "Root mean square error of this frame.", kAccuracy}, "/error/rmse"},
    {{"visibility_rmse", "visibility", "linear light, 0..1", "Root mean square error in visibility of this frame.",
      kAccuracy},
     "/visibility/rmse"},
    {{"shading_rmse", "shading", "linear light, 0..1", "Root mean square error in shading of this frame.", kAccuracy},
     "/shading/rmse"},
    {{"bias", "bias", "linear light, 0..1", "Mean signed error of this frame.", kAccuracy}, "/error/bias"},
    {{"flicker", "flicker", "linear light, 0..1", "Root mean square change of the error since the previous frame.",
      kAccuracy},
     "/flicker"},
};

const std::vector<Source> kClaimColumns = {
    {{"claim", "claim", "", "What a publication says about a technique."}, "/name"},
    {{"unit", "unit", "", "The unit of the claim's numbers.", kNumbers}, "/unit"},
    {{"published_low", "published", "see unit", "The published number, or the lower end of the published range.",
      kNumbers},
     "/published_low"},
    {{"published_high", "up to", "see unit", "The upper end of the published range; a dash means \"or more\".",
      kNumbers},
     "/published_high"},
    {{"ours", "ours", "see unit",
      "The number in this report. `beampipe claims` also lists the claims that this report has no number for.",
      kNumbers},
     "/ours"},
    {{"per_cent", "per cent", "",
      "How far ours lies from the nearer end of the published range, of which this is a percentage; 0 within it.",
      kNumbers},
     "/per_cent"},
    {{"holds", "holds", "", "Is that at most 10 per cent either way?", kNumbers}, "/holds"},
    {{"kind", "kind", "", "Rendered, or true by definition: a format or a constant of the program.", kSources},
     "/kind"},
    {{"source", "source", "", "The place of the claim in the publication.", kSources}, "/source"},
    {{"beside", "what ours is", "", "What our number is, if it is not the same quantity.", kNumbers}, "/beside"},
    {{"command", "command", "", "The command that finds our number.", kSources}, "/command"},
};

// The value at a path of keys, each after a "/". Null if one of them is missing.
const Json* value_at(const Json& record, std::string_view pointer) {
  const Json* value = &record;
  while (value && !pointer.empty()) {
    const std::size_t end = std::min(pointer.find('/', 1), pointer.size());
    value = value->find(pointer.substr(1, end - 1));
    pointer.remove_prefix(end);
  }
  return value;
}

// One row per record, one column per source that any record has.
Table make_table(const std::string& name, const std::string& title, const std::string& note,
                 const std::vector<Source>& sources, const std::vector<Json>& records) {
  Table table{name, title, note, {}, std::vector<std::vector<Json>>(records.size())};
  for (const Source& source : sources) {
    const auto has_it = [&](const Json& record) { return value_at(record, source.pointer) != nullptr; };
    if (std::none_of(records.begin(), records.end(), has_it)) continue;
    table.columns.push_back(source.column);
    for (std::size_t i = 0; i < records.size(); ++i) {
      const Json* value = value_at(records[i], source.pointer);
      table.rows[i].push_back(value ? *value : Json());
    }
  }
  return table;
}

// Adds three columns after the DRAM bytes for each implementation of the modelled hardware, and those of energy.
std::vector<Source> with_modelled(std::vector<Source> sources, const ReportFile& report, const std::string& unit,
                                  const std::string& energy_unit) {
  auto place =
      std::find_if(sources.begin(), sources.end(), [](const Source& s) { return s.column.key == "dram_bytes"; });
  for (const std::string& implementation : implementations_of(report)) {
    const std::string key = "modelled_ms_" + implementation, pointer = "/modelled_ms/" + implementation;
    const std::string title = implementation + ", ";
    for (const TimeKind& kind : kTimes)
      place = sources.insert(std::next(place), {{key + "_" + kind.key, title + kind.title, unit,
                                                 "Modelled time. " + std::string(kind.meaning), kTime},
                                                pointer + "/" + kind.key});
  }
  add_energy(sources, report, energy_unit);
  return sources;
}

// Nothing if a frame does not have the number.
std::optional<double> mean_of_frames(const Json& result, std::string_view key) {
  double sum = 0;
  const std::vector<Json>& frames = result.at("frames").elements();
  for (const Json& frame : frames) {
    const Json* const number = frame.find(key);
    if (!number) return std::nullopt;
    sum += number->get<double>();
  }
  return sum / static_cast<double>(frames.size());
}

// Of the first frame: what the pixels of a bin take on chip, and how many bins have room. Means over the frames: how
// unevenly bins fill cores, and DRAM bytes of geometry.
void add_room(const ReportFile& report, const Json& result, Json& record) {
  const Json* const memory = report.json.find("memory_system");
  if (!memory || !memory->at("modelled").get<bool>() || is_reference(result.at("technique").get<std::string>())) return;
  MemoryParameters parameters;
  parameters.on_chip_bytes = memory->at("on_chip_bytes").get<std::uint32_t>();
  parameters.bins_per_core = memory->at("bins_per_core").get<std::uint32_t>();
  const std::vector<Json>& frames = result.at("frames").elements();
  Json spread;
  for (const Json& frame : frames)
    if (const Json* const of_frame = frame.find("bin_spread")) add_numbers(spread, *of_frame);
  if (!spread.is_null()) {
    divide_numbers(spread, frames.size());
    record["bin_spread"] = spread;
  }
  for (const Json& buffer : frames.front().at("buffers").elements()) {
    if (buffer.at("name") != kOpenPixels) continue;
    const double bytes = buffer.at("peak_bytes").get<double>();
    record["bin_bytes"] = bytes;
    record["bins_held"] = parameters.bins_held(bytes, frames.front().value("bin_pixels", 0.0));
  }
  double geometry = 0;
  for (const Json& frame : frames)
    for (const Json& stage : frame.at("stages").elements())
      if (const auto known = find_stage(std::string_view(stage.at("stage").get<std::string>()));
          known && (info_of(known->id).group == StageGroup::geometry || info_of(known->id).group == StageGroup::raster))
        geometry += stage.at("dram_bytes").get<double>();
  record["dram_geometry_bytes"] = geometry / static_cast<double>(frames.size());
}

// In memory, of MSAA with so many samples. On chip, the picture alone is in memory.
double msaa_bytes(double samples, const MemoryParameters& memory) {
  const std::uint32_t rung = std::bit_ceil(static_cast<std::uint32_t>(std::clamp(std::ceil(samples), 1.0, 1024.0)));
  const Technique msaa = parse_technique(msaa_spec(rung));
  const double in_memory = msaa.framebuffer_bytes_per_pixel(), here = msaa.framebuffer_bytes_per_pixel(memory);
  return here < in_memory ? here : in_memory * samples / rung;
}

std::vector<Json> technique_records(const ReportFile& report) {
  std::vector<Json> records;
  for (const Json& result : report.json.at("results").elements()) {
    Json record = result;
    const TechniqueSummary summary = read_summary(result);
    record["wall_ms"] = summary.wall_ms;
    if (result.value("equivalent_msaa_does_not_converge", false)) record["emr_bound"] = "does not converge";
    if (summary.dram_bytes > 0) {  // otherwise no memory was modelled
      for (const char* key : {"logical_bytes", "sector_bytes", "l2_bytes", "dram_bytes"})
        if (const std::optional<double> mean = mean_of_frames(result, key)) record[key] = *mean;
    }
    add_room(report, result, record);
    if (!summary.modelled_ms.empty()) record["hardware"] = hardware_label(report);
    for (const auto& [implementation, ms] : summary.modelled_ms)
      record["modelled_ms"][implementation] = {
          {"at_once", ms.at_once}, {"on_cores", ms.on_cores}, {"in_turn", ms.in_turn}};
    Json energy;
    for (const Json& frame : result.at("frames").elements())
      if (const Json* const of_frame = frame.find("energy_mj")) add_numbers(energy, *of_frame);
    if (!energy.is_null()) {
      divide_numbers(energy, result.at("frames").size());
      record["energy_mj"] = energy;
    }
    if (const Json* visibility = result.find("visibility"))
      if (const auto emr = read_emr(*visibility)) record["visibility"]["emr_bound"] = bound_text(*emr);
    if (summary.emr) {
      record["emr_bound"] = bound_text(*summary.emr);
      record["msaa_bytes_per_pixel"] = msaa_bytes(summary.emr->samples, report.memory);
    }
    records.push_back(std::move(record));
  }
  return records;
}

// The elements of each result's array `key`, each with the result's technique.
std::vector<Json> members(const Json& results, const std::string& key) {
  std::vector<Json> records;
  for (const Json& result : results.elements()) {
    for (Json member : result.at(key).elements()) {
      member["technique"] = result.at("technique");
      records.push_back(std::move(member));
    }
  }
  return records;
}

// The work that each technique saved in a frame.
std::vector<Json> saved_records(const Json& results) {
  std::vector<Json> records;
  for (const Json& result : results.elements()) {
    Json record = Json::object();
    for (const Json& frame : result.at("frames").elements()) add_numbers(record, frame.value("saved", Json::object()));
    if (record.size() == 0) continue;
    divide_numbers(record, result.at("frames").size());
    record["technique"] = result.at("technique");
    records.push_back(std::move(record));
  }
  return records;
}

// Of each technique, stage and array; means over the frames.
std::vector<Json> array_records(const Json& results) {
  std::vector<Json> records;
  for (const Json& result : results.elements()) {
    const std::vector<Json>& frames = result.at("frames").elements();
    std::map<std::pair<std::string, std::string>, Json> sums;
    std::vector<std::string> stages;
    for (const Json& frame : frames) {
      const Json arrays = frame.value("dram_arrays", Json::array());
      for (const Json& each : arrays.elements()) {
        const auto stage = each.at("stage").get<std::string>();
        if (std::ranges::find(stages, stage) == stages.end()) stages.push_back(stage);
        Json& sum = sums[{stage, each.at("array").get<std::string>()}];
        for (const char* key : {"read", "written", "compressed", "l2"})
          sum[key] = sum.value(key, 0.0) + each.value(key, 0.0) / static_cast<double>(frames.size());
      }
    }
    for (const std::string& stage : stages)
      for (const auto& [place, sum] : sums) {
        if (place.first != stage) continue;
        Json record = sum;
        record["technique"] = result.at("technique");
        record["stage"] = stage, record["array"] = place.second;
        if (const double moved = sum.at("read").get<double>() + sum.at("written").get<double>(); moved > 0)
          record["share"] = sum.at("compressed").get<double>() / moved;
        records.push_back(std::move(record));
      }
  }
  return records;
}

const std::vector<Source> kArrayColumns = {
    {{"technique", "technique", "", "The technique's spec."}, "/technique"},
    {{"stage", "stage", "", "The stage that moves the bytes."}, "/stage"},
    {{"array", "array", "", "Where in memory they lie."}, "/array"},
    {{"l2_bytes", "L2", "bytes", "Asked of L2."}, "/l2"},
    {{"read_bytes", "DRAM read", "bytes", "Read from DRAM."}, "/read"},
    {{"written_bytes", "DRAM written", "bytes", "Written to DRAM."}, "/written"},
    {{"compressed", "compressed", "share",
      "The part of the bytes of DRAM that is of compressed blocks; the rest is raw. "
      "Blocks that are cleared move nothing."},
     "/share"},
};

// The published figures about this trace. Those that are true by definition are about the program.
std::vector<Json> claim_records(const Json& report) {
  std::vector<Json> records;
  const Json claims = report.value("claims", Json::array());
  for (const Json& claim : claims.elements())
    if (claim.value("kind", std::string()) != "true by definition") records.push_back(claim);
  return records;
}

std::vector<Source> saved_columns() {
  std::vector<Source> columns = {{{"technique", "technique", "", "The technique's spec."}, "/technique"}};
  std::vector<SavedWork> all = saved_work({{StageId::sample_raster}});
  for (const SavedWork& saved : saved_work({{StageId::conservative_raster},
                                            {StageId::a_buffer},
                                            {StageId::windows},
                                            {StageId::beam_fragment},
                                            {StageId::compose}}))
    if (saved.name != std::string("empty_tiles") && saved.name != std::string("hidden_triangles")) all.push_back(saved);
  for (const SavedWork& saved : all)
    columns.push_back({{saved.name, saved.title, saved.unit, sentence(saved.meaning)}, std::string("/") + saved.name});
  return columns;
}

}  // namespace

std::vector<Table> report_tables(const ReportFile& report) {
  const Json& results = report.json.at("results");
  const std::vector<Json> frames = members(results, "frames");
  const bool is_sequence = frames.size() > results.size();
  const std::string mean = is_sequence ? "Means over the frames. " : "";
  std::vector<Table> tables;
  tables.push_back(make_table("techniques", "Techniques", mean,
                              with_measures(with_modelled(kTechniqueColumns, report, "ms per frame", "mJ per frame")),
                              technique_records(report)));
  tables.push_back(make_table("stages", "Stages",
                              mean + "Bytes, times and energy add up to those of the technique, times to that in turn.",
                              stage_columns(report), stage_records(report)));
  if (is_sequence)
    tables.push_back(
        make_table("frames", "Frames", "", with_measures(with_modelled(kFrameColumns, report, "ms", "mJ")), frames));
  const std::vector<Json> arrays = array_records(results);
  if (!arrays.empty())
    tables.push_back(make_table("dram_arrays", "Bytes of L2 and DRAM by array", mean, kArrayColumns, arrays));
  const std::vector<Json> saved = saved_records(results);
  if (!saved.empty()) tables.push_back(make_table("saved", "Saved work", mean, saved_columns(), saved));
  tables.push_back(make_table("framebuffer", "Framebuffers", "", kSurfaceColumns, members(results, "framebuffer")));
  const std::vector<Json> claims = claim_records(report.json);
  if (!claims.empty())
    tables.push_back(make_table(
        "claims", "Published figures about this trace",
        "The command beampipe claims lists all published figures, also those about other scenes. Our modelled "
        "times are those of " +
            hardware_label(report) + ".",
        kClaimColumns, claims));
  return tables;
}

std::string sentence(std::string definition) {
  if (!definition.empty()) definition[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(definition[0])));
  return definition + ".";
}

std::string csv_text(const Table& table) {
  std::vector<std::string> keys;
  for (const Column& column : table.columns) keys.push_back(column.key);
  return csv_text(keys, table.rows);
}

}  // namespace beampipe
