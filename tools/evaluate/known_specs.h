// Specs that have a meaning of their own here: the reference, which errors are measured against, and MSAA, whose rates
// stand for accuracy.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace beampipe {

inline constexpr const char* kReferenceSpec = "reference";
// The same number of samples at other places, which are independent of those.
inline constexpr const char* kSecondReferenceSpec = "reference:set=2";
inline constexpr const char* kMsaaName = "msaa";

// "msaa:8".
inline std::string msaa_spec(std::uint32_t samples) {
  return std::string(kMsaaName).append(":").append(std::to_string(samples));
}

// The technique's name: "beam" of "beam:bits=64".
inline std::string_view name_in_spec(std::string_view spec) { return spec.substr(0, spec.find(':')); }

// A reference with any samples.
inline bool is_reference(std::string_view spec) { return name_in_spec(spec) == kReferenceSpec; }

// Any MSAA, whatever its options.
inline bool is_msaa(std::string_view spec) { return name_in_spec(spec) == kMsaaName; }

}  // namespace beampipe
