#include "tools/report/report_json.h"

#include <algorithm>

#include "tools/claims/claims.h"
#include "tools/evaluate/draw_notes.h"
#include "tools/evaluate/frame_json.h"
#include "tools/evaluate/measures.h"
#include "tools/evaluate/memory_system.h"
#include "tools/evaluate/resume.h"

namespace beampipe {
namespace {

template <class T>
std::optional<T> if_it_converges(const EquivalentMsaa& emr, T value) {
  return emr.does_not_converge ? std::nullopt : std::optional(value);
}

// An equivalent rate, if there is one, among the other keys of an object.
template <class T, class Place>
void add_rate(ObjectForm<T>& object, Place rate) {
  const auto part = [rate](auto take) {
    return [rate, take](const T& value) {
      const std::optional<EquivalentMsaa> emr = rate(value);
      return emr ? take(*emr) : std::nullopt;
    };
  };
  using Emr = EquivalentMsaa;
  object
      .written("equivalent_msaa", part([](const Emr& emr) { return if_it_converges(emr, emr.samples); }),
               form::amount(),
               "Equivalent MSAA rate: the N at which msaa:N has the same error on the same frames, by the metric.")
      .written("equivalent_msaa_is_lower_bound",
               part([](const Emr& emr) { return if_it_converges(emr, emr.is_lower_bound); }), form::boolean(),
               "The rate is at least that: the MSAA ladder ends before it.")
      .written("equivalent_msaa_is_upper_bound",
               part([](const Emr& emr) { return emr.is_upper_bound ? std::optional(true) : std::nullopt; }),
               form::boolean(), "The rate is at most that: the first rung of the ladder is better.")
      .written("equivalent_msaa_low", part([](const Emr& emr) { return emr.low; }), form::amount(),
               "The lower end of the rate's range, about a standard deviation away: by the unevenness of the MSAA "
               "ladder, and, of all errors by RMSE, by blocks of pixels drawn again and the reference's own error, if "
               "that was measured.")
      .written("equivalent_msaa_high", part([](const Emr& emr) { return emr.high; }), form::amount(),
               "The upper end of that range; missing where it leaves the ladder.")
      .written("equivalent_msaa_does_not_converge",
               part([](const Emr& emr) { return emr.does_not_converge ? std::optional(true) : std::nullopt; }),
               form::boolean(), "There is no rate: the error is below that of the last rung, which falls no more.");
}

Form<Surface> surface_form() {
  return ObjectForm<Surface>()
      .written("name", &Surface::name, form::text(), "Its name.")
      .written("format", &Surface::format, form::text(), "What it stores per pixel; \"x N\" means N times.")
      .written("bytes_per_pixel", &Surface::bytes_per_pixel, form::count(), "Its size.");
}

std::uint64_t a_buffer_peak(const TechniqueReport& result) {
  std::uint64_t peak = 0;
  for (const FrameReport& frame : result.frames) peak = std::max(peak, frame.a_buffer_peak_bytes);
  return peak;
}

// The error in visibility and its own equivalent rate.
struct Visibility {
  double rmse;
  std::optional<EquivalentMsaa> msaa;
};

std::optional<Visibility> visibility_of(const TechniqueReport& result) {
  if (!result.parts) return std::nullopt;
  return Visibility{result.parts->visibility, result.visibility_msaa};
}

Form<Visibility> visibility_form() {
  ObjectForm<Visibility> visibility;
  visibility.written("rmse", &Visibility::rmse, form::amount(), "Root mean square.");
  add_rate(visibility, [](const Visibility& each) { return each.msaa; });
  return visibility;
}

std::optional<Json> causes_of(const TechniqueReport& result) {
  Json causes;
  for (const auto& [cause, part] : result.causes) causes[cause] = part;
  return causes.is_null() ? std::nullopt : std::optional(causes);
}

std::optional<Json> orders_of(const TechniqueReport& result) {
  if (result.orders.empty()) return std::nullopt;
  Json orders;
  for (const OrderReport& order : result.orders) orders[order.order] = rmse_form().write(order.rmse);
  orders["largest_difference"] = result.order_difference;
  return orders;
}

Json orders_schema() {
  Json schema = form::by_name(rmse_form()).schema;
  schema["properties"]["largest_difference"] =
      described(form::amount().schema, "RMS difference between the two orders whose pictures differ most.");
  return schema;
}

// All but the frames, which are written one after the other.
Form<TechniqueReport> result_form() {
  using Result = TechniqueReport;
  ObjectForm<Result> result;
  result.written("technique", &Result::technique, form::text("a spec"), "Its spec, as `beampipe run -t` takes it.")
      .written("pixels_on_chip", &Result::pixels_on_chip, form::boolean(),
               "The pixels of a bin are on chip while it is drawn.")
      .written("framebuffer_bytes_per_pixel", &Result::framebuffer_bytes_per_pixel, form::count(),
               "All surfaces in memory.")
      .written("peak_bytes_per_pixel", &Result::peak_bytes_per_pixel, form::amount(),
               "The framebuffer, and A-buffer, translucent layer and spilled records in the frame where these are "
               "largest.")
      .written("on_chip_bytes_per_pixel", &Result::on_chip_bytes_per_pixel, form::amount(),
               "All buffers that a bin has on chip, at their peaks, over the pixels of the largest bin.")
      .written("off_chip_bytes_per_pixel", &Result::peak_bytes_per_pixel, form::amount(), "As peak_bytes_per_pixel.")
      .written("framebuffer", &Result::framebuffer, form::list(surface_form()), "The surfaces in memory.")
      .written("a_buffer_peak_bytes", a_buffer_peak, form::count(),
               "The largest size of the A-buffer in any frame; 0: there is none.")
      .written("error", &Result::error, error_form(), "Differences from the reference.");
  add_rate(result, [](const Result& each) { return each.equivalent_msaa; });
  return result
      .written("visibility", visibility_of, visibility_form(),
               "The error in visibility, where surfaces vary, and its own equivalent rate.")
      .written(
          "shading", [](const Result& each) { return each.parts ? std::optional(each.parts->shading) : std::nullopt; },
          rmse_form(), "The error in shading, where surfaces vary.")
      .written("flicker", &Result::flicker, form::amount(),
               "Root mean square change of the error from one frame to the next.")
      .written("error_causes", causes_of, form::as_it_is(form::by_name(form::number()).schema),
               "After --causes: parts of the mean square error by cause, which add up to 1. A part is negative where "
               "the cause makes up for others.")
      .written("orders", orders_of, form::as_it_is(orders_schema()),
               "After --orders: errors with the triangles in other orders.")
      .written("inspections", form::filled(&Result::inspections), form::text("a file"),
               "The file with the histories of some pixels (`beampipe schema inspections`).");
}

Form<FrameContent> content_form() {
  using Content = FrameContent;
  return ObjectForm<Content>()
      .written("index", &Content::index, form::count(), "In the trace.")
      .written("width", &Content::width, form::count(1), "In pixels.")
      .written("height", &Content::height, form::count(1), "In pixels.")
      .written("triangles", &Content::triangles, form::count(), "Of all draws, before clipping and culling.")
      .written("draws", &Content::draws, form::count(), "Their number.")
      .written("lights", &Content::lights, form::count(), "Their number.");
}

Form<LadderRung> rung_form(const char* key, const char* meaning) {
  return ObjectForm<LadderRung>()
      .written("samples", &LadderRung::samples, form::count(1), "Samples per pixel.")
      .written(key, &LadderRung::error, form::amount(), meaning);
}

Form<std::vector<LadderRung>> ladder_form() { return form::list(rung_form("rmse", "Its RMSE.")); }

Form<MemoryParameters> memory_form() {
  ObjectForm<MemoryParameters> object;
  object.written("modelled", &MemoryParameters::modelled, form::boolean(), "Whether caches and DRAM were modelled.");
  for (const MemoryParameter& parameter : memory_parameters())
    object.add({parameter.key, parameter.meaning + ".", true, parameter.schema, {}, parameter.get});
  return object;
}

std::optional<Json> hardware_of(const Report& report) {
  return report.hardware.implementations.empty() ? std::nullopt : std::optional(report.hardware.json);
}

std::optional<std::string> hardware_name_of(const Report& report) {
  return report.hardware.named.empty() ? std::nullopt : std::optional(report.hardware.named);
}

Json schema_of_list(const Json& element) { return {{"type", "array"}, {"items", element}}; }

// All but the results and the claims, which are written one after the other.
ObjectForm<Report> head_form() {
  const Json object = {{"type", "object"}};
  ObjectForm<Report> head;
  return head
      .written(
          "beampipe_report", [](const Report&) { return 2; }, form::version(2), "The version of this format.")
      .written("trace", &Report::trace, form::text(), "The trace, as the user named it.")
      .written("version", &Report::version, form::text(), "Of the program.")
      .written("simd", &Report::simd, form::text(), "The instruction set that was used.")
      .written("command_line", form::filled(&Report::command_line), form::text(), "The command that made it.")
      .written("threads", &Report::threads, form::count(1), "That worked at once.")
      .written("memory_system", &Report::memory, memory_form(), "The modelled memory system.")
      .written(
          "made_by",
          [](const Report& report) { return report.made_by.is_null() ? std::nullopt : std::optional(report.made_by); },
          form::as_it_is(maker_form().schema), "All that the results depend on.")
      .written("hardware", hardware_of, form::as_it_is(object),
               "The hardware whose times are modelled (`beampipe schema hardware`).")
      .written("hardware_named", hardware_name_of, form::text(), "The hardware as the user named it.")
      .written(
          "trace_frames",
          [](const Report& report) {
            return report.frames.empty() ? std::nullopt : std::optional<std::uint64_t>(report.trace_frames);
          },
          form::count(1), "Frames of the whole trace.")
      .written("frames", form::filled(&Report::frames), form::list(content_form()),
               "What each rendered frame asks to be drawn.")
      .written("metric", form::filled(&Report::metric), form::one_of(metric_names()),
               "The measure that equivalent rates compare.")
      .written("reference_error", &Report::reference_error, form::amount(),
               "After --reference-error: RMSE of the reference itself, which is that between two independent ones over "
               "the root of 2.")
      .written("msaa_ladder", form::filled(&Report::msaa_ladder), ladder_form(),
               "Errors of msaa:N, between which equivalent rates are interpolated if the metric is RMSE.")
      .written("metric_msaa_ladder", form::filled(&Report::metric_ladder),
               form::list(rung_form("error", "Its error: 1 - SSIM, the RMSE of sRGB values for PSNR, or the measure.")),
               "The same by the metric, if that is another.")
      .written("visibility_msaa_ladder", form::filled(&Report::visibility_ladder), ladder_form(),
               "Those in visibility alone, where surfaces vary.")
      .written("notes", form::filled(&Report::notes), notes_form(),
               "What the frames ask for and no technique does, and shaders that were stopped.");
}

// The lines of a value that stands `level` levels deep, as in json_text. Line ends within strings are escaped.
std::string indented(const Json& json, std::size_t level) {
  std::string text;
  for (const char c : json.dump(2)) {
    text += c;
    if (c == '\n') text.append(2 * level, ' ');
  }
  return text;
}

// The text of a non-empty object without its last brace, for more members to follow.
std::string opened(const Json& json, std::size_t level) {
  std::string text = indented(json, level);
  text.resize(text.find_last_not_of(" \n", text.size() - 2) + 1);
  return text;
}

// Writes an array as the member `key` of an object that stands `level` levels deep.
class ArrayText {
 public:
  ArrayText(const char* key, std::size_t level, const WriteText& write) : level_(level), write_(write) {
    write_(",\n" + blanks(level_ + 1) + '"' + key + "\": [");
  }
  // What comes next is an element.
  void next() {
    write_((is_empty_ ? "\n" : ",\n") + blanks(level_ + 2));
    is_empty_ = false;
  }
  void end() const { write_(is_empty_ ? "]" : "\n" + blanks(level_ + 1) + "]"); }

