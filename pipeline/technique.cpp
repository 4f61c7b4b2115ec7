#include "pipeline/technique.h"

#include <map>

#include "pipeline/technique_table.h"
#include "traces/closest_name.h"

namespace beampipe {
namespace {

bool is_variant(const TechniqueKind& kind) { return !kind.variant.key.empty(); }

std::vector<const TechniqueKind*> kinds_named(std::string_view name) {
  std::vector<const TechniqueKind*> kinds;
  for (const TechniqueKind& kind : technique_kinds())
    if (kind.name == name) kinds.push_back(&kind);
  return kinds;
}

[[noreturn]] void fail_name(const Spec& spec) {
  std::vector<std::string> names;
  for (const TechniqueKind& kind : technique_kinds())
    if (!is_variant(kind)) names.push_back(kind.name);
  spec.fail("the name must be " + list_of(names) + did_you_mean(spec.name(), names));
}

// The variant that the spec chooses, or else the technique of this name that is not a variant.
const TechniqueKind& chosen_kind(const Spec& spec, const std::vector<const TechniqueKind*>& kinds) {
  const TechniqueKind *plain = nullptr, *chosen = nullptr;
  for (const TechniqueKind* const kind : kinds) {
    const auto& [key, word, otherwise, owns] = kind->variant;
    if (!is_variant(*kind)) plain = kind;
    if (!is_variant(*kind) || !spec.has(key, word)) continue;
    if (chosen && owns == chosen->variant.key) chosen = nullptr;
    if (chosen) spec.fail(title_of(*chosen) + " must be without " + key + '=' + word);
    chosen = kind;
  }
  if (!chosen && !plain) fail_name(spec);
  return chosen ? *chosen : *plain;
}

// The options that choose between the variants of a name. The choice is made already: they accept it, and nothing else.
SpecOptions variant_options(const TechniqueKind& chosen, const std::vector<const TechniqueKind*>& kinds) {
  std::map<std::string, std::vector<std::string>> words;  // by key; the default comes first
  for (const TechniqueKind* const kind : kinds) {
    if (!is_variant(*kind)) continue;
    const auto& [key, word, otherwise, owns] = kind->variant;
    if (words[key].empty()) words[key].push_back(otherwise);
    words[key].push_back(word);
  }
  SpecOptions options;
  for (const auto& [key, of_key] : words) {
    if (key == chosen.variant.owns) continue;
    const std::string valid = chosen.variant.key == key ? chosen.variant.word : of_key.front();
    std::string usage = key + '=' + of_key.front();
    for (std::size_t i = 1; i < of_key.size(); ++i) usage += '|' + of_key[i];
    options.push_back({.form = SpecOption::Form::value,
                       .key = key,
                       .usage = usage,
                       .words = of_key,
                       .expected = list_of(of_key),
                       .fallback = of_key.front(),
                       .help = "",
                       .set = [valid](std::string_view value) { return value == valid; }});
  }
  return options;
}

}  // namespace

Technique parse_technique(std::string_view text) {
  const Spec spec(text);
  const std::vector<const TechniqueKind*> kinds = kinds_named(spec.name());
  const TechniqueKind& kind = chosen_kind(spec, kinds);
  Technique technique = kind.make([&](SpecOptions options) {
    for (SpecOption& option : variant_options(kind, kinds)) options.push_back(std::move(option));
    set_options(spec, title_of(kind), options);
  });
  technique.spec = text;
  return technique;
}

}  // namespace beampipe
