#include "simd/target.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "hwy/targets.h"

namespace beampipe {
namespace {

std::string name_of(std::int64_t target) {
  std::string name = hwy::TargetName(target);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return name;
}

// The list is made before one is chosen: afterwards the library names only the chosen one.
const std::vector<std::int64_t>& all_targets() {
  static const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  return targets;
}

void choose(std::int64_t targets) {  // 0 means all that the machine has
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const std::int64_t target : all_targets()) names.push_back(name_of(target));
  return names;
}

std::string simd_target() { return name_of(hwy::SupportedAndGeneratedTargets().front()); }

void use_simd_target(const std::string& name) {
  for (const std::int64_t target : all_targets())
    if (name_of(target) == name) return choose(target);
  throw std::invalid_argument("expected an instruction set that this machine has, found \"" + name + "\"");
}

}  // namespace beampipe
