// The modelled cache, byte by byte.
#include "pipeline/memory/block_cache.h"

#include <gtest/gtest.h>

#include "pipeline/memory/tile_surface.h"

namespace beampipe {
namespace {

// Two sets of two ways, lines of 128 bytes: 4 sectors.
constexpr CacheParameters kSmall{512, 2, 128};

MemoryParameters memory() { return {}; }

struct Bytes {
  std::uint64_t sector, dram;
  bool operator==(const Bytes&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Bytes& bytes) {
  return out << bytes.sector << " in sectors, " << bytes.dram << " of DRAM";
}

// What the counters have gained since the last call.
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
  BlockCache cache(memory(), kSmall, 8, 128, false, nullptr);
  Meter meter;
  cache.read(1, 0, 40, 4, meter.counters);   // sector 1
  cache.read(1, 0, 60, 8, meter.counters);   // sectors 1 and 2, of the same request
  cache.read(2, 0, 64, 32, meter.counters);  // another request for sector 2, which is there
  cache.read(2, 1, 0, 128, meter.counters);  // another block
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{2 * 32 + 32 + 128, 2 * 32 + 128}));
}

TEST(BlockCache, WritesBackWhatIsDirtyOnce) {
  BlockCache cache(memory(), kSmall, 8, 128, false, nullptr);
  Meter meter;
  cache.write(1, 0, 0, 32, meter.counters);  // a whole sector
  cache.write(2, 0, 0, 32, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{64, 32}));
  cache.write(3, 0, 8, 16, meter.counters);  // part of one: fetched first
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 64}));
  cache.write(4, 0, 0, 20, meter.counters);  // whole in two pieces of one request
  cache.write(4, 0, 20, 12, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 32}));
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{0, 0})) << "there is nothing left";
}

TEST(BlockCache, TheLeastRecentlyUsedLineOfItsSetGoes) {
  BlockCache cache(memory(), kSmall, 8, 128, false, nullptr);
  Meter meter;
  for (const std::size_t block : {0, 2, 0, 4})
    cache.read(static_cast<std::uint32_t>(block), block, 0, 32, meter.counters);
  cache.read(9, 0, 0, 32, meter.counters);  // was used after 2: still there
  cache.read(9, 2, 0, 32, meter.counters);  // gone
  cache.read(9, 1, 0, 32, meter.counters);  // the other set
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{7 * 32, 5 * 32}));
}

TEST(BlockCache, ClearedBlocksAreNotFetchedAndGoBackWhole) {
  BlockCache cache(memory(), kSmall, 8, 128, true, nullptr);
  Meter meter;
  cache.read(1, 0, 0, 128, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 0}));
  cache.stream_read(0, meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 0}));
  cache.write(1, 0, 4, 4, meter.counters);  // the rest of the block is clear, and memory does not know it yet
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 128}));
  cache.stream_read(0, meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 128}));
}

TEST(BlockCache, CompressedBlocksMoveTheirCompressedSize) {
  std::uint32_t size = 33;
  BlockCache cache(memory(), kSmall, 8, 128, true, [&](std::size_t) { return size; });
  Meter meter;
  cache.write(1, 0, 0, 4, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 64})) << "33 bytes in two sectors";
  cache.read(2, 0, 0, 4, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 64})) << "fetched whole, and clean";
  cache.stream_read(0, meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 64}));
  size = 128;  // no gain: raw
  cache.write(3, 0, 0, 4, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 64 + 128}));
  size = 1;  // a line of which only one sector is there cannot be compressed
  cache.write(4, 0, 0, 32, meter.counters);
  cache.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{32, 32}));
}

TEST(BlockCache, CompressionAndModelCanBeSwitchedOff) {
  MemoryParameters parameters;
  parameters.compression = false;
  Meter meter;
  BlockCache raw(parameters, kSmall, 8, 128, true, [](std::size_t) { return 1u; });
  raw.write(1, 0, 0, 128, meter.counters);
  raw.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{128, 128}));
  parameters.modelled = false;
  BlockCache none(parameters, kSmall, 8, 128, true, nullptr);
  none.write(1, 0, 0, 128, meter.counters);
  none.flush(meter.counters);
  none.stream_read(0, meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{0, 0}));
}

TEST(TileSurface, AQuadOfPixelsIsOneSector) {
  const ZOrder order(4, 4);
  EXPECT_EQ(order.of[1], 1u);
  EXPECT_EQ(order.of[4], 2u);  // below the first
  EXPECT_EQ(order.of[5], 3u);
  EXPECT_EQ(order.of[2], 4u);
  EXPECT_EQ(order.positions, 16u);
  TileSurface surface(memory(), order, 8);
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
  TileSurface surface(memory(), order, 64);  // 4 to a block
  Meter meter;
  for (std::uint32_t pixel = 0; pixel < 5; ++pixel) surface.write(0, pixel, meter.counters);
  surface.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{5 * 64, 3 * 256}));
  surface.read_all(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{3 * 256, 3 * 256}));
}

TEST(TileSurface, ABatchOfTrianglesEndsWithEmptyCaches) {
  MemoryParameters parameters;
  parameters.triangles_per_batch = 10;
  const ZOrder order(2, 2);
  TileSurface surface(parameters, order, 8);
  Meter meter;
  for (const std::uint32_t triangle : {8, 9, 10}) surface.write(triangle, 0, meter.counters);
  surface.flush(meter.counters);
  EXPECT_EQ(meter.since(), (Bytes{3 * 32, 256 + 64})) << "the cleared block whole, then a sector fetched and written";
}

}  // namespace
}  // namespace beampipe
