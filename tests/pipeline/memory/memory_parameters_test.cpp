// What the parameters of the memory system change, and what they leave as it is.

#include "pipeline/memory/block_cache.h"
#include "tests/pipeline/surface_traces.h"
#include "tests/pipeline/test_pictures.h"

namespace beampipe::memory_parameters_test {

std::uint64_t dram_bytes(const FrameResult& result) {
  std::uint64_t bytes = 0;
  for (const StageCounters& stage : result.stages) bytes += stage.dram_bytes;
  return bytes;
}

// Bins of `beam` are part of its algorithm, so its picture changes with them too.
TEST(MemoryParameters, SmallerBinsAreThoseOfTheSpec) {
  const Trace trace = random_trace(70, 50, 90, 3);
  MemoryParameters memory;
  memory.bin_pixels = 16;
  expect_same(render_with("beam", trace, memory), render_with("beam:bin=16", trace, {}), "bin=16");
  expect_same(render_with("beam:bin=8", trace, memory), render_with("beam:bin=8", trace, {}), "bin=8");
  EXPECT_EQ(render_with("msaa:8", trace, memory).bin_pixels, 16u * 16);
  EXPECT_EQ(render_with("msaa:8", trace, memory).image.rgba, render_with("msaa:8", trace, {}).image.rgba);
}

// One pixel of 4 bytes, in the first of two sectors: read and written back whole.
TEST(MemoryParameters, SectorsMoveWhole) {
  for (const std::uint32_t sector : {32u, 64u, 128u}) {
    MemoryParameters memory;
    memory.sector_bytes = sector;
    BlockCache cache(memory, {1024, 2, 256}, BlockCache::Level::rop, {.count = 4, .bytes = 256});
    StageCounters counters;
    cache.write(1, 2, 8, 4, counters);
    cache.flush(counters);
    EXPECT_EQ(counters.sector_bytes, sector);
    EXPECT_EQ(counters.dram_bytes, 2 * sector) << "fetched, because it was written in part, and written back";
    cache.read(1, 2, 30, 4, counters);
    cache.finish_request();
    EXPECT_EQ(counters.sector_bytes, sector + (sector == 32 ? 64 : sector)) << "bytes 30 to 33";
  }
}

// All frames' traffic is in whole sectors, whatever they and the lines are.
TEST(MemoryParameters, EverySectorAndLineSizeCounts) {
  const Trace trace = random_surfaces(64, 64, 60, 5);
  const FrameResult smallest = render_with("msaa:4", trace, {});
  for (const std::uint32_t sector : {32u, 64u, 128u}) {
    for (std::uint32_t line = sector; line <= std::min(8 * sector, 1024u); line *= 2) {
      MemoryParameters memory;
      memory.sector_bytes = sector;
      memory.l1.line_bytes = memory.l2.line_bytes = line;
      memory.l1.ways = memory.l2.ways = 4;
      const FrameResult result = render_with("msaa:4", trace, memory);
      EXPECT_EQ(result.image.rgba, smallest.image.rgba);
      for (const StageCounters& stage : result.stages)
        for (const std::uint64_t bytes : {std::uint64_t{stage.sector_bytes}, std::uint64_t{stage.l2_bytes},
                                          std::uint64_t{stage.dram_bytes}, std::uint64_t{stage.texture_dram_bytes}})
          EXPECT_EQ(bytes % sector, 0u) << stage.stage << ", " << sector << ", " << line;
      const StageCounters& shade = stage_of(result, "shade");
      const StageCounters& shade_32 = stage_of(smallest, "shade");
      EXPECT_EQ(shade.texture_bytes, shade_32.texture_bytes);
      EXPECT_GE(shade.texture_dram_bytes, shade_32.texture_dram_bytes);
      EXPECT_LE(shade.texture_dram_bytes, shade_32.texture_dram_bytes * sector / 32);
      if (sector == 32) {
        EXPECT_EQ(shade.texture_dram_bytes, shade_32.texture_dram_bytes) << "every sector once";
      }
    }
  }
}

// What lets a sweep render once for several caches. Smaller ones change traffic alone.
TEST(MemoryParameters, CachesThatHoldAllMoveTheSameBytes) {
  const std::vector<const char*> specs = {"beam", "beam:order=sorted", "beam:order=stream", "msaa:8", "acaa:8", "z3"};
  for (const Trace& trace : {random_trace(64, 64, 300, 7), random_surfaces(64, 64, 300, 8)}) {
    for (const char* spec : specs) {
      MemoryParameters large;
      large.l1 = {1 << 22, 8, 128}, large.l2 = {1 << 24, 8, 128}, large.rop = {1 << 24, 2, 256};
      const FrameResult most = render_with(spec, trace, large);
      const auto holding = [](CacheParameters cache, std::uint64_t bytes) {
        const std::uint64_t set = cache.ways * cache.line_bytes;
        cache.bytes = static_cast<std::uint32_t>((std::max<std::uint64_t>(bytes, 1) + set - 1) / set * set);
        return cache;
      };
      MemoryParameters enough;
      enough.l1 = holding({0, 3, 128}, most.cache_reach.l1);
      enough.l2 = holding({0, 5, 128}, most.cache_reach.l2);
      enough.rop = holding({0, 7, 256}, most.cache_reach.rop);
      const FrameResult least = render_with(spec, trace, enough);
      expect_same(least, most, spec);
      EXPECT_EQ(least.cache_reach, most.cache_reach) << spec;
      MemoryParameters tiny;
      tiny.l1 = {128, 1, 128}, tiny.l2 = {256, 2, 128}, tiny.rop = {256, 1, 256};
      const FrameResult thrashing = render_with(spec, trace, tiny);
      EXPECT_EQ(thrashing.cache_reach, most.cache_reach) << spec << ": it is the same, whatever the caches hold";
      EXPECT_EQ(thrashing.image.rgba, most.image.rgba) << spec;
      EXPECT_GT(dram_bytes(thrashing), dram_bytes(most)) << spec;
      for (std::size_t i = 0; i < most.stages.size(); ++i) {
        EXPECT_EQ(thrashing.stages[i].logical_bytes(), most.stages[i].logical_bytes()) << spec;
        EXPECT_EQ(thrashing.stages[i].ops, most.stages[i].ops) << spec;
        if (most.stages[i].stage == StageId::bin_sort) continue;  // its lists go through DRAM where L2 is too small
        EXPECT_EQ(thrashing.stages[i].sector_bytes, most.stages[i].sector_bytes) << spec;
      }
    }
  }
}

}  // namespace beampipe::memory_parameters_test
