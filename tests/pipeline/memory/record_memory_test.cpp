// Records in memory, and a pool that the whole frame shares.
#include "pipeline/memory/record_memory.h"

#include "pipeline/units/frame_pool.h"
#include "tests/pipeline/test_pictures.h"

namespace beampipe::record_memory_test {

// A line of 256 bytes has 14 chunks of 18 bytes. Lines start out cleared, and one that is written goes back as a whole.
TEST(RecordMemory, RecordsTakeTheChunksThatWereGivenBack) {
  const MemoryParameters parameters;
  const MemorySystem system{parameters};  // which it refers to
  RecordMemory memory(system, "records", 3, {26, 18});
  StageCounters counters;
  std::uint32_t key = 0;
  memory.access({++key, 0, 14, true}, counters);  // the first line: eight sectors
  memory.access({++key, 1, 14, true}, counters);  // the second one
  memory.access({++key, 1, 14, false}, counters);
  memory.access({++key, 0, 0, true}, counters);   // fourteen are free again: the last one's link is written
  memory.access({++key, 2, 14, true}, counters);  // and they are taken
  memory.flush(counters);
  EXPECT_EQ(counters.sector_bytes, (8u + 8 + 8 + 1 + 8) * 32);
  EXPECT_EQ(counters.dram_bytes, 2u * 256) << "two lines have been in use";
  std::vector<float> bytes(3);
  memory.add_bytes(bytes);
  EXPECT_EQ(bytes, (std::vector<float>{14 * 18, 2 * 14 * 18, 14 * 18}));
}

// A pool of four chunks, of which one is guaranteed to each of two pixels.
TEST(FramePool, IsFullWhenItHasTooFewChunks) {
  const auto full_at = [](const std::vector<std::vector<PoolClaim>>& of_bins) {
    FramePool pool(2, 2 * (kChunkBytes + kFrameChunkLinkBytes), 1);
    for (const std::vector<PoolClaim>& claims : of_bins) pool.add(claims);
    return pool.full_at();
  };
  EXPECT_EQ(full_at({}), ~0u);
  EXPECT_EQ(full_at({{{5, 2}}}), ~0u);
  EXPECT_EQ(full_at({{{5, 2}, {9, 1}}}), 9u);
  EXPECT_EQ(full_at({{{5, 1}, {9, 1}}, {{7, 1}}}), 9u) << "whichever bin comes first";
  EXPECT_EQ(full_at({{{7, 1}}, {{5, 1}, {9, 1}}}), 9u);
  EXPECT_EQ(full_at({{{5, 2}, {6, -1}, {7, 1}}}), ~0u);
  // A triangle takes before it gives, in one bin or in several, and in whatever order it visits its pixels.
  EXPECT_EQ(full_at({{{5, 2}, {6, -1}, {6, 1}}}), 6u);
  EXPECT_EQ(full_at({{{5, 1}, {6, -1}, {6, 1}}, {{5, 1}}}), 6u);
  EXPECT_EQ(full_at({{{5, 1}, {6, -1}}, {{5, 1}, {6, 1}}}), 6u);
  EXPECT_EQ(full_at({{{5, 1}, {6, 1}, {6, -1}}, {{5, 1}}}), 6u);
}

// Numbers of chunks have 24 bits. Of three chunks a pixel, 2560 x 1440 pixels leave 2^24 - 11,059,200 = 5,718,016; 2^24
// / 3 = 5,592,405 pixels have no more than those.
TEST(FramePool, HasNoMoreChunksThanNumbersCanName) {
  const auto full_at = [](std::int32_t chunks) {
    FramePool pool(2560 * 1440, 90, 3);
    pool.add({{5, chunks}});
    return pool.full_at();
  };
  EXPECT_EQ(full_at(5'718'016), ~0u);
  EXPECT_EQ(full_at(5'718'017), 5u);
  EXPECT_NO_THROW(FramePool(5'592'405, 90, 3));
  EXPECT_THROW(FramePool(5'592'406, 90, 3), std::runtime_error);
}

// Every pixel is full of triangles that are smaller than it. With the pool closed, the picture is what fewer surfaces a
// pixel make of it: no pixel is left out, and the mean colour is that of the triangles.
TEST(FramePool, AFullPoolIsClosed) {
  constexpr int kSide = 12;
  const Trace trace = parts_of_pixels(kSide, 4, 31);
  const FrameResult result = render("beam:order=stream", trace);
  const auto pixels = static_cast<double>(kSide * kSide);
  EXPECT_LE(sum_of(result, "record_bytes"), 90 * pixels);
  EXPECT_GT(sum_of(result, "record_bytes"), 80 * pixels);
  EXPECT_GT(sum_of(result, "merges"), 20 * pixels) << "32 triangles a pixel";
  EXPECT_GT(sum_of(result, "refusals"), 10 * pixels);
  EXPECT_LT(sum_of(result, "refusals"), 30 * pixels);
  EXPECT_EQ(sum_of(result, "lost_specks"), 0) << "there are none";
  EXPECT_LT(rmse(result.image, picture("reference", trace)), 0.05);
  for (std::size_t i = 3; i < result.image.rgba.size(); i += 4) ASSERT_EQ(result.image.rgba[i], 1.0f);
  // The order of bins and threads does not matter, nor does it which pixels are asked for.
  FrameInput other;
  other.threads = 2, other.tile_size = 4;
  EXPECT_EQ(parse_technique("beam:order=stream").render(trace, 0, other).image.rgba, result.image.rgba);
  const std::vector<PixelAddress> corner{{0, 0}};
  other.pixels = &corner;
  const FrameResult part = parse_technique("beam:order=stream").render(trace, 0, other);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(part.image.rgba[c], result.image.rgba[c]);
}

// What holds for a bin is the same in each of its pixels.
TEST(PooledPixels, CountersOfBins) {
  const Trace trace = random_trace(64, 32, 6000, 3);
  const FrameResult result = render("beam:pool=16", trace);
  for (const char* name : {"collections", "pool_bytes"}) {
    const std::vector<float>& values = result.pixel_counters.at(name);
    for (std::size_t i = 0; i < values.size(); ++i) {
      ASSERT_GT(values[i], 0) << name;
      ASSERT_EQ(values[i], values[i % 64 / 32 * 32]) << name;
    }
    EXPECT_NE(values[0], values[32]) << name;
  }
  const std::vector<float>& records = result.pixel_counters.at("record_bytes");
  EXPECT_GE(result.pixel_counters.at("pool_bytes")[0] * 1024, *std::max_element(records.begin(), records.end()));
}

// L2 has 2 KiB, which hold a part of the records that do not fit into the pool. The others move to and from DRAM, under
// a name of their own. Pictures stay what they are.
TEST(PooledPixels, SpilledRecords) {
  const Trace trace = random_trace(32, 32, 3000, 3);
  MemoryParameters small;
  small.l2 = {2048, 16, 128};
  const FrameResult result = render_with("beam:pool=16", trace, small), large = render("beam:pool=16", trace);
  EXPECT_EQ(result.image.rgba, large.image.rgba);
  const auto spilled = [](const FrameResult& of) {
    const auto found = std::ranges::find(of.buffers, kSpilledRecords, &Buffer::name);
    return found == of.buffers.end() ? 0.0 : static_cast<double>(found->peak_bytes);
  };
  const auto moved = [](const FrameResult& of) {
    ArrayBytes bytes;
    for (const ArrayBytes& each : of.dram_arrays)
      if (each.array == kSpilledRecords) bytes.read += each.read, bytes.written += each.written;
    return bytes;
  };
  // A chunk of the pool has 18 bytes, one in memory a sector of 32. Chunks in memory have their peak at some time, and
  // all chunks.
  const double held = spilled(result), all = result.pixel_counters.at("pool_bytes")[0] * 1024 / 18;
  EXPECT_EQ(spilled(large), held);
  EXPECT_GE(held / 32, all - 1024 * 16 / 18);
  EXPECT_LE(held / 32, all);
  EXPECT_EQ(moved(large).read + moved(large).written, 0u) << "L2 holds them";
  const ArrayBytes bytes = moved(result);
  EXPECT_NEAR(static_cast<double>(bytes.read + bytes.written), sum_of(result, "memory_chunks") * 32 * (1 - 2048 / held),
              2 * 32);
  EXPECT_GT(bytes.written, 0u);
  EXPECT_GT(bytes.read, bytes.written) << "what is written is read again, and collections only read";
  for (const ArrayBytes& each : result.dram_arrays) EXPECT_NE(each.array, "compose");
  // With room for all, there is no such buffer.
  EXPECT_EQ(spilled(render("beam:pool=128", random_trace(32, 32, 20, 3))), 0);
}

// One pixel, whose pool of 16 bytes has no chunk, and all of it in memory: two halves, and a surface behind them. Words
// of 6 bytes are read and written for three fragments. Two collections read the word, and write it, because each finds
// a half that is final. The records' chunks with their links of 18 bytes: three are written; a collection reads them to
// look and to retire, and writes three; the second half reads these and writes four; a collection reads them twice, and
// gives them back.
TEST(PooledPixels, CollectionsInMemoryWriteBack) {
  const Trace trace = pixel_trace(1, 1,
                                  {{{{0.5, -30, 0.1}, {0.5, 30, 0.1}, {-30, 0, 0.1}}, glm::vec3(1)},
                                   {{{0.5, -30, 0.2}, {0.5, 30, 0.2}, {30, 0, 0.2}}, glm::vec3(1)},
                                   {{{-30, -30, 0.9}, {60, -30, 0.9}, {-30, 60, 0.9}}, glm::vec3(1)}});
  MemoryParameters memory;
  memory.framebuffer = Place::in_memory;
  const FrameResult result = render_with("beam:pool=16", trace, memory);
  EXPECT_EQ(sum_of(result, "collections"), 2);
  EXPECT_EQ(sum_of(result, "bytes"), 6 * (3 * 2 + 2 + 2) + 18 * (3 + (3 + 3 + 3) + (3 + 4) + (4 + 4)));
}

}  // namespace beampipe::record_memory_test
