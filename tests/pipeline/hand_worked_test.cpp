// Every byte of every stage for two traces, worked out by hand.

#include "pipeline/technique.h"
#include "tests/test.h"
#include "traces/files/trace_io.h"

namespace beampipe::hand_worked_test {

Trace read_sample(const char* name) {
  return read_trace(std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples" / name);
}

struct Bytes {
  const char* stage;
  std::uint64_t items_in, items_out, read, written, sectors, l2, dram;
};

void expect_bytes(const char* sample, const char* spec, const std::vector<Bytes>& expected, bool compression = true) {
  const Trace trace = read_sample(sample);
  FrameInput run{1};
  run.memory.compression = compression;
  const FrameResult result = parse_technique(spec).render(trace, 0, run);
  ASSERT_EQ(result.stages.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const StageCounters& found = result.stages[i];
    const Bytes& stage = expected[i];
    EXPECT_EQ(name_of(found.stage), stage.stage);
    EXPECT_EQ(found.items_in, stage.items_in) << stage.stage;
    EXPECT_EQ(found.items_out, stage.items_out) << stage.stage;
    EXPECT_EQ(found.bytes_read, stage.read) << stage.stage;
    EXPECT_EQ(found.bytes_written, stage.written) << stage.stage;
    EXPECT_EQ(found.sector_bytes, stage.sectors) << stage.stage;
    EXPECT_EQ(found.l2_bytes, stage.l2) << stage.stage;
    EXPECT_EQ(found.dram_bytes, stage.dram) << stage.stage;
  }
}

constexpr std::uint64_t kSetup = 116;  // bytes that the setup of a triangle passes on: 88, and 28 of attributes
constexpr std::uint64_t kTriangleSetup = 64 + 96 + 32;  // bytes in sectors: vertices read, setup and attributes written
constexpr std::uint64_t kTriangleRaster = 2 * 32 + 96;  // bytes in sectors: list written and read, setup read

TEST(HandWorked, TriangleMsaaWithAndWithoutCompression) {
  for (const bool compression : {true, false}) {
    SCOPED_TRACE(compression);
    const std::uint64_t tested = (compression ? 32 : 256) + 384;
    expect_bytes("paper_triangle.json", "msaa:1",
                 {{"vertex_setup", 1, 1, 48, kSetup, kTriangleSetup, kTriangleSetup, kTriangleSetup},
                  {"sample_raster", 1, 6, 88 + 13 * 4, 6 * 10, kTriangleRaster, kTriangleRaster, kTriangleRaster},
                  {"shade", 6, 6, 6 * 38, 6 * 6, 32, 32, 32},
                  {"depth_test", 6, 6, 6 * 14, 6 * 10, 64 + 64 + 128, tested, tested}},
                 compression);
  }
}

// Closed depths are read once for each pair, and read and written once where the triangle covers a whole pixel. Its
// fragment has 21 bytes there, others 57, and the closed depth is 4 more. The sort reads and writes the list's 8 bytes
// in each of three passes; keys make one trip to DRAM and back, and the rest stays in L2. A pixel has a word of 6
// bytes. The nine that are partly covered have a record: one bit plane of 32 bytes and one surface of 8, in three
// chunks with links of 2 bytes, which are read when the chunks are taken. It is written once, and read once in the end,
// when 16 bytes of sums are written and read.
TEST(HandWorked, TriangleNearFirst) {
  constexpr std::uint64_t kPairs = 13, kFragments = 10, kPartial = 9, kBytes = 9 * 57 + 21, kPair = 16, kWord = 6,
                          kRecord = 32 + 8, kLinks = 3 * 2, kSums = 16, kEntry = 4 + 4;
  expect_bytes("paper_triangle.json", "beam",
               {{"vertex_setup", 1, 1, 48, kSetup, kTriangleSetup, kTriangleSetup, kTriangleSetup},
                {"bin_sort", 1, 1, 3 * kEntry, 4 + 3 * kEntry, 32 + 32 + 64, 32 + 32 + 64, 32 + 32},
                {"conservative_raster", 1, kPairs, 88 + 4 * kPairs, kPairs * kPair, kTriangleRaster, kTriangleRaster,
                 kTriangleRaster},
                {"beam_fragment", kPairs, kFragments, kPairs * (kPair + 88), kBytes, 0, 0, 0},
                {"compose", kFragments, kFragments,
                 kBytes + (kFragments + 64) * (4 + kWord) + 4 + kPartial * (kLinks + kRecord + kLinks + kSums),
                 kFragments * kWord + 4 + kPartial * (kRecord + kSums), 0, 0, 0},
                {"shade", kFragments, kFragments, kFragments * (28 + 8), kFragments * 6, kFragments * 32, 32, 32},
                {"resolve", 64, 64, 64 * 8, 384, 384, 384, 384}});
}

TEST(HandWorked, TriangleBeam) {
  constexpr std::uint64_t kPairs = 13, kFragments = 10, kWhole = 1, kPartial = kFragments - kWhole, kFragment = 62,
                          kPair = 16, kRecord = 12 + 4, kHead = 4;
  expect_bytes(
      "paper_triangle.json", "beam:order=sorted",
      {{"vertex_setup", 1, 1, 48, kSetup, kTriangleSetup, kTriangleSetup, kTriangleSetup},
       {"conservative_raster", 1, kPairs, 88 + 4 * (kPairs + 1) + kPairs * (kPair + 4), kPairs * kPair + 4,
        kTriangleRaster, kTriangleRaster, kTriangleRaster},
       {"a_buffer", kPairs, kPairs, kPairs * (kPair + kHead) + 64 * kHead + kPairs * kRecord,
        kPairs * (kHead + kRecord), 320 + 256 + 224 + 416, 320 + 256 + 224 + 224, 256 + 256 + 256 + 224},
       {"windows", kPairs, kPairs, kPairs * kRecord, kPairs * kPair, 416, 0, 0},
       {"beam_fragment", kPairs - kWhole, kPartial, (kPairs - kWhole) * (kPair + 88), kPartial * kFragment, 1152, 96,
        96},
       {"shade", kFragments, kFragments, kFragments * (28 + 8), kFragments * 6, kFragments * 32, 32, 32},
       {"compose", kFragments, kFragments, kPartial * (kFragment + 42) + kWhole * kPair, kFragments * 42,
        128 + 320 + 192, 256 + 1024 + 384, 256 + 1024 + 384},
       {"resolve", 64, 64, 64 * 42, 384, 256 + 2048 + 384 + 384, 256 + 1024 + 384 + 384, 256 + 1024 + 384 + 384}});
}

// The triangle has half of the area of 3.5 x 3.5 pixels, and its number of samples is exactly proportional to its area.
TEST(HandWorked, TriangleReference) {
  constexpr std::uint64_t kSamples = 4096 * 49 / 8;
  const Trace trace = read_sample("paper_triangle.json");
  const FrameResult result = parse_technique("reference").render(trace, 0, {1});
  ASSERT_EQ(result.stages.size(), 3u);
  EXPECT_EQ(result.stages[1].items_in, 1u);
  EXPECT_EQ(result.stages[1].items_out, kSamples);
  EXPECT_EQ(result.stages[1].bytes_read, 88 + kSamples * 8) << "the triangle, and a depth for each";
}

TEST(HandWorked, QuadsMsaa) {
  expect_bytes(
      "paper_quads.json", "msaa:1",
      {{"vertex_setup", 4, 4, 2 * 72, 4 * kSetup, 160 + 352 + 128, 160 + 352 + 128, 160 + 352 + 128},
       {"sample_raster", 4, 32, 4 * 88 + (4 * 13 + 2) * 4, 32 * 10 + 2 * 4, 2 * 32 + 352, 2 * 32 + 352, 2 * 32 + 352},
       {"shade", 32, 32, 32 * 38, 32 * 6, 128, 128, 128},
       {"depth_test", 32, 28, 32 * 14, 28 * 10, 576 + 384, 96 + 384, 96 + 384}});
}

TEST(HandWorked, QuadsBeam) {
  constexpr std::uint64_t kPairs = 52, kTaken = 50, kFragments = 38, kWindows = 31, kFragment = 62, kPair = 16,
                          kRecord = 12 + 4, kHead = 4;
  constexpr std::uint64_t kSetupSectors = 13 * 3 + 13 * 4 + 12 * 4 + 12 * 3, kAttributeSectors = 10 + 20 + 18 + 18;
  expect_bytes(
      "paper_quads.json", "beam:order=sorted",
      {{"vertex_setup", 4, 4, 2 * 72, 4 * kSetup, 160 + 352 + 128, 160 + 352 + 128, 160 + 352 + 128},
       {"conservative_raster", 4, kPairs, 4 * 88 + 4 * (kPairs + 4) + kPairs * (kPair + 4), kPairs * kPair + 4 * 4,
        2 * 32 + 352, 2 * 32 + 352, 2 * 32 + 352},
       {"a_buffer", kPairs, kPairs, kPairs * (kPair + kHead) + 64 * kHead + kPairs * kRecord,
        kPairs * (kHead + kRecord), 768 + 256 + 896 + 1664, 768 + 256 + 896 + 832, 256 + 256 + 896 + 832},
       {"windows", kTaken, kWindows, (kTaken + 1) * kRecord, kTaken * kPair, (kTaken + 1) * 32, 0, 0},
       {"beam_fragment", kTaken, kFragments, kTaken * (kPair + 88), kFragments * kFragment, kSetupSectors * 32, 352,
        352},
       {"shade", kFragments, kFragments, kFragments * (28 + 8), kFragments * 6, kAttributeSectors * 32, 128, 128},
       {"compose", kFragments, kWindows, kFragments * kFragment + kWindows * 42, kWindows * 42, 160 + 896 + 256,
        256 + 1280 + 384, 256 + 1280 + 384},
       {"resolve", 64, 64, 64 * 42, 384, 256 + 2048 + 384 + 384, 256 + 1280 + 384 + 384, 256 + 1280 + 384 + 384}});
}

// Pixel (2, 3), which the triangle covers entirely, and pixel (0, 0), which it does not touch.
TEST(HandWorked, BytesOfAPixel) {
  const Trace trace = read_sample("paper_triangle.json");
  const auto bytes = [&](const char* spec, std::size_t x, std::size_t y) {
    return parse_technique(spec).render(trace, 0, {1}).pixel_counters.at("bytes").at(y * 8 + x);
  };
  EXPECT_EQ(bytes("msaa:1", 2, 3), 4 + 4 + 6) << "depth read and written, colour written";
  EXPECT_EQ(bytes("acaa:1", 2, 3), 4 + 4 + 4 + 2 * 8) << "depth again; the accumulator read and written";
  EXPECT_EQ(bytes("beam:order=sorted", 2, 3), 3 * 4 + 3 * 16 + 42)
      << "head exchanged, and read; record written, sorted, put into a window; aggregate";
  for (const auto& [x, y] : {std::pair{2u, 3u}, {0u, 0u}}) EXPECT_EQ(bytes("beam", x, y), 6) << "the picture alone";
  EXPECT_EQ(bytes("visibility", 2, 3), 4 + 4 + 4 + 8 + 6) << "a number in place of colour; G-buffer, colour written";
  EXPECT_EQ(bytes("deferred", 2, 3), 4 + 4 + 4 + 8 + 6) << "depth again in place of the number";
  EXPECT_EQ(bytes("dvm", 2, 3), 8 * (4 + 4 + 4) + 9 + 8 + 6) << "8 samples, one of which is shaded";
  for (const char* spec : {"msaa:1", "acaa:1", "deferred"}) EXPECT_EQ(bytes(spec, 0, 0), 0) << spec;
  EXPECT_EQ(bytes("beam:order=sorted", 0, 0), 4) << "the head";
  FrameInput run{1};
  run.memory.modelled = false;
  for (const char* spec : {"beam", "beam:order=sorted", "beam:order=stream"})
    EXPECT_FALSE(parse_technique(spec).render(trace, 0, run).pixel_counters.contains("bytes")) << spec;
}

}  // namespace beampipe::hand_worked_test
