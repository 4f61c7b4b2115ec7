// What it costs to read what pixels keep and to write their colours.
#pragma once

#include <cstdint>

#include "stages/cost/counters.h"
#include "stages/data/pixel_formats.h"

namespace beampipe {

// `items`: aggregates or samples; `item_bytes`: size of each; `cost`: per pixel.
inline void charge_resolve(std::uint64_t items, std::uint32_t item_bytes, std::uint64_t pixels,
                           const OperationCounts& cost, StageCounters& counters) {
  counters.items_in += items;
  counters.items_out += pixels;
  counters.ops += cost * pixels;
  counters.bytes_read += items * item_bytes;
  counters.bytes_written += pixels * kColorBytes;
  counters.lanes_used += items;
  counters.lanes_issued += items;
}

}  // namespace beampipe
