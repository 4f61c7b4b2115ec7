#include "tools/evaluate/metrics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include "tools/evaluate/powers.h"
#include "traces/size_text.h"

namespace beampipe {

void require_same_size(const Image& image, const Image& reference) {
  const std::size_t values = std::size_t{4} * image.width * image.height;
  if (image.width != reference.width || image.height != reference.height || image.rgba.size() != values ||
      reference.rgba.size() != values) {
    throw std::invalid_argument("the pictures have different sizes: " + size_text(image.width, image.height) + " and " +
                                size_text(reference.width, reference.height));
  }
}

namespace {

double difference(const Image& image, const Image& reference, std::size_t value) {
  return static_cast<double>(image.rgba[value]) - static_cast<double>(reference.rgba[value]);
}

// The number of values, out of n, from the rank of p99 to the last: that rank is ceil(0.99 n) = n - floor(n / 100). For
// p99.9, it is ceil(0.999 n) = n - floor(n / 1000).
std::uint64_t values_from_p99_up(std::uint64_t n) { return n / 100 + 1; }
std::uint64_t values_from_p999_up(std::uint64_t n) { return n / 1000 + 1; }

// Of a row, R, G, B and A of each pixel.
std::vector<double> encoded_row(const Image& image, std::uint32_t y) {
  std::vector<double> row(std::size_t{4} * image.width);
  const float* const linear = image.rgba.data() + row.size() * y;
  for (std::size_t i = 0; i < row.size(); ++i) row[i] = srgb_of_linear(linear[i]);
  return row;
}

}  // namespace

ErrorAccumulator::ErrorAccumulator(std::uint64_t pixels) : expected_(3 * pixels) {}

void ErrorAccumulator::add(const Image& image, const Image& reference) {
  require_same_size(image, reference);
  largest_.reserve(largest_.size() + 3 * std::size_t{image.width} * image.height);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    double row_sum = 0, row_squares = 0, row_absolutes = 0, row_relatives = 0;
    for (std::uint32_t x = 0; x < image.width; ++x) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const std::size_t value = 4 * (std::size_t{y} * image.width + x) + channel;
        const double error = difference(image, reference, value), truth = reference.rgba[value];
        if (!std::isfinite(error)) {
          throw std::runtime_error("the value at pixel (" + std::to_string(x) + ", " + std::to_string(y) +
                                   ") is not finite");
        }
        row_sum += error;
        row_squares += error * error;
        row_absolutes += std::abs(error);
        row_relatives += error * error / (truth * truth + kRelativeEpsilon);
        largest_.push_back(std::abs(error));
      }
    }
    sum_ += row_sum;
    sum_of_squares_ += row_squares;
    sum_of_absolutes_ += row_absolutes;
    sum_of_relatives_ += row_relatives;
  }
  count_ += std::uint64_t{3} * image.width * image.height;
  const std::uint64_t keep = values_from_p99_up(expected_);
  if (largest_.size() > keep) {
    std::nth_element(largest_.begin(), largest_.begin() + static_cast<std::ptrdiff_t>(keep - 1), largest_.end(),
                     std::greater<>());
    largest_.resize(keep);
    largest_.shrink_to_fit();
  }
}

ErrorStats ErrorAccumulator::stats() const {
  if (count_ != expected_)
    throw std::logic_error("error statistics: the number of pixels added is not the number announced");
  if (count_ == 0) return {};
  // The stored values are exactly those from the rank of p99 to the last.
  std::vector<double> largest = largest_;
  const auto p999 = largest.end() - static_cast<std::ptrdiff_t>(values_from_p999_up(count_));
  std::nth_element(largest.begin(), p999, largest.end());
  const auto [p99, max] = std::minmax_element(largest.begin(), largest.end());
  const double n = static_cast<double>(count_);
  return {.rmse = std::sqrt(sum_of_squares_ / n),
          .bias = sum_ / n,
          .p99 = *p99,
          .max = *max,
          .p999 = *p999,
          .mae = sum_of_absolutes_ / n,
          .rel_mse = sum_of_relatives_ / n};
}

ErrorStats measure_error(const Image& image, const Image& reference) {
  ErrorAccumulator accumulator(std::uint64_t{image.width} * image.height);
  accumulator.add(image, reference);
  return accumulator.stats();
}

double encoded_rmse(const Image& image, const Image& reference) {
  require_same_size(image, reference);
  double squares = 0;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const std::vector<double> row = encoded_row(image, y), reference_row = encoded_row(reference, y);
    double row_squares = 0;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double error = i % 4 == 3 ? 0.0 : row[i] - reference_row[i];
      row_squares += error * error;
    }
    squares += row_squares;
  }
  return std::sqrt(squares / (3.0 * image.width * image.height));
}

std::vector<float> pixel_errors(const Image& image, const Image& reference) {
  require_same_size(image, reference);
  std::vector<float> errors(std::size_t{image.width} * image.height);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    double squares = 0;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const double error = difference(image, reference, 4 * i + channel);
      squares += error * error;
    }
    errors[i] = static_cast<float>(std::sqrt(squares / 3.0));
  }
  return errors;
}

std::vector<float> signed_errors(const Image& image, const Image& reference) {
  require_same_size(image, reference);
  std::vector<float> errors;
  errors.reserve(image.rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (i % 4 != 3) errors.push_back(static_cast<float>(difference(image, reference, i)));
  return errors;
}

double flicker(const std::vector<float>& previous_errors, const std::vector<float>& errors) {
  if (previous_errors.size() != errors.size())
    throw std::invalid_argument("two frames of different sizes do not flicker");
  double squares = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double change = double{errors[i]} - previous_errors[i];
    squares += change * change;
  }
  return errors.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(errors.size()));
}

