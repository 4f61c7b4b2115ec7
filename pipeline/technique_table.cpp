#include "pipeline/technique_table.h"

#include "stages/surface/surface_shader.h"

// The techniques of beampipe, in the order of --help and the docs. Each is NAME_kind() in a file of
// pipeline/techniques/.
#define BEAMPIPE_TECHNIQUES(X) \
  X(beam)                      \
  X(beam_sorted)               \
  X(beam_stream)               \
  X(casav)                     \
  X(alpha)                     \
  X(z3)                        \
  X(msaa)                      \
  X(acaa)                      \
  X(deferred)                  \
  X(visibility)                \
  X(taa)                       \
  X(dvm)                       \
  X(reference)

namespace beampipe {

#define BEAMPIPE_DECLARE(name) TechniqueKind name##_kind();
BEAMPIPE_TECHNIQUES(BEAMPIPE_DECLARE)
#undef BEAMPIPE_DECLARE

namespace {

std::vector<std::string> specs_of_all(std::vector<std::string> TechniqueKind::*specs) {
  std::vector<std::string> all;
  for (const TechniqueKind& kind : technique_kinds()) all.insert(all.end(), (kind.*specs).begin(), (kind.*specs).end());
  return all;
}

}  // namespace

const std::vector<TechniqueKind>& built_in_kinds() {
#define BEAMPIPE_CALL(name) name##_kind(),
  static const std::vector<TechniqueKind> kinds = {BEAMPIPE_TECHNIQUES(BEAMPIPE_CALL)};
#undef BEAMPIPE_CALL
  return kinds;
}

// Weak, so that the linker prefers a program's own.
[[gnu::weak]] const std::vector<TechniqueKind>& technique_kinds() { return built_in_kinds(); }

SpecOption filter_option(int& texture_taps) {
  return choice(
      "filter", texture_taps, {{"sampler", 0}, {"anisotropic", kAnisotropic}, {"1", 1}, {"4", 4}, {"16", 16}},
      "textures: filtered as their samplers ask for, or with an anisotropy of 16, or the mean over the footprint by up "
      "to so many taps; beam in all orders has 16");
}

std::vector<std::string> example_specs() { return specs_of_all(&TechniqueKind::examples); }

std::vector<std::string> stressed_specs() { return specs_of_all(&TechniqueKind::stressed); }

}  // namespace beampipe
