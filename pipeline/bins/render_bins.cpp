#include "pipeline/bins/render_bins.h"

#include <malloc.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include "pipeline/bins/bands.h"
#include "pipeline/bins/threads.h"
#include "pipeline/memory/dram_trace.h"
#include "pipeline/memory/geometry_memory.h"
#include "stages/raster/bin_sort_cost.h"

namespace beampipe {
namespace {

TileGrid tile_grid(const FrameContext& context, int tile_size) {
  return {context.frame, context.run.tile_size > 0 ? context.run.tile_size : tile_size};
}

// Throws std::runtime_error if memory is modelled without bins, and the plan cannot do without.
TileGrid bin_grid(const FrameContext& context, const BinPlan& plan, int bin_size) {
  const MemoryParameters& memory = context.run.memory;
  if (memory.draws_unbinned()) {
    if (plan.framebuffer.needs_bins) throw std::runtime_error("the technique needs bins; the memory system has none");
    const auto side = static_cast<int>(std::max(context.frame.width, context.frame.height));
    return {context.frame, side + side % 2};
  }
  return plan.keeps_tile_size ? TileGrid{context.frame, bin_size} : tile_grid(context, bin_size);
}

// Those of the pre-pass, and BinPlan::stages for this frame.
std::vector<Stage> stages_of(const FrameContext& context, const BinPlan& plan) {
  std::vector<Stage> stages;
  if (plan.has_prepass) {
    stages = {{StageId::vertex_setup, Pass::prepass}, {StageId::sample_raster, Pass::prepass}};
    if (context.has_cutouts()) stages.emplace_back(StageId::alpha_test, Pass::prepass);
    stages.emplace_back(StageId::depth_test, Pass::prepass);
  }
  stages.emplace_back(StageId::vertex_setup);
  for (const StageId stage : plan.stages) {
    if (stage == StageId::blend && !context.rop && !context.has_blending()) continue;
    stages.emplace_back(stage);
    if (stage == StageId::beam_fragment && context.has_alpha()) stages.emplace_back(StageId::alpha_mask);
    if (stage == StageId::sample_raster && context.has_cutouts()) stages.emplace_back(StageId::alpha_test);
  }
  return stages;
}

// The plan's stage that does; none if the plan only looks at its bins.
StageId rasterizing_stage(const BinPlan& plan) {
  const auto found = std::ranges::find_if(plan.stages, [](StageId id) { return info_of(id).rasterizes; });
  return found == plan.stages.end() ? StageId::none : *found;
}

void stop_if_cancelled(const FrameInput& run) {
  if (run.cancelled && *run.cancelled) throw Cancelled();
}

// Where DRAM requests are to be recorded; null: nowhere.
DramTrace* dram_trace_of(const FrameContext& context) {
  return context.run.memory.modelled ? context.sinks.dram_trace : nullptr;
}

// What one pass over the geometry costs, whatever the technique.
struct GeometryPass {
  StageCounters setup, raster;
  DramTally tally;

  // `first_pass`: of the frame, for the record of DRAM requests.
  GeometryPass(const FrameContext& context, StageId raster_stage, std::uint32_t first_pass)
      : setup(context.setup), raster{raster_stage}, trace_(dram_trace_of(context)), first_pass_(first_pass) {
    const std::uint64_t triangles = context.setup.items_out;
    record(DramTrace::Step::setup, 0, [&](DramLog* log) {
      move_setup({context.run.memory, log, &tally}, context.setup.bytes_read, context.triangles.triangles.size(),
                 context.surface_bytes, setup);
    });
    raster.items_in = triangles;
    raster.bytes_read = triangles * sizeof(SetupTriangle);
  }

  void add_list(const MemoryParameters& memory, const TriangleList& list, bool is_sorted, std::size_t bin) {
    raster.empty_tiles += list.empty();
    record(DramTrace::Step::binning, bin, [&](DramLog* log) { write_list({memory, log, &tally}, list, raster); });
    record(DramTrace::Step::lists, bin, [&](DramLog* log) {
      if (is_sorted) {
        read_list({memory, log, &tally}, list, raster);
      } else {
        read_bin({memory, log, &tally}, list, raster);
      }
    });
  }

 private:
  // Calls move(log), and adds what it has recorded to the trace.
  template <class Move>
  void record(DramTrace::Step step, std::size_t bin, Move&& move) const {
    if (!trace_) return move(nullptr);
    DramLog log;
    move(&log);
    trace_->add(log, 0, first_pass_, step, bin);
  }

