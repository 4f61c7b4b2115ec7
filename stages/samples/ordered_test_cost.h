// What ordered_test is charged.
#pragma once

#include "stages/cost/plane_cost.h"
#include "stages/data/sample_tile.h"
#include "stages/rop/rop_cost.h"

namespace beampipe {

// What became of the samples of fragments with one rule and one side.
struct TestedSamples {
  std::uint64_t tested = 0, stencil_failed = 0, depth_failed = 0, passed = 0;
};

inline OperationCounts ordered_test_cost(const RopRule& rule, const Stencil& stencil, const TestedSamples& samples) {
  OperationCounts ops;
  if (rule.has_stencil) {
    ops += stencil_test_cost(stencil) * samples.tested;
    ops += stencil_operation_cost(stencil.fail, stencil) * samples.stencil_failed;
    ops += stencil_operation_cost(stencil.depth_fail, stencil) * samples.depth_failed;
    ops += stencil_operation_cost(stencil.pass, stencil) * samples.passed;
  }
  if (rule.depth != Compare::always || rule.writes_depth)
    ops += depth_test_cost() * (samples.tested - samples.stencil_failed);
  return ops;
}

}  // namespace beampipe
