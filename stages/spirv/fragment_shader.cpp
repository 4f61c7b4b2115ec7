#include "stages/spirv/fragment_shader.h"

#include "stages/spirv/assign_rows.h"
#include "stages/spirv/decode.h"
#include "stages/spirv/module.h"

namespace beampipe {

LaneProgram load_fragment_shader(std::span<const std::uint32_t> words, const Specialization& specialization) {
  const ShaderModule module(simplify(words, specialization));
  return assign_rows(decode(module));
}

bool may_discard(std::span<const std::uint32_t> words) {
  constexpr std::size_t kHeaderWords = 5;
  for (std::size_t at = kHeaderWords; at < words.size();) {
    const std::uint32_t count = words[at] >> 16, op = words[at] & 0xffffu;
    if (op == spv::OpKill || op == spv::OpTerminateInvocation || op == spv::OpDemoteToHelperInvocation) return true;
    if (count == 0) return false;
    at += count;
  }
  return false;
}

}  // namespace beampipe
