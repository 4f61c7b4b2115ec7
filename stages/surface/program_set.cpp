#include "stages/surface/program_set.h"

#include <tbb/parallel_for.h>

#include <utility>

#include "stages/spirv/fragment_shader.h"

namespace beampipe {

ProgramSet::ProgramSet(const Trace& trace) : shaders_(trace.programs.size()), idle_(trace.programs.size()) {
  tbb::parallel_for(std::size_t{0}, shaders_.size(), [&](std::size_t i) {
    const ShaderProgram& program = trace.programs[i];
    Specialization constants;
    for (const SpecializationConstant& each : program.specialization) constants[each.id].push_back(each.bits);
    try {
      shaders_[i].code = std::make_unique<const LaneProgram>(load_fragment_shader(program.spirv, constants));
    } catch (const ShaderError& error) {
      shaders_[i].error = error.what();
    }
  });
}

std::unique_ptr<ShaderExecutor> ProgramSet::take(std::uint32_t program) const {
  {
    const std::lock_guard lock(mutex_);
    if (auto& idle = idle_[program]; !idle.empty()) {
      std::unique_ptr<ShaderExecutor> executor = std::move(idle.back());
      idle.pop_back();
      return executor;
    }
  }
  return std::make_unique<ShaderExecutor>(*shaders_[program].code);
}

void ProgramSet::give_back(std::uint32_t program, std::unique_ptr<ShaderExecutor> executor) const {
  const std::lock_guard lock(mutex_);
  idle_[program].push_back(std::move(executor));
}

}  // namespace beampipe
