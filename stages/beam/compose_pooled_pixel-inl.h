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
  RecordView<Words> record;

  void look_at(std::uint32_t pixel) {
    index = pixel;
    word_ = &pixels_.words[pixel];
  }
  const PixelWord& word() const { return *word_; }
  void look_at_record() {
    shape = word_->shape;
    area = word_->area;
    record = pixels_.records.view(word_->record_size, word_->number);
  }
  const CoverDepth& cover_depth() const { return pixels_.covers[index]; }

  // The positions of owner k.
  Mask owned(std::size_t k) const { return Mask(record.owned(k)); }
  void own(std::size_t k, const Mask& positions) { positions.store(record.owned(k)); }

  // Takes the pixel's state apart.
  void open() {
    empty = final = Mask::filled(false);
    if (word_->kind == PixelKind::open) {
      look_at_record();
      ++work_.splits[shape.planes()];
      count_read(shape.planes() * 4 * Words);
      if (shape.has_empty) empty = Mask(record.head->empty);
      if (shape.has_final) final = Mask(record.head->final);
      return;
    }
    area = {};
    shape = {};
    record = pixels_.records.view(0, spare_);
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
    const std::uint32_t larger = pixels_.records.take(size);
    const RecordView<Words> view = pixels_.records.view(size, larger);
    for (std::size_t k = 0; k < shape.owners; ++k) {
      view.set(k, record.slots[k], record.plane(k), record.farthest(k));
      owned(k).store(view.owned(k));
    }
    view.head->sums = record.head->sums;
    pixels_.records.give_back(word_->record_size, word_->number);
    word_->record_size = size;
    word_->number = larger;
    record = view;
  }

  // The sums will be read and written.
  void use_sums() {
    work_.bytes_written += sizeof(PixelSums);
    if (shape.has_sums) {
      work_.bytes_read += sizeof(PixelSums);
    } else {
      record.head->sums = {};
      shape.has_sums = true;
    }
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
  }
  // `triangle`: its number in the list.
  void cover(std::uint32_t triangle, const CoverDepth& depth) {
    release();
    word_->kind = PixelKind::covered;
    word_->number = triangle;
    pixels_.covers[index] = depth;
  }
  void store() {
    if (word_->kind != PixelKind::open) {
      word_->kind = PixelKind::open;
      word_->record_size = 0;
      word_->number = spare_;
      spare_ = pixels_.records.take(0);
    }
    ++work_.joins[shape.states()];
    store_sums();
    count_write(shape.planes() * 4 * Words);
    if (shape.has_empty) empty.store(record.head->empty);
    if (shape.has_final) final.store(record.head->final);
  }
  // The same where positions have not changed.
  void store_sums() {
    pixels_.pool.resize(word_->chunks, shape.chunks(Words));
    float& most = result_.maps.record_bytes[index];
    most = std::max(most, static_cast<float>(word_->chunks.count * (kChunkBytes + kChunkLinkBytes)));
    word_->shape = shape;
    word_->area = area;
  }

  // Every access follows the links of the record's chunks.
  void count_read(std::size_t bytes) {
    work_.bytes_read += bytes + word_->chunks.count * kChunkLinkBytes;
    count_visit(false);
  }

 private:
  static constexpr std::uint32_t kPositions = 32 * Words;

  void release() {
    if (word_->kind != PixelKind::open) return;
    pixels_.records.give_back(word_->record_size, word_->number);
    pixels_.pool.resize(word_->chunks, 0);
  }

  void count_write(std::size_t bytes) {
    work_.bytes_written += bytes;
    count_visit(true);
  }
  void count_visit(bool is_write) {
    if (result_.lists_visits) result_.visits.push_back({number, index, word_->chunks.count, is_write});
    if (word_->chunks.in_memory == 0) return;
    result_.chunks_in_memory += word_->chunks.in_memory;
    result_.maps.memory_chunks[index] += static_cast<float>(word_->chunks.in_memory);
  }

  PooledPixels<Words>& pixels_;
  PooledResult& result_;
  PooledWork& work_;
  PixelWord* word_ = nullptr;
  std::uint32_t spare_;  // a record for a pixel that has none yet
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
