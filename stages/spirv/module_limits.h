// module_limits: SPIR-V -> an error if SPIRV-Tools would take long to validate or to simplify it
//
// The time of SPIRV-Tools grows with the square of some numbers and with products of others, which a short module can
// make large: a structure of two structures of two structures. Modules that were made to reach one of these limits take
// up to two seconds. Shaders of captured programs stay far below all of them, with up to 2,000 instructions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace beampipe {

struct ModuleLimits {
  static constexpr std::size_t kWords = std::size_t{1} << 18;
  static constexpr std::uint32_t kIds = 1u << 20;
  static constexpr std::uint32_t kNesting = 64;  // of selections and loops
  static constexpr std::uint64_t kBlocks = 4096;
  // Parts of types and of values, each with the parts of its parts.
  static constexpr std::uint64_t kParts = 1u << 20;
  static constexpr std::uint64_t kBuiltIns = 256;               // decorations
  static constexpr std::uint64_t kGroupDecorations = 1u << 16;  // decorations of groups, for each member
  // After all functions are inlined.
  static constexpr std::uint64_t kInlinedWords = 1u << 17;
  static constexpr std::uint64_t kSteps = 1u << 23;  // from values back to what they are copies or changes of
  static constexpr std::uint64_t kPhiOperands = 1u << 19;
  static constexpr std::uint64_t kBlockValues = 1u << 25;  // values that may be known in each block
};

// All throw ShaderError.

// Before validation: of any words. Blocks, parts of types and values where arrays count as one element, decorations.
void check_module(std::span<const std::uint32_t> words);

// Before inlining: of a valid module without specialization constants. Functions must not call themselves; words,
// blocks, and parts of values, where the elements of short arrays count.
void check_calls(std::span<const std::uint32_t> words);

// Before the rest: of one function, which calls none. Steps from values to others; values that may depend on the way;
// values that may be known in a block.
void check_values(std::span<const std::uint32_t> words);

}  // namespace beampipe
