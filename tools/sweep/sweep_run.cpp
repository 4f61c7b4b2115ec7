#include "tools/sweep/sweep_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <thread>

#include "tools/evaluate/machine_memory.h"
#include "tools/evaluate/progress.h"

namespace beampipe {
namespace {

using Clock = std::chrono::steady_clock;

std::size_t parts_of(const SweepJob& job) { return job.technique ? job.cells.size() : 1; }

std::string duration_text(double seconds) {
  if (seconds < 90) return std::to_string(static_cast<int>(seconds + 0.5)) + " s";
  if (seconds < 5400) return std::to_string(static_cast<int>(seconds / 60 + 0.5)) + " min";
  return std::to_string(static_cast<int>(seconds / 3600 + 0.5)) + " h";
}

// Lets jobs start when they fit beside those that run. A job that is alone always starts.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::uint64_t bytes) : bytes_(bytes) {}

  void take(std::uint64_t bytes) {
    std::unique_lock lock(mutex_);
    freed_.wait(lock, [&] { return used_ == 0 || used_ + bytes <= bytes_; });
    used_ += std::max<std::uint64_t>(bytes, 1);
  }
  void give_back(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    used_ -= std::max<std::uint64_t>(bytes, 1);
    freed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable freed_;
  std::uint64_t bytes_, used_ = 0;
};

// Counts what is finished, and tells the user.
class Tally {
 public:
  Tally(std::size_t parts, InterruptGate& gate) : parts_(parts), gate_(gate) { tell(); }
  ~Tally() {
    const auto held = gate_.hold();
    gate_.set_kept("");
  }

  void add(CellSource source) {
    const std::lock_guard lock(mutex_);
    ++(source == CellSource::stored   ? outcome_.stored
       : source == CellSource::shared ? outcome_.shared
                                      : outcome_.rendered);
    tell();
  }
  void fail(const std::string& what) {
    const std::lock_guard lock(mutex_);
    outcome_.failures.push_back(what);
  }
  const SweepOutcome& outcome() const { return outcome_; }

 private:
  void tell() {
    const std::size_t made = outcome_.shared + outcome_.rendered, done = made + outcome_.stored;
    const std::string count = std::to_string(done) + " of " + std::to_string(parts_) + " results";
    std::string left;
    if (outcome_.rendered > 0) {
      const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
      left = ", about " + duration_text(seconds / static_cast<double>(made) * static_cast<double>(parts_ - done)) +
             " left";
    }
    progress_.show(count + left);
    const auto held = gate_.hold();
    gate_.set_kept(count + " are kept, and the same command goes on from there");
  }

  std::size_t parts_;
  InterruptGate& gate_;
  std::mutex mutex_;
  SweepOutcome outcome_;
  Clock::time_point start_ = Clock::now();
  Progress progress_;
};

std::string name_of(const SweepPlan& plan, const SweepJob& job) {
  const std::string trace = file_beside_plan(plan, plan.traces[job.trace]);
  return trace + ", " + (job.technique ? plan.techniques[*job.technique] : "errors");
}

}  // namespace

SweepOutcome run_jobs(const SweepPlan& plan, const std::vector<SweepJob>& jobs, TraceShelf& shelf,
                      SweepResults& results, const SweepWorkers& workers, InterruptGate& gate) {
  const auto cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int at_once = std::clamp(workers.jobs > 0 ? workers.jobs : cores, 1,
                                 static_cast<int>(std::clamp<std::size_t>(jobs.size(), 1, 1024)));
  JobLimits limits;
  limits.threads = workers.threads > 0 ? workers.threads : std::max(1, cores / at_once);
  limits.pictures = workers.pictures;
  // Half of the memory is for pairs, as in a run of one technique, and half for all else.
  limits.memory_limit = machine_memory() / 2 / static_cast<std::uint64_t>(at_once);
  MemoryBudget budget(machine_memory() / 2);

  std::size_t parts = 0;
  for (const SweepJob& job : jobs) parts += parts_of(job);
  Tally tally(parts, gate);
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < jobs.size(); i = next++) {
      const SweepJob& job = jobs[i];
      std::uint64_t bytes = 0;
      try {
        const std::uint64_t needed = memory_of(plan, job, shelf);
        budget.take(needed);
        bytes = needed;
        run_job(plan, job, shelf, results, limits, [&](CellSource source) { tally.add(source); });
      } catch (const std::bad_alloc&) {
        tally.fail(name_of(plan, job) + ": out of memory");
      } catch (const std::exception& error) {
        tally.fail(name_of(plan, job) + ": " + error.what());
      }
      if (bytes > 0) budget.give_back(bytes);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < at_once; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  return tally.outcome();
}

}  // namespace beampipe
