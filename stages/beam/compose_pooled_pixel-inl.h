// The pixel that compose_pooled works on: its state taken apart, and put together again. Inlined into kernels, once per
// SIMD target.
#if defined(BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_PIXEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_PIXEL_INL_H_
#undef BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_PIXEL_INL_H_
#else
#define BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_PIXEL_INL_H_
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "stages/beam/compose_pooled.h"
#include "stages/beam/compose_pooled_cost.h"
#include "stages/beam/register_mask-inl.h"
#include "stages/data/pooled_pixels.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace {

template <std::size_t Words>
class PixelAtHand {
 public:
  using Mask = HWY_NAMESPACE::Mask<Words>;

  PixelAtHand(PooledPixels<Words>& pixels, PooledResult& result, PooledWork& work)
      : pixels_(pixels), result_(result), work_(work), spare_(pixels.records.take(0)) {}
  PixelAtHand(const PixelAtHand&) = delete;
  ~PixelAtHand() { pixels_.records.give_back(0, spare_); }

  std::uint32_t index = 0;   // within the tile
  std::uint32_t number = 0;  // in the list, of the triangle for which pixels are looked at

  // What rules work on, from open() to store(); of specks, from look_at_record().
  RecordShape shape;
  FixedSum area;
  Mask empty, final;
  std::size_t new_slots = 0;  // that a record which is stored has to write
  RecordView<Words> record;

  void look_at(std::uint32_t pixel) {
    index = pixel;
    word_ = &pixels_.words[pixel];
  }
  const PixelWord& word() const { return *word_; }
  HWY_INLINE void look_at_record() {
    shape = word_->shape;
    area = word_->area;
    record = RecordStore<Words>::view(word_->record_size, word_->record);
  }
  const CoverDepth& cover_depth() const { return pixels_.covers[index]; }

  // Is there room for the record as its shape is now, or would be?
  bool has_room() const { return has_room(shape); }
  bool has_room(const RecordShape& record_shape) const {
    return pixels_.pool.has_room(word_->kind == PixelKind::open ? word_->chunks : ChunkPool::Chunks{},
                                 record_shape.chunks(Words));
  }

  // The positions of owner k.
  Mask owned(std::size_t k) const { return Mask(record.owned(k)); }
  void own(std::size_t k, const Mask& positions) { positions.store(record.owned(k)); }

  // Takes the pixel's state apart.
  HWY_INLINE void open() {
    take_apart();
    if (word_->kind != PixelKind::open) return;
    ++work_.splits[shape.planes()];
    count_read(shape.planes() * 4 * Words);
  }
  // The same without what it costs.
  HWY_INLINE void take_apart() {
    empty = final = Mask::filled(false);
    new_slots = 0;
    if (word_->kind == PixelKind::open) {
      look_at_record();
      if (shape.has_empty) empty = Mask(record.head->empty);
      if (shape.has_final) final = Mask(record.head->final);
      return;
    }
    area = {};
    shape = {};
    record = RecordStore<Words>::view(0, spare_);
    if (word_->kind == PixelKind::covered) {
      OwnerSlot slot;
      slot.set(word_->number, 0.0f, kPositions, 0.5f, 0.5f);
      record.set(0, slot, cover_depth().plane, cover_depth().farthest);
      own(0, Mask::filled(true));
      shape.owners = 1;
    } else {
      empty = Mask::filled(true);
      shape.has_empty = true;
    }
  }

  // There is room for so many owners. Only open pixels have more than fit into the spare record.
  void make_room_for(std::size_t owners) {
    if (owners <= RecordStore<Words>::owners_in(0) || word_->kind != PixelKind::open) return;
    const std::uint8_t size = RecordStore<Words>::size_for(owners);
    if (size <= word_->record_size) return;
    void* const larger = pixels_.records.take(size);
    const RecordView<Words> view = RecordStore<Words>::view(size, larger);
    for (std::size_t k = 0; k < shape.owners; ++k) {
      view.set(k, record.slots[k], record.plane(k), record.farthest(k));
      owned(k).store(view.owned(k));
    }
    view.head->sums = record.head->sums;
    view.head->nearest_speck = record.head->nearest_speck;
    pixels_.records.give_back(word_->record_size, word_->record);
    word_->record_size = size;
    word_->record = larger;
    record = view;
  }

  // The sums will be read and written.
  void use_sums() {
    work_.bytes_written += sizeof(PixelSums);
    if (shape.has_sums) {
      work_.bytes_read += sizeof(PixelSums);
    } else {
      record.head->sums = {};
      record.head->nearest_speck = kNoDepth;
      shape.has_sums = true;
    }
  }

  // Of a frame's pool, where nothing is final before the end and sums are of specks.
  void forget_sums() { shape.has_sums = false, area = {}; }

