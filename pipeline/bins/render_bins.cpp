#include "pipeline/bins/render_bins.h"

#include <malloc.h>
#include <tbb/parallel_for.h>

#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "pipeline/bins/bands.h"
#include "pipeline/bins/threads.h"
#include "pipeline/memory/geometry_memory.h"
#include "stages/raster/bin_sort_cost.h"

namespace beampipe {
namespace {

TileGrid tile_grid(const FrameContext& context, int tile_size) {
  return {context.frame, context.run.tile_size > 0 ? context.run.tile_size : tile_size};
}

// The stages of a bin. Frames with cutouts or translucent triangles have a few more.
std::vector<std::string> stages_of(const FrameContext& context, const BinPlan& plan) {
  std::vector<std::string> stages;
  for (const std::string& stage : plan.stages) {
    stages.push_back(stage);
    if (stage == "beam_fragment" && context.has_alpha()) stages.push_back("alpha_mask");
    if (stage == "sample_raster" && context.has_cutouts()) stages.push_back("alpha_test");
    if (stage == "depth_test" && context.has_blending()) stages.push_back("blend");
  }
  return stages;
}

// What one pass over the geometry costs, whatever the technique.
struct GeometryPass {
  StageCounters setup, raster;

  explicit GeometryPass(const FrameContext& context) : setup(context.setup) {
    const std::uint64_t triangles = context.setup.items_out;
    move_setup(context.run.memory, context.setup.bytes_read, context.triangles.triangles.size(), setup);
    stream(context.run.memory, context.surface_bytes, setup);
    raster.items_in = triangles;
    raster.bytes_read = triangles * sizeof(SetupTriangle);
  }

  void add_list(const MemoryParameters& memory, const TriangleList& list, bool is_sorted) {
    raster.empty_tiles += list.empty();
    write_list(memory, list, raster);
    if (is_sorted) {
      read_list(memory, list, raster);
    } else {
      read_bin(memory, list, raster);
    }
  }
};

// Renders bins without triangles, one of each size.
class EmptyBins {
 public:
  EmptyBins(const FrameContext& context, const BinPlan& plan, const std::vector<std::string>& stages,
            const BinRenderer& render)
      : context_(context), plan_(plan), stages_(stages), render_(render) {}

  // Not thread-safe.
  void prepare(const Tile& tile) {
    std::unique_ptr<Bin>& bin = bins_[size_of(tile)];
    if (bin) return;
    bin = std::make_unique<Bin>(context_, tile, list_, stages_, plan_.framebuffer);
    render_(*bin);
    bin->finish_memory();
  }

  const Bin& like(const Tile& tile) const { return *bins_.at(size_of(tile)); }

 private:
  using Size = std::pair<std::size_t, std::size_t>;
  static Size size_of(const Tile& tile) { return {tile.width(), tile.pixels()}; }

  const FrameContext& context_;
  const BinPlan& plan_;
  const std::vector<std::string>& stages_;
  const BinRenderer& render_;
  const TriangleList list_;
  std::map<Size, std::unique_ptr<Bin>> bins_;
};

// Adds up what bins recorded. Only sums and the picture are kept, so that memory use stays that of the picture.
class FrameRecorder {
 public:
  FrameRecorder(const FrameContext& context, const std::vector<std::string>& stages, std::size_t bins)
      : context_(context), texture_passes_(context.texture_layout ? bins : 0) {
    const Frame& frame = context.frame;
    result_.image = {frame.width, frame.height, std::vector<float>(4 * pixels())};
    result_.stages.push_back(StageCounters{context.setup.stage});
    for (const std::string& name : stages) result_.stages.push_back(StageCounters{name});
  }

  // Thread-safe. `index`: of the bin, in the order in which bins are drawn.
  void add(Bin& bin, std::size_t index) {
    if (!texture_passes_.empty()) texture_passes_[index] = bin.take_texture_passes();
    add(bin, bin.tile);
  }

  // Thread-safe. Adds for `tile` what a bin of the same size recorded, which has no triangles either.
  void add_empty(const Bin& bin, const Tile& tile) { add(bin, tile); }

  FrameResult finish(const GeometryPass& pass, std::uint64_t list_bytes) {
    StageCounters& setup = result_.stages.at(0);   // vertex_setup, then the stages of the plan,
    StageCounters& raster = result_.stages.at(1);  // whose first one rasterizes
    for (int i = 0; i < geometry_passes_; ++i) {
      setup += pass.setup;
      raster += pass.raster;
    }
    charge_texture_dram();
    const std::uint64_t triangles = context_.triangles.triangles.size();
    result_.buffers = {
        {"setup_triangles", triangles * (sizeof(SetupTriangle) + sizeof(FlatAttributes)) + context_.surface_bytes},
        {"bin_lists", list_bytes}};
    for (const auto& [name, bytes] : buffer_peaks_) result_.buffers.push_back({name, bytes, true});
    return std::move(result_);
  }

