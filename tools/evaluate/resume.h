// Going on with a run that was stopped.
//
// Each finished frame leaves a record, DIR/unfinished/frame_0007.json: what report.json is to say of it, the sums over
// the frames so far, and digests of the frame's files and of the record itself. It is written behind the files. When
// report.json is written, the records go away.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "tools/files/output.h"
#include "traces/json.h"

namespace beampipe {

// What results depend on, by name: the command, the program and the trace by their contents, options. `more`: options
// of the command's own.
Json made_by(const std::string& command, const RunPlan& plan, const Json& more);

struct FrameRecord {
  std::vector<FrameReport> reports;  // one per technique
  Json sums;                         // the command's own
};

class FrameRecords {
 public:
  FrameRecords(OutputFolder& output, Json maker) : output_(output), maker_(std::move(maker)) {}

  // Whether report.json is there and made by the same; then removes the records that a kill may have left beside it.
  // Throws std::runtime_error, one line, when another made it.
  bool is_finished();

  // The records of `frames` up to the first that is missing or damaged, or one of whose files is. Each has one report
  // per spec and sums like `no_sums` but for the numbers; one that differs counts as damaged. Throws
  // std::runtime_error, one line that says what has changed, when all that is there was made by another.
  std::vector<FrameRecord> read(const std::vector<std::size_t>& frames, const std::vector<std::string>& specs,
                                const Json& no_sums) const;

  void write(const FrameRecord& record);

  // All of them.
  void remove();

 private:
  std::optional<FrameRecord> read(std::size_t frame, const std::vector<std::string>& specs, const Json& no_sums) const;
  std::vector<std::filesystem::path> list() const;
  [[noreturn]] void refuse(const Json& other_maker) const;

  OutputFolder& output_;
  Json maker_;
};

// In the output folder.
std::string frame_record_name(std::size_t frame);

}  // namespace beampipe
