// What compare finds out beyond the error itself, when it is asked to: causes of error, and how much the order of the
// triangles matters.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tools/evaluate/progress.h"
#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "traces/json.h"

namespace beampipe {

// The parts of the mean square error that causes have, pooled over frames.
class CauseShares {
 public:
  CauseShares();

  // Splits the frame's error (pipeline/error_causes.h), and adds one layer per cause, "cause_leak" and so on, to the
  // result's counters. Nothing where the technique does not tell its weights.
  void add(const Technique& technique, const RunPlan& plan, std::size_t frame, const Image& reference,
           FrameResult& result);

  // In the order of kErrorCauses; they add up to 1. Empty when nothing was added or there is no error.
  std::vector<std::pair<std::string, double>> shares() const;

  // What was added so far, to go on from there.
  Json sums() const;
  void set_sums(const Json& sums);

 private:
  std::map<std::string, double> squares_;
  double all_squares_ = 0;
};

// Renders frames with their triangles in each TriangleOrder, every picture against the reference of the same order:
// at equal depth the earlier triangle wins, so that faces which coincide look different in the reference too.
class OrderComparison {
 public:
  explicit OrderComparison(std::vector<Technique> techniques);

  void add(const Technique& reference, const RunPlan& plan, std::size_t frame, Progress& progress);

  // Of technique i: fills `orders` and `order_difference`.
  void report(std::size_t i, TechniqueReport& report) const;

  // What was added so far, to go on from there.
  Json sums() const;
  void set_sums(const Json& sums);

 private:
  struct Sums {
    std::vector<double> errors;       // per order: of squared errors
    std::vector<double> differences;  // per pair of orders: of squared differences
  };
  std::vector<Technique> techniques_;
  std::vector<Sums> sums_;
  double values_ = 0;  // that each sum is over
};

}  // namespace beampipe
