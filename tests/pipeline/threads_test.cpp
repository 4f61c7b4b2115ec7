// Work on a number of threads: what it keeps, and what it sees of the number.
#include "pipeline/bins/threads.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace beampipe {
namespace {

std::size_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

void expect_no_growth_since([[maybe_unused]] std::size_t before) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers keep freed memory
  constexpr std::size_t kMostGrowth = std::size_t{4} << 20;
  EXPECT_LT(resident_bytes(), before + kMostGrowth);
#endif
}

// A few microseconds, so that some frames end while another thread is still about to leave their work.
void run_frame() {
  std::atomic<int> sum = 0;
  on_threads(2, [&] { tbb::parallel_for(0, 24, [&](int i) { sum += i; }); });
  ASSERT_EQ(sum, 276);
}

TEST(Threads, KeepNoMemoryFromFrameToFrame) {
  for (int frame = 0; frame < 1000; ++frame) run_frame();
  const std::size_t before = resident_bytes();
  for (int frame = 0; frame < 4000; ++frame) run_frame();
  expect_no_growth_since(before);
}

// As in Python, where each call has a thread of its own.
TEST(Threads, KeepNoMemoryOfThreadsThatHaveEnded) {
  for (int frame = 0; frame < 100; ++frame) std::thread(run_frame).join();
  const std::size_t before = resident_bytes();
  for (int frame = 0; frame < 2000; ++frame) std::thread(run_frame).join();
  expect_no_growth_since(before);
}

TEST(Threads, AnErrorLeavesThemUsable) {
  for (int i = 0; i < 100; ++i)
    EXPECT_THROW(on_threads(2, [] { on_threads(2, [] { throw std::runtime_error("x"); }); }), std::runtime_error);
  run_frame();
}

TEST(Threads, WorkSeesTheNumberThatItWasGiven) {
  const auto seen = [] { return tbb::this_task_arena::max_concurrency(); };
  for (const int threads : {1, 2, 3, 2}) EXPECT_EQ(on_threads(threads, seen), threads);
  on_threads(2, [&] {
    EXPECT_EQ(on_threads(3, seen), 3);
    EXPECT_EQ(on_threads(2, seen), 2);
    EXPECT_EQ(seen(), 2);
  });
}

}  // namespace
}  // namespace beampipe
