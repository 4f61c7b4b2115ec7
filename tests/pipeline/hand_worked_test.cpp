// Every byte of every stage for two traces, worked out by hand.
#include <gtest/gtest.h>

#include <filesystem>

#include "pipeline/technique.h"
#include "traces/files/trace_io.h"

namespace beampipe::hand_worked_test {

struct Bytes {
  const char* stage;
  std::uint64_t items_in, items_out, read, written, sectors, l2, dram;
};

void expect_bytes(const char* sample, const char* spec, const std::vector<Bytes>& expected, bool compression = true) {
  const Trace trace = read_trace(std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples" / sample);
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

// Both traces are 8 x 8 pixels, one bin. Pixel (x, y) has position p in Z order: the bits of x and y in turn, x first.
//
// The corners are (1.25, 1.25), (4.75, 4.75), (1.25, 4.75). The centres of six pixels lie inside: (1,2) (1,3) (2,3)
// (1,4) (2,4) (3,4), at positions 9, 11, 14, 33, 36, 37.
//
// Depth is one block of 64 x 4 = 256 bytes, 8 positions to a sector. Positions 9, 11, 14 are in sector 1, the others in
// sector 4: two sectors are read and two written, 128 bytes. The block was cleared, so nothing is fetched. It is
// written back with one plane: 12 bytes, and one bit for each of 64 samples that distinguishes it from clear, 8 bytes.
// These 20 bytes take one sector, 32. Raw the block is 256 bytes.
//
// Colour is two blocks of 32 x 6 = 192 bytes, 6 sectors, rows 0 to 3 and rows 4 to 7. Positions 9, 11, 14 begin at
// bytes 54, 66 and 84: sectors 1 and 2. Positions 33, 36, 37 are 1, 4, 5 of their block, bytes 6, 24 and 30 to 35:
// sectors 0 and 1. Four sectors are written, 128 bytes. Both blocks were clear, so they are written back whole: 384.
TEST(HandWorked, TriangleMsaa) {
  expect_bytes("paper_triangle.json", "msaa:1",
               {{"vertex_setup", 1, 1, 48, kSetup, kTriangleSetup, kTriangleSetup, kTriangleSetup},
                {"sample_raster", 1, 6, 88 + 13 * 4, 6 * 10, kTriangleRaster, kTriangleRaster, kTriangleRaster},
                {"shade", 6, 6, 6 * 38, 6 * 6, 32, 32, 32},
                {"depth_test", 6, 6, 6 * 14, 6 * 10, 64 + 64 + 128, 32 + 384, 32 + 384},
                {"resolve", 64, 64, 384, 384, 768, 768, 768}});
}

TEST(HandWorked, TriangleMsaaWithoutCompression) {
  expect_bytes("paper_triangle.json", "msaa:1",
               {{"vertex_setup", 1, 1, 48, kSetup, kTriangleSetup, kTriangleSetup, kTriangleSetup},
                {"sample_raster", 1, 6, 88 + 13 * 4, 6 * 10, kTriangleRaster, kTriangleRaster, kTriangleRaster},
                {"shade", 6, 6, 6 * 38, 6 * 6, 32, 32, 32},
                {"depth_test", 6, 6, 6 * 14, 6 * 10, 64 + 64 + 128, 256 + 384, 256 + 384},
                {"resolve", 64, 64, 384, 384, 768, 768, 768}},
               false);
}

// Closed depths are read once for each pair, and read and written once where the triangle covers a whole pixel; there
// its depth plane is fetched again. A fragment has 57 bytes, and the closed depth is 4 more. The sort reads and writes
// the list's 8 bytes in each of three passes; keys make one trip to DRAM and back, and the rest stays in L2.
TEST(HandWorked, TriangleNearFirst) {
  constexpr std::uint64_t kPairs = 13, kFragments = 10, kFragment = 57, kPair = 16, kPixel = 154, kPlane = 4 + 40,
                          kEntry = 4 + 4;
  expect_bytes("paper_triangle.json", "beam",
               {{"vertex_setup", 1, 1, 48, kSetup, kTriangleSetup, kTriangleSetup, kTriangleSetup},
                {"bin_sort", 1, 1, 3 * kEntry, 4 + 3 * kEntry, 32 + 32 + 64, 32 + 32 + 64, 32 + 32},
                {"conservative_raster", 1, kPairs, 88 + 4 * kPairs, kPairs * kPair, kTriangleRaster, kTriangleRaster,
                 kTriangleRaster},
                {"beam_fragment", kPairs, kFragments, kPairs * (kPair + 88), kFragments * kFragment, 0, 0, 0},
                {"compose", kFragments, kFragments, kFragments * (kFragment + 4 + kPixel) + 4 + kPlane + 64 * kPixel,
                 kFragments * kPixel + 4, 64, 64, 0},
                {"shade", kFragments, kFragments, kFragments * (28 + 8), kFragments * 6, kFragments * 32, 32, 32},
                {"resolve", 64, 64, 64 * 8, 384, 384, 384, 384}});
}

// The closed triangle touches 13 pixels: (1,1) (2,1) (1,2) (2,2) (3,2) (1,3) (2,3) (3,3) (4,3) (1,4) (2,4) (3,4) (4,4),
// at positions 3, 6, 9, 12, 13, 11, 14, 15, 26, 33, 36, 37, 48. In (2,1), (3,2) and (4,3) it has no area.
//
// Raster reads the triangle, 88; for 13 pairs the closed depth, 4 each; and for pixel (2,3), which the triangle covers
// whole and closes, once more 4 read and 4 written. The 13 pairs of 16 bytes wait until the bin's last triangle has
// come; then each is read with its closed depth: 13 x 20. Together 404 are read and 13 x 16 + 4 written. In memory,
// vertex_setup and the raster move what they do above, 192 and 160.
//
// A-buffer, insertion. Logically, 13 pairs of 16 are read, 13 heads of 4 read and written, 13 records of 16 written;
// then 64 heads and 13 records are read: 724 read, 260 written. In memory, heads, 4 bytes each, are two blocks of 128.
// Their sectors 0, 1, 3, 4 and 6 are read and written: 320 bytes. The cleared blocks are written back raw, 256, and the
// next pass reads them, 256 and 256. 13 records of 12 + 4 bytes follow one another: 208 bytes in seven sectors, 224
// written. The last sector is written in part and fetched first: 224 + 32 of DRAM.
//
// A-buffer, sorting reads each record, which lies in one sector: 13 x 32 = 416 bytes. L1 asks L2 for the seven sectors
// once, and L2 asks DRAM, 224. Together the A-buffer moves 1216 in sectors, 320 + 256 + 224 + 224 = 1024 of L2, 992 of
// DRAM.
//
// Windows reads the records again, 13 x 16, 416 in sectors, all from L1, and passes on 13 pairs of 16.
//
// Fragments. Pixel (2,3) is covered as a whole and takes a shortcut: compose reads its pair, 16 bytes, and no fragment
// is made. For the other twelve beam_fragment reads 16 + 88 bytes each, and writes 62 for each of the nine that have
// area: 1248 read, 558 written. In memory it fetches for the twelve the triangle's setup, three sectors: 12 x 96 =
// 1152, from L2 and DRAM once, 96.
//
// Shade reads pairs and attributes and writes a colour for the nine and the whole pixel: 10 x (8 + 28) and 10 x 6. It
// fetches 10 x 32 in sectors, and once 32 from L2 and DRAM.
//
// Composition reads nine fragments of 62 and the nine pixels, 42 each, and the whole pixel's pair, 16: 952. It writes
// ten pixels, 420, at positions 3, 9, 12, 11, 14, 15, 33, 36, 37, 48. Coverage, 4 bytes: sectors 0, 1, 4, 6, 128 bytes,
// and one block of 256 to DRAM. Masks, 32 bytes: ten sectors, 320, in four blocks of 8 pixels, 1024. Colour, 6 bytes:
// positions 3 to 15 in sectors 0, 1, 2; positions 33 to 48 in sectors 0, 1, 3: 192 bytes, and two blocks of 192.
// Together 640 and 1664.
//
// Resolve reads all, 64 x 42: coverage 256, masks 2048, of which four blocks are still clear and 1024 move, colour 384.
// It writes the picture, 384.
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
  const Trace trace = read_trace(std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples/paper_triangle.json");
  const FrameResult result = parse_technique("reference").render(trace, 0, {1});
  ASSERT_EQ(result.stages.size(), 3u);
  EXPECT_EQ(result.stages[1].items_in, 1u);
  EXPECT_EQ(result.stages[1].items_out, kSamples);
  EXPECT_EQ(result.stages[1].bytes_read, 88 + kSamples * 8) << "the triangle, and a depth for each";
}

// Quad A covers 0.25 to 3.75 in x and y; quad B, farther away and drawn later, covers 2.25 to 5.75. Each has 16
// centres. Those on its diagonal belong to the first triangle (x >= y: 10 centres, then 6), whose left edge the
// diagonal is. B loses the four centres (2..3, 2..3). 32 samples are tested and 28 pass. The raster reads four
// triangles, the closed depth of 13 cells for each, and once more of the two cells that it closes (one in each quad,
// next to the diagonal; the first triangle owns the corner that lies on it): 4 x 88 + 54 x 4 = 568. It writes 32 x 10 +
// 2 x 4.
//
// Depth requests, by triangle: A's read and write sectors 0 and 1 each; B's first reads 1, 3, 6 and writes 3, 6; B's
// second reads 1, 4, 6 and writes 4, 6. 18 sectors: 576 bytes. The block is written back with four planes, 48 bytes,
// and 64 numbers of 3 bits (four planes and clear), 24: 72 bytes in three sectors, 96.
//
// Colour: A's triangles write sectors 0, 1, 2 of the upper block each; B's first writes 4 and 5 of it and 3 of the
// lower block; B's second 0, 1 and 3 of the lower. 12 sectors: 384 bytes. Both blocks are written back whole, 384.
//
// Geometry: vertex_setup reads twice 6 indices and 4 vertices, 2 x 72 bytes in 5 sectors, and writes 352 bytes of
// setup, 11 sectors, and 112 of attributes, 4: 640. The bin's list has 16 bytes, a sector written and read; with the
// setup the raster moves 64 + 352. Shading reads the attributes, 128.
TEST(HandWorked, QuadsMsaa) {
  expect_bytes(
      "paper_quads.json", "msaa:1",
      {{"vertex_setup", 4, 4, 2 * 72, 4 * kSetup, 160 + 352 + 128, 160 + 352 + 128, 160 + 352 + 128},
       {"sample_raster", 4, 32, 4 * 88 + (4 * 13 + 2) * 4, 32 * 10 + 2 * 4, 2 * 32 + 352, 2 * 32 + 352, 2 * 32 + 352},
       {"shade", 32, 32, 32 * 38, 32 * 6, 128, 128, 128},
       {"depth_test", 32, 28, 32 * 14, 28 * 10, 576 + 384, 96 + 384, 96 + 384},
       {"resolve", 64, 64, 384, 384, 768, 768, 768}});
}

// Each closed triangle touches the ten pixels of its half and three more in a corner on the diagonal: 52 pairs. It
// covers one pixel whole: (2,1), (1,2), (4,3) or (3,4). In that pixel the quad's other triangle has a pair as well,
// which touches the corner, so no pixel takes the shortcut.
//
// Raster reads 4 x 88, 52 x 20 for the waiting pairs and 4 x 56 of closed depth: 1616. It writes 52 x 16 + 4 x 4.
//
// A-buffer. Logically, 52 x (16 + 4) + 64 x 4 + 52 x 16 = 2128 are read and 52 x 20 written. Heads: A's triangles read
// and write sectors 0 and 1, B's sectors 1, 3, 4 and 6: 12 of them, 768. Two blocks are written back raw, 256, and read
// again, 256. Records: each triangle's 208 bytes lie in 7 sectors, 896 written; sectors 6 and 19, which two triangles
// share, are fetched first, so DRAM sees 64 + 832. Sorting asks for 52 x 32 = 1664, of L2 and DRAM once, 832.
//
// Windows. A closes pixel (2,2); of B's two pairs there, one is looked at and none is taken. 51 records are read and 50
// pairs passed on, in 31 windows: one for each of 28 pixels, and a second in (3,2), (2,3) and (3,3), where A leaves
// something free.
//
// Fragments. 50 x (16 + 88) are read. 38 pairs have area, ten of each of A's triangles and nine of each of B's: 38 x 62
// written. The setups of the four triangles lie in 3, 4, 4 and 3 sectors: (13 x 3 + 13 x 4 + 12 x 4 + 12 x 3) x 32 =
// 5600, of L2 and DRAM once, 352. Attributes lie in 1, 2, 2 and 2: (10 + 20 + 18 + 18) x 32 = 2112, once 128. shade
// reads, logically, 38 x (8 + 28) and writes 38 x 6.
//
// Composition reads 38 fragments and for each window the pixel, 38 x 62 + 31 x 42, and writes 31 x 42. All but the last
// write of a pixel stay on chip. The 28 pixels take, of coverage, sectors 0, 1, 3, 4 and 6, 160, and a block of 256; of
// masks 28 sectors, 896, in five blocks, 1280; of colour sectors 0, 1, 2, 4, 5 and 0, 1, 3: 256, and two blocks of 192.
// Resolve reads 256, 2048 (of which 1280 move) and 384, and writes 384.
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
  const Trace trace = read_trace(std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples/paper_triangle.json");
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
