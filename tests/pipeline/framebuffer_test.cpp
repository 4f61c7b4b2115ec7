// Where the pixels of a bin are: on chip only if they fit, and what moves to and from DRAM in either place.

#include "stages/data/setup_triangle.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::framebuffer_test {

constexpr std::uint64_t kBinPixels = 32 * 32;

// Two large bins fit on a core, whatever a pixel takes.
constexpr MemoryParameters kRoomy = [] {
  MemoryParameters memory;
  memory.on_chip_bytes = 1 << 20;
  return memory;
}();

// One bin that a single triangle covers.
Trace covered_bin() { return pixel_trace(32, 32, {covering(0.5)}); }

std::uint64_t on_chip_bytes(const FrameResult& result) { return bytes_of(result, "open_pixels"); }

// One triangle covers all pixels, so there are words of 6 bytes and no records. Words are in blocks of 16 pixels, which
// have 3 sectors. `compose` writes each back once, and `resolve` reads it.
TEST(Framebuffer, OpenPixelsThatExceedTheBudgetMoveThroughMemory) {
  constexpr std::uint64_t kState = 46, kInSectors = kBinPixels / 16 * 3 * 32;
  const Technique beam = parse_technique("beam");
  const Trace trace = covered_bin();
  MemoryParameters fits, too_small;
  fits.on_chip_bytes = 2 * kBinPixels * kState;
  too_small.on_chip_bytes = 64 * kState - 1;
  too_small.bins_per_core = 1;

  const FrameResult on_chip = render_with("beam", trace, fits);
  EXPECT_EQ(stage_of(on_chip, "compose").dram_bytes, 0u);
  EXPECT_EQ(stage_of(on_chip, "resolve").dram_bytes, kBinPixels * kPictureBytes);
  EXPECT_EQ(on_chip_bytes(on_chip), kBinPixels * kState);
  EXPECT_EQ(beam.framebuffer_bytes_per_pixel(fits), kPictureBytes);

  const FrameResult in_memory = render_with("beam", trace, too_small);
  EXPECT_EQ(stage_of(in_memory, "compose").dram_bytes, kInSectors);
  EXPECT_EQ(stage_of(in_memory, "resolve").dram_bytes, kInSectors + kBinPixels * kPictureBytes);
  EXPECT_EQ(on_chip_bytes(in_memory), 0u);
  EXPECT_EQ(beam.framebuffer_bytes_per_pixel(too_small), kState);
  EXPECT_EQ(on_chip.image.rgba, in_memory.image.rgba);
}

// 384 KiB of caches, 80 cores with two bins each: 160 bins that find no room have 2457 bytes each, 4 bins of a small
// frame have a quarter, and a thousand cores leave one set of 4 lines of 256 bytes.
TEST(Framebuffer, BinsWithoutRoomShareTheCachesOfRops) {
  const Framebuffer beam = parse_technique("beam").framebuffer, msaa = parse_technique("msaa:8").framebuffer;
  MemoryParameters memory;
  const std::uint32_t all = memory.rop.bytes;
  EXPECT_EQ(beam.memory_of_bin(memory, 1000).rop.bytes, all) << "on chip";
  memory.on_chip_bytes = 64 * 46 - 1;
  EXPECT_TRUE(beam.finds_no_room(memory));
  EXPECT_EQ(beam.memory_of_bin(memory, 1000).rop.bytes, 2457u);
  EXPECT_EQ(beam.memory_of_bin(memory, 1000).framebuffer, Place::in_memory);
  EXPECT_EQ(beam.memory_of_bin(memory, 4).rop.bytes, all / 4);
  EXPECT_FALSE(msaa.finds_no_room(memory)) << "in memory on the machine that it is made for";
  EXPECT_EQ(msaa.memory_of_bin(memory, 1000).rop.bytes, all);
  memory.cores = 1000;
  EXPECT_EQ(beam.memory_of_bin(memory, 5000).rop.bytes, 1024u);
}

