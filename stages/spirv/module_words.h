// The instructions of SPIR-V words that nobody has checked.
#pragma once

#include <cstdint>
#include <span>
#include <spirv/unified1/spirv.hpp>

#include "stages/spirv/shader_error.h"

namespace beampipe {

inline constexpr std::size_t kModuleHeaderWords = 5;

// Calls visit(opcode, operands), where results and their types are operands too. Throws ShaderError if an instruction
// does not end in the module.
template <class Visit>
void for_each_instruction(std::span<const std::uint32_t> words, Visit&& visit) {
  for (std::size_t at = kModuleHeaderWords; at < words.size();) {
    const std::size_t count = words[at] >> 16;
    if (count == 0 || count > words.size() - at) throw ShaderError("invalid SPIR-V: an instruction leaves the module");
    visit(static_cast<spv::Op>(words[at] & 0xffffu), words.subspan(at + 1, count - 1));
    at += count;
  }
}

}  // namespace beampipe