 private:
  static std::string blanks(std::size_t level) { return std::string(2 * level, ' '); }

  std::size_t level_;
  const WriteText& write_;
  bool is_empty_ = true;
};

void write_result(const TechniqueReport& result, const Report& report, const WriteText& write) {
  write(opened(result_form().write(result), 2));
  ArrayText frames("frames", 2, write);
  for (const FrameReport& frame : result.frames) {
    frames.next();
    write(indented(beampipe::to_json(frame, result, report.hardware), 4));
  }
  frames.end();
  write("\n    }");
}

}  // namespace

Json report_schema() {
  Json result = result_form().schema;
  result["properties"]["frames"] =
      described(schema_of_list(frame_schema()), "One element for each frame that was rendered.");
  result["required"].push_back("frames");
  Json schema = Form<Report>(head_form()
                                 .added("results", schema_of_list(result),
                                        "One element for each technique. `compare` adds the reference as the last.")
                                 .added("claims", form::list(claim_form()).schema,
                                        "Published figures for which this report has our number."))
                    .schema;
  schema["required"].push_back("results");
  schema["required"].push_back("claims");
  return schema_file(schema, "beampipe report, version 2");
}

void write_json(const Report& report, const WriteText& write) {
  write(opened(Form<Report>(head_form()).write(report), 0));
  ArrayText results("results", 0, write);
  for (const TechniqueReport& result : report.results) {
    results.next();
    write_result(result, report, write);
  }
  results.end();
  ArrayText claims("claims", 0, write);
  for (const Claim& claim : answered_claims(report)) {
    claims.next();
    write(indented(claim_form().write(claim), 2));
  }
  claims.end();
  write("\n}\n");
}

}  // namespace beampipe
