// Records when each stage ran, on which thread and in which tile. It is for viewers and part of no result.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/tile.h"

namespace beampipe {

class Timeline {
 public:
  using Clock = std::chrono::steady_clock;

  struct Event {
    std::string name;  // of a stage, or of a whole frame
    std::thread::id thread;
    std::optional<std::pair<std::int32_t, std::int32_t>>
        tile;  // its first pixel; none when the stage works on the whole frame
    Clock::time_point start, end;
  };

  // May be called from any thread.
  void add(Event event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
  }

  // Call it when no thread adds any more.
  const std::vector<Event>& events() const { return events_; }

 private:
  std::mutex mutex_;
  std::vector<Event> events_;
};

// Takes the place of a stage's counters in the call of the stage, and records how long that call took:
//   const StageTimer timed(sinks.timeline, tile);
//   conservative_raster(triangles, list, tile, timed(raster), pairs);
class StageTimer {
 public:
  // Lives until the end of the full expression, which is the call of the stage.
  class Span {
   public:
    Span(Timeline* timeline, const Tile* tile, StageCounters& counters)
        : timeline_(timeline), tile_(tile), counters_(counters) {
      if (timeline_) start_ = Timeline::Clock::now();
    }
    ~Span() {
      if (!timeline_) return;
      Timeline::Event event{
          std::string(name_of(counters_.stage)), std::this_thread::get_id(), {}, start_, Timeline::Clock::now()};
      if (tile_) event.tile = {tile_->x0, tile_->y0};
      timeline_->add(std::move(event));
    }
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;

    operator StageCounters&() const { return counters_; }

   private:
    Timeline* timeline_;
    const Tile* tile_;
    StageCounters& counters_;
    Timeline::Clock::time_point start_;
  };

  // A null `timeline` records nothing. The tile must outlive the timer.
  explicit StageTimer(Timeline* timeline) : timeline_(timeline) {}
  StageTimer(Timeline* timeline, const Tile& tile) : timeline_(timeline), tile_(&tile) {}

  Span operator()(StageCounters& counters) const { return {timeline_, tile_, counters}; }

 private:
  Timeline* timeline_;
  const Tile* tile_ = nullptr;
};

}  // namespace beampipe
