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

Json to_json(const TechniqueReport& result, const Report& report) {
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
  json["frames"] = Json::array();
  for (const FrameReport& frame : result.frames)
    json["frames"].push_back(beampipe::to_json(frame, result, report.hardware, report.more_hardware));
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

}  // namespace

Json to_json(const Report& report) {
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
  json["results"] = Json::array();
  for (const TechniqueReport& result : report.results) json["results"].push_back(to_json(result, report));
  json["claims"] = Json::array();
  for (const Claim& claim : answered_claims(report)) json["claims"].push_back(to_json(claim));
  return json;
}

}  // namespace beampipe
