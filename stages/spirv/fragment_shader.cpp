#include "stages/spirv/fragment_shader.h"

#include "stages/spirv/assign_rows.h"
#include "stages/spirv/decode.h"
#include "stages/spirv/module.h"

namespace beampipe {

LaneProgram load_fragment_shader(std::span<const std::uint32_t> words, const Specialization& specialization) {
  const ShaderModule module(simplify(words, specialization));
  return assign_rows(decode(module));
}

}  // namespace beampipe
