// simplify: SPIR-V of any fragment shader -> valid SPIR-V of one function without variables that values can replace
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace beampipe {

// Bits of specialization constants, by their SpecId.
using Specialization = std::unordered_map<std::uint32_t, std::vector<std::uint32_t>>;

// Validates the module with SPIRV-Tools by the rules that all versions of SPIR-V share, and simplifies it with its
// optimizer: functions are inlined, variables become values, constants are folded, and what has no effect goes. Loops
// stay loops, and a function that only ends the invocation may stay a function. Throws ShaderError, also for modules
// beyond ModuleLimits.
std::vector<std::uint32_t> simplify(std::span<const std::uint32_t> words, const Specialization& specialization);

}  // namespace beampipe
