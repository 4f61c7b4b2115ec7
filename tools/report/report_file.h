// report.json as `run` and `compare` left it, and what the plots take from it.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/evaluate/metrics.h"
#include "traces/json.h"

namespace beampipe {

// One line: "FILE: what is wrong with it".
struct ReportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Per frame, the mean of the frames: with all stages at once, and one after the other.
struct ModelledMs {
  double overlap = 0, sum = 0;
};

// What one technique cost and bought, over all frames of a report.
struct TechniqueSummary {
  std::string spec;
  double bytes_per_pixel = 0;  // of framebuffer and A-buffer, at their peak
  double wall_ms = 0;          // per frame: the median of the frames' medians
  // By the way in which the modelled hardware runs the techniques. Empty: not modelled.
  std::map<std::string, ModelledMs> modelled_ms;
  double dram_bytes = 0;              // per frame: the mean of the frames
  std::optional<double> rmse;         // after `compare`
  std::optional<EquivalentMsaa> emr;  // after `compare`
};

struct ReportFile {
  std::filesystem::path folder;
  std::string scene;                         // the trace's file name without folder and extension
  Json json;                                 // the whole file
  std::vector<TechniqueSummary> techniques;  // without `reference`, which the others are judged by
  std::vector<LadderRung> msaa_ladder;       // empty after `run`
};

// Of one member of the report's "results". Throws nlohmann's exceptions when it is not one.
TechniqueSummary read_summary(const Json& result);

// For each technique and stage, in order: what the frames' "stages" say, summed over the frames, and "technique",
// "frames" (how many), "logical_bytes" (read and written), "ops_per_byte" (of these) and "lane_use" (the last two where
// there is something to divide by).
std::vector<Json> stage_records(const ReportFile& report);

// Reads FOLDER/report.json. Throws ReportError; TraceError when it is no file of JSON.
ReportFile read_report(const std::filesystem::path& folder);

// Geometric means of rmse, emr and times over several reports, of the techniques that are in all of them, in the order
// of the first. A mean is a lower (upper) bound when one of its values is; it can be both: then it is neither. Throws
// ReportError when they have no technique in common, and std::invalid_argument when there is no report.
std::vector<TechniqueSummary> mean_summaries(const std::vector<ReportFile>& reports);

}  // namespace beampipe
