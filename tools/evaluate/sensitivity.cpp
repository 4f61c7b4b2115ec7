#include "tools/evaluate/sensitivity.h"

#include <algorithm>
#include <cmath>

namespace beampipe {

std::vector<Hardware> drawn_hardware(const Hardware& hardware, int count) {
  std::mt19937_64 random(1);
  Hardware plain = hardware;
  plain.json = nullptr;
  std::vector<Hardware> draws(static_cast<std::size_t>(count), plain);
  for (Hardware& draw : draws)
    for (const auto& [rate, range] : hardware.ranges) {
      draw.rates.at(rate) = range.low * std::pow(range.high / range.low, uniform(random));
    }
  return draws;
}

Interval middle_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t outside = (values.size() + 19) / 20 - 1;
  return {values.at(outside), values.at(values.size() - 1 - outside)};
}

std::vector<RateEnds> ends_of_ranges(const Hardware& hardware) {
  Hardware plain = hardware;
  plain.json = nullptr;
  std::vector<RateEnds> all;
  for (const auto& [rate, range] : hardware.ranges) {
    all.push_back({rate, plain, plain});
    all.back().low.rates.at(rate) = range.low;
    all.back().high.rates.at(rate) = range.high;
  }
  return all;
}

}  // namespace beampipe