  DramTrace* trace_;
  std::uint32_t first_pass_;
};

// A bin without triangles.
struct EmptyBin {
  Bin bin;
  std::optional<glm::vec4> color{};  // that all pixels have
  bool has_counts = false;           // is any pixel counter not 0?

  // Of the bin, when it is rendered.
  void look_at_result() {
    const std::vector<glm::vec4>& picture = bin.picture();
    const auto differs = [&](const glm::vec4& pixel) { return pixel != picture.front(); };
    if (!picture.empty() && std::none_of(picture.begin(), picture.end(), differs)) color = picture.front();
    for (const auto& [name, values] : bin.pixel_counters())
      has_counts |= std::any_of(values.begin(), values.end(), [](float value) { return value != 0; });
  }
};

// Counts a bin as finished when it ends.
struct CountedBin {
  Completion* const completion;

  explicit CountedBin(Completion* of) : completion(of) {}
  ~CountedBin() {
    if (completion) ++completion->finished;
  }
  CountedBin(const CountedBin&) = delete;
  CountedBin& operator=(const CountedBin&) = delete;
};

// Renders bins without triangles, one of each size.
class EmptyBins {
 public:
  EmptyBins(const FrameContext& context, const Framebuffer& framebuffer, const std::vector<Stage>& stages,
            const BinRenderer& render, std::size_t bins)
      : context_(context), framebuffer_(framebuffer), stages_(stages), render_(render), frame_bins_(bins) {}

  // Not thread-safe.
  void prepare(const Tile& tile) {
    std::unique_ptr<EmptyBin>& empty = bins_[size_of(tile)];
    if (empty) return;
    empty.reset(new EmptyBin{.bin = {context_, tile, list_, stages_, framebuffer_, frame_bins_}});
    empty->bin.render(render_);
    empty->look_at_result();
  }

  const EmptyBin& like(const Tile& tile) const { return *bins_.at(size_of(tile)); }

  // The colour of some of them; 0 if there is none.
  glm::vec4 color() const {
    for (const auto& [size, empty] : bins_)
      if (empty->color) return *empty->color;
    return glm::vec4(0.0f);
  }

 private:
  using Size = std::pair<std::size_t, std::size_t>;
  static Size size_of(const Tile& tile) { return {tile.width(), tile.pixels()}; }

  const FrameContext& context_;
  const Framebuffer& framebuffer_;
  const std::vector<Stage>& stages_;
  const BinRenderer& render_;
  std::size_t frame_bins_;
  const TriangleList list_;
  std::map<Size, std::unique_ptr<EmptyBin>> bins_;
};

// Adds up what bins recorded. Only sums and the picture are kept, so that memory use stays that of the picture.
class FrameRecorder {
 public:
  FrameRecorder(const FrameContext& context, const std::vector<Stage>& stages, std::size_t bins,
                std::uint32_t first_pass)
      : context_(context),
        texture_passes_(context.texture_layout ? bins : 0),
        trace_(dram_trace_of(context)),
        first_pass_(first_pass),
        texture_pass_starts_(trace_ ? texture_passes_.size() : 0) {
    const Frame& frame = context.frame;
    result_.image = {frame.width, frame.height, {}};
    result_.bin_operations.resize(bins);
    result_.bin_invocations.resize(bins);
    spilled_.resize(bins);
    for (const Stage stage : stages) result_.stages.push_back(StageCounters{stage});
  }

  // Before bins are added: the picture starts with this colour, and bins without triangles that have it need not write
  // theirs.
  void start(const glm::vec4& color) {
    color_ = color;
    std::vector<glm::vec4> row(context_.frame.width, color);
    std::vector<float>& rgba = result_.image.rgba;
    rgba.reserve(4 * pixels());
    for (std::uint32_t y = 0; y < context_.frame.height; ++y)
      rgba.insert(rgba.end(), &row.front().x, &row.front().x + 4 * row.size());
  }

  // Thread-safe. `index`: of the bin, in the order in which bins are drawn.
  void add(Bin& bin, std::size_t index) {
    if (!texture_passes_.empty()) texture_passes_[index] = bin.take_texture_passes();
    if (!texture_pass_starts_.empty()) texture_pass_starts_[index] = bin.texture_pass_starts();
    if (trace_) trace_->add(*bin.dram_log(), first_pass_, index);
    add(bin, bin.tile, index, true, true);
  }

  // Thread-safe. Adds for `tile` what a bin of the same size recorded, which has no triangles either.
  void add_empty(const EmptyBin& empty, const Tile& tile, std::size_t index) {
    add(empty.bin, tile, index, empty.has_counts, empty.color != color_);
  }

