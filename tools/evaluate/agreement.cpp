#include "tools/evaluate/agreement.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace beampipe {
namespace {

std::vector<double> ranks_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    for (std::size_t i = first; i < end; ++i) ranks[order[i]] = static_cast<double>(first + end - 1) / 2;
  }
  return ranks;
}

// Pearson's, of numbers whose mean is `mean`. None if all of either list are equal.
std::optional<double> correlation(const std::vector<double>& a, const std::vector<double>& b, double mean) {
  double of_both = 0, of_a = 0, of_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    of_both += (a[i] - mean) * (b[i] - mean);
    of_a += (a[i] - mean) * (a[i] - mean);
    of_b += (b[i] - mean) * (b[i] - mean);
  }
  if (of_a == 0 || of_b == 0) return {};
  return of_both / std::sqrt(of_a * of_b);
}

}  // namespace

Agreement agreement_of(const std::vector<MeasuredAndModelled>& numbers) {
  Agreement result{.count = numbers.size()};
  if (numbers.empty()) return result;
  const auto count = static_cast<double>(numbers.size());
  double errors = 0, logarithms = 0, squares = 0;
  std::vector<double> measured, modelled;
  for (const MeasuredAndModelled& each : numbers) {
    errors += std::abs(each.modelled - each.measured) / each.measured;
    logarithms += std::log(each.modelled / each.measured);
    measured.push_back(each.measured);
    modelled.push_back(each.modelled);
  }
  result.mape = errors / count;
  result.geometric_mean = std::exp(logarithms / count);
  if (numbers.size() < 2) return result;
  for (const MeasuredAndModelled& each : numbers)
    squares += std::pow(std::log(each.modelled / each.measured) - logarithms / count, 2);
  result.spread = std::exp(std::sqrt(squares / (count - 1)));
  result.spearman = correlation(ranks_of(measured), ranks_of(modelled), (count - 1) / 2);
  return result;
}

}  // namespace beampipe
