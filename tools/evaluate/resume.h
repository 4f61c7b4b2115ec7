// Continuing a run that was stopped.
//
// Each finished frame leaves a record, DIR/unfinished/frame_0007.json. It holds what report.json will say about the
// frame, the sums over all frames so far, and digests of the frame's files and of the record itself. It is written
// after the frame's files. Once report.json is written, the records are removed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "tools/files/output.h"
#include "traces/files/json_form.h"

namespace beampipe {

// Everything that results depend on: the command, digests of the program and of the trace, and options. A report has it
// as "made_by".
struct Maker {
  std::string command;
  const RunPlan& plan;
  // Options of `compare` alone.
  std::optional<std::vector<std::uint64_t>> ladder = {};
  std::optional<bool> causes = {}, orders = {};
  std::optional<std::string> metric = {};
  std::optional<double> pixels_per_degree = {};
};
Form<Maker> maker_form();

struct FrameRecord {
  std::vector<FrameReport> reports;  // one per technique
  Json sums;                         // whatever the command adds up over frames
};

class FrameRecords {
 public:
  FrameRecords(OutputFolder& output, Json maker) : output_(output), maker_(std::move(maker)) { set_kept(0, 0); }

  // Throws std::runtime_error, one line, if the folder has results of another trace, or of `compare` while this is
  // `run`, which has no errors.
  void require_own_folder() const;

  // Whether report.json exists and was made by the same run. If so, this removes records that were left when the
  // program was killed. Throws std::runtime_error, one line, if report.json was made by another run.
  bool is_finished();

  // Reads the records of `frames`, one after the other, up to the first frame whose record or files are missing or
  // damaged, or whose record take() refuses. Returns how many were taken. A record must have one report per spec, and
  // sums that differ from `no_sums` only in their numbers; otherwise it counts as damaged. Throws std::runtime_error,
  // one line that says what has changed, if all records were made by another run.
  std::size_t read(const std::vector<std::size_t>& frames, const std::vector<std::string>& specs, const Json& no_sums,
                   const std::function<bool(const FrameRecord&)>& take) const;

  // `finished`: with this frame. An interrupt then says so, and how to go on.
  void write(const FrameRecord& record, std::size_t finished, std::size_t all);

  // Removes all records. An interrupt then says nothing of frames.
  void remove();

 private:
  std::optional<FrameRecord> read(std::size_t frame, const std::vector<std::string>& specs, const Json& no_sums) const;
  void set_kept(std::size_t finished, std::size_t all) const;
  std::vector<std::filesystem::path> list() const;
  [[noreturn]] void refuse(const Json& other_maker) const;

  OutputFolder& output_;
  Json maker_;
};

// The path of a frame's record in the output folder.
std::string frame_record_name(std::size_t frame);

}  // namespace beampipe