  // `bins_in_work`: at the same time.
  FrameResult finish(const GeometryPass& pass, std::uint64_t list_bytes, std::uint64_t bins_in_work) {
    for (StageCounters& stage : result_.stages)
      for (const StageCounters* const of_pass : {&pass.setup, &pass.raster})
        for (int i = 0; stage.stage.id == of_pass->stage.id && i < passes(stage.stage.pass); ++i) stage += *of_pass;
    for (const Pass each : {Pass::prepass, Pass::main})
      tally_.add(pass.tally, each, static_cast<std::uint64_t>(passes(each)));
    if (trace_) repeat_geometry();
    charge_texture_dram();
    const std::uint64_t spilled = charge_spilled(bins_in_work);
    const std::uint64_t triangles = context_.triangles.triangles.size();
    if (!context_.run.memory.draws_unbinned())
      result_.buffers = {
          {"setup_triangles", triangles * (sizeof(SetupTriangle) + sizeof(FlatAttributes)) + context_.surface_bytes},
          {"bin_lists", list_bytes}};
    for (const auto& [name, bytes] : buffer_peaks_) result_.buffers.push_back({name, bytes, true});
    if (spilled > 0) result_.buffers.push_back({kSpilledRecords, spilled});
    result_.dram_arrays = tally_.sums();
    return std::move(result_);
  }

 private:
  // `has_counts`, `has_picture`: are the pixel counters and the picture other than what the frame starts with?
  void add(const Bin& bin, const Tile& tile, std::size_t index, bool has_counts, bool has_picture) {
    for (const StageCounters& stage : bin.stages()) {
      if (info_of(stage.stage.id).can_be_shader) result_.bin_operations[index] += stage.ops.total();
      if (stage.stage.id == StageId::shade) result_.bin_invocations[index] += stage.lanes_issued;
    }
    spilled_[index] = bin.spilled();
    std::map<std::string, std::vector<float>*> counters;  // of the frame
    {
      const std::lock_guard lock(mutex_);
      for (const StageCounters& stage : bin.stages()) *find_counters(result_.stages, stage.stage) += stage;
      tally_.add(bin.dram_tally());
      for (const auto& [name, bytes] : bin.buffer_peaks()) {
        std::uint64_t& peak = buffer_peaks_[name];
        peak = std::max(peak, bytes);
      }
      result_.a_buffer_peak_bytes += bin.a_buffer_bytes();
      result_.cache_reach.add(bin.cache_reach());
      passes_ = std::max(passes_, bin.geometry_passes(Pass::main));
      prepasses_ = std::max(prepasses_, bin.geometry_passes(Pass::prepass));
      for (std::size_t i = 0; i < bin.geometry_pass_starts().size(); ++i) {
        if (i == geometry_pass_starts_.size()) geometry_pass_starts_.push_back(~0u);
        geometry_pass_starts_[i] = std::min(geometry_pass_starts_[i], bin.geometry_pass_starts()[i]);
      }
      for (const auto& [name, values] : bin.pixel_counters()) {
        std::vector<float>& of_frame = result_.pixel_counters[name];
        of_frame.resize(pixels());
        counters[name] = &of_frame;
      }
    }
    if (has_counts)
      for (const auto& [name, values] : bin.pixel_counters())
        copy_to_frame(values, tile, context_.frame, *counters.at(name));
    if (has_picture && !bin.picture().empty()) place(bin.picture(), tile);
  }

  // What was recorded of the first pass over the geometry is part of the later ones too. Those of the depth pre-pass
  // come first of all.
  void repeat_geometry() {
    std::vector<DramTrace::GeometryPass> passes;
    for (std::size_t i = 0; i < std::max(geometry_pass_starts_.size(), std::size_t{1}); ++i)
      passes.push_back(
          {first_pass_ + (i == 0 ? 0 : geometry_pass_starts_[i]), i < static_cast<std::size_t>(prepasses_)});
    trace_->repeat(passes, DramTrace::Step::setup, DramTrace::Step::lists);
  }

  void charge_texture_dram() {
    if (texture_passes_.empty()) return;
    const auto bytes = texture_dram_bytes(context_.run.memory, texture_passes_, trace_ ? record_texels() : nullptr);
    for (StageCounters& stage : result_.stages) {
      stage.dram_bytes += bytes[stage.stage.number()];
      stage.texture_dram_bytes += bytes[stage.stage.number()];
      tally_.add(tally_.array("texels"), DramAccess::read, stage.stage, bytes[stage.stage.number()]);
      tally_.add_l2(tally_.array("texels"), stage.stage, stage.texture_l2_bytes);
    }
  }

