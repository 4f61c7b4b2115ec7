// Compares what a technique renders in a hard case with exact arithmetic.
#pragma once

#include <optional>
#include <string>

#include "pipeline/technique.h"
#include "tools/stress/exact.h"
#include "tools/stress/hard_cases.h"

namespace beampipe {

// For colours up to 1 in fp16: two roundings of half a unit in the last place, which is 2^-12.
inline constexpr double kFormatError = 0x1p-11;
inline constexpr double kUnorm8Error = 0.5 / 255;  // of each sum that is rounded to 8 bits

// The error of the reference's samples against the exact area. In each row of samples, an edge can be off by at most
// one sample. Rows are shifted against each other, so that the errors of neighbouring rows cancel.
inline constexpr double kReferenceError = 0x1p-8;

struct Verdict {
  double error = 0;                               // the largest over all pixels and R, G, B, A
  double limit = 0;                               // the largest error allowed
  std::string reason;                             // of the limit; empty if it is that of the format
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
