#include "pipeline/technique.h"

#include <bit>
#include <charconv>
#include <optional>

#include "hwy/targets.h"
#include "pipeline/beam.h"
#include "pipeline/msaa.h"
#include "pipeline/reference.h"

namespace beampipe {
namespace {

// "name[:item[,item...]]", an item being "value" or "key=value".
struct Spec {
  std::string text, name;
  std::vector<std::string> items;
};

[[noreturn]] void fail(const Spec& spec, const std::string& expected) {
  throw SpecError("technique '" + spec.text + "': expected " + expected);
}

Spec split_spec(std::string_view text) {
  Spec spec{std::string(text), std::string(text.substr(0, text.find(':'))), {}};
  if (spec.name.size() == text.size()) return spec;
  std::string_view rest = text.substr(spec.name.size() + 1);
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    more = comma != std::string_view::npos;
    spec.items.emplace_back(rest.substr(0, comma));
    if (more) rest.remove_prefix(comma + 1);
  }
  return spec;
}

MaskSource mask_source(const Spec& spec) {
  if (spec.items.empty()) return MaskSource::table;
  if (spec.items == std::vector<std::string>{"mask=table"}) return MaskSource::table;
  if (spec.items == std::vector<std::string>{"mask=exact"}) return MaskSource::exact;
  fail(spec, spec.name + " or " + spec.name + ":mask=table|exact");
}

Technique beam_technique(const Spec& spec, Composition composition) {
  const BeamOptions options{composition, composition == Composition::merge ? mask_source(spec) : MaskSource::table};
  return {spec.text, beam_framebuffer(composition), 0,
          [options](const Trace& trace, std::size_t frame, const RunOptions& run) {
            return render_beam(trace, trace.frames.at(frame), options, run);
          }};
}

Technique msaa_technique(const Spec& spec) {
  int samples = 0;
  if (spec.items.size() == 1) {
    const std::string& item = spec.items.front();
    const auto [end, error] = std::from_chars(item.data(), item.data() + item.size(), samples);
    if (error != std::errc{} || end != item.data() + item.size()) samples = 0;
  }
  if (samples < 1 || samples > kMaxMsaaSamples || !std::has_single_bit(static_cast<unsigned>(samples)))
    fail(spec, "msaa:N with N = 1, 2, 4, 8, 16, 32, 64, 128, 256, 512 or 1024");
  return {spec.text, msaa_framebuffer(samples), static_cast<std::uint32_t>(samples),
          [samples](const Trace& trace, std::size_t frame, const RunOptions& run) {
            return render_msaa(trace, trace.frames.at(frame), samples, run);
          }};
}

}  // namespace

Technique parse_technique(std::string_view text) {
  const Spec spec = split_spec(text);
  if (spec.name == "beam") return beam_technique(spec, Composition::merge);
  if (spec.name == "msaa") return msaa_technique(spec);
  if (spec.name != "alpha" && spec.name != "reference") fail(spec, "beam, alpha, msaa:N or reference");
  if (!spec.items.empty()) fail(spec, "'" + spec.name + "' alone: it has no options");
  if (spec.name == "alpha") return beam_technique(spec, Composition::over);
  return {spec.text, reference_framebuffer(), 0,
          [](const Trace& trace, std::size_t frame, const RunOptions& run) {
            return render_reference(trace, trace.frames.at(frame), run);
          }};
}

std::string technique_help() {
  return "  beam         analytic coverage, 32-bit localization mask, depth slab; sorted fragments, one aggregate per pixel\n"
         "               beam:mask=table  masks from a 64 x 64 table, as in the paper (the default)\n"
         "               beam:mask=exact  masks from exact edge tests\n"
         "  alpha        the same fragments, plain OVER, no mask\n"
         "  msaa:N       multisampling, N = 1, 2, 4, ... 1024; above 16: super-resolution of 8x\n"
         "  reference    4096 samples per pixel, double precision: the truth that errors are measured against\n";
}

std::string simd_target() { return hwy::TargetName(hwy::SupportedTargets() & -hwy::SupportedTargets()); }

}  // namespace beampipe
