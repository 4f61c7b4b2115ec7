// A bin: one tile of the frame and the triangles that touch it. It owns everything that is recorded while a technique
// renders it: stage counters and times, on-chip buffers, per-pixel counters, and the picture.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/bins/bin_observer.h"
#include "pipeline/bins/frame_context.h"
#include "pipeline/bins/timeline.h"
#include "pipeline/memory/framebuffer.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/memory/linear_memory.h"
#include "pipeline/memory/texture_memory.h"
#include "pipeline/memory/tile_surface.h"
#include "stages/data/tile.h"

namespace beampipe {

// One stage of a bin: its counters, and the timer that records when it runs.
class BinStage {
 public:
  BinStage(StageCounters& stage_counters, const StageTimer& timer, const MemorySystem& memory)
      : counters(stage_counters), timer_(timer), memory_(memory) {}

  // Stands for the counters in the call of the stage function, and times that call:
  //   conservative_raster(triangles, list, tile, stage.timed(), pairs);
  StageTimer::Span timed() const { return timer_(counters); }

  // Charges reading or writing the first `bytes` of the bin's part of an array, which no cache helps with.
  void reads(std::string_view array, std::uint64_t bytes) const {
    stream(memory_, DramAccess::read, {array}, bytes, counters);
  }
  void writes(std::string_view array, std::uint64_t bytes) const {
    stream(memory_, DramAccess::write, {array}, bytes, counters);
  }

  // The same where a stage does not tell reads from writes: recorded as reads of an array with the stage's name.
  void streams(std::uint64_t bytes) const { reads(name_of(counters.stage), bytes); }

  // Charges reading `bytes` and writing a copy, and so on in turn, `times` times, counted in sectors as one stream.
  void copies(std::string_view from, std::string_view to, int times, std::uint64_t bytes) const;

  // Charges moving `bytes` of an array in a row between a stage and L2, which holds them.
  void moves_in_l2(std::string_view array, std::uint64_t bytes) const {
    stream_in_l2(memory_, ArrayName{array}.number(memory_), bytes, counters);
  }

  StageCounters& counters;

 private:
  const StageTimer& timer_;
  const MemorySystem& memory_;
};

class Bin {
 public:
  const FrameContext& context;
  const Tile& tile;
  const TriangleList& list;

  // `stages`: in the order of the pipeline. `bins`: how many the frame has. Everything that is passed must outlive the
  // bin.
  Bin(const FrameContext& frame_context, const Tile& bin_tile, const TriangleList& triangles,
      const std::vector<Stage>& stages, const Framebuffer& framebuffer, std::size_t bins);
  Bin(const Bin&) = delete;
  Bin& operator=(const Bin&) = delete;

  // Throws std::logic_error when the technique has not listed the stage.
  BinStage stage(StageId id, Pass pass = Pass::main);

  const SetupTriangles& triangles() const { return context.triangles; }
  TileShader shader() const { return {context.shader, tile}; }
  const glm::vec3& background() const { return context.background; }

  // Who looks at the bin's pixels; null: nobody.
  BinObserver* observer() { return observer_ ? &*observer_ : nullptr; }
  const PixelObservers* observers() const { return observer_ ? &observer_->pixels() : nullptr; }

  // One value per pixel of the tile, row by row; all 0 when it is first asked for.
  std::vector<float>& pixel_counter(const std::string& name);

  // An on-chip buffer holds so many bytes now. Its peak is recorded.
  void holds(const std::string& buffer, std::uint64_t bytes) {
    std::uint64_t& peak = buffer_peaks_[buffer];
    peak = std::max(peak, bytes);
  }

  // An array that a stage of the bin keeps in memory while the bin is drawn.
  struct KeptInMemory {
    Stage stage;
    std::uint64_t peak_bytes = 0;
    std::uint64_t reads = 0, writes = 0;  // sectors that moved through L2
  };

  // The records that do not fit into a pool. Whoever adds up the bins that are in work at the same time knows how much
  // of them L2 holds.
  void spills(const KeptInMemory& records) { spilled_ = records; }

  // The bin keeps so many bytes of A-buffer in memory.
  void keeps_a_buffer(std::uint64_t bytes) { a_buffer_bytes_ += bytes; }

