#include "stages/surface/program_alpha.h"

#include "stages/spirv/fragment_shader.h"

namespace beampipe {

AlphaMode program_alpha_mode(const Trace& trace, const Draw& draw, DrawOrder order) {
  constexpr Blend kReplaces{BlendFactor::one, BlendFactor::zero, BlendOperation::add};
  if (order == DrawOrder::by_depth && draw.state.blend && *draw.state.blend != kReplaces) return AlphaMode::blend;
  return may_discard(trace.programs[draw.program->program].spirv) ? AlphaMode::mask : AlphaMode::opaque;
}

}  // namespace beampipe
