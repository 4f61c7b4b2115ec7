// Runs a check once for each instruction set that the kernels were compiled for and that this machine has.
#pragma once

#include "simd/target.h"
#include "tests/test.h"

namespace beampipe {

// While `check` runs, all kernels use one target. Afterwards they use the machine's best one, even if it throws.
template <class Check>
void on_every_target(Check&& check) {
  struct Restore {
    ~Restore() { use_simd_target(simd_targets().front()); }
  } restore;
  for (const std::string& target : simd_targets()) {
    SCOPED_TRACE(target);
    use_simd_target(target);
    check();
  }
}

}  // namespace beampipe
