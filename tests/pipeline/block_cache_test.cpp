// The modelled cache, byte by byte.
#include "pipeline/memory/block_cache.h"

#include "pipeline/memory/linear_memory.h"
#include "pipeline/memory/tile_surface.h"
#include "tests/test.h"

namespace beampipe::block_cache_test {

// Two sets of two ways, with lines of 128 bytes, which are 4 sectors.
constexpr CacheParameters kSmall{512, 2, 128};

MemoryParameters memory() { return {}; }

struct Bytes {
  std::uint64_t sector, dram;
  bool operator==(const Bytes&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Bytes& bytes) {
  return out << bytes.sector << " in sectors, " << bytes.dram << " of DRAM";
}

// Tells how much the counters have grown since the last call.
class Meter {
 public:
  StageCounters counters;
  Bytes since() {
    const Bytes gained{counters.sector_bytes - last_.sector, counters.dram_bytes - last_.dram};
    last_ = {counters.sector_bytes, counters.dram_bytes};
    return gained;
  }

 private:
  Bytes last_{0, 0};
};

TEST(BlockCache, FetchesTheSectorsThatAreRead) {
  BlockCache cache(memory(), kSmall, BlockCache::Level::rop, {.count = 8, .bytes = 128});
  Meter meter;
  cache.read(1, 0, 40, 4, meter.counters);   // sector 1
  cache.read(1, 0, 60, 8, meter.counters);   // sectors 1 and 2, of the same request
  cache.read(2, 0, 64, 32, meter.counters);  // another request for sector 2, which is in the cache
  cache.read(2, 1, 0, 128, meter.counters);  // another block
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{2 * 32 + 32 + 128, 2 * 32 + 128}));
}

TEST(BlockCache, WritesBackWhatIsDirtyOnce) {
  BlockCache cache(memory(), kSmall, BlockCache::Level::rop, {.count = 8, .bytes = 128});
  Meter meter;
  cache.write(1, 0, 0, 32, meter.counters);  // a whole sector
  cache.write(2, 0, 0, 32, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{64, 32}));
  cache.write(3, 0, 8, 16, meter.counters);  // part of a sector, which is fetched first
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 64}));
  cache.write(4, 0, 0, 20, meter.counters);  // a whole sector, in two pieces of one request
  cache.write(4, 0, 20, 12, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 32}));
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{0, 0})) << "there is nothing left";
}

TEST(BlockCache, ClearedBlocksAreNotFetchedAndGoBackWhole) {
  BlockCache cache(memory(), kSmall, BlockCache::Level::rop, {.count = 8, .bytes = 128, .cleared = true});
  Meter meter;
  cache.read(1, 0, 0, 128, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 0}));
  cache.stream_read(0, meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 0}));
  cache.write(1, 0, 4, 4, meter.counters);  // memory does not know yet that the rest of the block is cleared
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 128}));
  cache.stream_read(0, meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 128}));
}

TEST(BlockCache, CompressedBlocksMoveTheirCompressedSize) {
  std::uint32_t size = 33;
  BlockCache cache(memory(), kSmall, BlockCache::Level::rop,
                   {.count = 8, .bytes = 128, .cleared = true, .compressed_bytes = [&](std::size_t) { return size; }});
  Meter meter;
  cache.write(1, 0, 0, 4, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 64})) << "33 bytes in two sectors";
  cache.read(2, 0, 0, 4, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 64})) << "fetched whole, and clean";
  cache.stream_read(0, meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 64}));
  size = 128;  // compression gains nothing, so the block is stored raw
  cache.write(3, 0, 0, 4, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 64 + 128}));
  size = 1;  // a line with only one sector in the cache cannot be compressed
  cache.write(4, 0, 0, 32, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 32}));
}

TEST(BlockCache, CompressionAndModelCanBeSwitchedOff) {
  MemoryParameters parameters;
  parameters.compression = false;
  Meter meter;
  BlockCache raw(parameters, kSmall, BlockCache::Level::rop,
                 {.count = 8, .bytes = 128, .cleared = true, .compressed_bytes = [](std::size_t) { return 1u; }});
  raw.write(1, 0, 0, 128, meter.counters);
  raw.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 128}));
  parameters.modelled = false;
  BlockCache none(parameters, kSmall, BlockCache::Level::rop, {.count = 8, .bytes = 128, .cleared = true});
  none.write(1, 0, 0, 128, meter.counters);
  none.flush(meter.counters);
  none.stream_read(0, meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{0, 0}));
}