EquivalentMsaa equivalent_msaa(double error, const std::vector<LadderRung>& ladder) {
  const auto not_rising = [](const LadderRung& a, const LadderRung& b) { return a.samples >= b.samples; };
  if (ladder.empty() || ladder.front().samples == 0 ||
      std::adjacent_find(ladder.begin(), ladder.end(), not_rising) != ladder.end()) {
    throw std::invalid_argument("an MSAA ladder needs rungs of rising sample counts");
  }
  LadderRung before = ladder.front();
  if (error > before.error) return {static_cast<double>(before.samples), false, true};
  if (error == before.error) return {static_cast<double>(before.samples), false, false};
  for (const LadderRung& rung : ladder) {
    if (rung.error >= before.error) {
      if (rung.samples > before.samples) before.samples = rung.samples;  // the curve is flat up to this rung
      continue;
    }
    if (rung.error == error) return {static_cast<double>(rung.samples), false, false};
    if (rung.error < error) {
      const double part = std::log(before.error / error) / std::log(before.error / rung.error);  // 0 if rung.error is 0
      const double n0 = before.samples, n1 = rung.samples;
      return {n0 * std::pow(n1 / n0, part), false, false};
    }
    before = rung;
  }
  return {static_cast<double>(ladder.back().samples), true, false};
}

std::optional<double> unevenness(const std::vector<LadderRung>& ladder) {
  const auto is_exact = [](const LadderRung& rung) { return rung.error <= 0; };
  if (ladder.size() < 5 || std::any_of(ladder.begin(), ladder.end(), is_exact)) return std::nullopt;
  double variance = 0;
  for (std::size_t i = 1; i + 1 < ladder.size(); ++i) {
    const LadderRung &before = ladder[i - 1], &rung = ladder[i], &after = ladder[i + 1];
    const double part = std::log(static_cast<double>(rung.samples) / before.samples) /
                        std::log(static_cast<double>(after.samples) / before.samples);
    const double off = std::log(rung.error / before.error) - part * std::log(after.error / before.error);
    variance += off * off / (1 + part * part + (1 - part) * (1 - part));
  }
  return std::sqrt(variance / static_cast<double>(ladder.size() - 2));
}

bool converges(const std::vector<LadderRung>& ladder) {
  const std::optional<double> deviation = unevenness(ladder);
  if (!deviation) return true;
  const double fall = std::log(ladder[ladder.size() - 3].error / ladder.back().error);
  return fall > 2 * std::sqrt(2.0) * *deviation;
}

EmrRange range_of(const EquivalentMsaa& low, const EquivalentMsaa& high) {
  return {low.is_upper_bound ? std::nullopt : std::optional(low.samples),
          high.is_lower_bound ? std::nullopt : std::optional(high.samples)};
}

namespace {

// The end of the ranges on one side of a rate; none if one of them is open.
std::optional<double> common_end(double rate, const std::vector<EmrRange>& ranges,
                                 std::optional<double> EmrRange::*end) {
  double squares = 0;
  for (const EmrRange& range : ranges) {
    if (!(range.*end)) return std::nullopt;
    const double away = std::log(*(range.*end) / rate);
    if ((end == &EmrRange::high) == (away > 0)) squares += away * away;
  }
  return rate * std::exp((end == &EmrRange::high ? 1 : -1) * std::sqrt(squares));
}

}  // namespace

EmrRange range_by_reference(double error, const std::vector<LadderRung>& ladder, double reference_error) {
  const auto without = [&](double measured) {
    return std::sqrt(std::max(measured * measured - reference_error * reference_error, 0.0));
  };
  const EquivalentMsaa found = equivalent_msaa(error, ladder);
  std::vector<LadderRung> rungs;
  for (const LadderRung& rung : ladder)
    if (const double rest = without(rung.error); rest > 0 || rung.error == 0) rungs.push_back({rung.samples, rest});
  if (rungs.empty()) return {};
  const EquivalentMsaa moved = equivalent_msaa(without(error), rungs);
  const double ratio = std::max(moved.samples, found.samples) / std::min(moved.samples, found.samples);
  EmrRange range{found.samples / ratio, found.samples * ratio};
  if (found.is_upper_bound) range.low.reset();
  if (found.is_lower_bound || moved.is_lower_bound) range.high.reset();
  return range;
}

EquivalentMsaa limited_equivalent_msaa(double error, const std::vector<LadderRung>& ladder,
                                       std::vector<EmrRange> ranges) {
  EquivalentMsaa emr = equivalent_msaa(error, ladder);
  emr.does_not_converge = emr.is_lower_bound && !converges(ladder);
  if (const std::optional<double> deviation = unevenness(ladder))
    ranges.push_back(range_of(equivalent_msaa(error * std::exp(*deviation), ladder),
                              equivalent_msaa(error * std::exp(-*deviation), ladder)));
  if (ranges.empty()) return emr;
  if (!emr.does_not_converge) emr.low = common_end(emr.samples, ranges, &EmrRange::low);
  emr.high = common_end(emr.samples, ranges, &EmrRange::high);
  return emr;
}

double best_error(const std::vector<LadderRung>& ladder) {
  double best = std::numeric_limits<double>::infinity();
  for (const LadderRung& rung : ladder) best = std::min(best, rung.error);
  return best;
}

}  // namespace beampipe
