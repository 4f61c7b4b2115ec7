// The measures of a picture's error, one by one: their names, what they mean, and which of them equivalent rates
// compare.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/evaluate/flip.h"
#include "tools/evaluate/metrics.h"

namespace beampipe {

// How the errors of several frames become one.
enum class Pooling {
  none,    // not from the frames' numbers alone: an equivalent rate cannot use it
  mean,    // over all pixels
  squares  // root of the mean square over all pixels
};

struct Measure {
  const char *key, *title, *unit, *meaning;                 // `key`: in JSON and after --metric
  std::optional<double> (*value)(const ErrorStats& stats);  // none if it was not measured, or if it is infinite
  bool may_be_negative = false;
  Pooling pooling = Pooling::none;
  // What equivalent rates compare: 0 where pictures are equal, and larger the worse a picture is.
  double (*error)(const ErrorStats& stats) = nullptr;
  // Measures it on a picture, and where it is stored. Null for those that ErrorAccumulator finds.
  double (*measure)(const Image& image, const Image& reference, double pixels_per_degree) = nullptr;
  std::optional<double> ErrorStats::*stored = nullptr;
  // A value for each pixel; null if it has none.
  std::vector<float> (*map)(const Image& image, const Image& reference, double pixels_per_degree) = nullptr;
};

// All, in the order in which tables list them.
std::span<const Measure> measures();

// The keys of those by which equivalent rates can be found, and of those with a `map`.
std::vector<std::string> metric_names();
std::vector<std::string> map_names();

// The one with the `error` that equivalent rates compare. For PSNR this is the RMSE of the same values: the PSNR is its
// logarithm, and equivalent rates are interpolated in logarithms. Throws std::invalid_argument if there is none.
const Measure& find_metric(std::string_view key);

// What is averaged over pixels for an error of one frame, and the error that such an average means.
double pooled_part(const Measure& measure, double error);
double pooled(const Measure& measure, double average);

// Adds up what ErrorAccumulator does not measure, frame by frame.
class MeasurePool {
 public:
  // `frame`: of a frame with this many pixels, with the same measures as the others.
  void add(const ErrorStats& frame, std::uint64_t pixels);

  // Sets these measures as if all frames were one picture.
  void finish(ErrorStats& stats) const;

 private:
  ErrorStats sums_;
  double pixels_ = 0;
};

// All measures of one picture. Throws as measure_error does.
ErrorStats measure_all(const Image& image, const Image& reference, double pixels_per_degree = kPixelsPerDegree);

// Those of several frames, pooled as `compare` pools them. Of the measures that ErrorAccumulator does not find, only
// this one is measured; null: all. Throws as measure_error does.
ErrorStats measure_frames(std::span<const PicturePair> frames, double pixels_per_degree = kPixelsPerDegree,
                          const Measure* only = nullptr);

// Those of a picture that equals the reference.
ErrorStats no_error();

}  // namespace beampipe