  // A pass of the bin over the frame begins, in which textures are read again; where it reads the geometry again too,
  // it is one more geometry pass, and else the pass before goes on.
  enum class Geometry { read_again, goes_on };
  void starts_pass(Pass pass, Geometry geometry);

  // Lets `by` render the bin, and accounts for what it has left open. Throws std::logic_error if it has read texels
  // that it did not charge.
  void render(const std::function<void(Bin&)>& by);

  // Does the technique have that stage? If not, it draws into the picture in memory.
  bool resolves() const { return find_counters(stages_, {StageId::resolve}) != nullptr; }

  // The finished picture: RGBA, one per pixel of the tile. Charges `resolve` with writing it to memory. Throws
  // std::logic_error if there is one already.
  void finish(std::vector<glm::vec4> picture);

  // ---- The modelled memory system ----
  const MemorySystem& memory() const { return memory_; }
  bool models_memory() const { return memory().modelled; }
  bool keeps_pixels_on_chip() const { return memory().framebuffer == Place::on_chip; }
  const ZOrder& z_order();              // of the tile's pixels
  TriangleFetches& triangle_fetches();  // setup and attributes that shaders fetch by a triangle's number

  // For AttributesInOrder: null if all triangles are flat.
  TriangleFetches* surface_fetches() { return context.shader.is_flat() ? nullptr : &triangle_fetches(); }

  // Collects the texels that a stage reads until they are charged; null if there are no textures.
  TexelRequests* texels() { return texels_ ? &*texels_ : nullptr; }
  void charge_texels(const BinStage& stage);

  // ---- What was recorded ----
  const DramLog* dram_log() const { return dram_log_ ? &*dram_log_ : nullptr; }  // null: it is not asked for
  const DramTally& dram_tally() const { return dram_tally_; }
  // In which pass of the log each geometry pass begins, and in which one each pass of textures reads texels.
  const std::vector<std::uint32_t>& geometry_pass_starts() const { return geometry_pass_starts_; }
  const std::vector<std::uint32_t>& texture_pass_starts() const { return texture_pass_starts_; }
  TexturePasses take_texture_passes() { return texture_fetches_ ? texture_fetches_->take_passes() : TexturePasses{}; }
  const std::vector<glm::vec4>& picture() const { return picture_; }  // empty: a later stage makes the frame's
  const std::vector<StageCounters>& stages() const { return stages_; }
  const std::map<std::string, std::vector<float>>& pixel_counters() const { return pixel_counters_; }
  const std::map<std::string, std::uint64_t>& buffer_peaks() const { return buffer_peaks_; }
  std::uint64_t a_buffer_bytes() const { return a_buffer_bytes_; }
  const KeptInMemory& spilled() const { return spilled_; }
  // Of the GPU's caches, of which the bin may have a part.
  CacheReach cache_reach() const;
  int geometry_passes(Pass pass) const { return pass == Pass::main ? std::max(geometry_passes_, 1) : prepasses_; }

 private:
  std::optional<BinObserver> observer_;
  StageTimer timer_;
  std::optional<DramLog> dram_log_;
  DramTally dram_tally_;
  CacheReach cache_reach_;
  MemorySystem memory_;                // with the place where this technique's pixels are
  std::vector<StageCounters> stages_;  // never grows, because stages hold references to their counters
  std::map<std::string, std::vector<float>> pixel_counters_;
  std::map<std::string, std::uint64_t> buffer_peaks_;
  std::uint64_t a_buffer_bytes_ = 0;
  KeptInMemory spilled_;
  int geometry_passes_ = 0, prepasses_ = 0;
  std::vector<std::uint32_t> geometry_pass_starts_, texture_pass_starts_ = {0};
  bool is_texture_pass_placed_ = false;
  std::vector<glm::vec4> picture_;
  std::optional<ZOrder> z_order_;
  std::optional<TriangleFetches> triangle_fetches_;
  std::optional<TexelRequests> texels_;
  std::optional<TextureFetches> texture_fetches_;
};

// Adds one to a pixel's count for each of its fragments.
template <class Fragment>
void count_by_pixel(const std::vector<Fragment>& fragments, std::vector<float>& counts) {
  for (const Fragment& fragment : fragments) ++counts[fragment.pixel];
}

}  // namespace beampipe