 private:
  void add(const Bin& bin, const Tile& tile) {
    std::map<std::string, std::vector<float>*> counters;  // of the frame
    {
      const std::lock_guard lock(mutex_);
      for (std::size_t s = 0; s < bin.stages().size(); ++s) result_.stages[s + 1] += bin.stages()[s];
      for (const auto& [name, bytes] : bin.buffer_peaks()) {
        std::uint64_t& peak = buffer_peaks_[name];
        peak = std::max(peak, bytes);
      }
      result_.a_buffer_peak_bytes += bin.a_buffer_bytes();
      geometry_passes_ = std::max(geometry_passes_, bin.geometry_passes());
      for (const auto& [name, values] : bin.pixel_counters()) {
        std::vector<float>& of_frame = result_.pixel_counters[name];
        of_frame.resize(pixels());
        counters[name] = &of_frame;
      }
    }
    for (const auto& [name, values] : bin.pixel_counters())
      copy_to_frame(values, tile, context_.frame, *counters.at(name));
    if (!bin.picture().empty()) place(bin.picture(), tile);
  }

  void charge_texture_dram() {
    if (texture_passes_.empty()) return;
    const std::size_t stages = result_.stages.size() - 1;  // of a bin
    const std::vector<std::uint64_t> bytes = texture_dram_bytes(context_.run.memory, texture_passes_, stages);
    for (std::size_t s = 0; s < stages; ++s) {
      result_.stages[s + 1].dram_bytes += bytes[s];
      result_.stages[s + 1].texture_dram_bytes += bytes[s];
    }
  }

  std::size_t pixels() const { return std::size_t{context_.frame.width} * context_.frame.height; }

  void place(const std::vector<glm::vec4>& picture, const Tile& tile) {
    const glm::vec4* from = picture.data();
    for (std::int32_t y = tile.y0; y < tile.y1; ++y, from += tile.width()) {
      const std::size_t first = static_cast<std::size_t>(y) * context_.frame.width + static_cast<std::size_t>(tile.x0);
      std::copy_n(&from->x, 4 * tile.width(), result_.image.rgba.data() + 4 * first);
    }
  }

  const FrameContext& context_;
  std::mutex mutex_;
  FrameResult result_;
  std::map<std::string, std::uint64_t> buffer_peaks_;
  std::vector<TexturePasses> texture_passes_;  // by bin; empty without textures
  int geometry_passes_ = 1;
};

}  // namespace

FrameResult render_bins(const FrameContext& context, const BinPlan& plan, const BinRenderer& render) {
  const RunOptions& run = context.run;
  const TileGrid grid = plan.keeps_tile_size ? TileGrid{context.frame, plan.framebuffer.bin_size}
                                             : tile_grid(context, plan.framebuffer.bin_size);
  if (run.weights) run.weights->assign(std::size_t{context.frame.width} * context.frame.height, {});
  GeometryPass pass(context);
  const std::vector<std::string> stages = stages_of(context, plan);
  FrameRecorder recorder(context, stages, grid.tiles.size());
  const std::uint64_t entry_bytes = sizeof(std::uint32_t) + (plan.sorts_lists ? kKeyBytes : 0);
  std::uint64_t list_bytes = 0;
  EmptyBins empty_bins(context, plan, stages, render);
  const bool shares_empty_bins = !plan.writes_frame && !run.timeline;
  const auto render_band = [&](const Band& band) {
    const std::vector<TriangleList> lists = bin_triangles(context.triangles, grid, band);
    for (const TriangleList& list : lists) {
      list_bytes += list.size() * entry_bytes;
      pass.add_list(run.memory, list, plan.sorts_lists);
    }
    const auto is_shared = [&](std::size_t i) { return shares_empty_bins && lists[i].empty(); };
    for (std::size_t i = 0; i < lists.size(); ++i)
      if (is_shared(i)) empty_bins.prepare(grid.tiles[band.first + i]);
    tbb::parallel_for(std::size_t{0}, lists.size(), [&](std::size_t i) {
      if (is_shared(i)) {
        const Tile& tile = grid.tiles[band.first + i];
        recorder.add_empty(empty_bins.like(tile), tile);
        return;
      }
      Bin bin(context, grid.tiles[band.first + i], lists[i], stages, plan.framebuffer);
      render(bin);
      bin.finish_memory();
      recorder.add(bin, band.first + i);
    });
  };
  for (const Band& band :
       split_into_bands(context.triangles, grid, {plan.pair_bytes, plan.translucent_pair_bytes, &context.shader},
                        thread_count(run.threads), run.memory_limit)) {
    if (band.first > 0) malloc_trim(0);  // glibc would keep the freed memory of a band in addition to the next one's
    on_threads(run.threads, [&] { render_band(band); });
  }
  FrameResult result = recorder.finish(pass, list_bytes);
  const auto side = static_cast<std::uint32_t>(grid.size);
  result.bin_pixels = std::min(side, context.frame.width) * std::min(side, context.frame.height);
  return result;
}

void run_on_tiles(const FrameContext& context, const std::string& stage, FrameResult& result,
                  const std::function<void(const Tile&, const BinStage&)>& work) {
  const std::vector<Tile> tiles = tile_grid(context, kBinSize).tiles;
  std::vector<StageCounters> of_tiles(tiles.size(), StageCounters{stage});
  on_threads(context.run.threads, [&] {
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
      const StageTimer timer(context.run.timeline, tiles[i]);
      work(tiles[i], BinStage(of_tiles[i], timer, context.run.memory));
    });
  });
  StageCounters& counters = result.stages.emplace_back(StageCounters{stage});
  for (const StageCounters& of_tile : of_tiles) counters += of_tile;
}

void copy_to_image(const std::vector<glm::vec4>& pixels, Image& image) {
  std::copy_n(&pixels.front().x, 4 * pixels.size(), image.rgba.begin());
}

}  // namespace beampipe
