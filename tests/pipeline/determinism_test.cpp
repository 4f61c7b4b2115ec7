// Pictures and counters do not depend on the number of threads, the SIMD target or the order of work.
#include "pipeline/bins/timeline.h"
#include "pipeline/technique_table.h"
#include "tests/pipeline/surface_traces.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/simd/every_target.h"
#include "tests/thorough.h"

namespace beampipe::determinism_test {

// Compares every technique on every instruction set, with 1 to 16 threads in turn (with each of these numbers if
// thorough), with one thread and the best instruction set.
void expect_same_everywhere(const Trace& trace) {
  int threads = 0;
  for (const std::string& spec : example_specs()) {
    const Technique technique = parse_technique(spec);
    const FrameResult expected = technique.render(trace, 0, {1});
    on_every_target([&] {
      for (int i = 0; i < (thoroughness() > 1 ? 16 : 1); ++i) {
        threads = threads % 16 + 1;
        expect_same(expected, technique.render(trace, 0, {threads}), spec + (" threads: " + std::to_string(threads)));
      }
    });
  }
}

TEST(Determinism, AnyInstructionSetAndNumberOfThreads) { expect_same_everywhere(random_trace(100, 40, 200, 3)); }

TEST(Determinism, AnyInstructionSetAndNumberOfThreadsWithMaterials) {
  expect_same_everywhere(random_surfaces(70, 40, 80, 3));
}

TEST(Determinism, AnyInstructionSetAndNumberOfThreadsWithDrawState) {
  expect_same_everywhere(random_states(50, 34, 30, 3));
}

// One bin without triangles stands for all of its size, but not where a timeline is recorded.
TEST(Determinism, BinsWithoutTrianglesAreAlike) {
  for (const Trace& trace :
       {random_trace(290, 170, 2, 1), random_surfaces(290, 170, 2, 5), random_trace(70, 40, 0, 1)}) {
    for (const std::string& spec : example_specs()) {
      const Technique technique = parse_technique(spec);
      Timeline timeline;
      const FrameSinks every_bin{.timeline = &timeline};
      expect_same(technique.render(trace, 0, {}, every_bin), technique.render(trace, 0, {}), spec);
    }
  }
}

// In bounded memory: pixels are closed while the raster goes on.
bool has_open_pixels(const std::string& spec) {
  return spec.starts_with("beam") && !spec.starts_with("beam:order=sorted");
}

// Pictures and counters with tiles from a single quad to one that is larger than the frame.
void expect_same_in_any_tile(const Trace& trace) {
  FrameInput options;
  options.memory.modelled = false;  // its caches depend on the tile
  for (const std::string& spec : example_specs()) {
    const Technique technique = parse_technique(spec);
    options.tile_size = 0;
    const FrameResult expected = technique.render(trace, 0, options);
    for (const int tile_size :
         thoroughness() > 1 ? std::vector{2, 6, 8, 16, 22, 32, 64, 128} : std::vector{2, 22, 128}) {
      SCOPED_TRACE(spec + (" tile size: " + std::to_string(tile_size)));
      options.tile_size = tile_size;
      const FrameResult found = technique.render(trace, 0, options);
      EXPECT_EQ(found.image.rgba, expected.image.rgba);
      EXPECT_EQ(found.pixel_counters, expected.pixel_counters);
      ASSERT_EQ(found.stages.size(), expected.stages.size());
      // A closed pixel hides what the raster has not found yet, and that depends on the tile.
      if (has_open_pixels(spec)) continue;
      for (std::size_t i = 0; i < found.stages.size(); ++i) {
        StageCounters a = found.stages[i], b = expected.stages[i];
        if (a.stage == StageId::bin_sort) continue;  // of the triangles of each tile
        EXPECT_EQ(a.items_out, b.items_out) << a.stage;
        if (spec.starts_with("casav") && a.stage == StageId::beam_fragment)
          a.ops = b.ops = {};  // the edges of a triangle are prepared for masks once per tile
        if (spec.starts_with("reference") && a.stage == StageId::resolve) continue;  // it skips tiles without triangles
        // Rasters count their setup once per tile, and `material_sort` has the sums of 256 digits in each tile.
        if (!info_of(a.stage.id).rasterizes && a.stage != StageId::material_sort) {
          EXPECT_EQ(a, b) << a.stage;
        }
      }
    }
  }
}

TEST(Determinism, AnyTileSize) { expect_same_in_any_tile(random_trace(50, 38, 100, 5)); }

TEST(Determinism, AnyTileSizeWithMaterials) { expect_same_in_any_tile(random_surfaces(46, 34, 70, 5)); }

TEST(Determinism, AnyTileSizeWithDrawState) { expect_same_in_any_tile(random_states(46, 34, 24, 5)); }

TEST(Determinism, TheFrameIsTheSameWhereverTilesFallInIt) {
  // Rendered alone, the lower right quarter of a frame has the same pixels in other tiles.
  const Trace whole = random_trace(96, 96, 300, 9);
  Trace part = whole;
  Frame& frame = part.frames[0];
  frame.width = frame.height = 48;
  glm::dmat4 half(1.0);  // the quarter's clip space is [0, 1] x [-1, 0] of that of the whole
  half[0][0] = half[1][1] = 2.0;
  half[3] = glm::dvec4(-1.0, 1.0, 0.0, 1.0);
  frame.projection = half * frame.projection;
  for (const std::string& spec : example_specs()) {
    if (spec.starts_with("dvm")) continue;  // its random choices depend on the pixel's place in the frame
    if (has_open_pixels(spec) || spec.find("near-first") != spec.npos)
      continue;  // bins are sorted as a whole, and sums are rounded by a triangle's number
    const Technique technique = parse_technique(spec);
    const Image a = technique.render(whole, 0, {2}).image, b = technique.render(part, 0, {2}).image;
    for (std::size_t y = 0; y < 48; ++y) {
      const auto row = a.rgba.begin() + static_cast<std::ptrdiff_t>(4 * ((y + 48) * 96 + 48));
      EXPECT_TRUE(std::equal(row, row + 4 * 48, b.rgba.begin() + static_cast<std::ptrdiff_t>(4 * 48 * y)))
          << spec << ", row " << y;
    }
  }
}

}  // namespace beampipe::determinism_test
