// Runs work on a given number of threads. 0 stands for all that the machine has.
#pragma once

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

namespace beampipe {

inline int thread_count(int threads) { return threads > 0 ? threads : tbb::info::default_concurrency(); }

// An arena for so many threads. It is the caller's alone, and becomes free for others when the pointer is gone.
std::shared_ptr<tbb::task_arena> borrow_arena(int threads);

// Runs `work` with its parallel loops on so many threads, and returns what it returns.
template <class Work>
auto on_threads(int threads, Work&& work) {
  const int allowed = thread_count(threads);
  // oneTBB starts more threads than the machine has only if it is told to. It is not told otherwise, because it reads
  // such a limit without a lock while another thread, such as one that renders another frame, sets it.
  std::optional<tbb::global_control> limit;
  if (allowed > tbb::info::default_concurrency())
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(allowed));
  return borrow_arena(allowed)->execute(std::forward<Work>(work));
}

}  // namespace beampipe
