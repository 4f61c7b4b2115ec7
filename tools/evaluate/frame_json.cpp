#include "tools/evaluate/frame_json.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "stages/cost/counters.h"
#include "tools/evaluate/energy.h"
#include "tools/evaluate/measures.h"
#include "tools/evaluate/modelled_time.h"
#include "tools/evaluate/saved_work.h"

namespace beampipe {
namespace {

// In "buffers".
constexpr const char* kHeldByBin = "bin";

// Where a counter stands in the JSON of a stage: "ops.add" is the key "add" of the object "ops".
std::pair<std::string_view, std::string_view> keys_of(const CounterInfo& counter) {
  const std::string_view name = counter.name;
  const std::size_t dot = name.find('.');
  return dot == name.npos ? std::pair(std::string_view(), name) : std::pair(name.substr(0, dot), name.substr(dot + 1));
}

void add_counter(ObjectForm<StageCounters>& object, const CounterInfo& counter) {
  object.written(
      std::string(keys_of(counter).second),
      [&counter](const StageCounters& stage) { return std::uint64_t{counter.value(stage)}; }, form::count(),
      counter.meaning);
  StageCounters any;
  if (counter.stored(any))
    object.taken(
        [&counter](const Json& json, StageCounters& stage) { *counter.stored(stage) = json.get<std::uint64_t>(); });
}

// The stage that a T is about.
template <class T>
void add_stage(ObjectForm<T>& object, const std::string& meaning) {
  object
      .written(
          "stage", [](const T& each) { return std::string(name_of(each.stage)); }, form::text(), meaning)
      .taken([](const Json& json, T& each) {
        const std::string name = json.get<std::string>();
        const std::optional<Stage> known = find_stage(name);
        if (!known) throw std::runtime_error("\"stage\": expected the name of a stage, found \"" + name + '"');
        each.stage = *known;
      });
}

Form<Interval> interval_form() {
  return ObjectForm<Interval>()
      .written("low", &Interval::low, form::amount(), "The least.")
      .written("high", &Interval::high, form::amount(), "The most.");
}

// What add_energy writes.
Json energy_schema() {
  const Form<Interval> interval = interval_form();
  const Json of_each = form::by_name(interval).schema;
  ObjectForm<Energy> object;
  for (const EnergyTerm& term : energy_terms())
    object.added(term.name, term.by_implementation ? of_each : interval.schema,
                 std::string("Of ") + term.meaning + ".");
  object.added("total", of_each, "All of these.");
  return Form<Energy>(object).schema;
}

// Adds an implementation's energy to a stage or a frame.
void add_energy(Json& object, const std::string& implementation, const Energy& energy) {
  const auto written = interval_form().write;
  Json& of = object["energy_mj"];
  for (const EnergyTerm& term : energy_terms()) {
    Json& part = of[term.name];
    (term.by_implementation ? part[implementation] : part) = written(energy.*term.part);
  }
  of["total"][implementation] = written(energy.total());
}

Form<StageCounters> make_stage_form() {
  ObjectForm<StageCounters> stage, operations;
  add_stage(stage, "The stage's name, as `beampipe counters` lists it.");
  const std::span<const CounterInfo> counters = stage_counters();
  for (std::size_t i = 0; i < counters.size();) {
    const std::string group(keys_of(counters[i]).first);
    ObjectForm<StageCounters> grouped;
    for (; i < counters.size() && keys_of(counters[i]).first == group; ++i)
      add_counter(group.empty() ? stage : grouped, counters[i]);
    if (group.empty()) continue;
    const Form<StageCounters> form = grouped;
    stage.written(group, std::identity(), form, "Operations of the stage, by kind.").taken(form.take);
  }
  return stage
      .added("modelled_ms", form::by_name(form::amount()).schema,
             "Milliseconds that the modelled hardware takes for this stage, by implementation.")
      .added("busiest_unit", form::by_name(form::text()).schema, "The unit that takes so long, by implementation.")
      .added("busiest_rate", form::by_name(form::text()).schema,
             "The rate of the description at which most of that time goes, by implementation.")
      .added("energy_mj", energy_schema(),
             "Millijoules that the modelled hardware takes for this stage, by where they go; by implementation where "
             "they differ.");
}

const Form<StageCounters>& stage_form() {
  static const Form<StageCounters> form = make_stage_form();
  return form;
}

Form<WallTime> wall_form() {
  return ObjectForm<WallTime>()
      .written("median", &WallTime::median, form::amount(), "Of all timed runs.")
      .written("min", &WallTime::min, form::amount(), "Of the fastest run.")
      .written("max", &WallTime::max, form::amount(), "Of the slowest run.")
      .written("runs", &WallTime::runs, form::count(1), "Timed runs.")
      .written("with_memory_model", &WallTime::with_memory_model, form::boolean(),
               "The timed runs also modelled caches and DRAM.")
      .written(
          "kept", [](const WallTime& wall) { return wall.kept ? std::optional(true) : std::nullopt; }, form::boolean(),
          "These are times of an earlier run, whose picture was kept.")
      .taken([](const Json& json, WallTime& wall) { wall.kept = json.get<bool>(); })
      .written("modelling_run", &WallTime::modelling_run, form::amount(),
               "Time of the additional run that modelled them.");
}

// A frame of a technique.
struct FrameOf {
  const FrameReport& frame;
  const TechniqueReport& result;
  StageCounters all = {};               // its stages
  FrameReport* read_back_to = nullptr;  // the same frame, while it is read
};

// A member of the report of the frame.
template <class Value>
struct OfReport {
  Value FrameReport::*place;
  const Value& operator()(const FrameOf& of) const { return of.frame.*place; }
  Value& ref(FrameOf& of) const { return of.read_back_to->*place; }
};

// A text or list, which is left out if it is empty.
template <class Value>
struct FilledOfReport {
  Value FrameReport::*place;
  std::optional<Value> operator()(const FrameOf& of) const { return form::filled(place)(of.frame); }
  Value& ref(FrameOf& of) const { return of.read_back_to->*place; }
};

// All buffers of the frame at their peak: the framebuffer's surfaces, the A-buffer and others.
std::vector<Buffer> buffers_of(const FrameOf& of) {
  std::vector<Buffer> buffers;
  for (const Surface& surface : of.result.framebuffer)
    buffers.push_back({surface.name, surface.bytes_per_pixel * of.frame.pixels});
  if (of.frame.a_buffer_peak_bytes > 0) buffers.push_back({kABuffer, of.frame.a_buffer_peak_bytes});
  buffers.insert(buffers.end(), of.frame.buffers.begin(), of.frame.buffers.end());
  return buffers;
}

Form<Buffer> buffer_form() {
  return ObjectForm<Buffer>()
      .written("name", &Buffer::name, form::text(), "Its name.")
      .written("peak_bytes", &Buffer::peak_bytes, form::count(), "Its largest size.")
      .written(
          "held", [](const Buffer& buffer) { return buffer.per_bin ? kHeldByBin : "frame"; },
          form::one_of({"frame", kHeldByBin}), "Whether each bin has one, or the frame.")
      .taken([](const Json& json, Buffer& buffer) { buffer.per_bin = json == kHeldByBin; });
}

Form<ArrayBytes> array_form() {
  ObjectForm<ArrayBytes> form;
  add_stage(form, "That moves them.");
  return form.written("array", &ArrayBytes::array, form::text(), "Where in memory they lie.")
      .written("read", &ArrayBytes::read, form::count(), "Bytes from DRAM.")
      .written("written", &ArrayBytes::written, form::count(), "Bytes to DRAM.")
      .written("compressed", &ArrayBytes::compressed, form::count(), "Those of both that are of compressed blocks.")
      .written("l2", &ArrayBytes::l2, form::count(), "Bytes asked of L2.")
      .may_lack();
}

Form<StoppedDraw> stopped_form() {
  return ObjectForm<StoppedDraw>()
      .written("draw", &StoppedDraw::draw, form::count(), "The draw's index in the frame.")
      .written("invocations", &StoppedDraw::invocations, form::count(1), "So many.");
}

Form<PixelCounterStats> statistics_form() {
  return ObjectForm<PixelCounterStats>()
      .written("mean", &PixelCounterStats::mean, form::number(), "Over all pixels.")
      .written("max", &PixelCounterStats::max, form::number(), "Over all pixels.")
      .written("share", &PixelCounterStats::share, form::amount(), "Of the pixels: where it is not 0.");
}

// Times of an implementation.
Form<ModelledTime> modelled_form() {
  ObjectForm<ModelledTime> form;
  for (const TimeKind& kind : kTimes) form.written(kind.key, kind.ms, form::amount(), kind.meaning);
  return form.written("busiest", &ModelledTime::busiest, form::text(), "The busiest unit of all at once.")
      .written("busiest_rate", &ModelledTime::busiest_rate, form::text(),
               "The rate of the description at which most of its time goes.");
}

Form<BinSpread> spread_form() {
  return ObjectForm<BinSpread>()
      .written("busiest_core", &BinSpread::busiest_core, form::amount(),
               "Work of the busiest core over the mean of cores, bins in their order on the core that is free first.")
      .written("p99", &BinSpread::p99, form::amount(),
               "Work of the bin that 99 % do not exceed, over the mean of bins.")
      .written("most", &BinSpread::most, form::amount(), "Work of the fullest bin, over the mean of bins.");
}

std::optional<Json> saved_of(const FrameOf& of) {
  Json saved;
  for (const SavedWork& each : saved_work(of.frame.stages)) saved[each.name] = each.amount;
  return saved.is_null() ? std::nullopt : std::optional(saved);
}

Form<FrameOf> make_frame_form() {
  const auto member = []<class Value>(Value FrameReport::*place) { return OfReport<Value>{place}; };
  const auto filled = []<class Value>(Value FrameReport::*place) { return FilledOfReport<Value>{place}; };
  const auto part = [](double ErrorParts::*place) {
    return [place](const FrameOf& of) {
      return of.frame.parts ? std::optional(of.frame.parts.value().*place) : std::nullopt;
    };
  };
  using Frame = FrameReport;
  ObjectForm<FrameOf> form;
  form.written("index", member(&Frame::index), form::count(), "The frame's index in the trace.")
      .written("image", member(&Frame::image), form::text("a file"),
               "The picture as EXR; paths are relative to the report's folder.")
      .written("picture", member(&Frame::picture), form::text("a file"), "The picture as PNG.")
      .written("counters", filled(&Frame::counters), form::text("a file"),
               "The counters of each pixel, as channels of an EXR.")
      .written("error", member(&Frame::error), error_form(), "Differences from the reference.")
      .written("visibility", part(&ErrorParts::visibility), rmse_form(),
               "The error in visibility, where surfaces vary.")
      .taken(
          [](const Json& json, FrameOf& of) { of.read_back_to->parts = {.visibility = json.at("rmse").get<double>()}; })
      .written("shading", part(&ErrorParts::shading), rmse_form(), "The error in shading, where surfaces vary.")
      .taken([](const Json& json, FrameOf& of) {
        if (of.read_back_to->parts) of.read_back_to->parts->shading = json.at("rmse").get<double>();
      })
      .written("flicker", member(&Frame::flicker), form::amount(),
               "Root mean square change of the error since the previous frame.")
      .written("wall_ms", member(&Frame::wall_ms), wall_form(), "Time of the simulator, in milliseconds.")
      .written("a_buffer_peak_bytes", member(&Frame::a_buffer_peak_bytes), form::count(),
               "The largest size of the A-buffer.")
      .written("bin_pixels", member(&Frame::bin_pixels), form::count(), "Pixels of the largest bin.")
      .written("bin_operations", filled(&Frame::bin_operations), form::list(form::count()),
               "Operations of each bin in stages that can be done in shaders, row by row.")
      .written("bin_invocations", filled(&Frame::bin_invocations), form::list(form::count()),
               "Invocations of fragment shaders that each bin starts, row by row.")
      .written("dram_arrays", filled(&Frame::dram_arrays), form::list(array_form()),
               "What each stage moves to and from DRAM and asks of L2, by array.")
      .written("stopped", filled(&Frame::stopped), form::list(stopped_form()),
               "Invocations of programs' fragment shaders that took too many steps and count as discarded, by draw.");
  for (const char* column : {"logical_bytes", "sector_bytes", "l2_bytes", "dram_bytes"})
    for (const CounterInfo& counter : stage_counters())
      if (counter.name == std::string_view(column))
        form.written(
            column, [&counter](const FrameOf& of) { return std::uint64_t{counter.value(of.all)}; }, form::count(),
            "Sum over the stages.");
  return form.written("buffers", buffers_of, form::list(buffer_form()), "Every buffer at its peak.")
      .taken([list = form::list(buffer_form())](const Json& json, FrameOf& of) {
        list.take(json, of.read_back_to->buffers);
        std::erase_if(of.read_back_to->buffers, [](const Buffer& buffer) { return buffer.name == kABuffer; });
      })
      .written("pixel_counters", filled(&Frame::pixel_counters), form::by_name(statistics_form()),
               "Statistics of each counter of pixels, by name.")
      .written("saved", saved_of, form::as_it_is(form::by_name(form::count()).schema),
               "Work that was not done, by name (`beampipe counters`).")
      .written("stages", member(&Frame::stages), form::list(stage_form()),
               "The stages, in the order in which they run.")
      .added("modelled_ms", form::by_name(modelled_form()).schema, "Modelled times, by implementation.")
      .added("bin_spread", spread_form().schema, "How unevenly bins fill the cores.")
      .added("energy_mj", energy_schema(), "Modelled energy, in millijoules: the sum over the stages.");
}

const Form<FrameOf>& frame_form() {
  static const Form<FrameOf> form = make_frame_form();
  return form;
}

}  // namespace

Form<ErrorStats> error_form() {
  ObjectForm<ErrorStats> object;
  for (const Measure& measure : measures()) {
    const Form<double> number = measure.may_be_negative ? form::number() : form::amount();
    object.written(measure.key, measure.value, number, measure.meaning);
  }
  Form<ErrorStats> form = object;
  form.take = [](const Json& json, ErrorStats& stats) { stats = error_of(json); };
  return form;
}

ErrorStats error_of(const Json& json) {
  const auto number = [&](const char* key) { return json.at(key).get<double>(); };
  ErrorStats stats{.rmse = number("rmse"),
                   .bias = number("bias"),
                   .p99 = number("p99"),
                   .max = number("max"),
                   .p999 = number("p999"),
                   .mae = number("mae"),
                   .rel_mse = number("rel_mse")};
  for (const Measure& measure : measures())
    if (measure.stored && json.contains(measure.key)) stats.*measure.stored = number(measure.key);
  return stats;
}

Form<double> rmse_form() {
  return ObjectForm<double>().written("rmse", std::identity(), form::amount(), "Root mean square.");
}

Json frame_schema() { return frame_form().schema; }

Json to_json(const FrameReport& frame, const TechniqueReport& result, const Hardware& hardware) {
  FrameOf of{frame, result};
  for (const StageCounters& stage : frame.stages) of.all += stage;
  Json json = frame_form().write(of);
  if (of.all.sector_bytes == 0) return json;  // the reference models no memory, and times without it would mean nothing
  std::vector<Json>& stages = json["stages"].elements();
  if (!frame.bin_operations.empty()) json["bin_spread"] = spread_form().write(bin_spread(hardware, frame.work()));
  for (const Implementation& implementation : hardware.implementations) {
    const ModelledTime time = modelled_time(hardware, implementation, frame.work());
    json["modelled_ms"][implementation.name] = modelled_form().write(time);
    for (const StageTime& of_stage : time.stages) {
      Json& stage = *find_stage(stages, name_of(of_stage.stage));
      stage["modelled_ms"][implementation.name] = of_stage.ms;
      stage["busiest_unit"][implementation.name] = of_stage.busiest;
      stage["busiest_rate"][implementation.name] = of_stage.busiest_rate;
    }
    if (!has_energy(hardware)) continue;
    const std::vector<StageEnergy> energy = modelled_energy(hardware, implementation, frame.stages);
    add_energy(json, implementation.name, sum_of(energy));
    for (const StageEnergy& each : energy)
      add_energy(*find_stage(stages, name_of(each.stage)), implementation.name, each.energy);
  }
  return json;
}

Json* find_stage(std::vector<Json>& stages, std::string_view name) {
  const auto found = std::find_if(stages.begin(), stages.end(), [&](Json& each) { return each.at("stage") == name; });
  return found == stages.end() ? nullptr : &*found;
}

FrameReport frame_of(const Json& json) {
  if (json.contains("visibility")) static_cast<void>(json.at("shading"));
  FrameReport frame;
  const TechniqueReport unknown;
  FrameOf of{.frame = frame, .result = unknown, .read_back_to = &frame};
  frame_form().take(json, of);
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
