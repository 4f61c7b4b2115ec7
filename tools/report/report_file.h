// Reads report.json, and summarises it for plots and tables.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "pipeline/memory/parameters.h"
#include "tools/evaluate/metrics.h"
#include "traces/files/json.h"

namespace beampipe {

// One line: "FILE: what is wrong with it".
struct ReportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// What read() returns. A JsonError of it becomes a ReportError that names the folder's report.json.
template <class Read>
auto read_from_report(const std::filesystem::path& folder, const Read& read) {
  try {
    return read();
  } catch (const JsonError& error) {
    throw ReportError((folder / "report.json").string() + ": not a report of beampipe: " + error.what());
  }
}

// Modelled milliseconds per frame (the mean over the frames): with all stages at once, with bins one by one on cores,
// and one stage after the other.
struct ModelledMs {
  double at_once = 0, on_cores = 0, in_turn = 0;
  std::string busiest;  // what limits `at_once`, as limit_text() writes it; several, with commas, if they differ from
                        // frame to frame
};

// Cost and error of one technique, over all frames of a report.
struct TechniqueSummary {
  std::string spec;
  double bytes_per_pixel = 0;          // framebuffer, and at their peaks A-buffer, translucent layer, spilled records
  std::string off_chip;                // the names of these, as far as there are any
  double on_chip_bytes_per_pixel = 0;  // all buffers that a bin has on chip, at their peaks
  double all_bytes_per_pixel = 0;      // both
  std::uint64_t bin_pixels = 0;        // of the largest bin
  bool pixels_on_chip = false;         // while a bin is drawn
  double wall_ms = 0;                  // per frame: the median of the frames' medians
  // By implementation of the modelled hardware. Empty if nothing was modelled.
  std::map<std::string, ModelledMs> modelled_ms;
  double dram_bytes = 0;              // per frame: the mean over the frames
  std::optional<double> rmse;         // only in reports of `compare`
  std::optional<EquivalentMsaa> emr;  // only in reports of `compare`
};

struct ReportFile {
  std::filesystem::path folder;
  std::string scene = {};                         // the name of the trace's file, without folder and extension
  Json json = {};                                 // the whole file
  MemoryParameters memory = {};                   // of the modelled hardware
  std::vector<TechniqueSummary> techniques = {};  // all techniques except `reference`
  std::vector<LadderRung> msaa_ladder = {};       // empty in reports of `run`
};

// The equivalent rate of one element of the report's "results", or of its "visibility". None if it has none. Throws
// JsonError if it is something else.
std::optional<EquivalentMsaa> read_emr(const Json& json);

// "estimate", "at least" or "at most".
std::string bound_text(const EquivalentMsaa& emr);

// Summarises one element of the report's "results". Throws JsonError if it is something else.
TechniqueSummary read_summary(const Json& result);

// The ways of building the pipeline whose times are modelled, in the order of the hardware's description. Empty if
// nothing was modelled.
std::vector<std::string> implementations_of(const ReportFile& report);

// "titan_v": the hardware whose times are modelled; empty if it has no name.
std::string hardware_label(const ReportFile& report);

// "titan_v.shaders": the implementation of the report's hardware, for people; without the latter if it has no name.
std::string name_of(const ReportFile& report, const std::string& implementation);

// One object for each technique and stage, in their order: the means over the frames of the numbers in "stages", and
// these keys: "technique", "logical_bytes" (read and written), "ops_per_byte" (operations per logical byte) and
// "lane_use". The last two are missing if they would divide by zero. The sums over a technique's stages are the means
// over its frames.
std::vector<Json> stage_records(const ReportFile& report);

// Adds the numbers in the object `other`, and in the objects in it, to those under the same keys in `sum`.
void add_numbers(Json& sum, const Json& other);

// Divides the numbers in the object by `count`. Whole numbers stay whole if they can.
void divide_numbers(Json& sum, std::uint64_t count);

// Reads FOLDER/report.json. Throws ReportError, or TraceError if the file is not JSON.
ReportFile read_report(const std::filesystem::path& folder);

// Of positive numbers, of which there is at least one. It is 0 if one of them is 0, and exact if all are equal.
double geometric_mean(const std::vector<double>& values);

// The geometric means over several reports of RMSE, EMR, times and bytes, for the techniques that are in all reports,
// in the order of the first report, and for the implementations of hardware that all reports of a technique have. A
// mean is a lower (upper) bound if one of its values is. If it would be both, it is
// marked as both and is neither. Throws ReportError if the reports have no technique in common, and
// std::invalid_argument if there is no report.
std::vector<TechniqueSummary> mean_summaries(const std::vector<ReportFile>& reports);

}  // namespace beampipe
