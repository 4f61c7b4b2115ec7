// How wrong a picture is, and how much MSAA would be as wrong.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/technique.h"

namespace beampipe {

// Of the differences image - reference over R, G, B of all pixels, in linear light. A (coverage) does not count.
struct ErrorStats {
  double rmse = 0;  // root of the mean square
  double bias = 0;  // mean, signed
  double p99 = 0;   // of the n absolute values in rising order, the one at rank ceil(0.99 n), counted from 1
  double max = 0;   // largest absolute value
  bool operator==(const ErrorStats&) const = default;
};

// Pools the errors of several frames as if they were one picture. Sums are taken in double precision, row by row in
// order, so that the result is the same everywhere. Keeps about 1 % of the values: those that p99 can still depend on.
class ErrorAccumulator {
 public:
  // `pixels`: how many will be added in all frames together.
  explicit ErrorAccumulator(std::uint64_t pixels);

  // Throws std::invalid_argument when the sizes differ, and std::runtime_error naming the pixel when a value is not
  // finite.
  void add(const Image& image, const Image& reference);

  // Zero when no pixel was announced. Throws std::logic_error unless exactly the announced pixels were added.
  ErrorStats stats() const;

 private:
  std::uint64_t expected_ = 0, count_ = 0;  // values: three per pixel
  double sum_ = 0, sum_of_squares_ = 0;
  std::vector<double> largest_;  // the floor(expected / 100) + 1 largest absolute errors so far, in no order
};

// Of one picture; throws as ErrorAccumulator::add does.
ErrorStats measure_error(const Image& image, const Image& reference);

// Per pixel, the root of the mean square of the three channels' errors. Throws std::invalid_argument when sizes differ.
std::vector<float> pixel_errors(const Image& image, const Image& reference);

// image - reference of R, G, B, three values per pixel. Throws std::invalid_argument when sizes differ.
std::vector<float> signed_errors(const Image& image, const Image& reference);

// By how much the errors of two frames in a row differ, pixel by pixel: the root of the mean square. What changes in
// the reference too does not count. Throws std::invalid_argument when the numbers of values differ.
double flicker(const std::vector<float>& errors_before, const std::vector<float>& errors);

// A rung of the MSAA ladder: msaa:samples was measured to have this RMSE.
struct LadderRung {
  std::uint32_t samples = 0;
  double rmse = 0;
};

struct EquivalentMsaa {
  double samples = 0;
  bool is_lower_bound = false;  // better than the last rung: `samples` is the last rung's
  bool is_upper_bound = false;  // worse than the first rung: `samples` is the first rung's
  bool operator==(const EquivalentMsaa&) const = default;
};

// The smallest N at which MSAA has this RMSE. The curve of MSAA is the running minimum of the measured RMSE over N, so
// that it never rises, and is straight between rungs in log N and log RMSE. (Towards a rung with RMSE 0 such a line
// falls at once: any RMSE between is worth the rung before.) Throws std::invalid_argument when the ladder is empty or
// not rising.
EquivalentMsaa equivalent_msaa(double rmse, const std::vector<LadderRung>& ladder);

// The lowest RMSE on the ladder.
double best_rmse(const std::vector<LadderRung>& ladder);

}  // namespace beampipe
