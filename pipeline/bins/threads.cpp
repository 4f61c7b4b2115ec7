#include "pipeline/bins/threads.h"

#include <map>
#include <mutex>
#include <vector>

namespace beampipe {
namespace {

// By their numbers of threads. The one thing that outlives a call; no result depends on it.
struct IdleArenas {
  std::mutex mutex;
  std::map<int, std::vector<std::unique_ptr<tbb::task_arena>>> arenas;
};

}  // namespace

// oneTBB 2021.8 does not free an arena that is given up right after its last task, which takes 7 KB for two threads and
// 40 KB for sixteen. So arenas are used again, and none is ever given up.
std::shared_ptr<tbb::task_arena> borrow_arena(int threads) {
  static IdleArenas& idle = *new IdleArenas;  // never destroyed, because oneTBB may end before it
  std::unique_ptr<tbb::task_arena> arena;
  {
    const std::lock_guard lock(idle.mutex);
    std::vector<std::unique_ptr<tbb::task_arena>>& arenas = idle.arenas[threads];
    if (!arenas.empty()) {
      arena = std::move(arenas.back());
      arenas.pop_back();
    }
  }
  if (!arena) arena = std::make_unique<tbb::task_arena>(threads);
  return {arena.release(), [threads](tbb::task_arena* returned) {
            const std::lock_guard lock(idle.mutex);
            idle.arenas[threads].emplace_back(returned);
          }};
}

}  // namespace beampipe
