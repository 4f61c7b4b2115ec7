#include "tools/claims/claims.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "pipeline/sampling.h"
#include "pipeline/techniques/dvm.h"
#include "pipeline/techniques/taa.h"
#include "simd/mask_table.h"
#include "stages/data/paper_aggregate.h"
#include "stages/samples/sample_select.h"
#include "stages/temporal/temporal.h"

namespace beampipe {
namespace {

constexpr const char* kSlides = "Crassin et al. 2018, slides, p. 23";
constexpr const char* kPaper = "Crassin et al. 2018, section 3";
constexpr const char* kAcaa = "Enderton et al. 2015";
constexpr const char* kDvm = "DVM article";
constexpr double kOrMore = std::numeric_limits<double>::infinity();

constexpr const char* kNoRendering = "beampipe claims";
constexpr const char* kClassroom =
    "beampipe make classroom --width 1280 --height 720 -o classroom.json && "
    "beampipe run classroom.json -t beam:rules=paper msaa:32,64,128,256 -o out/times";
constexpr const char* kErrors =
    "beampipe make classroom -o classroom.json && beampipe compare classroom.json -t beam:rules=paper -o out/classroom";
constexpr const char* kHairball =
    "beampipe make hairball -o hairball.json && beampipe compare hairball.json -t beam:rules=paper -o out/hairball";
constexpr const char* kBoat =
    "beampipe make boat -o boat.json && beampipe compare boat.json -t beam:rules=paper -o out/boat";
constexpr const char* kAcaaCommand =
    "beampipe make classroom -o classroom.json && beampipe run classroom.json -t msaa:1,prepass "
    "-t msaa:8,color=rgba16f,prepass -t acaa:8 -o out/acaa";

std::string number(double value, int digits = 4) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

// 0.1f as 0.1.
double written(float value) { return std::stod(number(static_cast<double>(value), 6)); }

double bytes_of(const char* spec) { return parse_technique(spec).framebuffer_bytes_per_pixel(); }

double bytes_of(const char* spec, const std::string& surface) {
  for (const Surface& each : parse_technique(spec).framebuffer)
    if (each.name == surface) return each.bytes_per_pixel;
  return 0;
}

double bytes_without_color(const char* spec) { return bytes_of(spec) - bytes_of(spec, "color"); }

double mebibytes_at_4k(const char* spec) { return bytes_of(spec) * 3840 * 2160 / (1024.0 * 1024.0); }

void add_memory_claims(std::vector<Claim>& claims) {
  const auto add = [&](const char* name, const char* unit, double low, double high, double ours, const char* source) {
    claims.push_back({name, unit, low, high, ours, source, kNoRendering, ""});
  };
  const auto bytes = [&](const char* name, double low, double high, double ours, const char* source) {
    add(name, "bytes/pixel", low, high, ours, source);
  };
  bytes("beam, coverage", 4, 4, bytes_of("beam:rules=paper", "coverage"), kSlides);
  bytes("beam, mask", 4, 4, bytes_of("beam:rules=paper", "mask"), kSlides);
  bytes("beam, plane of the depth slab", 16, 16, bytes_of("beam:rules=paper", "depth_plane"), kSlides);
  bytes("beam, thickness of the depth slab", 4, 4, bytes_of("beam:rules=paper", "thickness"), kSlides);
  bytes("beam, depth range", 8, 8, bytes_of("beam:rules=paper", "depth_range"), kSlides);
  bytes("beam, colour", 6, 6, bytes_of("beam:rules=paper", "color"), kSlides);
  bytes("beam, without colour", 36, 36, bytes_without_color("beam:rules=paper"), kSlides);
  bytes("beam, with fp16 RGB", 42, 42, bytes_of("beam:rules=paper"), kSlides);
  bytes("beam, without colour, a plane of three coefficients", 32, 32, kTextBytesWithoutColor, kPaper);
  bytes("beam, area-conserving rules, 256 positions, with fp16 RGB", 42, 42, bytes_of("beam"), kSlides);
  add("beam, bytes over those of MSAA 8x, with colour", "", 0, 1, bytes_of("beam:rules=paper") / bytes_of("msaa:8"),
      kPaper);
  bytes("MSAA 8x, without colour", 24, 32, bytes_without_color("msaa:8"), kSlides);
  bytes("MSAA 8x, with fp16 RGB", 72, 80, bytes_of("msaa:8"), kSlides);
  bytes("MSAA 32x, without colour", 96, 128, bytes_without_color("msaa:32"), kSlides);
  bytes("MSAA 32x, with fp16 RGB", 288, 320, bytes_of("msaa:32"), kSlides);
  add("MSAA beyond hardware's rates, samples of a super-resolved pixel", "samples", 8, 8,
      msaa_sampling(32).pattern.count, kPaper);
  add("beam, bits of the mask", "bits", 32, 32, 8 * bytes_of("beam:rules=paper", "mask"),
      "Crassin et al. 2018, section 2");
  add("beam, table of masks", "KiB", 16, 16, kTableAngles * kTableDistances * 4 / 1024.0,
      "Crassin et al. 2018, slides, p. 8");
  add("MSAA 8x, fp16 RGBA, 3840 x 2160", "MiB", 759, 759, mebibytes_at_4k("msaa:8,color=rgba16f"), kAcaa);
  add("ACAA 8x, fp16 RGBA, 3840 x 2160", "MiB", 316, 316, mebibytes_at_4k("acaa:8"), kAcaa);
  add("ACAA 8x, part of MSAA's memory that is saved", "", 0.5, kOrMore,
      1 - bytes_of("acaa:8") / bytes_of("msaa:8,color=rgba16f"), kAcaa);
  bytes("DVM, visibility id of a shading sample", 4, 4, bytes_of("dvm", "shading_visibility"), kDvm);
  bytes("DVM, mask of a shading sample", 4, 4, bytes_of("dvm", "mask"), kDvm);
  bytes("DVM, location of a shading sample", 5 / 8.0, 1, bytes_of("dvm", "location"), kDvm);
  bytes("DVM, visibility id, mask and location of a shading sample", 4 + 4 + 5 / 8.0, 4 + 4 + 1, kShadingSampleBytes,
        kDvm);
  add("DVM, visibility samples of a pixel", "", 8, 8, kQuadSamples / 4.0, kDvm);
  add("DVM, visibility samples of a 2x2 quad", "", 32, 32, kQuadSamples, kDvm);
  add("DVM, shading samples of a 2x2 quad", "", 4, 4, std::size(SampleQuad{}.mask), kDvm);
  add("DVM, motion below which the clamp fades out", "pixels", 0.05, 0.05, written(kStillPixels), kDvm);
  add("TAA, jitter positions", "", 8, 8, TaaOptions{}.samples, kDvm);
  add("TAA, weight T of a new frame", "", 0.05, 0.1, written(TaaOptions{}.blend), kDvm);
  add("TAA, what the first frame still counts after 1 frame at T = 0.1", "", 0.9, 0.9, 1 - written(TaaOptions{}.blend),
      kDvm);
  const struct {
    double blend, published[5];
  } fading[] = {{0.1, {0.430, 0.206, 0.042, 0.0087, 0.0018}}, {0.05, {0.663, 0.463, 0.215, 0.099, 0.046}}};
  constexpr int kFrames[] = {8, 15, 30, 45, 60};
  for (const auto& [blend, published] : fading)
    for (std::size_t i = 0; i < 5; ++i)
      claims.push_back({"TAA, what the first frame still counts after " + std::to_string(kFrames[i]) +
                            " frames at T = " + (blend == 0.1 ? "0.1" : "0.05"),
                        "", published[i], published[i], std::pow(1 - blend, kFrames[i]), kDvm, kNoRendering,
                        "(1 - T)^frames, as in stages/temporal/temporal.h"});
}

// ---- Times and errors of the paper ----

std::optional<double> quotient(std::optional<double> a, std::optional<double> b) {
  if (!a || !b || *b == 0) return {};
  return *a / *b;
}

void add_time_claims(const Report& report, std::vector<Claim>& claims) {
  constexpr const char* kModelled = "modelled, stage after stage, beam in shaders: there is no such GPU here";
  constexpr double kBeamMs = 30.2;
  const FrameReport* const beam = first_frame(report, "beam:rules=paper");
  const bool is_classroom = scene_of(report) == "classroom";
  const std::vector<std::pair<const char*, double>> published = {
      {"beam:rules=paper", kBeamMs}, {"msaa:32", 24}, {"msaa:128", 78}, {"msaa:256", 198}};
  for (const auto& [spec, ms] : published)
    claims.push_back({std::string(spec) + ", time, classroom, 1280 x 720, Titan V", "ms", ms, ms,
                      is_classroom ? modelled_ms(report, first_frame(report, spec)) : std::nullopt, kPaper, kClassroom,
                      kModelled});
  const auto ratio = [&](const std::string& spec, const Implementation& implementation) -> std::optional<double> {
    const FrameReport* const msaa = first_frame(report, spec);
    if (!report.memory.modelled || !beam || !msaa) return {};
    return modelled_time(report.hardware, implementation, msaa->stages).sum_ms /
           modelled_time(report.hardware, implementation, beam->stages).sum_ms;
  };
  const auto add = [&](const std::string& spec, double low, double high, const char* source, const char* what = "") {
    for (const Implementation& implementation :
         report.hardware.implementations.empty() ? titan_v().implementations : report.hardware.implementations)
      claims.push_back({spec + " / beam, time" + what + ", beam as " + implementation.name, "", low, high,
                        ratio(spec, implementation), source, kClassroom,
                        "modelled, stage after stage, of the report's scene"});
  };
  for (const auto& [spec, ms] : published)
    if (spec != published[0].first) add(spec, ms / kBeamMs, ms / kBeamMs, kPaper);
  add("msaa:64", 1, kOrMore, "Crassin et al. 2018, abstract: faster than 64x", ", in words");
  add("msaa:256", 6, 7, "Crassin et al. 2018, section 3 (7x) and slides, p. 15 (about 6x)", ", in words");
}

void add_error_claims(const Report& report, std::vector<Claim>& claims) {
  const auto emr = [&](const char* scene) -> std::optional<double> {
    for (const TechniqueReport& result : report.results)
      if (result.technique == "beam:rules=paper" && result.equivalent_msaa && scene_of(report) == scene)
        return result.equivalent_msaa->samples;
    return {};
  };
  constexpr const char* kEmr = "EMR of beam:rules=paper, 320 x 180, our scene of that kind; the paper judged by eye";
  claims.push_back({"beam, quality, classroom", "samples", 256, 256, emr("classroom"), kPaper, kErrors, kEmr});
  claims.push_back({"beam, quality, hairball (64x needed to converge)", "samples", 64, 256, emr("hairball"),
                    "Crassin et al. 2018, section 3, figure 5", kHairball, kEmr});
  claims.push_back({"beam, quality, boat (256x needed for the ropes)", "samples", 256, 256, emr("boat"),
                    "Crassin et al. 2018, section 3, figure 5", kBoat, kEmr});
  std::optional<double> most;
  const FrameReport* const frame = first_frame(report, "beam:rules=paper");
  if (frame && scene_of(report) == "classroom" && frame->pixel_counters.contains("fragments"))
    most = frame->pixel_counters.at("fragments").max;
  claims.push_back({"classroom, most fragments of a pixel", "fragments", 50, kOrMore, most, kPaper, kClassroom,
                    "the largest value of channel `fragments`, our scene of that kind"});
}

// ---- ACAA ----

// Without geometry and its attributes, which no technique of these saves.
double framebuffer_dram(const FrameReport& frame) {
  double bytes = 0;
  for (const StageCounters& stage : frame.stages)
    if (stage.stage == "depth_test" || stage.stage == "accumulate" || stage.stage == "resolve")
      bytes += static_cast<double>(stage.dram_bytes);
  return bytes;
}

void add_acaa_claims(const Report& report, std::vector<Claim>& claims) {
  const FrameReport* const one = first_frame(report, "msaa:1,prepass");
  const FrameReport* const msaa = first_frame(report, "msaa:8,color=rgba16f,prepass");
  const FrameReport* const acaa = first_frame(report, "acaa:8");
  std::optional<double> given_back, saved, time_given_back, time_saved;
  if (report.memory.modelled && one && msaa && acaa) {
    const double difference = framebuffer_dram(*msaa) - framebuffer_dram(*acaa);
    given_back = quotient(difference, framebuffer_dram(*msaa) - framebuffer_dram(*one));
    saved = quotient(difference, framebuffer_dram(*msaa));
    if (const auto one_ms = modelled_ms(report, one)) {
      const double msaa_ms = *modelled_ms(report, msaa), ms = msaa_ms - *modelled_ms(report, acaa);
      time_given_back = quotient(ms, msaa_ms - *one_ms);
      time_saved = quotient(ms, msaa_ms);
    }
  }
  constexpr const char* kTraffic = "modelled DRAM bytes of depth_test, accumulate and resolve";
  constexpr const char* kTime = "modelled, stage after stage: there is no such GPU here";
  const auto add = [&](const char* name, double low, double high, std::optional<double> ours, const char* beside) {
    claims.push_back({name, "", low, high, ours, kAcaa, kAcaaCommand, beside});
  };
  add("ACAA, part of what MSAA adds to 1x in framebuffer traffic that is saved", 0.5, 0.5, given_back, kTraffic);
  add("ACAA, part of MSAA's off-chip traffic that is saved (abstract)", 0.2, 0.3, saved, kTraffic);
  add("ACAA, part of MSAA's framebuffer traffic that is saved (section 1)", 0.3, 0.3, saved, kTraffic);
  add("ACAA, part of what MSAA adds to 1x in frame time that is saved", 0.5, 0.5, time_given_back, kTime);
  add("ACAA, part of MSAA's frame time that is saved", 0.2, 0.3, time_saved, kTime);
}

}  // namespace

std::optional<double> Claim::difference() const {
  if (!ours) return {};
  return *ours - std::clamp(*ours, published_low, published_high);
}

std::string scene_of(const Report& report) { return std::filesystem::path(report.trace).stem().string(); }

const FrameReport* first_frame(const Report& report, const std::string& spec) {
  for (const TechniqueReport& result : report.results)
    if (result.technique == spec && !result.frames.empty()) return &result.frames.front();
  return nullptr;
}

std::optional<double> modelled_ms(const Report& report, const FrameReport* frame,
                                  const std::vector<std::string>& stages) {
  if (!frame || !report.memory.modelled || report.hardware.implementations.empty()) return {};
  const ModelledTime time = modelled_time(report.hardware, report.hardware.implementations.front(), frame->stages);
  if (stages.empty()) return time.sum_ms;
  std::optional<double> sum;
  for (std::size_t i = 0; i < frame->stages.size(); ++i)
    if (std::find(stages.begin(), stages.end(), frame->stages[i].stage) != stages.end())
      sum = sum.value_or(0) + time.stages[i];
  return sum;
}

std::vector<Claim> all_claims(const Report& report) {
  std::vector<Claim> claims;
  add_memory_claims(claims);
  add_acaa_claims(report, claims);
  add_time_claims(report, claims);
  add_error_claims(report, claims);
  add_dvm_claims(report, claims);
  return claims;
}

std::vector<Claim> answered_claims(const Report& report) {
  std::vector<Claim> claims = all_claims(report);
  std::erase_if(claims, [](const Claim& claim) { return !claim.ours; });
  return claims;
}

nlohmann::ordered_json to_json(const Claim& claim) {
  nlohmann::ordered_json json = {{"name", claim.name}, {"unit", claim.unit}, {"published_low", claim.published_low}};
  const auto or_null = [](std::optional<double> value) {
    return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
  };
  json["published_high"] = or_null(claim.published_high);  // null: or more
  json["ours"] = or_null(claim.ours);
  json["difference"] = or_null(claim.difference());
  json["source"] = claim.source;
  json["command"] = claim.command;
  json["beside"] = claim.beside;
  return json;
}

std::string claims_text(const std::vector<Claim>& claims) {
  std::string text =
      "| claim | unit | published | ours | difference | what ours is | source | command "
      "|\n|---|---|---|---|---|---|---|---|\n";
  for (const Claim& claim : claims) {
    std::string published = number(claim.published_low, 6);
    if (!std::isfinite(claim.published_high))
      published += " or more";
    else if (claim.published_high != claim.published_low)
      published += " to " + number(claim.published_high, 6);
    text += "| " + claim.name + " | " + claim.unit + " | " + published + " | " +
            (claim.ours ? number(*claim.ours) : "") + " | " + (claim.ours ? number(*claim.difference()) : "") + " | " +
            claim.beside + " | " + claim.source + " | `" + claim.command + "` |\n";
  }
  return text;
}

}  // namespace beampipe
