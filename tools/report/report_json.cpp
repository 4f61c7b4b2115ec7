#include "tools/report/report_json.h"

#include <algorithm>

#include "tools/claims/claims.h"
#include "tools/evaluate/draw_notes.h"
#include "tools/evaluate/frame_json.h"

namespace beampipe {
namespace {

void add(const EquivalentMsaa& emr, Json& json) {
  json["equivalent_msaa"] = emr.samples;
  json["equivalent_msaa_is_lower_bound"] = emr.is_lower_bound;
  if (emr.is_upper_bound) json["equivalent_msaa_is_upper_bound"] = true;
}

Json to_json(const std::vector<LadderRung>& ladder) {
  Json json = Json::array();
  for (const LadderRung& rung : ladder) json.push_back({{"samples", rung.samples}, {"rmse", rung.rmse}});
  return json;
}

// All but the frames.
Json to_json(const TechniqueReport& result) {
  Json json = {{"technique", result.technique},
               {"pixels_on_chip", result.pixels_on_chip},
               {"framebuffer_bytes_per_pixel", result.framebuffer_bytes_per_pixel},
               {"peak_bytes_per_pixel", result.peak_bytes_per_pixel()},
               {"on_chip_bytes_per_pixel", result.on_chip_bytes_per_pixel()},
               {"off_chip_bytes_per_pixel", result.peak_bytes_per_pixel()}};
  json["framebuffer"] = Json::array();
  for (const Surface& surface : result.framebuffer) {
    json["framebuffer"].push_back(
        {{"name", surface.name}, {"format", surface.format}, {"bytes_per_pixel", surface.bytes_per_pixel}});
  }
  std::uint64_t peak = 0;
  for (const FrameReport& frame : result.frames) peak = std::max(peak, frame.a_buffer_peak_bytes);
  json["a_buffer_peak_bytes"] = peak;
  if (result.error) json["error"] = beampipe::to_json(*result.error);
  if (result.equivalent_msaa) add(*result.equivalent_msaa, json);
  if (result.parts) {
    json["visibility"]["rmse"] = result.parts->visibility;
    add(result.visibility_msaa.value(), json["visibility"]);
    json["shading"]["rmse"] = result.parts->shading;
  }
  if (result.flicker) json["flicker"] = *result.flicker;
  for (const auto& [cause, part] : result.causes) json["error_causes"][cause] = part;
  if (!result.orders.empty()) {
    for (const OrderReport& order : result.orders) json["orders"][order.order] = {{"rmse", order.rmse}};
    json["orders"]["largest_difference"] = result.order_difference;
  }
  if (!result.inspections.empty()) json["inspections"] = result.inspections;
  return json;
}

Json to_json(const FrameContent& frame) {
  return {{"index", frame.index},         {"width", frame.width}, {"height", frame.height},
          {"triangles", frame.triangles}, {"draws", frame.draws}, {"lights", frame.lights}};
}

Json to_json(const CacheParameters& cache) {
  return {{"bytes", cache.bytes}, {"ways", cache.ways}, {"line_bytes", cache.line_bytes}};
}

Json to_json(const MemoryParameters& memory) {
  return {{"modelled", memory.modelled},
          {"compression", memory.compression},
          {"sector_bytes", memory.sector_bytes},
          {"rop_cache", to_json(memory.rop)},
          {"l1_cache", to_json(memory.l1)},
          {"l2_cache", to_json(memory.l2)},
          {"plane_bytes", memory.plane_bytes},
          {"bin_pixels", memory.bin_pixels},
          {"framebuffer", name_of(memory.framebuffer)},
          {"on_chip_bytes", memory.on_chip_bytes}};
}

// All but the results and the claims.
Json head_json(const Report& report) {
  Json json = {{"beampipe_report", 1}, {"trace", report.trace},     {"version", report.version},
               {"simd", report.simd},  {"threads", report.threads}, {"memory_system", to_json(report.memory)}};
  if (!report.made_by.is_null()) json["made_by"] = report.made_by;
  if (!report.hardware.implementations.empty()) json["hardware"] = report.hardware.json;
  for (const Hardware& each : report.more_hardware) json["more_hardware"][each.label] = each.json;
  if (!report.frames.empty()) {
    json["trace_frames"] = report.trace_frames;
    json["frames"] = Json::array();
    for (const FrameContent& frame : report.frames) json["frames"].push_back(to_json(frame));
  }
  if (!report.msaa_ladder.empty()) json["msaa_ladder"] = to_json(report.msaa_ladder);
  if (!report.visibility_ladder.empty()) json["visibility_msaa_ladder"] = to_json(report.visibility_ladder);
  if (!report.notes.empty()) json["notes"] = beampipe::to_json(report.notes);
  return json;
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
  write(opened(to_json(result), 2));
  ArrayText frames("frames", 2, write);
  for (const FrameReport& frame : result.frames) {
    frames.next();
    write(indented(beampipe::to_json(frame, result, report.hardware, report.more_hardware), 4));
  }
  frames.end();
  write("\n    }");
}

}  // namespace

void write_json(const Report& report, const WriteText& write) {
  write(opened(head_json(report), 0));
  ArrayText results("results", 0, write);
  for (const TechniqueReport& result : report.results) {
    results.next();
    write_result(result, report, write);
  }
  results.end();
  ArrayText claims("claims", 0, write);
  for (const Claim& claim : answered_claims(report)) {
    claims.next();
    write(indented(to_json(claim), 2));
  }
  claims.end();
  write("\n}\n");
}

}  // namespace beampipe
