// How well modelled numbers agree with measured ones.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace beampipe {

// Both positive, in the same unit.
struct MeasuredAndModelled {
  double measured = 0, modelled = 0;
};

// Those without a value need more numbers: the spread and the rank correlation two, the others one. Ranks also need
// numbers that are not all equal.
struct Agreement {
  std::size_t count = 0;
  std::optional<double> mape = {};            // mean of |modelled - measured| / measured: 0.2 is 20 %
  std::optional<double> geometric_mean = {};  // of modelled / measured
  std::optional<double> spread = {};          // its geometric standard deviation, for samples: at least 1
  std::optional<double> spearman = {};        // correlation of the ranks, -1..1; equal numbers share their mean rank
};

Agreement agreement_of(const std::vector<MeasuredAndModelled>& numbers);

}  // namespace beampipe
