// What `compare` can find out beyond the error itself: the causes of errors (--causes), and how much pictures depend on
// the order of the triangles (--orders).
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tools/evaluate/metrics.h"
#include "tools/evaluate/progress.h"
#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "traces/files/json.h"

namespace beampipe {

// How much each cause contributes to the mean square error, pooled over frames.
class CauseShares {
 public:
  CauseShares();

  // Splits the frame's error by cause (pipeline/error_causes.h) and adds one layer per cause ("cause_leak", ...) to the
  // per-pixel counters. `colors`: how both pictures were rendered; by_pixel if surfaces vary. Does nothing if the
  // technique does not report weights.
  void add(const Technique& technique, const RunPlan& plan, std::size_t frame, SurfaceColors colors,
           const PicturePair& pictures, std::map<std::string, std::vector<float>>& pixel_counters);

  // The shares in the order of kErrorCauses; they add up to 1. Empty if nothing was added or there is no error.
  std::vector<std::pair<std::string, double>> shares() const;

  // The sums so far, as JSON: saved and restored to continue a stopped run.
  Json sums() const;
  void set_sums(const Json& sums);

 private:
  std::map<std::string, double> squares_;
  double all_squares_ = 0;
};

// Renders frames with their triangles in each TriangleOrder and compares every picture with the reference in the same
// order. (The order also matters to the reference: at equal depth the earlier triangle wins.)
class OrderComparison {
 public:
  explicit OrderComparison(std::vector<Technique> techniques);

  void add(const Technique& reference, const RunPlan& plan, std::size_t frame, Progress& progress);

  // Fills `orders` and `order_difference` of technique i.
  void report(std::size_t i, TechniqueReport& report) const;

  // The sums so far, as JSON: saved and restored to continue a stopped run.
  Json sums() const;
  void set_sums(const Json& sums);

 private:
  struct Sums {
    std::vector<double> errors;       // for each order, the sum of squared errors
    std::vector<double> differences;  // for each pair of orders, the sum of squared differences
  };
  std::vector<Technique> techniques_;
  std::vector<Sums> sums_;
  double values_ = 0;  // the number of values in each sum
};

}  // namespace beampipe
