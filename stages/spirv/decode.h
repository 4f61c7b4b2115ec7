// decode: a simplified module -> lane operations whose rows are not numbered yet (stages/spirv/assign_rows.h)
#pragma once

#include "stages/spirv/draft.h"
#include "stages/spirv/module.h"

namespace beampipe {

// Limits on what a program may have.
inline constexpr std::size_t kMostLaneOps = std::size_t{1} << 18;  // and copies that phis take
inline constexpr std::uint32_t kMostMemoryRows = 4096;             // of outputs and local variables, and of inputs
inline constexpr std::size_t kMostParts = std::size_t{1} << 22;    // of all values

// Throws ShaderError, which names an opcode that is not supported.
Draft decode(const ShaderModule& module);

}  // namespace beampipe
