#include "stages/spirv/fragment_shader.h"

#include <utility>
#include <vector>

#include "stages/spirv/assign_rows.h"
#include "stages/spirv/decode.h"
#include "stages/spirv/module.h"

namespace beampipe {

LaneProgram load_fragment_shader(std::span<const std::uint32_t> words, const Specialization& specialization) {
  const ShaderModule module(simplify(words, specialization));
  return assign_rows(decode(module));
}

ShaderEffects effects_of(std::span<const std::uint32_t> words) {
  constexpr std::size_t kHeaderWords = 5;
  ShaderEffects found;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> built_ins;  // variable, or any other id; built-in
  for (std::size_t at = kHeaderWords; at < words.size();) {
    const std::uint32_t count = words[at] >> 16, op = words[at] & 0xffffu;
    found.discards |= op == spv::OpKill || op == spv::OpTerminateInvocation || op == spv::OpDemoteToHelperInvocation;
    if (count == 0 || count > words.size() - at) break;
    const auto operands = words.subspan(at + 1, count - 1);
    if (op == spv::OpExecutionMode && count >= 3)
      found.tests_early |= operands[1] == spv::ExecutionModeEarlyFragmentTests;
    if (op == spv::OpDecorate && count >= 4 && operands[1] == spv::DecorationBuiltIn)
      built_ins.emplace_back(operands[0], operands[2]);
    if (op == spv::OpGroupDecorate && count >= 2)
      for (const std::uint32_t target : operands.subspan(1))
        for (std::size_t i = built_ins.size(); i-- > 0;)
          if (built_ins[i].first == operands[0]) built_ins.emplace_back(target, built_ins[i].second);
    if (op == spv::OpVariable && count >= 4 && operands[2] == spv::StorageClassOutput) {
      for (const auto& [id, built_in] : built_ins) {
        found.writes_depth |= id == operands[1] && built_in == spv::BuiltInFragDepth;
        found.writes_samples |= id == operands[1] && built_in == spv::BuiltInSampleMask;
      }
    }
    at += count;
  }
  return found;
}

}  // namespace beampipe