// Two layers over 64 x 64 pixels, the farther first, with 4 KiB of caches. A layer of colours has 16 KiB; a layer of
// depths has 64 blocks, and one plane in each is a sector. In bins of 32 x 32 pixels each pixel is written once.
// Without bins both layers are, and the second one reads the depths of the first. Triangles stay on chip.
TEST(Framebuffer, WithoutBinsEachTriangleGoesOverTheWholeFrame) {
  const Trace trace = pixel_trace(64, 64, {covering(0.75), covering(0.25)});
  MemoryParameters memory;
  memory.rop.bytes = 4096;
  const FrameResult binned = render_with("msaa:1,color=rgba8", trace, memory);
  memory.binned = false;
  const FrameResult whole = render_with("msaa:1,color=rgba8", trace, memory);
  EXPECT_EQ(binned.image.rgba, whole.image.rgba);
  EXPECT_EQ(stage_of(binned, "depth_test").dram_bytes, 16384u + 64 * 32);
  EXPECT_EQ(stage_of(whole, "depth_test").dram_bytes, 2 * 16384u + 3 * 64 * 32);
  EXPECT_EQ(stage_of(whole, "sample_raster").dram_bytes, 0u);
  EXPECT_EQ(stage_of(whole, "shade").dram_bytes, 0u);
  const auto stored = [&](std::size_t bytes) { return memory.sectors(2 * bytes) * memory.sector_bytes; };
  EXPECT_EQ(
      stage_of(whole, "vertex_setup").dram_bytes,
      stage_of(binned, "vertex_setup").dram_bytes - stored(sizeof(SetupTriangle)) - stored(sizeof(FlatAttributes)));
  EXPECT_GT(stage_of(whole, "vertex_setup").dram_bytes, 0u) << "vertices are read";
  EXPECT_EQ(bytes_of(whole, "setup_triangles"), 0u);
  EXPECT_EQ(whole.bin_operations.size(), 1u);
}

// Behind caches a surface of one sample is the picture already. On chip it is written there from the bin.
TEST(Framebuffer, OneSampleInMemoryIsThePicture) {
  MemoryParameters memory;
  for (const char* spec : {"msaa:1", "msaa:1,prepass", "taa:8,shading=forward"}) {
    memory.framebuffer = Place::in_memory;
    for (const StageCounters& stage : render_with(spec, covered_bin(), memory).stages)
      EXPECT_NE(stage.stage, StageId::resolve) << spec;
    memory.framebuffer = Place::on_chip;
    const StageCounters stored = stage_of(render_with(spec, covered_bin(), memory), "resolve");
    EXPECT_EQ(stored.dram_bytes, kBinPixels * kPictureBytes) << spec;
    EXPECT_EQ(stored.items_in, kBinPixels) << spec;
  }
}

TEST(Framebuffer, TechniquesThatNeedBinsSayThatThereAreNone) {
  MemoryParameters memory;
  memory.binned = false;
  for (const char* spec : {"beam", "casav", "msaa:4,motion", "deferred"}) {
    SCOPED_TRACE(spec);
    EXPECT_THROW(render_with(spec, covered_bin(), memory), std::runtime_error);
  }
  EXPECT_NO_THROW(render_with("reference", covered_bin(), memory));
  memory.modelled = false;
  EXPECT_NO_THROW(render_with("beam", covered_bin(), memory)) << "bins change no picture";
}

TEST(Framebuffer, CoresHoldAsManyBinsAsHaveRoom) {
  MemoryParameters memory;
  memory.on_chip_bytes = 1000, memory.bins_per_core = 4;
  EXPECT_EQ(memory.bins_held(100, 1024), 4u) << "not more than a core works on";
  EXPECT_EQ(memory.bins_held(250, 1024), 4u);
  EXPECT_EQ(memory.bins_held(251, 1024), 3u);
  EXPECT_EQ(memory.bins_held(1000, 1024), 1u);
  EXPECT_EQ(memory.bins_held(5000, 1024), 1u) << "whatever a report says";
  EXPECT_EQ(memory.bins_held(0, 0), 4u) << "of a size that is not known";
  EXPECT_EQ(memory.bins_held(100, 256), 10u) << "sixteen of them have as many pixels as four of 32 x 32";
  EXPECT_EQ(memory.bins_held(50, 256), 16u);
  EXPECT_EQ(memory.bins_held(5, 64), 64u);
  EXPECT_EQ(memory.bins_held(5, 4096), 4u) << "larger ones count as well";
  memory.cores = 3;
  const Framebuffer msaa = parse_technique("msaa:8").framebuffer;
  EXPECT_EQ(msaa.bins_in_work(memory), 12u);
  memory.bin_pixels = 16;
  EXPECT_EQ(msaa.bins_in_work(memory), 48u);
}

