// Compares what a technique renders in a hard case with exact arithmetic.
#pragma once

#include <optional>
#include <string>

#include "pipeline/technique.h"
#include "tools/stress/exact.h"
#include "tools/stress/hard_cases.h"

namespace beampipe {

struct Verdict {
  double error = 0;                               // the largest over all pixels and R, G, B, A
  double limit = 0;                               // the largest error allowed
  std::string reason;                             // of the limit; empty if it is Technique::rounding_error
  bool passes() const { return error <= limit; }  // false for NaN
};

// Techniques that sample are compared with exact samples at the same places, all others with exact areas. Pictures of
// surfaces that vary are compared with what the case says about them, and their A with exact arithmetic.
class Judge {
 public:
  explicit Judge(const HardCase& hard_case) : case_(hard_case) {}

  Verdict judge(const Technique& technique, const FrameInput& options);

 private:
  const ExactPicture& areas();
  double largest_error(const Technique& technique, const FrameInput& options);

  const HardCase& case_;
  std::optional<ExactPicture> areas_;  // computed when it is first needed
};

}  // namespace beampipe
