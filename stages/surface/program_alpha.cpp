#include "stages/surface/program_alpha.h"

#include <spirv/unified1/spirv.hpp>

namespace beampipe {
namespace {

// Does the module have an instruction that discards an invocation?
bool may_discard(const std::vector<std::uint32_t>& spirv) {
  constexpr std::size_t kHeaderWords = 5;
  for (std::size_t at = kHeaderWords; at < spirv.size();) {
    const std::uint32_t words = spirv[at] >> 16, op = spirv[at] & 0xffffu;
    if (op == spv::OpKill || op == spv::OpTerminateInvocation || op == spv::OpDemoteToHelperInvocation) return true;
    if (words == 0) return false;
    at += words;
  }
  return false;
}

}  // namespace

AlphaMode program_alpha_mode(const Trace& trace, const Draw& draw) {
  constexpr Blend kReplaces{BlendFactor::one, BlendFactor::zero, BlendOperation::add};
  if (draw.state.blend && *draw.state.blend != kReplaces) return AlphaMode::blend;
  return may_discard(trace.programs[draw.program->program].spirv) ? AlphaMode::mask : AlphaMode::opaque;
}

}  // namespace beampipe
