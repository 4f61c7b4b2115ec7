// Runs fragment shaders with Mesa's software driver for Vulkan, lavapipe.
#pragma once

#include <memory>
#include <set>
#include <string>

#include "tests/lavapipe/shader_case.h"

namespace beampipe {

class Driver {
 public:
  // Null if there is no Vulkan device that is llvmpipe; `problem` then says why.
  static std::unique_ptr<Driver> find(std::string& problem);
  virtual ~Driver() = default;

  // `integers`, `floats`: locations that the shader writes. Throws std::runtime_error.
  virtual CaseOutputs run(const ShaderCase& shader, const std::set<std::uint32_t>& floats,
                          const std::set<std::uint32_t>& integers) = 0;
};

}  // namespace beampipe
