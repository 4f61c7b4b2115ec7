#include "stages/surface/program_alpha.h"

#include "stages/spirv/fragment_shader.h"

namespace beampipe {

AlphaMode program_alpha_mode(const Trace& trace, const Draw& draw, DrawOrder order) {
  constexpr Blend kReplaces{BlendFactor::one, BlendFactor::zero, BlendOperation::add};
  if (order == DrawOrder::by_depth && draw.state.blend && *draw.state.blend != kReplaces) return AlphaMode::blend;
  const ShaderEffects effects = effects_of(trace.programs[draw.program->program].spirv);
  if (effects.discards) return AlphaMode::mask;
  const bool decides =
      order == DrawOrder::of_api && (effects.writes_depth || effects.writes_samples || draw.state.alpha_to_coverage);
  return decides ? AlphaMode::mask : AlphaMode::opaque;
}

std::vector<std::string> fragment_requests(const Trace& trace, const Draw& draw) {
  std::vector<std::string> requests;
  if (draw.state.alpha_to_coverage) requests.emplace_back("alpha to coverage");
  if (!draw.program) return requests;
  const ShaderEffects effects = effects_of(trace.programs[draw.program->program].spirv);
  if (effects.discards && effects.tests_early) requests.emplace_back("early tests of fragments that are discarded");
  if (effects.writes_depth && !effects.tests_early) requests.emplace_back("depth that shaders write");
  if (effects.writes_samples) requests.emplace_back("sample masks that shaders write");
  return requests;
}

}  // namespace beampipe
