#include "tools/evaluate/measures.h"

#include <cmath>
#include <stdexcept>

#include "tools/evaluate/powers.h"
#include "tools/evaluate/ssim.h"

namespace beampipe {
namespace {

using Stats = ErrorStats;

template <double Stats::*member>
std::optional<double> value_of(const Stats& stats) {
  return stats.*member;
}
template <double Stats::*member>
double error_of(const Stats& stats) {
  return stats.*member;
}
template <std::optional<double> Stats::*member>
std::optional<double> measured(const Stats& stats) {
  return stats.*member;
}
template <std::optional<double> Stats::*member>
double measured_error(const Stats& stats) {
  return (stats.*member).value();
}

std::optional<double> psnr_of(const Stats& stats) {
  constexpr double kLog10Of2 = 0.30102999566398120;
  return stats.srgb_rmse.value_or(0) > 0 ? std::optional(-20 * kLog10Of2 * log2_of(*stats.srgb_rmse)) : std::nullopt;
}

constexpr const char* kLinear = "linear light, 0..1";

constexpr std::string_view kPsnr = "psnr";

constexpr Measure kMeasures[] = {
    {.key = "rmse",
     .title = "RMSE",
     .unit = kLinear,
     .meaning = "Root mean square error against the reference, over R, G and B of all pixels.",
     .value = value_of<&Stats::rmse>,
     .pooling = Pooling::squares,
     .error = error_of<&Stats::rmse>,
     .map = [](const Image& image, const Image& reference, double) { return pixel_errors(image, reference); }},
    {.key = "bias",
     .title = "bias",
     .unit = kLinear,
     .meaning = "Mean signed error over R, G and B of all pixels.",
     .value = value_of<&Stats::bias>,
     .may_be_negative = true},
    {.key = "p99",
     .title = "p99",
     .unit = kLinear,
     .meaning = "The absolute error that 99 % of all values do not exceed.",
     .value = value_of<&Stats::p99>},
    {.key = "max",
     .title = "max",
     .unit = kLinear,
     .meaning = "The largest absolute error.",
     .value = value_of<&Stats::max>},
    {.key = "p999",
     .title = "p99.9",
     .unit = kLinear,
     .meaning = "The absolute error that 99.9 % of all values do not exceed.",
     .value = value_of<&Stats::p999>},
    {.key = "mae",
     .title = "MAE",
     .unit = kLinear,
     .meaning = "Mean absolute error.",
     .value = value_of<&Stats::mae>,
     .pooling = Pooling::mean,
     .error = error_of<&Stats::mae>},
    {.key = "rel_mse",
     .title = "relMSE",
     .unit = "",
     .meaning = "Mean of the squared error, divided by the reference's square plus 0.01.",
     .value = value_of<&Stats::rel_mse>,
     .pooling = Pooling::mean,
     .error = error_of<&Stats::rel_mse>},
    {.key = "srgb_rmse",
     .title = "sRGB RMSE",
     .unit = "sRGB, 0..1",
     .meaning = "Root mean square error of values that are clamped to 0..1 and encoded in sRGB.",
     .value = measured<&Stats::srgb_rmse>,
     .pooling = Pooling::squares,
     .error = measured_error<&Stats::srgb_rmse>,
     .measure = [](const Image& image, const Image& reference, double) { return encoded_rmse(image, reference); },
     .stored = &Stats::srgb_rmse},
    {.key = "psnr",
     .title = "PSNR",
     .unit = "dB",
     .meaning = "Peak signal-to-noise ratio of these sRGB values, whose peak is 1. Equal pictures have none.",
     .value = psnr_of,
     .may_be_negative = true},
    {.key = "ssim",
     .title = "SSIM",
     .unit = "1 is best",
     .meaning = "Structural similarity of these sRGB values: the mean over pixels and channels.",
     .value = measured<&Stats::ssim>,
     .may_be_negative = true,
     .pooling = Pooling::mean,
     .error = [](const Stats& stats) { return 1 - stats.ssim.value(); },
     .measure = [](const Image& image, const Image& reference,
                   double) { return mean_ssim(ssim_map(image, reference), image.width); },
     .stored = &Stats::ssim,
     .map =
         [](const Image& image, const Image& reference, double) {
           const std::vector<double> map = ssim_map(image, reference);
           return std::vector<float>(map.begin(), map.end());
         }},
    {.key = "flip",
     .title = "FLIP",
     .unit = "0..1",
     .meaning = "LDR-FLIP, the visible difference when flipping between the pictures: the mean over pixels.",
     .value = measured<&Stats::flip>,
     .pooling = Pooling::mean,
     .error = measured_error<&Stats::flip>,
     .measure =
         [](const Image& image, const Image& reference, double pixels_per_degree) {
           return mean_of(flip_map(image, reference, pixels_per_degree), image.width);
         },
     .stored = &Stats::flip,
     .map = flip_map},
    {.key = "hdr_flip",
     .title = "HDR-FLIP",
     .unit = "0..1",
     .meaning = "HDR-FLIP: the largest LDR-FLIP over a range of exposures; the mean over pixels.",
     .value = measured<&Stats::hdr_flip>,
     .pooling = Pooling::mean,
     .error = measured_error<&Stats::hdr_flip>,
     .measure =
         [](const Image& image, const Image& reference, double pixels_per_degree) {
           return mean_of(hdr_flip_map(image, reference, pixels_per_degree), image.width);
         },
     .stored = &Stats::hdr_flip,
     .map = hdr_flip_map},
};

}  // namespace

std::span<const Measure> measures() { return kMeasures; }

std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  for (const Measure& measure : kMeasures)
    if (measure.error || measure.key == kPsnr) names.push_back(measure.key);
  return names;
}

