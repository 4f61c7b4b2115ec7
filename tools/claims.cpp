#include "tools/claims.h"

#include <algorithm>

#include "stages/paper_storage.h"

namespace beampipe {
namespace {

constexpr const char* kSlides = "Crassin et al. 2018, slides, p. 23";
constexpr const char* kPaper = "Crassin et al. 2018, section 3";
constexpr const char* kAcaa = "Enderton et al. 2015";
constexpr const char* kBytesCommand = "beampipe run TRACE -t SPEC -o DIR; framebuffer in DIR/report.json";

double bytes_of(const char* spec) { return parse_technique(spec).framebuffer_bytes_per_pixel(); }

double bytes_without_color(const char* spec) {
  double bytes = 0;
  for (const Surface& surface : parse_technique(spec).framebuffer)
    if (surface.name != "color") bytes += surface.bytes_per_pixel;
  return bytes;
}

double mebibytes_at_4k(const char* spec) { return bytes_of(spec) * 3840 * 2160 / (1024.0 * 1024.0); }

Claim bytes(const std::string& name, double low, double high, double ours, const char* source) {
  return {name, "bytes/pixel", low, high, ours, source, kBytesCommand};
}

const FrameReport* first_frame(const Report& report, const std::string& spec) {
  for (const TechniqueReport& result : report.results)
    if (result.technique == spec && !result.frames.empty()) return &result.frames.front();
  return nullptr;
}

// Depth, colour, accumulator and resolve: without geometry, which no technique of these saves.
double framebuffer_dram(const FrameReport& frame) {
  double bytes = 0;
  for (const StageCounters& stage : frame.stages)
    if (stage.stage != "vertex_setup") bytes += static_cast<double>(stage.dram_bytes);
  return bytes;
}

Claim acaa_gives_back(const Report& report) {
  Claim claim{"ACAA, share of MSAA's extra framebuffer traffic over 1x that is saved",
              "",
              0.5,
              0.5,
              {},
              kAcaa,
              "beampipe run TRACE -t msaa:1,prepass -t msaa:8,color=rgba16f,prepass -t acaa:8 -o DIR"};
  const FrameReport* const one = first_frame(report, "msaa:1,prepass");
  const FrameReport* const msaa = first_frame(report, "msaa:8,color=rgba16f,prepass");
  const FrameReport* const acaa = first_frame(report, "acaa:8");
  if (report.memory.modelled && one && msaa && acaa)
    claim.ours =
        (framebuffer_dram(*msaa) - framebuffer_dram(*acaa)) / (framebuffer_dram(*msaa) - framebuffer_dram(*one));
  return claim;
}

// The paper's times on a Titan V at 1280 x 720, of its classroom.
struct PublishedTime {
  const char* spec;
  double ms;
};
constexpr double kBeamMs = 30.2;
constexpr PublishedTime kMsaaMs[] = {{"msaa:32", 24}, {"msaa:128", 78}, {"msaa:256", 198}};

// The paper's prototype is `beam:rules=paper`; with ours, where that is not in the report.
const FrameReport* beam_frame(const Report& report) {
  const FrameReport* const paper = first_frame(report, "beam:rules=paper");
  return paper ? paper : first_frame(report, "beam");
}

std::vector<Claim> time_ratios(const Report& report) {
  std::vector<Claim> claims;
  const FrameReport* const beam = beam_frame(report);
  for (const Implementation& implementation : report.hardware.implementations) {
    for (const PublishedTime& published : kMsaaMs) {
      const double ratio = published.ms / kBeamMs;
      Claim claim{
          std::string(published.spec) + " / beam, modelled time without overlap, beam as " + implementation.name,
          "",
          ratio,
          ratio,
          {},
          kPaper,
          "beampipe run TRACE -t beam:rules=paper msaa:32,128,256 -o DIR"};
      const FrameReport* const msaa = first_frame(report, published.spec);
      if (report.memory.modelled && beam && msaa)
        claim.ours = modelled_time(report.hardware, implementation, msaa->stages).sum_ms /
                     modelled_time(report.hardware, implementation, beam->stages).sum_ms;
      claims.push_back(claim);
    }
  }
  return claims;
}

}  // namespace

std::optional<double> Claim::difference() const {
  if (!ours) return {};
  return *ours - std::clamp(*ours, published_low, published_high);
}

std::vector<Claim> memory_claims() {
  return {bytes("beam, without colour", 36, 36, bytes_without_color("beam:rules=paper"), kSlides),
          bytes("beam, with fp16 RGB", 42, 42, bytes_of("beam:rules=paper"), kSlides),
          bytes("beam, without colour, a plane of three coefficients", 32, 32, kTextBytesWithoutColor, kPaper),
          bytes("beam, area-conserving rules, 256 positions, with fp16 RGB", 42, 42, bytes_of("beam"), kSlides),
          bytes("MSAA 8x, without colour", 24, 32, bytes_without_color("msaa:8"), kSlides),
          bytes("MSAA 8x, with fp16 RGB", 72, 80, bytes_of("msaa:8"), kSlides),
          bytes("MSAA 32x, without colour", 96, 128, bytes_without_color("msaa:32"), kSlides),
          bytes("MSAA 32x, with fp16 RGB", 288, 320, bytes_of("msaa:32"), kSlides),
          {"MSAA 8x, fp16 RGBA, 3840 x 2160", "MiB", 759, 759, mebibytes_at_4k("msaa:8,color=rgba16f"), kAcaa,
           kBytesCommand},
          {"ACAA 8x, fp16 RGBA, 3840 x 2160", "MiB", 316, 316, mebibytes_at_4k("acaa:8"), kAcaa, kBytesCommand}};
}

std::vector<Claim> measured_claims(const Report& report) {
  std::vector<Claim> claims = {acaa_gives_back(report)};
  const std::vector<Claim> times = time_ratios(report);
  claims.insert(claims.end(), times.begin(), times.end());
  return claims;
}

nlohmann::ordered_json to_json(const Claim& claim) {
  nlohmann::ordered_json json = {{"name", claim.name},
                                 {"unit", claim.unit},
                                 {"published_low", claim.published_low},
                                 {"published_high", claim.published_high}};
  json["ours"] = claim.ours ? nlohmann::ordered_json(*claim.ours) : nlohmann::ordered_json();
  json["difference"] = claim.ours ? nlohmann::ordered_json(*claim.difference()) : nlohmann::ordered_json();
  json["source"] = claim.source;
  json["command"] = claim.command;
  return json;
}

}  // namespace beampipe
