// The work of a sweep, in jobs that share what they render.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "tools/sweep/sweep_results.h"

namespace beampipe {

// Cells of one trace, size and technique whose memory systems differ in nothing but the sizes of caches: what is
// rendered for the largest ones often holds for others too. Without a technique: the errors of the trace's pictures.
struct SweepJob {
  std::size_t trace = 0, size = 0;
  std::optional<std::size_t> technique;
  std::vector<std::size_t> cells;  // of the plan, those with the largest caches first
};

// In the order of the table, so that jobs of the same trace follow each other.
std::vector<SweepJob> jobs_of(const SweepPlan& plan);

// What a job may use.
struct JobLimits {
  int threads = 1;
  std::uint64_t memory_limit = 0;  // FrameInput::memory_limit
  std::filesystem::path pictures;  // the folder of a PictureCache for the reference; empty: none are kept
};

// An upper estimate of the bytes that a job takes besides memory_limit.
std::uint64_t memory_of(const SweepPlan& plan, const SweepJob& job, TraceShelf& shelf);

// Is everything that the job finds out stored?
bool is_finished(const SweepPlan& plan, const SweepJob& job, const SweepResults& results);

// How a cell was found out.
enum class CellSource { stored, shared, rendered };

// Renders what is not stored yet, and stores it cell by cell. Calls finished(source) after each cell, and once for
// errors.
void run_job(const SweepPlan& plan, const SweepJob& job, TraceShelf& shelf, SweepResults& results,
             const JobLimits& limits, const std::function<void(CellSource)>& finished);

}  // namespace beampipe
