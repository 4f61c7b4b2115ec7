#include "pipeline/technique.h"

#include <algorithm>

#include "pipeline/stored_colors.h"
#include "pipeline/technique_table.h"
#include "traces/closest_name.h"

namespace beampipe {
namespace {

[[noreturn]] void fail_name(const Spec& spec) {
  std::vector<std::string> names;
  for (const TechniqueKind& kind : technique_kinds())
    if (names.empty() || names.back() != kind.name) names.push_back(kind.name);
  const bool is_list = spec.name().find(',') != spec.name().npos;
  spec.fail("the name must be " + list_of(names) +
            (is_list ? "; spaces separate techniques" : did_you_mean(spec.name(), names)));
}

// The techniques of the spec's name, the default first.
std::vector<const TechniqueKind*> kinds_of(const Spec& spec) {
  std::vector<const TechniqueKind*> kinds;
  for (const TechniqueKind& kind : technique_kinds())
    if (kind.name == spec.name()) kinds.push_back(&kind);
  if (kinds.empty()) fail_name(spec);
  return kinds;
}

const TechniqueKind& chosen_kind(const Spec& spec, const std::vector<const TechniqueKind*>& kinds) {
  const auto chosen = std::ranges::find_if(
      kinds, [&](const TechniqueKind* kind) { return spec.has(kind->variant.key, kind->variant.word); });
  return chosen == kinds.end() ? *kinds.front() : **chosen;
}

// The option that chooses between techniques of one name. The choice is made already: it takes that, and nothing else.
SpecOption variant_option(const Variant& chosen, const std::vector<const TechniqueKind*>& kinds) {
  std::vector<std::string> words;
  for (const TechniqueKind* const kind : kinds) words.push_back(kind->variant.word);
  SpecOption option = choice_of_words(chosen.key, words, words.front(), "", [](std::size_t) {});
  option.set = [word = chosen.word](std::string_view value) { return value == word; };
  return option;
}

}  // namespace

FrameResult Technique::render(const Trace& trace, std::size_t frame, const FrameInput& run,
                              const FrameSinks& sinks) const {
  FrameResult result = renderer(trace, frame, run, sinks);
  if (const ColorTarget target = trace.frames[frame].target; target == ColorTarget::unorm)
    for (std::size_t i = 0; i < result.image.rgba.size(); ++i)
      if (i % 4 != 3) result.image.rgba[i] = shown(target, result.image.rgba[i]);
  return result;
}

Technique parse_technique(std::string_view text) {
  const Spec spec(text);
  const std::vector<const TechniqueKind*> kinds = kinds_of(spec);
  const TechniqueKind& kind = chosen_kind(spec, kinds);
  int taps = kind.texture_taps;
  Technique technique = kind.make([&](SpecOptions options) {
    if (kinds.size() > 1) options.push_back(variant_option(kind.variant, kinds));
    options.push_back(filter_option(taps));
    set_options(spec, title_of(kind), options);
  });
  technique.spec = text;
  technique.renderer = [render = std::move(technique.renderer), taps](const Trace& trace, std::size_t frame,
                                                                      FrameInput run, const FrameSinks& sinks) {
    run.texture_taps = taps;
    return render(trace, frame, run, sinks);
  };
  return technique;
}

}  // namespace beampipe
