// How large a picture's error is, and which MSAA rate has the same error.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/technique.h"

namespace beampipe {

// A picture and that of the reference.
struct PicturePair {
  const Image &image, &reference;
};

// Statistics of the differences image - reference, over R, G and B of all pixels, in linear light. Alpha is ignored.
// `measures()` (measures.h) describes them.
struct ErrorStats {
  double rmse = 0;     // root mean square
  double bias = 0;     // mean of the signed differences
  double p99 = 0;      // 99th percentile of the n absolute values: the one at rank ceil(0.99 n), counted from 1
  double max = 0;      // largest absolute value
  double p999 = 0;     // 99.9th percentile: at rank ceil(0.999 n)
  double mae = 0;      // mean of the absolute values
  double rel_mse = 0;  // mean of (image - reference)^2 / (reference^2 + kRelativeEpsilon)
  // What an eye may see, which ErrorAccumulator does not measure. The root mean square of differences of values that
  // are clamped to 0..1 and encoded in sRGB; means over pixels of SSIM (ssim.h), LDR-FLIP and HDR-FLIP (flip.h).
  std::optional<double> srgb_rmse = {}, ssim = {}, flip = {}, hdr_flip = {};
  bool operator==(const ErrorStats&) const = default;
};

// As in F. Rousselle, C. Knaus, M. Zwicker: Adaptive Sampling and Reconstruction using Greedy Error Minimization. ACM
// Transactions on Graphics 30 (6), 2011.
inline constexpr double kRelativeEpsilon = 0.01;

// Throws std::invalid_argument if the sizes differ.
void require_same_size(const Image& image, const Image& reference);

// Pools the errors of several frames as if they were one picture. It adds up doubles row by row, in a fixed order, so
// that the result is the same on every machine. It stores about 1 % of the values, which is what p99 needs.
class ErrorAccumulator {
 public:
  // `pixels` is the number of pixels in all frames that will be added.
  explicit ErrorAccumulator(std::uint64_t pixels);

  // Throws std::invalid_argument if the sizes differ, and std::runtime_error, which names the pixel, if a value is not
  // finite.
  void add(const Image& image, const Image& reference);

  // All zero if `pixels` was 0. Throws std::logic_error unless exactly that many pixels were added.
  ErrorStats stats() const;

 private:
  std::uint64_t expected_ = 0, count_ = 0;  // values, three per pixel
  double sum_ = 0, sum_of_squares_ = 0, sum_of_absolutes_ = 0, sum_of_relatives_ = 0;
  std::vector<double> largest_;  // the floor(expected / 100) + 1 largest absolute errors so far, unordered
};

// The errors of one picture, as ErrorAccumulator finds them. Throws as its add() does.
ErrorStats measure_error(const Image& image, const Image& reference);

// srgb_rmse. Throws std::invalid_argument if the sizes differ.
double encoded_rmse(const Image& image, const Image& reference);

// For each pixel, the root mean square of the errors in its three channels. Throws std::invalid_argument if the sizes
// differ.
std::vector<float> pixel_errors(const Image& image, const Image& reference);

// image - reference, three values per pixel: R, G and B. Throws std::invalid_argument if the sizes differ.
std::vector<float> signed_errors(const Image& image, const Image& reference);

// The root mean square of the change of the error from one frame to the next, over all values of signed_errors. A
// change that the reference shows too is no flicker. Throws std::invalid_argument if the numbers of values differ.
double flicker(const std::vector<float>& previous_errors, const std::vector<float>& errors);

// A rung of the MSAA ladder: the measured error of msaa:samples, such as its RMSE. `measures.h` has others.
struct LadderRung {
  std::uint32_t samples = 0;
  double error = 0;
};

// An equivalent MSAA rate (EMR).
struct EquivalentMsaa {
  double samples = 0;
  bool is_lower_bound = false;  // the error is below that of the last rung, whose samples these are
  bool is_upper_bound = false;  // the error is above that of the first rung, whose samples these are
  // What limited_equivalent_msaa() adds. No rate: the error is below that of the last rung, which falls no more.
  bool does_not_converge = false;
  std::optional<double> low = {}, high = {};  // about a standard deviation away; none if unknown or off the ladder
  bool operator==(const EquivalentMsaa&) const = default;
};

// The smallest N at which MSAA has this error. The error of MSAA as a function of N is the running minimum over the
// rungs, so that it never rises, with straight lines between the rungs in log N and log error. (A line to a rung with
// error 0 falls at once, so any error in between has the N of the rung before it.) Throws std::invalid_argument if the
// ladder is empty or its sample counts do not rise.
EquivalentMsaa equivalent_msaa(double error, const std::vector<LadderRung>& ladder);

// How far the errors of the rungs lie off a smooth curve: the standard deviation of their logarithms. Each rung lies
// off the line between its neighbours by independent deviations of all three. None if there are fewer than five rungs
// or if an error is 0.
std::optional<double> unevenness(const std::vector<LadderRung>& ladder);

// Whether the error still falls at the end of the ladder: over its last three rungs by more than two standard
// deviations of the difference between two rungs. A ladder without an unevenness is taken to converge.
bool converges(const std::vector<LadderRung>& ladder);

// Rates about a standard deviation away. None: off the ladder.
struct EmrRange {
  std::optional<double> low, high;
};
EmrRange range_of(const EquivalentMsaa& low, const EquivalentMsaa& high);

// What the reference's own error leaves open. Its variance is a part of the mean square of every error by RMSE: the
// range reaches as far, in both directions, as the rate moves without that part.
EmrRange range_by_reference(double error, const std::vector<LadderRung>& ladder, double reference_error);

// The equivalent rate, and how far the ladder's unevenness and other `ranges` leave it open. What they say is
// independent of each other: the logarithms of their ranges add up as squares.
EquivalentMsaa limited_equivalent_msaa(double error, const std::vector<LadderRung>& ladder,
                                       std::vector<EmrRange> ranges = {});

// The lowest error on the ladder.
double best_error(const std::vector<LadderRung>& ladder);

}  // namespace beampipe
