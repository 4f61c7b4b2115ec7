// Where surfaces vary, the error of a picture has two parts: visibility (who covers how much of a pixel) and shading
// (what colour it was taken to be).
//
// To tell them apart, every picture is rendered once more with SurfaceColors::by_pixel. Then the technique and the
// reference agree on the colour that a triangle has in a pixel, and their pictures differ only in visibility. What the
// error has beyond this difference is the error of shading. In each value of each pixel, the two parts add up to the
// error.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/metrics.h"
#include "tools/evaluate/msaa_ladder.h"
#include "tools/evaluate/progress.h"
#include "tools/evaluate/render.h"
#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "traces/files/json.h"

namespace beampipe {

// Does a frame of the plan have surfaces that vary?
bool has_varying_surfaces(const RunPlan& plan);

// Measures both parts and adds them to the per-pixel counters, as the layers "visibility_error" and "shading_error".
// `by_pixel`: the same pictures with SurfaceColors::by_pixel.
ErrorParts split_error(const PicturePair& pictures, const PicturePair& by_pixel,
                       std::map<std::string, std::vector<float>>& pixel_counters);

// Pools the parts of several frames as if they were one picture. All frames must have them.
ErrorParts pooled_parts(const FrameReports& frames);

// Splits the errors of a plan's techniques, frame by frame.
class ErrorSplit {
 public:
  // `techniques`: how many the plan has. `ladder`: as for MsaaLadder.
  ErrorSplit(std::size_t techniques, const std::vector<std::uint32_t>& ladder);

  // Goes on after the plan's first `frames` frames, for techniques that keep a history.
  void go_on_after(std::size_t frames, const RunPlan& plan, Progress& progress);

  // Renders the frame's reference. The frame's techniques follow, then its rungs.
  void start_frame(const RunPlan& plan, std::size_t frame, Progress& progress);

  // Renders the frame with technique i of the plan; `result` and `reference` are the pictures whose error is split.
  // Adds the two layers to the result's per-pixel counters.
  ErrorParts split(const RunPlan& plan, std::size_t i, FrameResult& result, const Image& reference, Progress& progress);

  // The pictures with SurfaceColors::by_pixel of the technique that was split last.
  PicturePair pictures() const { return {image_, reference_}; }

  void add_rungs(const RunPlan& plan, Progress& progress);

  // The errors of MSAA in visibility alone, over all frames. `rmses`: those of the plan's techniques.
  std::vector<LadderRung> rungs(const RunPlan& plan, const std::vector<double>& rmses, Progress& progress);

  // The sums so far, as JSON: saved and restored to continue a stopped run.
  Json sums() const { return ladder_.sums(); }
  void set_sums(const Json& sums) { ladder_.set_sums(sums); }

 private:
  Technique truth_ = parse_technique(kReferenceSpec);
  std::size_t frame_ = 0;  // the frame of `reference_`, if that is not empty
  Image reference_, image_;
  std::vector<History> histories_;  // one per technique
  MsaaLadder ladder_;
};

}  // namespace beampipe