std::vector<std::string> map_names() {
  std::vector<std::string> names;
  for (const Measure& measure : kMeasures)
    if (measure.map) names.push_back(measure.key);
  return names;
}

const Measure& find_metric(std::string_view key) {
  if (key == kPsnr) return find_metric("srgb_rmse");
  for (const Measure& measure : kMeasures)
    if (measure.error && measure.key == key) return measure;
  throw std::invalid_argument("no metric is called " + std::string(key));
}

double pooled_part(const Measure& measure, double error) {
  return measure.pooling == Pooling::squares ? error * error : error;
}

double pooled(const Measure& measure, double average) {
  return measure.pooling == Pooling::squares ? std::sqrt(average) : average;
}

void MeasurePool::add(const ErrorStats& frame, std::uint64_t pixels) {
  const auto frame_pixels = static_cast<double>(pixels);
  pixels_ += frame_pixels;
  for (const Measure& measure : measures())
    if (measure.stored && frame.*measure.stored)
      sums_.*measure.stored =
          (sums_.*measure.stored).value_or(0) + pooled_part(measure, *(frame.*measure.stored)) * frame_pixels;
}

void MeasurePool::finish(ErrorStats& stats) const {
  for (const Measure& measure : measures())
    if (measure.stored && sums_.*measure.stored)
      stats.*measure.stored = pooled(measure, *(sums_.*measure.stored) / pixels_);
}

ErrorStats measure_all(const Image& image, const Image& reference, double pixels_per_degree) {
  ErrorStats stats = measure_error(image, reference);
  for (const Measure& measure : kMeasures)
    if (measure.measure) stats.*measure.stored = measure.measure(image, reference, pixels_per_degree);
  return stats;
}

ErrorStats measure_frames(std::span<const PicturePair> frames, double pixels_per_degree, const Measure* only) {
  const auto pixels_of = [](const PicturePair& frame) {
    return std::uint64_t{frame.reference.width} * frame.reference.height;
  };
  std::uint64_t pixels = 0;
  for (const PicturePair& frame : frames) pixels += pixels_of(frame);
  ErrorAccumulator errors(pixels);
  MeasurePool pool;
  for (const PicturePair& frame : frames) {
    errors.add(frame.image, frame.reference);
    ErrorStats of_frame;
    for (const Measure& measure : kMeasures)
      if (measure.measure && (!only || only == &measure))
        of_frame.*measure.stored = measure.measure(frame.image, frame.reference, pixels_per_degree);
    pool.add(of_frame, pixels_of(frame));
  }
  ErrorStats stats = errors.stats();
  pool.finish(stats);
  return stats;
}

ErrorStats no_error() {
  ErrorStats stats;
  stats.ssim = 1;
  stats.srgb_rmse = stats.flip = stats.hdr_flip = 0;
  return stats;
}

}  // namespace beampipe
