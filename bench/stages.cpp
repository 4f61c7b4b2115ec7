// What each stage of `beam` costs per item of a frame, on one core: nanoseconds, and the operations that the stage
// counts.
#include <benchmark/benchmark.h>

#include "pipeline/bins/bands.h"
#include "pipeline/bins/threads.h"
#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/compose_beam.h"
#include "stages/beam/windows.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"
#include "traces/scenes.h"

namespace beampipe {
namespace {

constexpr int kPositions = 256, kTileSize = 32;
using Pixels = std::vector<StoredAggregate<8>>;

// The input of every stage for one tile.
struct TileWork {
  Tile tile;
  TriangleList list;
  std::vector<Pair> pairs;
  std::vector<SortRecord> records;
  ABuffer buffer;
  std::vector<std::vector<Pair>> windows;
  std::vector<std::vector<Fragment>> fragments;
  Pixels pixels;
};

struct FrameWork {
  Trace trace;
  SetupTriangles triangles;
  std::vector<glm::vec3> colors;
  PositionGrid grid{kPositions};
  BeamFragmentOptions options;
  std::vector<TileWork> tiles;

  explicit FrameWork(const std::string& scene) : trace(make_scene(scene, {.width = 640, .height = 360})) {
    StageCounters unused;
    const Frame& frame = trace.frames[0];
    triangles = vertex_setup(trace, frame, unused);
    colors = shade_triangles(triangles, frame.lighting);
    options = grid_options(grid, conserving_fragment_bytes(kPositions));
    const TileGrid tile_grid(frame, kTileSize);
    std::vector<TriangleList> lists = bin_triangles(triangles, tile_grid, {0, tile_grid.tiles.size()});
    for (std::size_t i = 0; i < lists.size(); ++i) {
      tiles.push_back(
          {tile_grid.tiles[i], std::move(lists[i]), {}, {}, {}, {}, {}, Pixels(tile_grid.tiles[i].pixels())});
      run(tiles.back());
    }
  }
  FrameWork(const FrameWork&) = delete;
  FrameWork& operator=(const FrameWork&) = delete;

  void run(TileWork& work) const {
    StageCounters unused;
    ClosedDepth closed(work.tile);
    conservative_raster(triangles, work.list, work.tile, unused, work.pairs, {&closed});
    work.records = sort_records(work.pairs, work.tile);
    work.buffer = a_buffer(work.records, work.tile.pixels(), 0, kStoredPairBytes, unused);
    Windows windows(work.pairs, work.buffer, kStoredPairBytes);
    std::vector<Pair> window, whole;
    std::vector<float> areas;
    while (windows.next([&](std::uint32_t pixel) { return !is_closed(work.pixels[pixel]); }, unused, window, whole)) {
      std::vector<Fragment> fragments;
      beam_fragment(triangles, window, work.tile, options, unused, fragments);
      shade_visible(colors, fragments, unused);
      compose_window(fragments, cell_positions(kPositions), unused, work.pixels, areas);
      compose_whole({whole, work.tile, colors}, unused, work.pixels);
      work.windows.push_back(window);
      work.fragments.push_back(fragments);
    }
  }
};

const FrameWork& frame_of(const std::string& scene) {
  static const FrameWork hairball("hairball"), terrain("terrain");
  return scene == "hairball" ? hairball : terrain;
}

void report(benchmark::State& state, const StageCounters& counters) {
  const auto items = static_cast<double>(std::max(counters.items_in, counters.items_out));
  state.counters["items"] = items;
  state.counters["ops_per_item"] = static_cast<double>(counters.ops.total()) / items;
  state.counters["ns_per_item"] =
      benchmark::Counter(items * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Measures body(tile, counters) over all tiles of a frame.
template <class Body>
void run_stage(benchmark::State& state, const FrameWork& frame, Body&& body) {
  StageCounters counters;
  for (auto _ : state) {
    counters = {};
    for (const TileWork& tile : frame.tiles) body(tile, counters);
  }
  report(state, counters);
}

void raster(benchmark::State& state, const std::string& scene) {
  const FrameWork& frame = frame_of(scene);
  run_stage(state, frame, [&](const TileWork& work, StageCounters& counters) {
    std::vector<Pair> pairs;
    ClosedDepth closed(work.tile);
    conservative_raster(frame.triangles, work.list, work.tile, counters, pairs, {&closed});
  });
}

void sort(benchmark::State& state, const std::string& scene) {
  run_stage(state, frame_of(scene), [&](const TileWork& work, StageCounters& counters) {
    a_buffer(sort_records(work.pairs, work.tile), work.tile.pixels(), 0, kStoredPairBytes, counters);
  });
}

void fragment(benchmark::State& state, const std::string& scene) {
  const FrameWork& frame = frame_of(scene);
  run_stage(state, frame, [&](const TileWork& work, StageCounters& counters) {
    std::vector<Fragment> fragments;
    for (const std::vector<Pair>& window : work.windows) {
      fragments.clear();
      beam_fragment(frame.triangles, window, work.tile, frame.options, counters, fragments);
    }
  });
}

void compose(benchmark::State& state, const std::string& scene) {
  run_stage(state, frame_of(scene), [&](const TileWork& work, StageCounters& counters) {
    Pixels pixels(work.tile.pixels());
    std::vector<float> areas;
    for (const std::vector<Fragment>& fragments : work.fragments)
      compose_window(fragments, cell_positions(kPositions), counters, pixels, areas);
  });
}

void resolve_pixels(benchmark::State& state, const std::string& scene) {
  run_stage(state, frame_of(scene), [&](const TileWork& work, StageCounters& counters) {
    benchmark::DoNotOptimize(resolve(composed_colors(work.pixels), glm::vec3(0.5f), 42, counters));
  });
}

void setup(benchmark::State& state, const std::string& scene) {
  const FrameWork& frame = frame_of(scene);
  StageCounters counters;
  on_threads(1, [&] {
    for (auto _ : state) {
      counters = {};
      benchmark::DoNotOptimize(vertex_setup(frame.trace, frame.trace.frames[0], counters));
    }
  });
  report(state, counters);
}

const bool registered = [] {
  for (const std::string scene : {"hairball", "terrain"}) {
    const auto add = [&](StageId id, auto* stage) {
      benchmark::RegisterBenchmark(std::string(name_of(id)).append("/" + scene).c_str(), stage, scene)
          ->Unit(benchmark::kMillisecond);
    };
    add(StageId::vertex_setup, setup);
    add(StageId::conservative_raster, raster);
    add(StageId::a_buffer, sort);
    add(StageId::beam_fragment, fragment);
    add(StageId::compose, compose);
    add(StageId::resolve, resolve_pixels);
  }
  return true;
}();

}  // namespace
}  // namespace beampipe
