// What is wrong with a shader, in one line.
#pragma once

#include <stdexcept>

namespace beampipe {

struct ShaderError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace beampipe
