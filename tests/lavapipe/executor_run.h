// The same cases with this project's executor, and how well the two agree.
#pragma once

#include <set>
#include <string>

#include "stages/spirv/lane_program.h"
#include "tests/lavapipe/driver.h"
#include "tests/lavapipe/shader_case.h"

namespace beampipe {

// Locations that the program writes, floats or integers.
std::set<std::uint32_t> written_locations(const LaneProgram& program, bool floats);

CaseOutputs run_executor(const ShaderCase& shader, const LaneProgram& program);

// Numbers are near if they differ by at most `tolerance`, and by as much of the driver's number where that is more than
// 1. Integers, infinities and what is not a number have to be the same. A pixel that only one of them discards has no
// output that is near.
struct Agreement {
  std::uint64_t outputs = 0, near = 0;
  std::uint64_t roughly = 0;  // within 100 times the tolerance
  double worst = 0;           // of those that are numbers in both, as `tolerance` is meant
  std::string example{};      // of one that is not near
  double share() const { return outputs == 0 ? 1 : static_cast<double>(near) / static_cast<double>(outputs); }
  void operator+=(const Agreement& more);
};
Agreement compare(const LaneProgram& program, const CaseOutputs& driver, const CaseOutputs& executor,
                  double tolerance = 1e-5);

// Both, and compares.
Agreement agreement_of(Driver& driver, const ShaderCase& shader, double tolerance = 1e-5);

}  // namespace beampipe