// What a bin needs of its part of the caches not to evict anything, the whole caches need as often as they are shared.
TEST(Framebuffer, ReachIsThatOfTheWholeCaches) {
  const Trace trace = covered_bin();
  MemoryParameters memory;
  memory.framebuffer = Place::in_memory;
  const std::uint64_t reach = render_with("beam", trace, memory).cache_reach.rop;
  EXPECT_GT(reach, 0u);
  memory.framebuffer = std::nullopt;
  memory.on_chip_bytes = 1;
  EXPECT_EQ(render_with("beam", trace, memory).cache_reach.rop, reach) << "one bin shares with none";
  memory.bin_pixels = 16;  // four bins, with a quarter of the pixels and of the caches each
  EXPECT_EQ(render_with("beam", trace, memory).cache_reach.rop, reach);
}

// 46 bytes of a pixel and two bins to a core: 32 x 32 need 94,208 bytes, 16 x 16 a quarter of that, 8 x 8 a sixteenth,
// and one of 8 x 8 half of that.
TEST(Framebuffer, BinsAreAsLargeAsFit) {
  const Framebuffer beam = parse_technique("beam").framebuffer;
  struct Case {
    std::uint32_t bytes;
    int side;
    bool on_chip;
  };
  for (const auto& [bytes, side, on_chip] : {Case{94208, 32, true},
                                             {94207, 16, true},
                                             {23552, 16, true},
                                             {23551, 8, true},
                                             {5888, 8, true},
                                             {5887, 8, true},
                                             {2944, 8, true},
                                             {2943, 32, false}}) {
    MemoryParameters memory;
    memory.on_chip_bytes = bytes;
    EXPECT_EQ(beam.bin_size_on(memory), side) << bytes;
    EXPECT_EQ(beam.is_on_chip(memory), on_chip) << bytes;
    memory.framebuffer = Place::in_memory;
    EXPECT_EQ(beam.bin_size_on(memory), 32) << bytes;
  }
  MemoryParameters phone;
  phone.on_chip_bytes = 32 * 1024, phone.framebuffer = Place::on_chip;
  EXPECT_EQ(parse_technique("msaa:4").framebuffer.bin_size_on(phone), 16) << "2 x 256 x 40 bytes";
  EXPECT_EQ(parse_technique("msaa:8").framebuffer.bin_size_on(phone), 8) << "2 x 64 x 80 bytes";
}

// The machine decides where pixels are, but not what is drawn or computed.
TEST(Framebuffer, OnChipOnlyThePictureGoesToMemory) {
  const Trace trace = random_trace(40, 36, 60, 5);
  for (const char* spec : {"beam", "beam:order=stream", "casav:order=near-first", "casav:order=stream", "z3", "msaa:8",
                           "msaa:8,prepass", "acaa:8", "acaa:8,double=stencil", "deferred", "visibility"}) {
    SCOPED_TRACE(spec);
    MemoryParameters memory = kRoomy;
    memory.framebuffer = Place::on_chip;
    const FrameResult on_chip = render_with(spec, trace, memory);
    memory.framebuffer = Place::in_memory;
    const FrameResult in_memory = render_with(spec, trace, memory);
    EXPECT_EQ(on_chip.image.rgba, in_memory.image.rgba);
    EXPECT_GT(on_chip_bytes(on_chip), 0u);
    EXPECT_EQ(on_chip_bytes(in_memory), 0u);
    EXPECT_EQ(stage_of(on_chip, "resolve").dram_bytes, 40u * 36 * kPictureBytes);
    EXPECT_GT(stage_of(in_memory, "resolve").dram_bytes, 40u * 36 * kPictureBytes);
    for (const Stage stage : {StageId::depth_test, StageId::stencil_test, StageId::accumulate})
      for (const StageCounters& counters : on_chip.stages)
        if (counters.stage == stage) {
          EXPECT_EQ(counters.sector_bytes, 0u) << stage;
        }
    ASSERT_EQ(on_chip.stages.size(), in_memory.stages.size());
    for (std::size_t i = 0; i < on_chip.stages.size(); ++i) {
      StageCounters a = on_chip.stages[i], b = in_memory.stages[i];
      EXPECT_LE(a.dram_bytes, b.dram_bytes) << a.stage;
      a.sector_bytes = b.sector_bytes, a.l2_bytes = b.l2_bytes, a.dram_bytes = b.dram_bytes;
      EXPECT_EQ(a, b) << a.stage;
    }
  }
}

