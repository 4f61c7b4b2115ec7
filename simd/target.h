// The instruction sets that the kernels were compiled for and that this machine has. Results have the same bits on all
// of them.
#pragma once

#include <string>
#include <vector>

namespace beampipe {

// Highway's names in lower case, the best first: "avx3", "avx2", "sse4", "ssse3", "scalar". At least one.
std::vector<std::string> simd_targets();

// The active instruction set's name.
std::string simd_target();

// From now on every kernel of the process uses this one. Call it while no kernel runs. Throws std::invalid_argument
// unless simd_targets() contains the name.
void use_simd_target(const std::string& name);

}  // namespace beampipe
