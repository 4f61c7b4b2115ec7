// The MSAA ladder of a comparison: the error of msaa:N for rising N, between which equivalent rates are found.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tools/evaluate/metrics.h"
#include "tools/evaluate/progress.h"
#include "tools/evaluate/run_plan.h"
#include "traces/files/json.h"

namespace beampipe {

// Is it msaa:N without options? Variants with options have other errors than a ladder's msaa:N.
bool is_rung(const Technique& technique);

class MsaaLadder {
 public:
  // The rungs are msaa:N for each N in `samples`, in any order, rendered with these colours. If `samples` is empty,
  // they are 1, 2, 4, ..., 256, and 512 and 1024 if a technique turns out to be better than these. Throws SpecError if
  // there is no such rate.
  explicit MsaaLadder(std::vector<std::uint32_t> samples, SurfaceColors colors = SurfaceColors::by_place);

  // Renders the frame with the rungs that are not among the plan's techniques, and adds their errors.
  void add(const RunPlan& plan, std::size_t frame, const Image& reference, Progress& progress);

  // The rungs with their errors over all frames. `rmses` has the errors of the plan's techniques, and
  // read_reference(frame) returns the reference's picture of a frame.
  std::vector<LadderRung> rungs(const RunPlan& plan, const std::vector<double>& rmses,
                                const std::function<Image(std::size_t frame)>& read_reference, Progress& progress);

  // The sums so far, as JSON: saved and restored to continue a stopped run.
  Json sums() const;
  void set_sums(const Json& sums);

 private:
  struct Rung {
    Technique technique;
    double squares = 0, pixels = 0;  // sums over the frames: squared errors per pixel, and pixels

    explicit Rung(std::uint32_t samples);
    void add(const RunPlan& plan, std::size_t frame, const Image& reference, SurfaceColors colors, Progress& progress);
    LadderRung measured(const RunPlan& plan, const std::vector<double>& rmses) const;
  };

  std::vector<Rung> rungs_;  // samples rise
  bool may_grow_;
  SurfaceColors colors_;
};

}  // namespace beampipe