  // L2 holds what the bins in work keep in memory, as far as it has room. What is beyond that moves to and from DRAM.
  // Returns the most bytes that are kept at once.
  std::uint64_t charge_spilled(std::uint64_t bins_in_work) {
    const std::uint64_t room = context_.run.memory.l2.bytes;
    std::uint64_t most = 0;
    for (std::size_t first = 0; first < spilled_.size(); first += bins_in_work) {
      const std::size_t end = std::min(first + bins_in_work, spilled_.size());
      std::uint64_t held = 0;
      for (std::size_t bin = first; bin < end; ++bin) held += spilled_[bin].peak_bytes;
      most = std::max(most, held);
      result_.cache_reach.add({.l2 = held});
      for (std::size_t bin = first; held > room && bin < end; ++bin)
        move_spilled(bin, static_cast<double>(held - room) / static_cast<double>(held));
    }
    return most;
  }

  // `part`: of the requests that L2 does not answer.
  void move_spilled(std::size_t bin, double part) {
    const Bin::KeptInMemory& kept = spilled_[bin];
    if (kept.reads + kept.writes == 0) return;
    const MemoryParameters& memory = context_.run.memory;
    const auto missed = [&](std::uint64_t sectors) {
      return static_cast<std::uint64_t>(static_cast<double>(sectors) * part) * memory.sector_bytes;
    };
    DramLog log;
    const MemorySystem system{memory, trace_ ? &log : nullptr, &tally_};
    const ArrayPart records{{kSpilledRecords}, tally_.array(kSpilledRecords)};
    StageCounters& counters = *find_counters(result_.stages, kept.stage);
    stream_in_dram(system, DramAccess::write, records, missed(kept.writes), counters);
    stream_in_dram(system, DramAccess::read, records, missed(kept.reads), counters);
    if (trace_) trace_->add(log, first_pass_, bin);
  }

  // The texels that a bin fetches in a pass over the frame follow the bin's other requests in that pass.
  TextureFetch record_texels() {
    return [this](std::size_t bin, std::size_t pass, const std::vector<TextureRead>& reads) {
      DramLog log;
      const std::uint16_t texels = log.array("texels", false);
      const std::uint32_t per_line = context_.run.memory.sectors_per_line();
      for (const TextureRead& read : reads)
        for (std::uint32_t sector = 0; sector < per_line; ++sector)
          if (read.sectors >> sector & 1)
            log.add(texels, DramAccess::read, std::uint64_t{read.line} * per_line + sector, 1,
                    Stage::of_number(read.stage));
      trace_->add(log, 0, first_pass_ + texture_pass_starts_[bin][pass], DramTrace::Step::texels, bin);
    };
  }

