#include "pipeline/bins/bands.h"

#include "stages/geometry/vertex_setup.h"
#include "stages/raster/conservative_raster.h"
#include "tests/message_of.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/simd/random.h"

namespace beampipe::bands_test {

// `layers` triangles that cover the whole frame, in no order of depth.
Trace stack_trace(std::uint32_t width, std::uint32_t height, int layers) {
  std::vector<PixelSpaceTriangle> triangles;
  const double w = width, h = height;
  for (int i = 0; i < layers; ++i) {
    const double z = 0.1 + 0.8 * ((i * 7) % layers) / layers;
    triangles.push_back({{{-w, -h, z}, {3 * w, -h, z}, {-w, 3 * h, z}}, glm::vec3(0.5f + 0.4f * (i % 2))});
  }
  return pixel_trace(width, height, triangles);
}

SetupTriangles setup_of(const Trace& trace) {
  StageCounters unused;
  return vertex_setup(trace, trace.frames[0], unused);
}

// The reference keeps every translucent layer of a sample, which opaque triangles have none of.
TEST(Bands, TranslucentLayersOfTheReferenceAreLimited) {
  Trace trace = stack_trace(16, 8, 50);
  FrameInput options;
  options.threads = 2;
  options.memory_limit = 16 << 20;
  const Technique reference = parse_technique("reference");
  EXPECT_NO_THROW(reference.render(trace, 0, options));
  trace.materials.resize(1);
  trace.materials[0].base_color.a = 0.5f, trace.materials[0].alpha_mode = AlphaMode::blend;
  trace.materials[0].unlit = trace.materials[0].double_sided = true;
  trace.meshes[0].materials.assign(trace.meshes[0].triangles.size(), 0);
  // 16 pixels of a tile, 4096 samples each, with 50 layers of 16 bytes, and those once and a half more: 125 MiB.
  EXPECT_EQ(message_of<std::runtime_error>([&] { reference.render(trace, 0, options); }),
            "the memory limit of 16 MiB is too low: the 50 triangles at pixels 0,0 to 3,3 need 126 MiB at once");
  const std::vector<float> whole = reference.render(trace, 0, {.threads = 2}).image.rgba;
  options.memory_limit = 126 << 20;  // one tile at a time
  EXPECT_EQ(reference.render(trace, 0, options).image.rgba, whole);
}

// 100 layers over tiles of 1024 pixels make 102,400 pairs of 10 bytes in a tile, and a list of 400 bytes.
TEST(Bands, HoldAsManyTilesAsFit) {
  const Trace trace = stack_trace(96, 64, 100);
  const SetupTriangles triangles = setup_of(trace);
  const TileGrid grid(trace.frames[0], 32);
  ASSERT_EQ(grid.tiles.size(), 6u);
  const auto sizes = [&](int threads, std::uint64_t limit) {
    std::vector<std::size_t> counts;
    for (const Band& band : split_into_bands(triangles, grid, {10}, threads, limit)) {
      EXPECT_EQ(band.first, counts.empty() ? 0 : counts.back());
      counts.push_back(band.last);
    }
    return counts;
  };
  using Ends = std::vector<std::size_t>;
  constexpr std::uint64_t kTile = 1024000, kList = 400;
  EXPECT_EQ(sizes(4, 0), (Ends{6})) << "no limit";
  EXPECT_EQ(sizes(4, 6 * kTile + 6 * kList), (Ends{6}));
  EXPECT_EQ(sizes(2, 2 * kTile + 6 * kList), (Ends{6})) << "as many tiles at once as threads";
  EXPECT_EQ(sizes(2, 2 * kTile + 3 * kList), (Ends{3, 6})) << "but all lists";
  EXPECT_EQ(sizes(8, 2 * kTile + 6 * kList), (Ends{2, 4, 6}));
  EXPECT_EQ(sizes(8, 1 * kTile + 1 * kList), (Ends{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(message_of<std::runtime_error>([&] { sizes(1, kTile); }),
            "the memory limit of 1 MiB is too low: the 100 triangles at pixels 0,0 to 31,31 need 1 MiB at once");
}

TEST(Bands, PixelsAreDividedIntoTiles) {
  Frame frame;
  frame.width = frame.height = 2;
  for (std::int32_t size = 1; size <= 16384; ++size) {
    const TileGrid grid(frame, size);
    for (std::int32_t tile = 0; tile * size <= 16384; ++tile) {
      ASSERT_EQ(grid.tiles_in(tile * size), tile) << size;
      ASSERT_EQ(grid.tiles_in(tile * size + size - 1), tile) << size;
    }
  }
}

TEST(Bands, ListsAreThoseOfTheWholeFrame) {
  const Trace trace = random_trace(150, 70, 400, 3);
  const SetupTriangles triangles = setup_of(trace);
  const TileGrid grid(trace.frames[0], 32);
  const std::vector<TriangleList> all = bin_triangles(triangles, grid, {0, grid.tiles.size()});
  for (std::size_t first = 0; first < grid.tiles.size(); ++first) {
    for (std::size_t last = first + 1; last <= grid.tiles.size(); ++last) {
      const std::vector<TriangleList> expected(all.begin() + static_cast<std::ptrdiff_t>(first),
                                               all.begin() + static_cast<std::ptrdiff_t>(last));
      EXPECT_EQ(bin_triangles(triangles, grid, {first, last}), expected) << first << " to " << last;
    }
  }
}

// The corners lie on pixel corners or anywhere, inside the frame or far outside it. Some triangles are long diagonals.
SetupTriangle random_triangle(Random& random, std::int32_t width, std::int32_t height) {
  const int reach = random.pick(std::array{1, 8, 40, 400});
  const std::int32_t left = random.int32(-reach, width), top = random.int32(-reach, height);
  SetupTriangle triangle{};
  do {
    const bool on_corners = random.one_in(2), thin = random.one_in(2);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t x = random.int32(0, reach), y = thin ? x + random.int32(0, 1) : random.int32(0, reach);
      triangle.x[k] = (left + x) * kSubpixelUnits + (on_corners ? 0 : random.int32(0, kSubpixelUnits));
      triangle.y[k] = (top + y) * kSubpixelUnits + (on_corners ? 0 : random.int32(0, kSubpixelUnits));
    }
    const Edge edge = edge_of(triangle, 0);
    if (edge.at(triangle.x[2], triangle.y[2]) < 0) {
      std::swap(triangle.x[1], triangle.x[2]);
      std::swap(triangle.y[1], triangle.y[2]);
    }
  } while (edge_of(triangle, 0).at(triangle.x[2], triangle.y[2]) == 0);
  return triangle;
}

std::size_t count_pairs(const SetupTriangles& triangles, const Tile& tile) {
  StageCounters unused;
  std::vector<Pair> pairs;
  conservative_raster(triangles, {0}, tile, unused, pairs);
  return pairs.size();
}

// Every tile that a triangle touches has it in its list. A few lists also hold a triangle that does not touch the tile:
// at the tips of slivers, and where the border of a triangle meets that of a tile.
TEST(Bands, ListsHoldWhatTilesTouch) {
  Random random(71);
  Frame frame;
  frame.width = 200, frame.height = 150;
  const TileGrid grid(frame, 32);
  std::size_t listed = 0, touched = 0;
  for (int i = 0; i < 20'000; ++i) {
    SetupTriangles one;
    one.triangles.push_back(random_triangle(random, 200, 150));
    const std::vector<TriangleList> lists = bin_triangles(one, grid, {0, grid.tiles.size()});
    for (std::size_t tile = 0; tile < lists.size(); ++tile) {
      const bool touches = count_pairs(one, grid.tiles[tile]) > 0;
      ASSERT_TRUE(!touches || !lists[tile].empty()) << "triangle " << i << ", tile " << tile;
      touched += touches;
      listed += !lists[tile].empty();
    }
  }
  EXPECT_LT(static_cast<double>(listed), 1.05 * static_cast<double>(touched));
}

// The quick estimate for the whole frame never counts fewer pairs than a triangle has.
TEST(Bands, NoTriangleSlipsThroughTheLimit) {
  Random random(72);
  Frame frame;
  frame.width = frame.height = 64;
  const TileGrid grid(frame, 64);
  constexpr std::size_t kHuge = 1 << 20;  // bytes per pair
  for (int i = 0; i < 20'000; ++i) {
    SetupTriangles one;
    one.triangles.push_back(random_triangle(random, 64, 64));
    const std::size_t pairs = count_pairs(one, grid.tiles[0]);
    if (pairs == 0) continue;
    ASSERT_THROW(split_into_bands(one, grid, {kHuge}, 1, pairs * kHuge - 1), std::runtime_error) << "triangle " << i;
  }
}

TEST(Bands, ResultsAreThoseOfTheWholeFrame) {
  const Trace trace = random_trace(150, 70, 2000, 3);
  for (const char* spec : {"beam:order=sorted", "casav", "alpha"}) {
    const Technique technique = parse_technique(spec);
    FrameInput options{2};
    const FrameResult whole = technique.render(trace, 0, options);
    // Raises the limit to what each error asks for, up to what the fullest tile needs. A band then holds few tiles.
    int errors = 0;
    for (options.memory_limit = 1;;) {
      try {
        expect_same(whole, technique.render(trace, 0, options), spec);
        break;
      } catch (const std::runtime_error& error) {
        const std::string text = error.what();
        const std::uint64_t needed = std::stoull(text.substr(text.find(" need ") + 6)) << 20;
        ASSERT_GT(needed, options.memory_limit);
        options.memory_limit = needed;
        ++errors;
      }
    }
    EXPECT_GT(errors, 0);
  }
}

// Techniques that work on a few triangles at a time keep no pairs, but their lists alone can exceed the limit.
TEST(Bands, ListsAloneMakeBandsToo) {
  const Trace trace = random_trace(150, 70, 2000, 3);
  for (const char* spec : {"beam", "beam:order=stream", "z3", "msaa:8", "dvm", "reference"}) {
    const Technique technique = parse_technique(spec);
    FrameInput options{2};
    const FrameResult whole = technique.render(trace, 0, options);
    options.memory_limit = setup_of(trace).triangles.size() * sizeof(std::uint32_t);
    expect_same(whole, technique.render(trace, 0, options), spec);
  }
}

}  // namespace beampipe::bands_test
