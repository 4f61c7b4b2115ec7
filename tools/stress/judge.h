// How wrong a technique is in a hard case, against exact arithmetic.
#pragma once

#include <optional>
#include <string>

#include "pipeline/technique.h"
#include "tools/stress/exact.h"
#include "tools/stress/hard_cases.h"

namespace beampipe {

// Colours up to 1 in fp16: half a unit in the last place is 2^-12 for each of two roundings.
inline constexpr double kFormatError = 0x1p-11;
inline constexpr double kUnorm8Error = 0.5 / 255;  // of each sum in 8 bits

// The reference's samples against the exact area: an edge may pass all 16 samples of a row on the wrong side by one
// sample's distance, 1/16 of a row; rows are shifted against each other, so that errors of neighbours cancel.
inline constexpr double kReferenceError = 0x1p-8;

struct Verdict {
  double error = 0;                               // largest, over pixels and R, G, B, A
  double limit = 0;                               // that is stated for it
  std::string reason;                             // of a limit that is not the format's
  bool passes() const { return error <= limit; }  // false for NaN
};

// Techniques that sample are held to the exact value of their samples, all others to the exact area.
class Judge {
 public:
  explicit Judge(const HardCase& hard_case) : case_(hard_case) {}

  Verdict judge(const Technique& technique, const RunOptions& options);

 private:
  const ExactPicture& areas();

  const HardCase& case_;
  std::optional<ExactPicture> areas_;  // worked out when first asked for
};

}  // namespace beampipe
