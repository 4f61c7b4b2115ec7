// Runs a check once per instruction set that kernels were compiled for and this machine has.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "hwy/targets.h"

namespace beampipe {

// While `check` runs, the kernels dispatch to one target; afterwards to the machine's best again, even if it throws.
template <class Check>
void on_every_target(Check&& check) {
  struct Restore {
    ~Restore() {
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().DeInit();
    }
  } restore;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    check();
  }
}

}  // namespace beampipe
