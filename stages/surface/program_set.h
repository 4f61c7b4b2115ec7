// The fragment shaders that the programs of a trace brought, ready to run.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "stages/spirv/shader_executor.h"
#include "traces/trace.h"

namespace beampipe {

class ProgramSet {
 public:
  explicit ProgramSet(const Trace& trace);

  // Of one of Trace::programs; null: it cannot run.
  const LaneProgram* find(std::uint32_t program) const { return shaders_[program].code.get(); }
  // Why it cannot run, in one line.
  const std::string& error(std::uint32_t program) const { return shaders_[program].error; }

  // Calls visit(executor) with an executor of the program that nobody else uses. From any thread.
  template <class Visit>
  void with_executor(std::uint32_t program, Visit&& visit) const {
    std::unique_ptr<ShaderExecutor> executor = take(program);
    visit(*executor);
    give_back(program, std::move(executor));
  }

 private:
  struct Shader {
    std::unique_ptr<const LaneProgram> code;
    std::string error;
  };
  std::unique_ptr<ShaderExecutor> take(std::uint32_t program) const;
  void give_back(std::uint32_t program, std::unique_ptr<ShaderExecutor> executor) const;

  std::vector<Shader> shaders_;
  mutable std::mutex mutex_;
  mutable std::vector<std::vector<std::unique_ptr<ShaderExecutor>>> idle_;  // by program
};

}  // namespace beampipe
