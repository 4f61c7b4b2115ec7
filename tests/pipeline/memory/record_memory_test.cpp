// Records in memory, and a pool that the whole frame shares.
#include "pipeline/memory/record_memory.h"

#include "pipeline/technique.h"
#include "pipeline/units/frame_pool.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/pipeline/test_traces.h"
#include "tests/test.h"

namespace beampipe::record_memory_test {

// A line of 256 bytes has 14 chunks of 18 bytes. Lines start out cleared, and one that is written goes back as a whole.
TEST(RecordMemory, RecordsTakeTheChunksThatWereGivenBack) {
  const MemoryParameters parameters;
  RecordMemory memory({parameters}, "records", 3, {26, 18});
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

// Numbers of chunks have 23 bits. Of two chunks a pixel, 1920 x 1080 pixels leave 2^23 - 4,147,200 = 4,241,408; twice
// as many pixels would need more than there are.
TEST(FramePool, HasNoMoreChunksThanNumbersCanName) {
  const auto full_at = [](std::int32_t chunks) {
    FramePool pool(1920 * 1080, 90, 2);
    pool.add({{5, chunks}});
    return pool.full_at();
  };
  EXPECT_EQ(full_at(4'241'408), ~0u);
  EXPECT_EQ(full_at(4'241'409), 5u);
  EXPECT_NO_THROW(FramePool(1u << 22, 90, 2));
  EXPECT_THROW(FramePool((1u << 22) + 1, 90, 2), std::runtime_error);
}

// Every pixel is full of triangles that are smaller than it. With the pool closed, the picture is what fewer surfaces a
// pixel make of it: no pixel is left out, and the mean colour is that of the triangles.
TEST(FramePool, AFullPoolIsClosed) {
  RandomNumbers random(31);
  std::vector<PixelSpaceTriangle> triangles;
  constexpr int kSide = 12, kParts = 4;  // pixels, parts of a pixel
  for (int y = 0; y < kSide * kParts; ++y)
    for (int x = 0; x < kSide * kParts; ++x)
      append(triangles,
             quad(x / 4.0, y / 4.0, (x + 1) / 4.0, (y + 1) / 4.0, 0.5, random.vector(glm::dvec3(0), glm::dvec3(1))));
  const Trace trace = pixel_trace(kSide, kSide, triangles);
  const FrameResult result = render("beam:order=stream", trace);
  const auto pixels = static_cast<double>(kSide * kSide);
  EXPECT_LE(sum_of(result, "record_bytes"), 90 * pixels);
  EXPECT_GT(sum_of(result, "record_bytes"), 80 * pixels);
  EXPECT_GT(sum_of(result, "merges"), 20 * pixels) << "32 triangles a pixel";
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

}  // namespace beampipe::record_memory_test