  int passes(Pass pass) const { return pass == Pass::main ? passes_ : prepasses_; }

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
  DramTally tally_;
  glm::vec4 color_{0.0f};  // that the picture starts with
  std::map<std::string, std::uint64_t> buffer_peaks_;
  std::vector<TexturePasses> texture_passes_;  // by bin; empty without textures
  std::vector<Bin::KeptInMemory> spilled_;     // by bin
  int passes_ = 1, prepasses_ = 0;
  DramTrace* trace_;
  std::uint32_t first_pass_;                                     // of the trace
  std::vector<std::uint32_t> geometry_pass_starts_;              // of any bin
  std::vector<std::vector<std::uint32_t>> texture_pass_starts_;  // by bin
};

}  // namespace

FrameResult render_bins(const FrameContext& context, const BinPlan& plan, const BinRenderer& render) {
  const FrameInput& run = context.run;
  const Framebuffer framebuffer = context.has_blending() ? plan.framebuffer.with_translucent() : plan.framebuffer;
  const int bin_size = framebuffer.bin_size_on(run.memory);
  const TileGrid grid = bin_grid(context, plan, bin_size);
  const FrameSinks& sinks = context.sinks;
  if (sinks.weights) sinks.weights->assign(std::size_t{context.frame.width} * context.frame.height, {});
  if (sinks.histories) sinks.histories->assign(run.pixels->size(), {});
  const std::vector<Stage> stages = stages_of(context, plan);
  const std::uint32_t first_pass = sinks.dram_trace ? sinks.dram_trace->passes() : 0;
  GeometryPass pass(context, rasterizing_stage(plan), first_pass);
  FrameRecorder recorder(context, stages, grid.tiles.size(), first_pass);
  const std::uint64_t entry_bytes = sizeof(std::uint32_t) + (plan.sorts_lists ? kKeyBytes : 0);
  std::uint64_t list_bytes = 0;
  EmptyBins empty_bins(context, framebuffer, stages, render, grid.tiles.size());
  const bool shares_empty_bins = !plan.empty_bins_differ && !sinks.timeline && !sinks.dram_trace && !sinks.histories;
  if (sinks.completion) sinks.completion->finished = 0, sinks.completion->all = grid.tiles.size();
  const auto render_band = [&](const Band& band) {
    const std::vector<TriangleList> lists = bin_triangles(context.triangles, grid, band);
    for (std::size_t i = 0; i < lists.size(); ++i) {
      list_bytes += lists[i].size() * entry_bytes;
      pass.add_list(run.memory, lists[i], plan.sorts_lists, band.first + i);
    }
    const auto is_shared = [&](std::size_t i) { return shares_empty_bins && lists[i].empty(); };
    for (std::size_t i = 0; i < lists.size(); ++i)
      if (is_shared(i)) empty_bins.prepare(grid.tiles[band.first + i]);
    if (band.first == 0) recorder.start(empty_bins.color());
    tbb::parallel_for(std::size_t{0}, lists.size(), [&](std::size_t i) {
      stop_if_cancelled(run);
      const CountedBin counted(sinks.completion);
      const auto is_here = [&](const PixelAddress& pixel) { return grid.tiles[band.first + i].holds(pixel); };
      if (run.pixels && std::none_of(run.pixels->begin(), run.pixels->end(), is_here)) return;
      if (is_shared(i)) {
        const Tile& tile = grid.tiles[band.first + i];
        recorder.add_empty(empty_bins.like(tile), tile, band.first + i);
        return;
      }
      Bin bin(context, grid.tiles[band.first + i], lists[i], stages, framebuffer, grid.tiles.size());
      bin.render(render);
      if (BinObserver* const observer = bin.observer()) observer->finish(bin.list, plan.order, bin.picture());
      recorder.add(bin, band.first + i);
    });
  };
  for (const Band& band :
       split_into_bands(context.triangles, grid, {plan.pair_bytes, plan.translucent_pair_bytes, &context.shader},
                        thread_count(run.threads), run.memory_limit)) {
    if (band.first > 0) malloc_trim(0);  // glibc would keep the freed memory of a band in addition to the next one's
    on_threads(run.threads, [&] { render_band(band); });
  }
  FrameResult result = recorder.finish(pass, list_bytes, framebuffer.bins_in_work(run.memory));
  const auto in_memory = [&](const Framebuffer& of) {
    return std::uint64_t{bytes_per_pixel(of.in_memory(run.memory))} * context.frame.width * context.frame.height;
  };
  if (in_memory(framebuffer) > in_memory(plan.framebuffer))
    result.buffers.push_back({kTranslucentLayer, in_memory(framebuffer) - in_memory(plan.framebuffer)});
  const auto side = static_cast<std::uint32_t>(grid.size);
  result.bin_pixels = std::min(side, context.frame.width) * std::min(side, context.frame.height);
  for (std::uint32_t draw = 0; draw < context.frame.draws.size(); ++draw)
    if (const std::uint64_t stopped = context.shader.stopped(draw)) result.stopped.push_back({draw, stopped});
  return result;
}

void run_on_tiles(const FrameContext& context, StageId stage, FrameResult& result,
                  const std::function<void(const Tile&, const BinStage&)>& work) {
  const std::vector<Tile> tiles = tile_grid(context, static_cast<int>(context.run.memory.bin_pixels)).tiles;
  std::vector<StageCounters> of_tiles(tiles.size(), StageCounters{stage});
  std::vector<DramTally> tallies(tiles.size());
  DramTrace* const trace = dram_trace_of(context);
  const std::uint32_t pass = trace ? trace->passes() : 0;
  on_threads(context.run.threads, [&] {
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
      stop_if_cancelled(context.run);
      const StageTimer timer(context.sinks.timeline, tiles[i]);
      DramLog log;
      const MemorySystem memory(context.run.memory, trace ? &log : nullptr, &tallies[i]);
      work(tiles[i], BinStage(of_tiles[i], timer, memory));
      if (trace) trace->add(log, pass, i);
    });
  });
  StageCounters& counters = result.stages.emplace_back(StageCounters{stage});
  for (const StageCounters& of_tile : of_tiles) counters += of_tile;
  DramTally tally;
  for (const DramTally& of_tile : tallies) tally.add(of_tile);
  for (const ArrayBytes& bytes : tally.sums()) result.dram_arrays.push_back(bytes);
}

void copy_to_image(const std::vector<glm::vec4>& pixels, Image& image) {
  std::copy_n(&pixels.front().x, 4 * pixels.size(), image.rgba.begin());
}

}  // namespace beampipe
