// Runs a check once per instruction set that kernels were compiled for and this machine has.
#pragma once

#include <gtest/gtest.h>

#include "simd/target.h"

namespace beampipe {

// While `check` runs, the kernels dispatch to one target; afterwards to the machine's best again, even if it throws.
template <class Check>
void on_every_target(Check&& check) {
  struct Restore {
    ~Restore() { use_best_simd_target(); }
  } restore;
  for (const std::string& target : simd_targets()) {
    SCOPED_TRACE(target);
    use_simd_target(target);
    check();
  }
}

}  // namespace beampipe
