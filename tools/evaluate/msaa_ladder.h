// The MSAA ladder of a comparison: the error of msaa:N for rising N, between which equivalent rates are found.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tools/evaluate/blocks.h"
#include "tools/evaluate/measures.h"
#include "tools/evaluate/metrics.h"
#include "tools/evaluate/progress.h"
#include "tools/evaluate/run_plan.h"
#include "traces/files/json.h"

namespace beampipe {

// Is it msaa:N without options? Variants with options have other errors than a ladder's msaa:N.
bool is_rung(const Technique& technique);

// The rates of a ladder that does not name its own, and those that it gets too while a technique is better.
const std::vector<std::uint32_t>& default_rungs();
const std::vector<std::uint32_t>& more_rungs();

// What errors are compared by.
struct Metric {
  const Measure& measure = find_metric("rmse");
  double pixels_per_degree = kPixelsPerDegree;
};

// The RMSE of a picture, its error by the metric, and its squared errors by block.
struct MetricErrors {
  double rmse = 0, error = 0;
  BlockSquares blocks{};
};

class MsaaLadder {
 public:
  // The rungs are msaa:N for each N in `samples`, in any order, rendered with these colours. If `samples` is empty,
  // they are 1, 2, 4, ..., 256, and 512 and 1024 if a technique other than a reference turns out to be better than
  // these by the metric. Throws SpecError if there is no such rate.
  explicit MsaaLadder(std::vector<std::uint32_t> samples, SurfaceColors colors = SurfaceColors::by_place,
                      const Metric& metric = {});

  // Renders the frame with the rungs that are not among the plan's techniques, and adds their errors.
  void add(const RunPlan& plan, std::size_t frame, const Image& reference, Progress& progress);

  struct Rungs {
    std::vector<LadderRung> rmse, error;  // errors over all frames: the RMSE, and by the metric
    std::vector<BlockSquares> blocks;     // of each
  };

  // `errors` has those of the plan's techniques, and read_reference(frame) returns the reference's picture of a frame.
  Rungs rungs(const RunPlan& plan, const std::vector<MetricErrors>& errors,
              const std::function<Image(std::size_t frame)>& read_reference, Progress& progress);

  // The sums so far, as JSON: saved and restored to continue a stopped run.
  Json sums() const;
  void set_sums(const Json& sums);

 private:
  struct Rung {
    Technique technique;
    // Sums over the frames: squared errors per pixel, errors per pixel as the metric pools them, and pixels.
    double squares = 0, errors = 0, pixels = 0;
    BlockSquares blocks{};

    explicit Rung(std::uint32_t samples);
  };

  void add(Rung& rung, const RunPlan& plan, std::size_t frame, const Image& reference, Progress& progress) const;
  void measure(const Rung& rung, const RunPlan& plan, const std::vector<MetricErrors>& errors, Rungs& measured) const;

  std::vector<Rung> rungs_;  // samples rise
  bool may_grow_;
  SurfaceColors colors_;
  Metric metric_;
};

}  // namespace beampipe
