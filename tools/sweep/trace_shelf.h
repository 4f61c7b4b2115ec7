// The traces of a sweep, in the sizes that it asks for.
#pragma once

#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "stages/surface/texture_set.h"
#include "tools/sweep/sweep_plan.h"
#include "traces/trace.h"

namespace beampipe {

// What a sweep must know of a trace before it renders it.
struct TraceInfo {
  std::string digest;
  PictureSize size;                  // of the first frame
  std::vector<std::size_t> frames;   // those that are rendered
  std::uint64_t bytes = 0;           // an estimate of what the trace takes in memory
  std::vector<std::uint64_t> needs;  // by technique of the plan: an estimate of the bytes that rendering a frame takes
};

// A trace and its textures, while jobs render it.
struct LoadedTrace {
  Trace trace;
  std::unique_ptr<const TextureSet> textures;
};

class TraceShelf {
 public:
  // The plan must outlive it. `allow_outside`: as in ReadOptions.
  TraceShelf(const SweepPlan& plan, bool allow_outside) : plan_(plan), allow_outside_(allow_outside) {}

  // Thread-safe. Both throw TraceError, and std::runtime_error, one line, if a frame cannot have the size or needs more
  // memory than the machine has.
  const TraceInfo& info(std::size_t trace, std::size_t size);
  std::shared_ptr<const LoadedTrace> load(std::size_t trace, std::size_t size);

 private:
  using Key = std::pair<std::size_t, std::size_t>;

  const SweepPlan& plan_;
  bool allow_outside_;
  // What is wrong with a trace in a size is known with all else, but an error only if somebody asks for it.
  struct Entry {
    TraceInfo info;
    std::exception_ptr error;
  };
  Entry look_at(Trace& trace, const PictureSize& size, const std::string& name) const;

  std::mutex mutex_;
  std::map<Key, Entry> entries_;
  std::map<Key, std::weak_ptr<const LoadedTrace>> loaded_;
  std::shared_ptr<const LoadedTrace> recent_;  // the next job is likely to want it too
};

}  // namespace beampipe