  FinalSums<std::int32_t, std::uint32_t> sums() const { return {area.units, record.head->sums.colors.load()}; }
  void set_sums(const FinalSums<std::int32_t, std::uint32_t>& sums) {
    area.units = static_cast<std::uint16_t>(sums.area);
    record.head->sums.colors.store(sums.colors);
  }

  bool is_finished() const { return shape.owners == 0 && !shape.has_empty; }
  bool is_covered_by_one() const {
    return shape.owners == 1 && shape.states() == 1 && !shape.has_sums && !record.slots[0].is_merged() &&
           record.slots[0].covered() == kPositions && record.slots[0].error() == 0;
  }

  // Puts the pixel's state together again: as finished, covered by one triangle, or open.
  void finish(const PixelColor& color) {
    release();
    word_->kind = PixelKind::finished;
    for (std::size_t c = 0; c < 3; ++c) word_->color[c] = HalfBits(color.color[c]);
    work_.bytes_written += kPixelWordBytes;
  }
  // `triangle`: its number in the list.
  void cover(std::uint32_t triangle, const CoverDepth& depth) {
    release();
    word_->kind = PixelKind::covered;
    word_->number = triangle;
    pixels_.covers[index] = depth;
    work_.bytes_written += kPixelWordBytes;
  }
  HWY_INLINE void store() {
    if (word_->kind != PixelKind::open) {
      const bool has_cover =
          word_->kind == PixelKind::covered && shape.owners > 0 && record.slots[0].triangle() == word_->number;
      new_slots += has_cover;
      word_->kind = PixelKind::open;
      word_->record_size = 0;
      word_->record = spare_;
      spare_ = pixels_.records.take(0);
    }
    ++work_.joins[shape.states()];
    work_.bytes_written += shape.planes() * 4 * Words + new_slots * sizeof(OwnerSlot);
    if (shape.has_empty) empty.store(record.head->empty);
    if (shape.has_final) final.store(record.head->final);
    store_sums();
  }
  // The same where positions have not changed.
  HWY_INLINE void store_sums() {
    resize(shape.chunks(Words));
    word_->shape = shape;
    word_->area = area;
    work_.bytes_written += kPixelWordBytes;
    count_visit(true);
  }

  // Every access follows the links of the record's chunks.
  HWY_INLINE void count_read(std::size_t bytes) {
    work_.bytes_read += bytes + word_->chunks.count * pixels_.pool.link_bytes();
    count_visit(false);
  }

 private:
  static constexpr std::uint32_t kPositions = 32 * Words;

  void release() {
    if (word_->kind != PixelKind::open) return;
    pixels_.records.give_back(word_->record_size, word_->record);
    resize(0);
    count_visit(true);
  }

  // Free chunks are linked: each one that is taken says which one is the next. The last chunk of the record is linked
  // to the first one that is taken; the last one that is given back, to those that are free already.
  //
  // Chunks in memory are the first to be given back. What they held may still be needed; then it moves to chunks on
  // chip that held something else. So many move at most, which is what is charged.
  HWY_INLINE void resize(std::uint32_t count) {
    ChunkPool::Chunks& chunks = word_->chunks;
    const ChunkPool::Chunks before = chunks;
    if (count == before.count) return;
    pixels_.pool.resize(chunks, count);
    if (before.count > 0) work_.bytes_written += pixels_.pool.link_bytes();
    if (count > before.count) {
      float& most = result_.maps.record_bytes[index];
      most = std::max(most, static_cast<float>(count * (kChunkBytes + pixels_.pool.link_bytes())));
      work_.bytes_read += (count - before.count) * pixels_.pool.link_bytes();
      if (chunks.in_memory > before.in_memory) count_spills({.reads = chunks.in_memory - before.in_memory + 0u});
    } else if (chunks.in_memory < before.in_memory) {
      const std::uint32_t moved = std::min<std::uint32_t>(before.in_memory, count) - chunks.in_memory;
      work_.bytes_read += moved * kChunkBytes;
      work_.bytes_written += moved * kChunkBytes;
      count_spills({.reads = moved, .writes = 1});
    }
  }

  HWY_INLINE void count_visit(bool is_write) {
    const ChunkPool::Chunks& chunks = word_->chunks;
    if (result_.lists_visits) [[unlikely]]
      result_.visits.push_back({number, index, chunks.count, is_write});
    if (chunks.in_memory > 0) [[unlikely]]
      count_spills(is_write ? ChunkRequests{.writes = chunks.in_memory} : ChunkRequests{.reads = chunks.in_memory});
  }
  void count_spills(const ChunkRequests& requests) {
    result_.spills += requests;
    result_.maps.memory_chunks[index] += static_cast<float>(requests.all());
  }

  PooledPixels<Words>& pixels_;
  PooledResult& result_;
  PooledWork& work_;
  PixelWord* word_ = nullptr;
  void* spare_;  // a record for a pixel that has none yet
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
