#include "tools/evaluate/metrics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

namespace beampipe {
namespace {

void require_same_size(const Image& image, const Image& reference) {
  const std::size_t values = std::size_t{4} * image.width * image.height;
  if (image.width != reference.width || image.height != reference.height || image.rgba.size() != values ||
      reference.rgba.size() != values) {
    throw std::invalid_argument("the pictures have different sizes: " + std::to_string(image.width) + " x " +
                                std::to_string(image.height) + " and " + std::to_string(reference.width) + " x " +
                                std::to_string(reference.height));
  }
}

double difference(const Image& image, const Image& reference, std::size_t value) {
  return static_cast<double>(image.rgba[value]) - static_cast<double>(reference.rgba[value]);
}

// The number of values, out of n, from the rank of p99 to the last: that rank is ceil(0.99 n) = n - floor(n / 100).
std::uint64_t values_from_p99_up(std::uint64_t n) { return n / 100 + 1; }

}  // namespace

ErrorAccumulator::ErrorAccumulator(std::uint64_t pixels) : expected_(3 * pixels) {}

void ErrorAccumulator::add(const Image& image, const Image& reference) {
  require_same_size(image, reference);
  largest_.reserve(largest_.size() + 3 * std::size_t{image.width} * image.height);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    double row_sum = 0, row_squares = 0;
    for (std::uint32_t x = 0; x < image.width; ++x) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double error = difference(image, reference, 4 * (std::size_t{y} * image.width + x) + channel);
        if (!std::isfinite(error)) {
          throw std::runtime_error("the value at pixel (" + std::to_string(x) + ", " + std::to_string(y) +
                                   ") is not finite");
        }
        row_sum += error;
        row_squares += error * error;
        largest_.push_back(std::abs(error));
      }
    }
    sum_ += row_sum;
    sum_of_squares_ += row_squares;
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
  const auto [p99, max] = std::minmax_element(largest_.begin(), largest_.end());
  const double n = static_cast<double>(count_);
  return {std::sqrt(sum_of_squares_ / n), sum_ / n, *p99, *max};
}

ErrorStats measure_error(const Image& image, const Image& reference) {
  ErrorAccumulator accumulator(std::uint64_t{image.width} * image.height);
  accumulator.add(image, reference);
  return accumulator.stats();
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

EquivalentMsaa equivalent_msaa(double rmse, const std::vector<LadderRung>& ladder) {
  const auto not_rising = [](const LadderRung& a, const LadderRung& b) { return a.samples >= b.samples; };
  if (ladder.empty() || ladder.front().samples == 0 ||
      std::adjacent_find(ladder.begin(), ladder.end(), not_rising) != ladder.end()) {
    throw std::invalid_argument("an MSAA ladder needs rungs of rising sample counts");
  }
  LadderRung before = ladder.front();
  if (rmse > before.rmse) return {static_cast<double>(before.samples), false, true};
  if (rmse == before.rmse) return {static_cast<double>(before.samples), false, false};
  for (const LadderRung& rung : ladder) {
    if (rung.rmse >= before.rmse) {
      if (rung.samples > before.samples) before.samples = rung.samples;  // the curve is flat up to this rung
      continue;
    }
    if (rung.rmse == rmse) return {static_cast<double>(rung.samples), false, false};
    if (rung.rmse < rmse) {
      const double part = std::log(before.rmse / rmse) / std::log(before.rmse / rung.rmse);  // 0 if rung.rmse is 0
      const double n0 = before.samples, n1 = rung.samples;
      return {n0 * std::pow(n1 / n0, part), false, false};
    }
    before = rung;
  }
  return {static_cast<double>(ladder.back().samples), true, false};
}

double best_rmse(const std::vector<LadderRung>& ladder) {
  double best = std::numeric_limits<double>::infinity();
  for (const LadderRung& rung : ladder) best = std::min(best, rung.rmse);
  return best;
}

}  // namespace beampipe
