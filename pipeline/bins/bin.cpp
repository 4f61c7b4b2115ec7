#include "pipeline/bins/bin.h"

#include <stdexcept>

namespace beampipe {

void BinStage::copies(std::string_view from, std::string_view to, int times, std::uint64_t bytes) const {
  for (std::uint64_t i = 0; i < 2 * static_cast<std::uint64_t>(times); ++i)
    stream(memory_, i % 2 == 0 ? DramAccess::read : DramAccess::write, {i % 2 == 0 ? from : to},
           (memory_.sectors((i + 1) * bytes) - memory_.sectors(i * bytes)) * memory_.sector_bytes, counters);
}

Bin::Bin(const FrameContext& frame_context, const Tile& bin_tile, const TriangleList& triangles,
         const std::vector<Stage>& stages, const Framebuffer& framebuffer, std::size_t bins)
    : context(frame_context),
      tile(bin_tile),
      list(triangles),
      timer_(context.sinks.timeline, tile),
      memory_(framebuffer.memory_of_bin(context.run.memory, bins)) {
  if (context.sinks.weights || context.sinks.histories) observer_.emplace(context, tile);
  memory_.reach = &cache_reach_;
  memory_.tally = &dram_tally_;
  if (context.sinks.dram_trace && memory_.modelled) memory_.log = &dram_log_.emplace();
  if (keeps_pixels_on_chip()) holds(kOpenPixels, tile.pixels() * framebuffer.on_chip_bytes_per_pixel());
  stages_.reserve(stages.size());
  for (const Stage stage : stages) stages_.push_back(StageCounters{stage});
  if (context.has_textures()) texels_.emplace(context.texture_layout ? &*context.texture_layout : nullptr);
  if (context.texture_layout) {
    const std::uint64_t bytes = context.texture_layout->bytes();
    cache_reach_.add({.l1 = bytes, .l2 = bytes});
    texture_fetches_.emplace(memory_);
  }
}

CacheReach Bin::cache_reach() const {
  CacheReach reach = cache_reach_;
  const std::uint32_t all = context.run.memory.rop.bytes, part = memory_.rop.bytes;
  reach.rop *= (all + part - 1) / part;
  return reach;
}

BinStage Bin::stage(StageId id, Pass pass) {
  if (StageCounters* const counters = find_counters(stages_, {id, pass})) return {*counters, timer_, memory()};
  throw std::logic_error("the technique has no stage " + std::string(name_of({id, pass})));
}

std::vector<float>& Bin::pixel_counter(const std::string& name) {
  std::vector<float>& values = pixel_counters_[name];
  if (values.empty()) values.resize(tile.pixels());
  return values;
}

void Bin::finish(std::vector<glm::vec4> picture) {
  if (!picture_.empty()) throw std::logic_error("the bin has a picture already");
  picture_ = std::move(picture);
  if (models_memory() && keeps_pixels_on_chip())
    for (float& bytes : pixel_counter("bytes")) bytes += static_cast<float>(kPictureBytes);
  if (resolves()) stage(StageId::resolve).writes("picture", tile.pixels() * kPictureBytes);
}

const ZOrder& Bin::z_order() {
  if (!z_order_) z_order_.emplace(tile.width(), tile.height());
  return *z_order_;
}

TriangleFetches& Bin::triangle_fetches() {
  if (!triangle_fetches_) triangle_fetches_.emplace(memory(), list, &context.shader);
  return *triangle_fetches_;
}

void Bin::charge_texels(const BinStage& stage) {
  if (!texels_) return;
  const std::uint64_t bytes = texels_->texels() * kTexelBytes;
  stage.counters.bytes_read += bytes;
  stage.counters.texture_bytes += bytes;
  if (dram_log_ && texels_->texels() > 0 && !is_texture_pass_placed_) {
    texture_pass_starts_.back() = dram_log_->pass();
    is_texture_pass_placed_ = true;
  }
  if (texture_fetches_) texture_fetches_->read(*texels_, stage.counters);
  texels_->clear();
}

void Bin::starts_pass(Pass pass, Geometry geometry) {
  if (geometry == Geometry::read_again) {
    ++(pass == Pass::main ? geometry_passes_ : prepasses_);
    if (dram_log_) {
      dram_log_->start_pass();
      geometry_pass_starts_.push_back(dram_log_->pass());
    }
  }
  if (texture_fetches_) texture_fetches_->start_pass();
  if (!dram_log_) return;
  dram_log_->start_pass();
  texture_pass_starts_.push_back(dram_log_->pass());
  is_texture_pass_placed_ = false;
}

void Bin::render(const std::function<void(Bin&)>& by) {
  by(*this);
  if (texels_ && texels_->texels() > 0) throw std::logic_error("a stage has read texels that none is charged for");
  // Serves the fetch that is still open, on the account of the stage that asked.
  StageCounters nothing_is_written;
  if (triangle_fetches_) triangle_fetches_->flush(nothing_is_written);
}

}  // namespace beampipe