TEST(Framebuffer, AnABufferAndWhatLaterFramesReadStayInMemory) {
  const Trace trace = random_trace(40, 36, 60, 5);
  MemoryParameters memory;
  memory.framebuffer = Place::on_chip;
  const FrameResult sorted = render_with("beam:order=sorted", trace, memory);
  EXPECT_GT(stage_of(sorted, "a_buffer").dram_bytes, 0u);
  EXPECT_EQ(stage_of(sorted, "resolve").dram_bytes, 40u * 36 * kPictureBytes);
  EXPECT_EQ(parse_technique("taa:8").framebuffer_bytes_per_pixel(memory), 4u + 16 + kPictureBytes);
  EXPECT_EQ(parse_technique("msaa:8").framebuffer_bytes_per_pixel(memory), kPictureBytes);
  EXPECT_EQ(parse_technique("beam").framebuffer_bytes_per_pixel(memory), kPictureBytes);
  memory.framebuffer = Place::in_memory;
  EXPECT_EQ(parse_technique("taa:8").framebuffer_bytes_per_pixel(memory), 42u);
  EXPECT_EQ(parse_technique("msaa:8").framebuffer_bytes_per_pixel(memory), 80u);
  EXPECT_EQ(parse_technique("beam").framebuffer_bytes_per_pixel(memory), 46u);
}

// A layer of fp16 RGBA takes 8 bytes per sample. dvm has another one, of the frame: later passes read it.
TEST(Framebuffer, ALayerOfTranslucentTrianglesIsWhereThePixelsAre) {
  SurfaceTrace scene(32, 32);
  const Trace opaque = scene.trace;
  scene.add_rectangle(3, 4, 20, 20, 0.5, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
  struct Bytes {
    const char* spec;
    std::uint64_t layer, of_frame;
  };
  for (const auto& [spec, layer, of_frame] :
       {Bytes{"visibility:8", 8 * 8, 0}, Bytes{"visibility", 8, 0}, Bytes{"deferred", 8, 0}, Bytes{"taa:8", 8, 0},
        Bytes{"taa:8,shading=forward", 0, 0}, Bytes{"dvm", 8 * 8, 8}, Bytes{"acaa:8", 0, 0}, Bytes{"msaa:8", 0, 0}}) {
    SCOPED_TRACE(spec);
    MemoryParameters memory = kRoomy;
    memory.framebuffer = Place::in_memory;
    EXPECT_EQ(bytes_of(render_with(spec, scene.trace, memory), kTranslucentLayer), kBinPixels * (layer + of_frame));
    EXPECT_EQ(bytes_of(render_with(spec, opaque, memory), kTranslucentLayer), 0u);
    memory.framebuffer = Place::on_chip;
    const FrameResult on_chip = render_with(spec, scene.trace, memory);
    EXPECT_EQ(bytes_of(on_chip, kTranslucentLayer), kBinPixels * of_frame);
    EXPECT_EQ(on_chip_bytes(on_chip), on_chip_bytes(render_with(spec, opaque, memory)) + kBinPixels * layer);
  }
}

}  // namespace beampipe::framebuffer_test
