// Work on a number of threads: what it keeps, and what it sees of the number.
#include "pipeline/bins/threads.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <fstream>

namespace beampipe {
namespace {

std::size_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// Frames of a few microseconds, so that some end while another thread is still about to leave their work.
void run_frames(int count) {
  std::atomic<int> sum = 0;
  for (int frame = 0; frame < count; ++frame)
    on_threads(2, [&] { tbb::parallel_for(0, 24, [&](int i) { sum += i; }); });
  ASSERT_EQ(sum, 276 * count);
}

TEST(Threads, KeepNoMemoryFromFrameToFrame) {
  run_frames(1000);
  const std::size_t before = resident_bytes();
  run_frames(4000);
  EXPECT_LT(resident_bytes(), before + (std::size_t{4} << 20));
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
