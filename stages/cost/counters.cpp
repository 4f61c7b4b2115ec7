#include "stages/cost/counters.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>

namespace beampipe {
namespace {

using Ops = OperationCounts;
using namespace counter_group;

constexpr CounterInfo field(CounterGroups group, const char* name, const char* title, const char* unit,
                            const char* meaning, std::uint64_t StageCounters::*counter) {
  return {.name = name, .title = title, .unit = unit, .meaning = meaning, .group = group, .field = counter};
}

constexpr CounterInfo operation(CounterGroups group, const char* name, const char* title, const char* meaning,
                                std::uint64_t Ops::*kind) {
  return {.name = name, .title = title, .unit = "operations", .meaning = meaning, .group = group, .operation = kind};
}

constexpr CounterInfo sum(const char* name, const char* title, const char* unit, const char* meaning,
                          std::uint64_t (*value)(const StageCounters&)) {
  return {.name = name, .title = title, .unit = unit, .meaning = meaning, .group = items, .sum = value};
}

constexpr CounterInfo kCounters[] = {
    field(items, "items_in", "items in", "items", "items that enter the stage", &StageCounters::items_in),
    field(items, "items_out", "items out", "items", "items that leave the stage", &StageCounters::items_out),
    sum("ops.total", "operations", "operations", "operations of all kinds",
        [](const StageCounters& stage) { return stage.ops.total(); }),
    operation(mul_add, "ops.mul_add", "mul-add",
              "multiplications; the addition of a multiply-add counts as an `ops.add`", &Ops::mul_add),
    operation(add, "ops.add", "add", "additions, subtractions, comparisons, minima, maxima and selections", &Ops::add),
    operation(bit, "ops.bit", "bit", "bitwise operations, shifts, absolute values and population counts", &Ops::bit),
    operation(fetch, "ops.fetch", "fetch", "table look-ups", &Ops::fetch),
    operation(special, "ops.special", "special", "divisions, remainders, square roots and arc tangents", &Ops::special),
    operation(convert, "ops.convert", "convert",
              "conversions between integers and floats, and between float32 and fp16 or normalized formats",
              &Ops::convert),
    operation(wide, "ops.wide", "64-bit", "the operations of all kinds that have integers of 64 bits", &Ops::wide),
    field(reads, "bytes_read", "read", "bytes",
          "logical bytes that the stage reads, counted at every read; queues between stages are included",
          &StageCounters::bytes_read),
    field(writes, "bytes_written", "written", "bytes", "logical bytes that the stage writes",
          &StageCounters::bytes_written),
    sum("logical_bytes", "logical", "bytes", "bytes_read + bytes_written",
        [](const StageCounters& stage) { return stage.logical_bytes(); }),
    field(sectors, "sector_bytes", "sectors", "bytes",
          "bytes that the stage requests from the memory system to read or write, in whole sectors (of 32 bytes by "
          "default); a queue that stays on chip requests nothing",
          &StageCounters::sector_bytes),
    field(outer_memory, "l2_bytes", "L2", "bytes",
          "bytes requested from L2, in whole sectors: what the ROP caches and L1 miss, write back or write through",
          &StageCounters::l2_bytes),
    field(outer_memory, "dram_bytes", "DRAM", "bytes",
          "bytes that move between the modelled caches and DRAM because of the stage, in either direction",
          &StageCounters::dram_bytes),
    field(texels, "texture_bytes", "texels", "bytes", "the part of bytes_read that is texels, counted at every read",
          &StageCounters::texture_bytes),
    field(texels, "texture_sector_bytes", "texel sectors", "bytes", "the part of sector_bytes that is texels",
          &StageCounters::texture_sector_bytes),
    field(texels, "texture_l2_bytes", "texel L2", "bytes", "the part of l2_bytes that is texels",
          &StageCounters::texture_l2_bytes),
    field(texels, "texture_dram_bytes", "texel DRAM", "bytes", "the part of dram_bytes that is texels",
          &StageCounters::texture_dram_bytes),
    field(positions, "position_tests", "position tests", "positions",
          "positions of masks that are tested against an edge, counted for each edge, or at which depths are "
          "compared; a look-up in the table of masks counts as 32",
          &StageCounters::position_tests),
    field(lanes, "lanes_used", "lanes used", "lanes", "lanes that have work", &StageCounters::lanes_used),
    field(lanes, "lanes_issued", "lanes issued", "lanes", "lanes that run, whether they have work or not",
          &StageCounters::lanes_issued),
    field(hidden, "hidden_items", "hidden", "items",
          "pairs (cells, in techniques that test samples) that a triangle touches and that are left out because "
          "another triangle in front covers the whole pixel (cell)",
          &StageCounters::hidden_items),
    field(hidden, "hidden_triangles", "hidden triangles", "triangles",
          "triangles left out of a tile because other triangles in front cover each of its pixels (cells) completely; "
          "counted once per tile and pass",
          &StageCounters::hidden_triangles),
    field(empties, "empty_tiles", "empty tiles", "tiles", "tiles that no triangle touches, counted in each pass",
          &StageCounters::empty_tiles),
};

constexpr auto kStored = std::count_if(std::begin(kCounters), std::end(kCounters),
                                       [](const CounterInfo& counter) { return counter.sum == nullptr; });
static_assert(sizeof(StageCounters) == alignof(std::uint64_t) + kStored * sizeof(std::uint64_t),
              "the table misses a counter");

}  // namespace

StageCounters& StageCounters::operator+=(const StageCounters& other) {
  if (stage.id != StageId::none && stage.id != other.stage.id)
    throw std::logic_error(std::string("counters of ").append(name_of(stage)) + " get those of " +
                           (other.stage.id == StageId::none ? "no stage" : std::string(name_of(other.stage))));
  for (const CounterInfo& counter : kCounters)
    if (std::uint64_t* const stored = counter.stored(*this)) *stored += counter.value(other);
  return *this;
}

std::span<const CounterInfo> stage_counters() { return kCounters; }

}  // namespace beampipe
