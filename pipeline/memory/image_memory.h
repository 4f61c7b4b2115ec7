// What a pass over the frame writes or reads once, pixel by pixel.
#pragma once

#include "pipeline/memory/linear_memory.h"
#include "stages/data/tile.h"
#include "stages/temporal/motion.h"

namespace beampipe {

inline constexpr std::uint64_t kImagePixelBytes = 6;  // fp16 RGB

// The finished picture of a bin.
inline void write_image(const MemoryParameters& memory, const Tile& tile, StageCounters& counters) {
  stream(memory, tile.pixels() * kImagePixelBytes, counters);
}

// The pass of `temporal`: the frame's motion, the history if there is one, and the history to come. What neighbouring
// pixels share comes from cache.
inline void move_temporal(const MemoryParameters& memory, const Tile& tile, bool has_history, StageCounters& counters) {
  constexpr std::uint64_t kHistoryBytes = 8;  // fp16 RGBA
  stream(memory, tile.pixels() * kMotionBytes, counters);
  if (has_history) stream(memory, tile.pixels() * kHistoryBytes, counters);
  stream(memory, tile.pixels() * kHistoryBytes, counters);
}

}  // namespace beampipe
