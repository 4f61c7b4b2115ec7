#include "pipeline/technique.h"

#include <algorithm>
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

// "beam[:key=value,...]": rules=conserve|paper; bits=N with conserve; mask=table|exact with the 32 bits of paper.
BeamOptions beam_options(const Spec& spec) {
  std::map<std::string, std::string> values;
  for (const std::string& item : spec.items) {
    const std::size_t equals = std::min(item.find('='), item.size());
    const std::string key = item.substr(0, equals);
    if (key != "rules" && key != "bits" && key != "mask") fail(spec, "options rules, bits or mask, as key=value");
    if (!values.emplace(key, item.substr(std::min(equals + 1, item.size()))).second) fail(spec, key + " once");
  }
  const auto choose = [&]<class Value>(const std::string& key, Value& value,
                                       const std::vector<std::pair<std::string, Value>>& choices) {
    const auto given = values.find(key);
    if (given == values.end()) return;
    std::string names;
    for (const auto& [name, choice] : choices) {
      if (given->second == name) return void(value = choice);
      names += (names.empty() ? "" : "|") + name;
    }
    fail(spec, key + "=" + names);
  };
  BeamOptions options;
  choose("rules", options.rules,
         std::vector<std::pair<std::string, Rules>>{{"conserve", Rules::conserve}, {"paper", Rules::paper}});
  if (options.rules == Rules::paper) {
    if (values.count("bits")) fail(spec, "no bits with rules=paper: its masks have 32");
    options.positions = 32;
    options.mask = MaskSource::table;
    choose("mask", options.mask,
           std::vector<std::pair<std::string, MaskSource>>{{"table", MaskSource::table}, {"exact", MaskSource::exact}});
  } else {
    if (values.count("mask")) fail(spec, "mask only with rules=paper: other masks are exact");
    choose("bits", options.positions,
           std::vector<std::pair<std::string, int>>{{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}});
  }
  return options;
}

Technique beam_technique(const Spec& spec, const BeamOptions& options) {
  return {spec.text, beam_framebuffer(options), 0,
          [options](const Trace& trace, std::size_t frame, const RunOptions& run) {
            return render_beam(trace, trace.frames.at(frame), options, run);
          }};
}

Technique msaa_technique(const Spec& spec) {
  int samples = 0;
  if (spec.items.size() == 1) {
    const std::string& item = spec.items.front();
    const auto [end, error] = std::from_chars(item.data(), item.data() + item.size(), samples);
    if (error != std::errc{} || end != item.data() + item.size() || item.front() == '0') samples = 0;
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
  if (spec.name == "beam") return beam_technique(spec, beam_options(spec));
  if (spec.name == "msaa") return msaa_technique(spec);
  if (spec.name != "alpha" && spec.name != "reference") fail(spec, "beam, alpha, msaa:N or reference");
  if (!spec.items.empty()) fail(spec, "'" + spec.name + "' alone: it has no options");
  if (spec.name == "alpha") return beam_technique(spec, {Rules::over, 0, MaskSource::none});
  return {spec.text, reference_framebuffer(), 0, [](const Trace& trace, std::size_t frame, const RunOptions& run) {
            return render_reference(trace, trace.frames.at(frame), run);
          }};
}

std::string technique_help() {
  return "  beam         sorted fragments with analytic coverage and a mask, one area-conserving aggregate per pixel\n"
         "               beam:bits=N      N = 32, 64, 128 or 256 (the default) mask positions\n"
         "               beam:rules=paper the published rules: 32-bit mask, depth slab\n"
         "               beam:rules=paper,mask=exact  its masks from edge tests in place of the 64 x 64 table\n"
         "  alpha        the same fragments, plain OVER, no mask\n"
         "  msaa:N       multisampling, N = 1, 2, 4, ... 1024; above 16: super-resolution of 8x\n"
         "  reference    4096 samples per pixel, double precision: the truth that errors are measured against\n";
}

std::string simd_target() { return hwy::TargetName(hwy::SupportedTargets() & -hwy::SupportedTargets()); }

}  // namespace beampipe
