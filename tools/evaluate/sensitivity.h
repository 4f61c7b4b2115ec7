// How far modelled times may be off, as far as the ranges of the hardware's rates tell.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "tools/evaluate/hardware.h"
#include "traces/files/json.h"

namespace beampipe {

struct Interval {
  double low = 0, high = 0;

  bool contains(double value) const { return low <= value && value <= high; }
  Json json() const { return Json::array({low, high}); }
};

// The next number of 2^53 steps from 0 to below 1, the same with every library.
inline double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

// The same hardware `count` times, without `json`: each rate that has a range is drawn from it, evenly on a logarithmic
// scale and apart from the others. Draws are the same in every run, and on all hardware that has the same ranges.
std::vector<Hardware> drawn_hardware(const Hardware& hardware, int count = 200);

// Nine tenths of the values lie in it: from the one at rank ceil(n / 20) from below to that from above. There is at
// least one value.
Interval middle_of(std::vector<double> values);

// A rate that has a range, at its ends; the other rates are as they are.
struct RateEnds {
  std::string rate;
  Hardware low, high;
};
std::vector<RateEnds> ends_of_ranges(const Hardware& hardware);

}  // namespace beampipe
