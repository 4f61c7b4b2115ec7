#include "tools/claims/our_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>

#include "pipeline/sampling.h"
#include "pipeline/techniques/dvm.h"
#include "pipeline/techniques/taa.h"
#include "simd/mask_table.h"
#include "simd/match.h"
#include "stages/data/casav_aggregate.h"
#include "stages/samples/sample_select.h"
#include "stages/temporal/temporal.h"

namespace beampipe {
namespace {

using Number = std::optional<double>;
using Ours = std::function<Number(const Findings&)>;

Number quotient(Number a, Number b) { return a && b && *b != 0 ? Number(*a / *b) : std::nullopt; }
Number difference(Number a, Number b) { return a && b ? Number(*a - *b) : std::nullopt; }

// ---- What needs no rendering ----

Ours constant(double value) {
  return [value](const Findings&) { return value; };
}

double bytes_of(const char* spec) { return parse_technique(spec).framebuffer_bytes_per_pixel(); }

double bytes_of(const char* spec, const std::string& surface) {
  for (const Surface& each : parse_technique(spec).framebuffer.in_memory({}))
    if (each.name == surface) return each.bytes_per_pixel;
  return 0;
}

double bytes_without_color(const char* spec) { return bytes_of(spec) - bytes_of(spec, "color"); }

double mebibytes_at_4k(const char* spec) { return bytes_of(spec) * 3840 * 2160 / (1024.0 * 1024.0); }

// The decimal number that was written in the code: 0.1 for 0.1f, which is not the same double.
double written(float value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", static_cast<double>(value));
  return std::stod(text);
}

// What the first frame still counts after so many frames, each of which counts `weight`.
Ours history(double weight, int frames) { return constant(std::pow(1 - weight, frames)); }

// ---- What reports have ----

const FrameReport* frame_of(const Findings& found, const std::string& spec) {
  for (const TechniqueReport& result : found.report.results)
    if (result.technique == spec && !result.frames.empty()) return &result.frames.back();
  return nullptr;
}

const StageCounters* stage_of(const Findings& found, const std::string& spec, Stage which) {
  const FrameReport* const frame = frame_of(found, spec);
  return frame ? find_counters(frame->stages, which) : nullptr;
}

std::optional<ModelledTime> time_of(const Findings& found, const std::string& spec) {
  const FrameReport* const frame = frame_of(found, spec);
  if (!frame || !found.report.memory.modelled || found.report.hardware.implementations.empty()) return {};
  return modelled_time(found.report.hardware, found.implementation, frame->work());
}

// Modelled milliseconds of these stages, or of all, one stage after the other.
Number milliseconds(const Findings& found, const std::string& spec, const std::vector<Stage>& stages = {}) {
  const std::optional<ModelledTime> time = time_of(found, spec);
  if (!time) return {};
  if (stages.empty()) return time->in_turn_ms;
  Number sum;
  for (const StageTime& each : time->stages)
    if (std::find(stages.begin(), stages.end(), each.stage) != stages.end()) sum = sum.value_or(0) + each.ms;
  return sum;
}

Ours ms(const std::string& spec, const std::vector<Stage>& stages = {}) {
  return [=](const Findings& found) { return milliseconds(found, spec, stages); };
}

Ours ms_over_casav(const std::string& spec) {
  return [=](const Findings& found) { return quotient(milliseconds(found, spec), milliseconds(found, "casav")); };
}

Number emr_of_casav(const Findings& found) {
  for (const TechniqueReport& result : found.report.results)
    if (result.technique == "casav" && result.equivalent_msaa) return result.equivalent_msaa->samples;
  return {};
}

Number most_fragments_of_casav(const Findings& found) {
  const FrameReport* const frame = frame_of(found, "casav");
  if (!frame || !frame->pixel_counters.contains("fragments")) return {};
  return frame->pixel_counters.at("fragments").max;
}

Number bytes_with_a_buffer_over_msaa(const Findings& found) {
  const FrameReport* const frame = frame_of(found, "casav");
  if (!frame || frame->pixels == 0) return {};
  const double a_buffer = static_cast<double>(frame->a_buffer_peak_bytes) / static_cast<double>(frame->pixels);
  return (bytes_of("casav") + a_buffer) / bytes_of("msaa:8");
}

// ---- Accumulative antialiasing against multisampling ----

struct AcaaNumbers {
  double one = 0, msaa = 0, acaa = 0;
};

// What ACAA saves, as a part of what MSAA adds to one sample per pixel.
Number part_of_added(const std::optional<AcaaNumbers>& of) {
  return of ? quotient(of->msaa - of->acaa, of->msaa - of->one) : std::nullopt;
}

// What ACAA saves, as a part of what MSAA takes.
Number part_of_all(const std::optional<AcaaNumbers>& of) {
  return of ? quotient(of->msaa - of->acaa, of->msaa) : std::nullopt;
}

constexpr const char* kOneSample = "msaa:1,prepass";
constexpr const char* kMsaa = "msaa:8,color=rgba16f,prepass";
constexpr const char* kAcaa = "acaa:8";

bool moves_framebuffer(const StageCounters& stage) {
  return stage.stage.id == StageId::depth_test || stage.stage == StageId::accumulate || stage.stage == StageId::resolve;
}
bool is_any(const StageCounters&) { return true; }

// DRAM bytes of these stages.
std::optional<AcaaNumbers> acaa_traffic(const Findings& found, bool (*counts)(const StageCounters&)) {
  const FrameReport *const one = frame_of(found, kOneSample), *const msaa = frame_of(found, kMsaa),
                           *const acaa = frame_of(found, kAcaa);
  if (!found.report.memory.modelled || !one || !msaa || !acaa) return {};
  const auto bytes = [&](const FrameReport& frame) {
    double sum = 0;
    for (const StageCounters& stage : frame.stages) sum += counts(stage) ? static_cast<double>(stage.dram_bytes) : 0;
    return sum;
  };
  return AcaaNumbers{bytes(*one), bytes(*msaa), bytes(*acaa)};
}

// One stage after the other, or all at once.
std::optional<AcaaNumbers> acaa_times(const Findings& found, double ModelledTime::*ms) {
  const std::optional<ModelledTime> one = time_of(found, kOneSample), msaa = time_of(found, kMsaa),
                                    acaa = time_of(found, kAcaa);
  if (!one || !msaa || !acaa) return {};
  return AcaaNumbers{(*one).*ms, (*msaa).*ms, (*acaa).*ms};
}

Ours saved(Number (*part)(const std::optional<AcaaNumbers>&), bool (*counts)(const StageCounters&)) {
  return [=](const Findings& found) { return part(acaa_traffic(found, counts)); };
}
Ours saved(Number (*part)(const std::optional<AcaaNumbers>&), double ModelledTime::*ms) {
  return [=](const Findings& found) { return part(acaa_times(found, ms)); };
}

// ---- The passes of the DVM article ----

struct ArticlePass {
  std::string name;
  std::vector<Stage> stages;
};

struct ArticlePath {
  std::string name, spec;
  std::vector<ArticlePass> passes;
};

constexpr const char* kForward = "taa:8,shading=forward";
constexpr const char* kDvm = "dvm:clamp=camera";  // as the article's

// The article's names, our specs, and the stages that do a pass's work. Every stage belongs to one pass.
std::vector<ArticlePath> article_paths() {
  const ArticlePass prepass{"PrePass",
                            {{StageId::vertex_setup, Pass::prepass},
                             {StageId::sample_raster, Pass::prepass},
                             {StageId::depth_test, Pass::prepass}}},
      // What draws visibility first has all of its geometry in the first pass.
      visibility{"PrePass", {StageId::vertex_setup, StageId::sample_raster, StageId::depth_test}},
      drawn{"Material", {StageId::vertex_setup, StageId::sample_raster, StageId::depth_test, StageId::shade}},
      shaded{"Material", {StageId::shade}}, lighting{"Lighting", {StageId::light}}, motion{"Motion", {StageId::motion}},
      resolve{"Resolve/TAA", {StageId::resolve, StageId::temporal}};
  const std::string msaa = ",prepass,motion,resolve=reinhard";
  return {
      {"Forward", kForward, {prepass, drawn, motion, resolve}},
      {"Msaa 2x", "msaa:2" + msaa, {prepass, drawn, motion, resolve}},
      {"Msaa 4x", "msaa:4" + msaa, {prepass, drawn, motion, resolve}},
      {"Msaa 8x", "msaa:8" + msaa, {prepass, drawn, motion, resolve}},
      {"Deferred", "taa:8,shading=deferred", {prepass, drawn, lighting, motion, resolve}},
      {"Visibility", "taa:8", {visibility, shaded, lighting, {"VisUtil", {StageId::material_sort}}, motion, resolve}},
      {"DVM",
       kDvm,
       {visibility,
        shaded,
        lighting,
        {"VisUtil", {StageId::sample_select, StageId::material_sort}},
        motion,
        {"Resolve/TAA", {StageId::dilate, StageId::temporal}}}}};
}

// ---- Shader invocations ----

Number invocations_per_pixel(const Findings& found, const std::string& spec) {
  const StageCounters* const shade = stage_of(found, spec, StageId::shade);
  const FrameReport* const frame = frame_of(found, spec);
  if (!shade || frame->pixels == 0) return {};
  return static_cast<double>(shade->lanes_issued) / static_cast<double>(frame->pixels);
}

Ours invocations(const std::string& spec) {
  return [=](const Findings& found) { return invocations_per_pixel(found, spec); };
}

Ours invocations_over_forward(const std::string& spec) {
  return [=](const Findings& found) {
    return quotient(invocations_per_pixel(found, spec), invocations_per_pixel(found, kForward));
  };
}

// Invocations fill whole quads, and those outside the triangle are not needed.
Number invocations_over_needed(const Findings& found) {
  const StageCounters* const shade = stage_of(found, kForward, StageId::shade);
  if (!shade || shade->lanes_used == 0) return {};
  return static_cast<double>(shade->lanes_issued) / static_cast<double>(shade->lanes_used);
}

// Triangles so small that each covers the centre of one pixel or of none.
Number triangles_without_center(const Findings& found) {
  const StageCounters* const raster = stage_of(found, kOneSample, StageId::sample_raster);
  if (!raster || raster->items_in == 0) return {};
  return 1 - static_cast<double>(raster->items_out) / static_cast<double>(raster->items_in);
}

Number dvm_less_visibility(const Findings& found) {
  return difference(milliseconds(found, kDvm), milliseconds(found, "taa:8"));
}

}  // namespace

std::vector<Formula> our_formulas() {
  std::vector<Formula> formulas = {
      {"casav.bytes.coverage", constant(bytes_of("casav", "coverage"))},
      {"casav.bytes.mask", constant(bytes_of("casav", "mask"))},
      {"casav.bytes.depth_plane", constant(bytes_of("casav", "depth_plane"))},
      {"casav.bytes.thickness", constant(bytes_of("casav", "thickness"))},
      {"casav.bytes.depth_range", constant(bytes_of("casav", "depth_range"))},
      {"casav.bytes.color", constant(bytes_of("casav", "color"))},
      {"casav.bytes.without_color", constant(bytes_without_color("casav"))},
      {"casav.bytes", constant(bytes_of("casav"))},
      {"casav.bytes.three_coefficients", constant(kTextBytesWithoutColor)},
      {"casav.bytes_over_msaa_8", constant(bytes_of("casav") / bytes_of("msaa:8"))},
      {"msaa_8.bytes.without_color", constant(bytes_without_color("msaa:8"))},
      {"msaa_8.bytes", constant(bytes_of("msaa:8"))},
      {"msaa_32.bytes.without_color", constant(bytes_without_color("msaa:32"))},
      {"msaa_32.bytes", constant(bytes_of("msaa:32"))},
      {"msaa.samples_of_super_resolved_pixel", constant(msaa_sampling(32).pattern.count)},
      {"casav.mask_bits", constant(8 * bytes_of("casav", "mask"))},
      {"casav.mask_table_kib", constant(kTableAngles * kTableDistances * 4 / 1024.0)},
      {"msaa_8.mib_at_4k", constant(mebibytes_at_4k("msaa:8,color=rgba16f"))},
      {"acaa_8.mib_at_4k", constant(mebibytes_at_4k("acaa:8"))},
      {"acaa_8.memory_saved", constant(1 - bytes_of("acaa:8") / bytes_of("msaa:8,color=rgba16f"))},
      {"dvm.bytes.visibility", constant(bytes_of("dvm", "shading_visibility"))},
      {"dvm.bytes.mask", constant(bytes_of("dvm", "mask"))},
      {"dvm.bytes.location", constant(bytes_of("dvm", "location"))},
      {"dvm.bytes.shading_sample", constant(kShadingSampleBytes)},
      {"dvm.visibility_samples.pixel", constant(kQuadSamples / 4.0)},
      {"dvm.visibility_samples.quad", constant(kQuadSamples)},
      {"dvm.shading_samples.quad", constant(std::size(SampleQuad{}.mask))},
      {"dvm.still_pixels", constant(written(kStillPixels))},
      {"taa.jitter_positions", constant(TaaOptions{}.samples)},
      {"taa.weight", constant(written(TaaOptions{}.blend))},
      {"taa.history.1_at_0.1", history(written(TaaOptions{}.blend), 1)},
      {"taa.history.8_at_0.1", history(0.1, 8)},
      {"taa.history.15_at_0.1", history(0.1, 15)},
      {"taa.history.30_at_0.1", history(0.1, 30)},
      {"taa.history.45_at_0.1", history(0.1, 45)},
      {"taa.history.60_at_0.1", history(0.1, 60)},
      {"taa.history.8_at_0.05", history(0.05, 8)},
      {"taa.history.15_at_0.05", history(0.05, 15)},
      {"taa.history.30_at_0.05", history(0.05, 30)},
      {"taa.history.45_at_0.05", history(0.05, 45)},
      {"taa.history.60_at_0.05", history(0.05, 60)},
      {"acaa.added_traffic_saved", saved(part_of_added, moves_framebuffer)},
      {"acaa.traffic_saved", saved(part_of_all, moves_framebuffer)},
      {"acaa.all_traffic_saved", saved(part_of_all, is_any)},
      {"acaa.added_ms_saved", saved(part_of_added, &ModelledTime::at_once_ms)},
      {"acaa.ms_saved", saved(part_of_all, &ModelledTime::at_once_ms)},
      {"acaa.added_ms_saved_in_turn", saved(part_of_added, &ModelledTime::in_turn_ms)},
      {"acaa.ms_saved_in_turn", saved(part_of_all, &ModelledTime::in_turn_ms)},
      {"ms.casav", ms("casav")},
      {"ms.msaa:32", ms("msaa:32")},
      {"ms.msaa:128", ms("msaa:128")},
      {"ms.msaa:256", ms("msaa:256")},
      {"ms_over_casav.msaa:32", ms_over_casav("msaa:32")},
      {"ms_over_casav.msaa:64", ms_over_casav("msaa:64")},
      {"ms_over_casav.msaa:128", ms_over_casav("msaa:128")},
      {"ms_over_casav.msaa:256", ms_over_casav("msaa:256")},
      {"casav.emr", emr_of_casav},
      {"casav.most_fragments", most_fragments_of_casav},
      {"ms.dvm_less_visibility", dvm_less_visibility},
      {"ms.supersampled.1x", ms("visibility:1", {StageId::shade, StageId::light})},
      {"ms.supersampled.2x", ms("visibility:2", {StageId::shade, StageId::light})},
      {"ms.supersampled.4x", ms("visibility:4", {StageId::shade, StageId::light})},
      {"ms.supersampled.8x", ms("visibility:8", {StageId::shade, StageId::light})},
      {"invocations.msaa:1,prepass", invocations("msaa:1,prepass")},
      {"invocations.msaa:8,prepass", invocations("msaa:8,prepass")},
      {"invocations_over_needed", invocations_over_needed},
      {"triangles_without_center", triangles_without_center},
      {"casav.bytes_with_a_buffer_over_msaa_8", bytes_with_a_buffer_over_msaa},
  };
  for (const ArticlePath& path : article_paths()) {
    for (const ArticlePass& pass : path.passes)
      formulas.push_back({"ms." + path.name + "." + pass.name, ms(path.spec, pass.stages)});
    formulas.push_back({"ms." + path.name + ".Total", ms(path.spec)});
    if (path.name.starts_with("Msaa"))
      formulas.push_back({"invocations_over_forward." + path.name, invocations_over_forward(path.spec)});
  }
  return formulas;
}

void expect_formulas_match(const std::vector<PublishedFigure>& figures, const std::vector<Formula>& formulas) {
  std::set<std::string> known, used, names;
  for (const Formula& formula : formulas)
    if (!known.insert(formula.id).second) throw std::logic_error("claims: there are two formulas " + formula.id);
  for (const PublishedFigure& figure : figures) {
    for (const std::string& name : {figure.numerator, figure.denominator})
      if (!name.empty() && !names.contains(name))
        throw std::logic_error("claims: \"" + figure.name + "\": there is no claim \"" + name + "\" before it");
    names.insert(figure.name);
    if (figure.formula.empty()) continue;
    if (!known.contains(figure.formula))
      throw std::logic_error("claims: \"" + figure.name + "\": there is no formula " + figure.formula);
    used.insert(figure.formula);
  }
  for (const std::string& id : known)
    if (!used.contains(id)) throw std::logic_error("claims: no published figure names the formula " + id);
}

}  // namespace beampipe
