// Renders the frames of a plan with its techniques and with the reference, and measures how wrong the pictures are.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/blocks.h"
#include "tools/evaluate/diagnosis.h"
#include "tools/evaluate/error_split.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/measures.h"
#include "tools/evaluate/metrics.h"
#include "tools/evaluate/msaa_ladder.h"
#include "tools/evaluate/progress.h"
#include "tools/evaluate/results.h"
#include "tools/evaluate/resume.h"
#include "tools/evaluate/run_plan.h"
#include "tools/files/output.h"
#include "traces/files/json.h"

namespace beampipe {

struct CompareOptions {
  std::vector<std::uint32_t> ladder;  // empty: the default ladder
  bool causes = false, orders = false;
  std::string metric = "rmse";  // what equivalent rates compare: one of metric_names()
  double pixels_per_degree = kPixelsPerDegree;
};

class Comparison {
 public:
  // Throws std::runtime_error, one line, unless the results can be written, and SpecError for a rung that is no MSAA.
  Comparison(const CompareOptions& options, RunPlan plan, OutputFolder& output);

  const RunPlan& plan() const { return plan_; }

  // Throws std::runtime_error, one line, if the folder has results of another trace.
  void require_own_folder() const { records_.require_own_folder(); }

  // Whether report.json is already the result of this comparison. Throws std::runtime_error, one line, if it is that of
  // another run.
  bool is_finished() { return records_.is_finished(); }

  // Takes over the frames that an earlier run of this comparison finished, and returns how many these are. Throws
  // std::runtime_error, one line, if the folder has records of another run only.
  std::size_t resume();

  // Renders and writes all other frames. Call it once.
  Report run();

 private:
  ErrorAccumulator new_errors() const;
  void compare_frame(std::size_t frame, Progress& progress);
  std::optional<ErrorParts> explain(std::size_t i, FrameResult& result, const Image& truth, std::size_t frame,
                                    Progress& progress);
  void recall_frame(const FrameRecord& record);
  Json sums() const;
  Image read_image(const FrameReport& frame) const;
  void pool_errors();
  EquivalentMsaa equivalent_of(std::size_t i, double error, const std::vector<LadderRung>& rungs,
                               std::vector<EmrRange> ranges = {}) const;
  void report_parts(Report& report, Progress& progress);
  std::vector<EmrRange> ranges_of(const MetricErrors& errors, const MsaaLadder::Rungs& rungs,
                                  const std::optional<double>& reference_error) const;
  Report report(Progress& progress);

  CompareOptions options_;
  OutputFolder& output_;
  RunPlan plan_;  // without the reference
  Json maker_;
  FrameRecords records_;
  Technique reference_ = parse_technique(kReferenceSpec);
  Metric metric_;
  MsaaLadder ladder_;
  TechniqueReport reference_result_;
  // Each has one entry per technique of the plan.
  std::vector<TechniqueReport> results_;
  std::vector<ErrorAccumulator> errors_;
  std::vector<BlockSquares> blocks_;
  std::vector<History> histories_;
  std::vector<std::vector<float>> last_errors_;
  std::vector<CauseShares> causes_;
  std::optional<ErrorSplit> split_;        // only if surfaces vary
  std::optional<OrderComparison> orders_;  // only if options_.orders
};

}  // namespace beampipe