// Requests that a ROP cache can answer do not count as L2 bytes. All requests to an L2 do.
TEST(BlockCache, L2IsAskedForWhatTheCacheBeforeItLacksOrEvicts) {
  for (const BlockCache::Level level : {BlockCache::Level::rop, BlockCache::Level::l2}) {
    BlockCache cache(memory(), kSmall, level, {.count = 8, .bytes = 128});
    StageCounters counters;
    for (const std::uint32_t triangle : {1, 2, 3}) {
      cache.read(triangle, 0, 0, 32, counters);
      cache.write(triangle, 0, 0, 32, counters);
    }
    cache.flush(counters);
    EXPECT_EQ(counters.sector_bytes, 3u * 64);
    EXPECT_EQ(counters.l2_bytes, level == BlockCache::Level::rop ? 64u : 3u * 64);
    EXPECT_EQ(counters.dram_bytes, 64u) << "fetched once, written back once";
    cache.stream_read(1, counters);
    EXPECT_EQ(counters.l2_bytes, (level == BlockCache::Level::rop ? 64u : 3u * 64) + 128);
  }
}

TEST(BlockCache, ReadingThroughAnL1) {
  constexpr CacheParameters one_line{128, 1, 128};
  BlockCache l2(memory(), kSmall, BlockCache::Level::l2, {.count = 8, .bytes = 128});
  BlockCache l1(memory(), one_line, l2);
  StageCounters counters;
  const auto read = [&](std::uint32_t key, std::size_t block, std::uint32_t first, std::uint32_t bytes) {
    l1.read(key, block, first, bytes, counters);
  };
  read(1, 0, 0, 64);   // in neither cache
  read(2, 0, 32, 64);  // L1 has one of the two sectors
  read(3, 1, 0, 32);   // evicts block 0 from L1
  read(4, 0, 0, 96);   // block 0 is still in L2
  l1.flush(counters);
  l2.flush(counters);
  EXPECT_EQ(counters.sector_bytes, 64u + 64 + 32 + 96);
  EXPECT_EQ(counters.l2_bytes, 64u + 32 + 32 + 96);
  EXPECT_EQ(counters.dram_bytes, 64u + 32 + 32);
}

// Three fetches of bytes that lie in two lines: an L1 of two lines misses once, an L1 of one line each time.
TEST(LinearMemory, FetchesAtOnceAreFetchesOneByOne) {
  for (const std::uint32_t lines : {1, 2}) {
    MemorySystem system;
    system.l1 = {lines * 128, lines, 128};
    StageCounters at_once, one_by_one;
    LinearMemory(system, 1024).fetch(100, 61, 3, at_once);  // sector 3 of the first line, 0 and 1 of the second
    LinearMemory memory(system, 1024);
    for (int i = 0; i < 3; ++i) memory.fetch(100, 61, 1, one_by_one);
    for (const StageCounters& counters : {at_once, one_by_one}) {
      EXPECT_EQ(counters.sector_bytes, 3u * 96);
      EXPECT_EQ(counters.l2_bytes, lines == 1 ? 3u * 96 : 96u);
      EXPECT_EQ(counters.dram_bytes, 96u);
    }
  }
}

TEST(TileSurface, PartsOfAnElement) {
  const ZOrder order(2, 2);
  TileSurface surface(memory(), "surface", order, {.parts = 16, .part_bytes = 6});  // 96 bytes, 2 to a block of 192
  StageCounters counters;
  surface.access(1, 1, 1u << 15, 1u << 4 | 1u << 5, counters);  // bytes 186 to 191; 120 to 131: sectors 5; 3 and 4
  surface.access(1, 0, 0, 0x8001, counters);                    // bytes 0 to 5 and 90 to 95: sectors 0 and 2
  surface.flush(counters);
  EXPECT_EQ(counters.sector_bytes, 5u * 32);
  EXPECT_EQ(counters.dram_bytes, 192u);
  EXPECT_EQ(surface.touched_bytes(0), 12u);
  EXPECT_EQ(surface.touched_bytes(1), 18u);
  EXPECT_EQ(surface.touched_bytes(2), 0u);
}

TEST(TileSurface, AQuadOfPixelsIsOneSector) {
  const ZOrder order(4, 4);
  EXPECT_EQ(order.of[1], 1u);
  EXPECT_EQ(order.of[4], 2u);  // below the first
  EXPECT_EQ(order.of[5], 3u);
  EXPECT_EQ(order.of[2], 4u);
  EXPECT_EQ(order.positions, 16u);
  TileSurface surface(memory(), "surface", order, {.part_bytes = 8});
  Meter meter;
  for (const std::uint32_t pixel : {0, 1, 4, 5}) surface.write(7, pixel, meter.counters);
  surface.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 256})) << "4 x 8 bytes, and the cleared rest of a block of 32 pixels";
  surface.read_all(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{256, 256}));
}

TEST(TileSurface, BinsAtTheBorderOfTheFrame) {
  const ZOrder order(5, 1);  // positions 0, 1, 4, 5, 16
  EXPECT_EQ(order.positions, 17u);
  TileSurface surface(memory(), "surface", order, {.part_bytes = 64});  // 4 to a block
  Meter meter;
  for (std::uint32_t pixel = 0; pixel < 5; ++pixel) surface.write(0, pixel, meter.counters);
  surface.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{5 * 64, 3 * 256}));
  surface.read_all(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{3 * 256, 3 * 256}));
}

}  // namespace beampipe::block_cache_test
