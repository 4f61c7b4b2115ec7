#include "stages/beam/compose_pooled.h"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "simd/conserve.h"
#include "simd/plane_gap.h"
#include "simd/plane_order.h"
#include "simd/prefetch.h"
#include "stages/beam/compose_pooled_cost.h"
#include "stages/beam/owner_rules.h"
#include "stages/data/pixel_depth.h"

// One version for vectors of 256 bits, which hold a whole mask, and one without vectors.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/beam/compose_pooled.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/plane_sides-inl.h"
#include "stages/beam/register_mask-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace {

// Of numbers, beside those of vectors.
using beampipe::greater, beampipe::lesser, beampipe::magnitude;

// Works on one pixel at a time: takes its state apart (begin), applies the rules, and puts it together again (store).
template <std::size_t Words>
class PooledComposer {
 public:
  using Mask = HWY_NAMESPACE::Mask<Words>;

  PooledComposer(const OwnersBin& bin, PooledPixels<Words>& pixels, PooledResult& result)
      : bin_(bin), pixels_(pixels), result_(result), spare_(pixels.records.take(0)) {}
  PooledComposer(const PooledComposer&) = delete;
  ~PooledComposer() { pixels_.records.give_back(0, spare_); }

  enum class Outcome { hidden, composed, merged };  // merged: two owners became one

  // `number`: of the fragment's triangle in the list. Whether closed pixels hide the fragment is decided here, although
  // the raster has left out many already: so pictures do not depend on how far the raster is ahead.
  Outcome add(const Fragment& fragment, std::uint32_t number, ClosedDepth& closed) {
    ++work.fragments;
    number_ = number;
    if (bin_.watermarks && pixels_.pool.wants_collection()) collect((*bin_.watermarks)[number], closed);
    if (closed.is_hidden(fragment.pixel, fragment.z_min)) return Outcome::hidden;
    look_at(fragment.pixel);
    const Mask mask(fragment.mask);
    if (mask.none()) {
      if (observer_) observer_->arrives(fragment, {});
      add_speck(fragment);
      return Outcome::composed;
    }
    const bool covers = fragment.alpha == 1.0f && mask == everywhere();
    if (word_->kind == PixelKind::covered) {
      const Side side = side_of(fragment);
      if (side == Side::farther || (side == Side::nearer && covers)) {
        if (observer_) observer_->arrives(fragment, side == Side::nearer ? fragment.mask : WideMask{});
        if (side == Side::nearer) cover(fragment, number, closed);
        return Outcome::composed;
      }
    } else if (word_->kind == PixelKind::untouched && covers) {
      if (observer_) observer_->arrives(fragment, fragment.mask);
      cover(fragment, number, closed);
      return Outcome::composed;
    }
    begin();
    return share(fragment, mask, number, closed);
  }

  // Computes the colours of all owners that are left, for finish(). The modelled machine shades owners as they become
  // final, so this leaves them alone if their requests for texels are kept.
  void shade_all() {
    if (bin_.shader.is_flat() || bin_.shade_at != OwnerPlace::covered) return;
    if (result_.texels && result_.texels->are_kept()) return;
    std::vector<Invocation> invocations;
    const auto add = [&](std::uint32_t pixel, std::uint32_t number, float u, float v) {
      const std::uint32_t triangle = bin_.list[number];
      shaded_at_.push_back(bin_.shader.is_flat(triangle) ? kNotShaded : static_cast<std::uint32_t>(invocations.size()));
      if (shaded_at_.back() != kNotShaded) invocations.push_back({triangle, bin_.shader.place(pixel, u, v)});
    };
    for (std::uint32_t pixel = 0; pixel < pixels_.words.size(); ++pixel) {
      first_shaded_.push_back(static_cast<std::uint32_t>(shaded_at_.size()));
      look_at(pixel);
      if (word_->kind == PixelKind::covered) add(pixel, word_->number, 0.5f, 0.5f);
      if (word_->kind != PixelKind::open) continue;
      const RecordView<Words> record = pixels_.records.view(word_->record_size, word_->number);
      for (std::size_t k = 0; k < word_->shape.owners; ++k) {
        const OwnerSlot& slot = record.slots[k];
        if (slot.is_merged()) {
          shaded_at_.push_back(kNotShaded);
        } else {
          add(pixel, slot.triangle(), slot.centroid().x, slot.centroid().y);
        }
      }
    }
    colors_ = bin_.shader.colors(invocations, result_.texels);
  }

  // All owners are final. `pixel`: index in the tile. Returns its colour.
  PixelColor finish(std::uint32_t pixel) {
    ++work.finished;
    look_at(pixel);
    if (observer_ && word_->kind != PixelKind::finished) observer_->arrivals_end();
    switch (word_->kind) {
      case PixelKind::untouched:
        return {0.0f, glm::vec3(0.0f)};
      case PixelKind::finished:
        return {1.0f, glm::vec3(word_->color[0], word_->color[1], word_->color[2])};
      case PixelKind::covered: {
        const glm::vec3 color = shaded_color(0, bin_.list[word_->number], 0.5f, 0.5f, everywhere());
        if (observer_) observer_->adds(bin_.list[word_->number], 1.0, color);
        return {1.0f, color};
      }
      case PixelKind::open:
        break;
    }
    begin();
    std::size_t count = 0;
    for (std::size_t k = 0; k < shape_.owners; ++k) list_owner(k, owners_[count++]);
    if (count > 0) retire(count);
    return limited();
  }

  PooledWork work;

 private:
  static constexpr auto kPositions = static_cast<float>(32 * Words);
  static Mask everywhere() { return Mask::filled(true); }
  static Mask nowhere() { return Mask::filled(false); }

  struct Owner {
    OwnerSlot slot;
    std::size_t index = 0;  // of the slot
    Mask owned{};
    float visible = 0;  // positions that it owns
    DepthPlane<float> plane{};
    float mean_u = 0, mean_v = 0;  // of these positions, in pixels from the pixel's centre

    SurfaceArea<float> area() const { return {slot.is_merged() ? visible : slot.covered(), visible, slot.error()}; }
    PlacedSurface<float> placed() const { return {visible, plane, mean_u, mean_v}; }
  };

  // An owner's place in the order in which owners become final.
  struct Place {
    std::size_t owner;  // index into owners_
    float fraction;
  };

  // ---- The pixel at hand ----

  void look_at(std::uint32_t pixel) {
    pixel_ = pixel;
    word_ = &pixels_.words[pixel];
    observer_ = observer_at(bin_.observers, pixel);
  }

  void look_at_record() {
    shape_ = word_->shape;
    area_ = word_->area;
    record_ = pixels_.records.view(word_->record_size, word_->number);
  }

  // The positions of owner k.
  Mask owned(std::size_t k) const { return Mask(record_.owned(k)); }
  void own(std::size_t k, const Mask& positions) { positions.store(record_.owned(k)); }

  // Takes the pixel's state apart.
  void begin() {
    empty_ = final_ = nowhere();
    if (word_->kind == PixelKind::open) {
      look_at_record();
      ++work.splits[shape_.planes()];
      read_record(shape_.planes() * 4 * Words);
      if (shape_.has_empty) empty_ = Mask(record_.head->empty);
      if (shape_.has_final) final_ = Mask(record_.head->final);
      return;
    }
    area_ = {};
    shape_ = {};
    record_ = pixels_.records.view(0, spare_);
    if (word_->kind == PixelKind::covered) {
      const CoverDepth& cover = pixels_.covers[pixel_];
      OwnerSlot slot;
      slot.set(word_->number, 0.0f, static_cast<std::uint32_t>(kPositions), 0.5f, 0.5f);
      record_.set(0, slot, cover.plane, cover.farthest);
      own(0, everywhere());
      shape_.owners = 1;
    } else {
      empty_ = everywhere();
      shape_.has_empty = true;
    }
  }

  // Puts the pixel's state together again, in as few bytes as it takes.
  void store(ClosedDepth& closed) {
    if (shape_.owners == 0 && !shape_.has_empty) {
      if (observer_) observer_->arrivals_end();
      const PixelColor color = limited();
      release();
      word_->kind = PixelKind::finished;
      for (std::size_t c = 0; c < 3; ++c) word_->color[c] = HalfBits(color.color[c]);
      closed.close(pixel_, kInFront);
      return;
    }
    if (is_covered_by_one()) {
      const std::uint32_t triangle = record_.slots[0].triangle();
      pixels_.covers[pixel_] = {record_.plane(0), record_.farthest(0)};
      release();
      word_->kind = PixelKind::covered;
      word_->number = triangle;
      return;
    }
    put_together();
  }

  void put_together() {
    if (word_->kind != PixelKind::open) {
      word_->kind = PixelKind::open;
      word_->record_size = 0;
      word_->number = spare_;
      spare_ = pixels_.records.take(0);
    }
    ++work.joins[shape_.states()];
    resize();
    write_record(shape_.planes() * 4 * Words);
    if (shape_.has_empty) empty_.store(record_.head->empty);
    if (shape_.has_final) final_.store(record_.head->final);
    word_->shape = shape_;
    word_->area = area_;
  }

  bool is_covered_by_one() const {
    return shape_.owners == 1 && shape_.states() == 1 && !shape_.has_sums && !record_.slots[0].is_merged() &&
           record_.slots[0].covered() == kPositions && record_.slots[0].error() == 0;
  }

  // There is room for so many owners. Only open pixels have more than fit into the spare record.
  void make_room_for(std::size_t owners) {
    if (owners <= RecordStore<Words>::owners_in(0) || word_->kind != PixelKind::open) return;
    const std::uint8_t size = RecordStore<Words>::size_for(owners);
    if (size <= word_->record_size) return;
    const std::uint32_t record = pixels_.records.take(size);
    const RecordView<Words> view = pixels_.records.view(size, record);
    for (std::size_t k = 0; k < shape_.owners; ++k) {
      view.set(k, record_.slots[k], record_.plane(k), record_.farthest(k));
      owned(k).store(view.owned(k));
    }
    view.head->sums = record_.head->sums;
    pixels_.records.give_back(word_->record_size, word_->number);
    word_->record_size = size;
    word_->number = record;
    record_ = view;
  }

  void resize() {
    pixels_.pool.resize(word_->chunks, shape_.chunks(Words));
    float& most = result_.maps.record_bytes[pixel_];
    most = std::max(most, static_cast<float>(word_->chunks.count * (kChunkBytes + kChunkLinkBytes)));
  }

  void release() {
    if (word_->kind != PixelKind::open) return;
    pixels_.records.give_back(word_->record_size, word_->number);
    pixels_.pool.resize(word_->chunks, 0);
  }

  // Every access follows the links of the record's chunks.
  void read_record(std::size_t bytes) {
    work.bytes_read += bytes + word_->chunks.count * kChunkLinkBytes;
    visit(false);
  }
  void visit(bool is_write) {
    if (result_.lists_visits) result_.visits.push_back({number_, pixel_, word_->chunks.count, is_write});
    if (word_->chunks.in_memory == 0) return;
    result_.chunks_in_memory += word_->chunks.in_memory;
    result_.maps.memory_chunks[pixel_] += static_cast<float>(word_->chunks.in_memory);
  }
  void write_record(std::size_t bytes) {
    work.bytes_written += bytes;
    visit(true);
  }

  // ---- Claim: a fragment takes the positions where it is nearer ----

  enum class Side { nearer, farther, crossing };

  // Where the fragment lies in a pixel that one triangle covers.
  Side side_of(const Fragment& fragment) {
    ++work.contests, ++work.planes;
    if (bin_.lists_fetches) result_.fetched.push_back(bin_.list[word_->number]);
    const PlaneGap<float> gap = plane_gap(fragment.plane, pixels_.covers[pixel_].plane);
    return is_nearer(gap) ? Side::nearer : is_farther(gap) ? Side::farther : Side::crossing;
  }

  void cover(const Fragment& fragment, std::uint32_t number, ClosedDepth& closed) {
    ++work.claims, ++work.covers;
    word_->kind = PixelKind::covered;
    word_->number = number;
    pixels_.covers[pixel_] = {fragment.plane, fragment.z_max};
    closed.close(pixel_, fragment.z_max);
  }

  Outcome share(const Fragment& fragment, const Mask& mask, std::uint32_t number, ClosedDepth& closed) {
    ++work.masks;
    work.masks_tested += shape_.owners;
    std::uint32_t contested = 0;  // bit k: owner k
    for (std::size_t k = 0; k < shape_.owners; ++k) contested |= std::uint32_t{!(owned(k) & mask).none()} << k;
    const Mask free = empty_ & mask, claimed = free | positions_won(fragment, mask, contested);
    if (observer_) observer_->arrives(fragment, claimed.wide());
    if (claimed.none()) return Outcome::composed;
    ++work.claims;
    const bool met_empty = !free.none();
    if (met_empty) {
      empty_ = without(empty_, claimed);
      shape_.has_empty = !empty_.none();
    }
    const std::size_t before = shape_.owners;
    take_away(claimed, contested);
    // Does this fragment close the pixel, or may it close it nearer than before?
    const bool closes = (met_empty || shape_.owners < before) && !shape_.has_empty;
    make_room_for(shape_.owners + 1u);
    record_.set(shape_.owners, slot_of(fragment, mask, number), fragment.plane, fragment.z_max);
    own(shape_.owners++, claimed);
    work.bytes_written += sizeof(OwnerSlot);
    const bool merged = shape_.owners > pixels_.most_owners && make_one_less(number);
    if (closes) close(closed);
    store(closed);
    return merged ? Outcome::merged : Outcome::composed;
  }

  HWY_INLINE static OwnerSlot slot_of(const Fragment& fragment, const Mask& mask, std::uint32_t number) {
    const auto covered = static_cast<std::uint32_t>(mask.count());
    OwnerSlot slot;
    slot.set(number, fragment.alpha * kPositions - static_cast<float>(covered), covered, fragment.centroid_u,
             fragment.centroid_v);
    return slot;
  }

  // An owner that has no position left is forgotten.
  void take_away(const Mask& claimed, std::uint32_t contested) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < shape_.owners; ++k) {
      if (contested >> k & 1) {
        const Mask left = without(owned(k), claimed);
        if (left.none()) continue;
        own(k, left);
      }
      keep(k, kept++);
    }
    shape_.owners = static_cast<std::uint8_t>(kept);
  }

  void keep(std::size_t from, std::size_t to) {
    if (from == to) return;
    record_.move(from, to);
    own(to, owned(from));
    ++work.moves;
    work.bytes_read += sizeof(OwnerSlot), work.bytes_written += sizeof(OwnerSlot);
  }

  // Of owner k.
  DepthPlane<float> plane_of(std::size_t k) {
    ++work.planes;
    work.bytes_read += sizeof(OwnerSlot);
    if (bin_.lists_fetches) result_.fetched.push_back(bin_.list[record_.slots[k].triangle()]);
    return record_.plane(k);
  }

  // The positions that the fragment takes from owners. `contested`: bit k: owner k has positions in its mask.
  HWY_INLINE Mask positions_won(const Fragment& fragment, const Mask& mask, std::uint32_t contested) {
    Mask won = nowhere();
    if (contested == 0) return won;
    const auto contests = static_cast<std::uint64_t>(std::popcount(contested));
    work.contests += contests, work.planes += contests;
    work.bytes_read += contests * sizeof(OwnerSlot);
    if (bin_.lists_fetches)
      for (std::uint32_t left = contested; left != 0; left &= left - 1)
        result_.fetched.push_back(bin_.list[record_.slots[std::countr_zero(left)].triangle()]);
    constexpr std::size_t kAtOnce = 8;
    for (std::size_t first = 0; first < shape_.owners; first += kAtOnce) {
      const PlaneSides<kAtOnce> sides =
          plane_sides<kAtOnce>(fragment.plane, {record_.z() + first, record_.dzdu() + first, record_.dzdv() + first});
      const std::size_t end = std::min<std::size_t>(first + kAtOnce, shape_.owners);
      for (std::size_t k = first; k < end; ++k) won = won | (owned(k) & mask & Mask::repeated(sides.nearer[k - first]));
      for (std::uint64_t left = (contested >> first) & sides.crossing & 0xff; left != 0; left &= left - 1) {
        const std::size_t k = first + static_cast<std::size_t>(std::countr_zero(left));
        won = won | positions_won_from(k, fragment, owned(k) & mask);
      }
    }
    return won;
  }

  // The contested positions that the fragment takes from owner k. At equal depth the triangle that comes first in the
  // trace has them.
  Mask positions_won_from(std::size_t k, const Fragment& fragment, const Mask& contested) {
    ++work.planes_compared;
    const DepthPlane<float> owner = record_.plane(k);
    const bool is_earlier = fragment.triangle < bin_.list[record_.slots[k].triangle()];
    const DepthPlane<float>&one = is_earlier ? owner : fragment.plane, &other = is_earlier ? fragment.plane : owner;
    const WideMask where = contested.wide();
    WideMask nearer;
    nearer_positions(one, other, bin_.positions.patterns.data(), Words, nearer.words.data(), where.words.data());
    return is_earlier ? without(contested, Mask(nearer)) : Mask(nearer);
  }

  // A pixel without empty positions hides what lies behind all of its owners.
  void close(ClosedDepth& closed) {
    float farthest = kInFront;
    for (std::size_t k = 0; k < shape_.owners; ++k) {
      ++work.bounds_found;
      work.vertices_bounded += !record_.slots[k].is_merged();
      plane_of(k);
      farthest = std::max(farthest, record_.farthest(k));
    }
    closed.close(pixel_, farthest);
  }

  // ---- Retire: nothing can hide a surface any more ----

  // Retires what is in front of the watermark, in all pixels.
  void collect(float watermark, ClosedDepth& closed) {
    work.words_scanned += pixels_.words.size();
    ++result_.collections;
    pixels_.pool.collected();
    for (std::uint32_t pixel = 0; pixel < pixels_.words.size(); ++pixel) {
      look_at(pixel);
      if (word_->kind != PixelKind::open || !may_retire(watermark)) continue;
      begin();
      if (retire_final(watermark)) store(closed);
    }
  }

  // Does any owner reach in front of the watermark?
  bool may_retire(float watermark) {
    const RecordView<Words> record = pixels_.records.view(word_->record_size, word_->number);
    bool may = false;
    read_record(word_->shape.owners * sizeof(OwnerSlot));
    for (std::size_t k = 0; k < word_->shape.owners; ++k) {
      ++work.finality_tests, ++work.planes;
      if (bin_.lists_fetches) result_.fetched.push_back(bin_.list[record.slots[k].triangle()]);
      may |= finality_of(record.plane(k), watermark) != Finality::is_open;
    }
    return may;
  }

  bool retire_final(float watermark) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < shape_.owners; ++k)
      if (is_final(k, plane_of(k), watermark)) list_owner(k, owners_[count++]);
    if (count > 0) retire(count);
    return count > 0;
  }

  // Is the owner nowhere farther than the watermark? Its plane over the whole pixel most often says that it is, or that
  // it is not.
  bool is_final(std::size_t k, const DepthPlane<float>& plane, float watermark) {
    ++work.finality_tests;
    const Finality finality = finality_of(plane, watermark);
    if (finality != Finality::depends_on_positions) return finality == Finality::is_final;
    ++work.farthest_found;
    const WideMask positions = owned(k).wide();
    return farthest_depth(plane, bin_.positions.patterns.data(), Words, positions.words.data()) <= watermark;
  }

  // All but the plane and the mean.
  void list_owner(std::size_t k, Owner& owner) {
    ++work.listed;
    work.bytes_read += sizeof(OwnerSlot);
    owner.slot = record_.slots[k];
    owner.index = k;
    owner.owned = owned(k);
    owner.visible = static_cast<float>(owner.owned.count());
  }

  // Adds owners_[0 .. count - 1] to what is final. Those that show the largest part of their positions come first: what
  // they take beyond their positions is then known when the others are added.
  void retire(std::size_t count) {
    ++work.retirements;
    use_sums();
    sort_by_fraction(count);
    auto final_positions = static_cast<float>(final_.count());
    for (std::size_t i = 0; i < count; ++i) {
      const Owner& owner = owners_[order_[i].owner];
      ++work.retired;
      const float area = retired_area(owner.area(), kPositions, Taken<float>{area_, final_positions});
      const glm::vec3 color = final_color(owner);
      const float counted = owner.visible / kPositions;
      if (observer_) observer_->settles(owner.owned.wide(), color, area, counted);
      final_positions += owner.visible;
      const float threshold = rounding_threshold(owner.slot.content());
      area_.add(area, threshold);
      record_.head->sums.colors.add({area * color[0], area * color[1], area * color[2], counted * color[0],
                                     counted * color[1], counted * color[2]},
                                    threshold);
      final_ = final_ | owner.owned;
    }
    shape_.has_final = !final_.none();
    std::uint32_t gone = 0;
    for (std::size_t i = 0; i < count; ++i) gone |= 1u << owners_[i].index;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < shape_.owners; ++k)
      if (!(gone >> k & 1)) keep(k, kept++);
    shape_.owners = static_cast<std::uint8_t>(kept);
  }

  // The sums will be read and written.
  void use_sums() {
    work.bytes_written += sizeof(PixelSums);
    if (shape_.has_sums) {
      work.bytes_read += sizeof(PixelSums);
    } else {
      record_.head->sums = {};
      shape_.has_sums = true;
    }
  }

  // Sets order_. Equal ones keep their order.
  void sort_by_fraction(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const Place place{i, owners_[i].area().fraction()};
      std::size_t j = i;
      for (; j > 0; --j) {
        ++work.order_tests;
        if (place.fraction <= order_[j - 1].fraction) break;
        order_[j] = order_[j - 1];
      }
      order_[j] = place;
    }
  }

  // ---- Merge: a pixel has more owners than it may have ----

  // Retires the owners that are final or, if there are none, makes one owner of two. Returns whether it merged.
  bool make_one_less(std::uint32_t number) {
    if (bin_.watermarks && retire_final((*bin_.watermarks)[number])) return false;
    for (std::size_t k = 0; k < shape_.owners; ++k) {
      list_owner(k, owners_[k]);
      owners_[k].plane = plane_of(k);
      measure(owners_[k]);
    }
    merge_closest();
    return true;
  }

  // Finds the mean of the positions that it owns.
  void measure(Owner& owner) {
    ++work.measured;
    const WideMask owned = owner.owned.wide();
    const PositionSums sums = position_sums(bin_.positions.patterns.data(), Words, owned.words.data());
    owner.mean_u = mean_position(sums.x, owner.visible) - 0.5f;
    owner.mean_v = mean_position(sums.y, owner.visible) - 0.5f;
  }

  float loss_of(const Owner& one, const Owner& other) {
    ++work.pairs_compared;
    return merge_loss(one.placed(), other.placed());
  }

  std::uint32_t trace_number(const Owner& owner) const { return bin_.list[owner.slot.triangle()]; }

  // Of owners at equal depth, those become one that lie closest in the trace: the fewest triangles come between them.
  std::uint32_t distance_in_trace(std::size_t i, std::size_t j) const {
    const std::uint32_t one = trace_number(owners_[i]), other = trace_number(owners_[j]);
    return std::max(one, other) - std::min(one, other);
  }

  void merge_closest() {
    ++work.merges;
    std::size_t first = 0, second = 1;
    float least = loss_of(owners_[0], owners_[1]);
    for (std::size_t j = 2; j < shape_.owners; ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        const float loss = loss_of(owners_[i], owners_[j]);
        if (loss > least || (loss == least && distance_in_trace(i, j) >= distance_in_trace(first, second))) continue;
        least = loss, first = i, second = j;
      }
    }
    Owner &one = owners_[first], &other = owners_[second];
    const Owner& larger = one.visible >= other.visible ? one : other;
    const bool counted = one.slot.error_is_limited() || other.slot.error_is_limited();
    const MergedParts<float> parts = merged_parts(one.area(), other.area(), counted);
    const glm::vec3 color_of_one = color_of(one.slot, one.owned), color_of_other = color_of(other.slot, other.owned);
    if (observer_)
      observer_->merges({one.owned.wide(), color_of_one, parts.one}, {other.owned.wide(), color_of_other, parts.other});
    OwnerSlot slot;
    slot.set_merged(larger.slot.triangle(), parts.error, parts.one * color_of_one + parts.other * color_of_other,
                    merge_threshold(one.slot.content(), other.slot.content()));
    record_.set(first, slot, larger.plane, pair_bounds(larger.plane, {kInFront, kNoDepth}).farthest);
    own(first, one.owned | other.owned);
    for (std::size_t k = second; k + 1 < shape_.owners; ++k) keep(k + 1, k);
    --shape_.owners;
  }

  // ---- Shading ----

  // Of an owner that becomes final, which shade_all() may have shaded.
  glm::vec3 final_color(const Owner& owner) {
    if (owner.slot.is_merged()) return owner.slot.color();
    const glm::vec2 centroid = owner.slot.centroid();
    return shaded_color(owner.index, bin_.list[owner.slot.triangle()], centroid.x, centroid.y, owner.owned);
  }

  // `k`: which of the pixel's owners.
  glm::vec3 shaded_color(std::size_t k, std::uint32_t triangle, float u, float v, const Mask& owned) {
    const std::uint32_t at = first_shaded_.empty() ? kNotShaded : shaded_at_[first_shaded_[pixel_] + k];
    if (at == kNotShaded) return color_at(triangle, u, v, owned);
    result_.shaded.push_back({triangle});
    return colors_[at];
  }

  glm::vec3 color_of(const OwnerSlot& slot, const Mask& owned) {
    if (slot.is_merged()) return slot.color();
    return color_at(bin_.list[slot.triangle()], slot.centroid().x, slot.centroid().y, owned);
  }

  // `owned`: positions of the pixel.
  glm::vec3 color_at(std::uint32_t triangle, float u, float v, const Mask& owned) {
    if (bin_.shade_at == OwnerPlace::covered || bin_.shader.is_flat(triangle)) return shade(triangle, u, v);
    if (bin_.shade_at == OwnerPlace::visible) return shade_at_mean(triangle, owned, 1.0f);
    if (bin_.shade_at == OwnerPlace::quarters) return shade_parts(triangle, owned, bin_.positions.quarters, 0.5f);
    return shade_parts(triangle, owned, bin_.positions.sixteenths, 0.25f);
  }

  // The mean of what is owned in each part of the pixel. `width`: of a part, in pixels.
  template <class Parts>
  glm::vec3 shade_parts(std::uint32_t triangle, const Mask& owned, const Parts& parts, float width) {
    glm::vec3 sum(0.0f);
    for (const WideMask& part : parts)
      if (const Mask here = owned & Mask(part); !here.none())
        sum += static_cast<float>(here.count()) * shade_at_mean(triangle, here, width);
    return sum / static_cast<float>(owned.count());
  }

  glm::vec3 shade_at_mean(std::uint32_t triangle, const Mask& positions, float width) {
    ++work.measured;
    const WideMask words = positions.wide();
    const PositionSums sums = position_sums(bin_.positions.patterns.data(), Words, words.words.data());
    const auto count = static_cast<float>(positions.count());
    return shade(triangle, mean_position(sums.x, count), mean_position(sums.y, count), width);
  }

  // `width`: of the area that the colour stands for, in pixels.
  glm::vec3 shade(std::uint32_t triangle, float u, float v, float width = 1.0f) {
    result_.shaded.push_back({triangle});
    const glm::vec3 color = bin_.shader.color(triangle, pixel_, u, v, width, result_.texels);
    end_request(result_.texels);
    return color;
  }

  // ---- Specks own no position ----

  // Each of the three positions nearest to a speck votes for it, if it is free or its owner is not nearer. Of specks
  // that face towards the viewer and specks that face away, those with the smaller area are the hidden sides of thin
  // bodies.
  void add_speck(const Fragment& fragment) {
    if (word_->kind == PixelKind::open) look_at_record();
    ++work.specks[word_->kind == PixelKind::open ? shape_.planes() : 0];
    const float votes = votes_for(fragment);
    if (votes == 0) return;
    const bool is_shared = word_->kind == PixelKind::open;
    if (!is_shared) begin();
    use_sums();
    FixedSum &same = record_.head->sums.specks[fragment.front], &opposite = record_.head->sums.specks[!fragment.front];
    const float before = greater(same, opposite);
    const float threshold = rounding_threshold(std::bit_cast<std::uint32_t>(fragment.alpha) ^
                                               std::bit_cast<std::uint32_t>(fragment.centroid_z));
    same.add(fragment.alpha * votes / 3.0f, threshold);
    const float area = speck_area<float>(same, opposite, before, area_);
    if (area > 0) {
      ++work.specks_added;
      const glm::vec3 color = shade(fragment.triangle, fragment.centroid_u, fragment.centroid_v);
      if (observer_) observer_->adds_speck(fragment.triangle, area, color);
      area_.add(area, threshold);
      record_.head->sums.colors.add({area * color[0], area * color[1], area * color[2], 0, 0, 0}, threshold);
    }
    if (is_shared) {  // its positions stay as they are
      resize();
      word_->shape = shape_;
      word_->area = area_;
    } else {
      put_together();
    }
  }

  float votes_for(const Fragment& speck) {
    if (word_->kind == PixelKind::untouched) return 3.0f;
    if (word_->kind == PixelKind::covered) {
      ++work.planes;
      if (bin_.lists_fetches) result_.fetched.push_back(bin_.list[word_->number]);
      return is_nearer_than(speck, pixels_.covers[pixel_].plane) ? 3.0f : 0.0f;
    }
    float votes = 0;
    read_record(3 * shape_.planes() * sizeof(std::uint32_t));
    for (const std::uint8_t position : bin_.positions.nearest_to(speck.centroid_u, speck.centroid_v)) {
      const auto has = [&](const std::uint32_t* words) { return words[position / 32] >> (position % 32) & 1; };
      std::size_t k = 0;
      while (k < shape_.owners && !has(record_.owned(k))) ++k;
      if (k < shape_.owners) {
        votes += is_nearer_than(speck, plane_of(k));
      } else {
        votes += shape_.has_empty && has(record_.head->empty);
      }
    }
    return votes;
  }

  bool is_nearer_than(const Fragment& speck, const DepthPlane<float>& plane) {
    ++work.speck_comparisons;
    return is_on_or_before(speck.centroid_z, plane, speck.centroid_u - 0.5f, speck.centroid_v - 0.5f);
  }

  // ---- Limit: the analytic estimate, no farther from the counted one than the tolerances allow ----

  PixelColor limited() {
    if (area_ <= 0) return {0.0f, glm::vec3(0.0f)};
    ++work.limited;
    work.bytes_read += sizeof(PixelSums);
    const float count = static_cast<float>(final_.count());
    Estimate<float> analytic{area_, {}}, counted{count / kPositions, {}};
    for (std::size_t c = 0; c < 3; ++c)
      analytic.color[c] = record_.head->sums.colors[c], counted.color[c] = record_.head->sums.colors[c + 3];
    const Estimate<float> result = limited_estimate(analytic, counted, kPositions);
    if (observer_) observer_->finishes(color_of(analytic), color_of(counted), color_of(result));
    return color_of(result);
  }

  static PixelColor color_of(const Estimate<float>& estimate) {
    return {estimate.area, {estimate.color[0], estimate.color[1], estimate.color[2]}};
  }

  const OwnersBin& bin_;
  PooledPixels<Words>& pixels_;
  PooledResult& result_;
  // The pixel at hand.
  std::uint32_t pixel_ = 0;   // index within the tile
  std::uint32_t number_ = 0;  // of the triangle at hand in the list
  PixelWord* word_ = nullptr;
  PixelObserver* observer_ = nullptr;  // null: nobody looks at it
  RecordShape shape_;
  FixedSum area_;
  Mask empty_, final_;
  RecordView<Words> record_;
  std::uint32_t spare_;  // a record for a pixel that has none yet
  std::array<Owner, kMostOwners + 1> owners_;
  std::array<Place, kMostOwners + 1> order_;
  // What shade_all() has shaded: the colours, and where those of each pixel's owners are.
  static constexpr std::uint32_t kNotShaded = ~0u;
  std::vector<glm::vec3> colors_;
  std::vector<std::uint32_t> first_shaded_, shaded_at_;
};

template <std::size_t Words>
void compose(const OwnersBin& bin, const OwnersBatch& batch, StageCounters& counters, const PooledTile<Words>& tile) {
  const std::vector<Fragment>& fragments = batch.fragments;
  PooledPixels<Words>& pixels = tile.pixels;
  PooledComposer<Words> composer(bin, pixels, tile.result);
  auto number = static_cast<std::uint32_t>(batch.first);
  constexpr std::size_t kAhead = 4;  // fragments
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    if (i + kAhead < fragments.size()) prefetch(pixels.words[fragments[i + kAhead].pixel]);
    const Fragment& fragment = fragments[i];
    while (bin.list[number] != fragment.triangle) ++number;
    using Outcome = typename PooledComposer<Words>::Outcome;
    const Outcome outcome = composer.add(fragment, number, tile.closed);
    tile.maps.fragments[fragment.pixel] += outcome != Outcome::hidden;
    tile.maps.merges[fragment.pixel] += outcome == Outcome::merged;
  }
  charge<Words>(composer.work, counters);
}

template <std::size_t Words>
std::vector<PixelColor> finish(const OwnersBin& bin, StageCounters& counters, PooledPixels<Words>& pixels,
                               PooledResult& result) {
  PooledComposer<Words> composer(bin, pixels, result);
  std::vector<PixelColor> colors(pixels.words.size());
  composer.shade_all();
  for (std::uint32_t i = 0; i < colors.size(); ++i) colors[i] = composer.finish(i);
  charge<Words>(composer.work, counters);
  return colors;
}

}  // namespace

// Highway's tables hold functions, not templates.
#define BEAMPIPE_KERNELS(words)                                                                                      \
  void compose_##words(const OwnersBin& bin, const OwnersBatch& batch, StageCounters& counters,                      \
                       const PooledTile<words>& tile) {                                                              \
    compose<words>(bin, batch, counters, tile);                                                                      \
  }                                                                                                                  \
  std::vector<PixelColor> finish_##words(const OwnersBin& bin, StageCounters& counters, PooledPixels<words>& pixels, \
                                         PooledResult& result) {                                                     \
    return finish<words>(bin, counters, pixels, result);                                                             \
  }
BEAMPIPE_KERNELS(1) BEAMPIPE_KERNELS(2) BEAMPIPE_KERNELS(4) BEAMPIPE_KERNELS(8)
#undef BEAMPIPE_KERNELS

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
#define BEAMPIPE_COMPOSE(words)                                                                                     \
  HWY_EXPORT(compose_##words);                                                                                      \
  template <>                                                                                                       \
  void compose_pooled(const OwnersBin& bin, const OwnersBatch& batch, StageCounters& counters,                      \
                      const PooledTile<words>& tile) {                                                              \
    HWY_DYNAMIC_DISPATCH(compose_##words)(bin, batch, counters, tile);                                              \
  }                                                                                                                 \
  HWY_EXPORT(finish_##words);                                                                                       \
  template <>                                                                                                       \
  std::vector<PixelColor> finish_pooled(const OwnersBin& bin, StageCounters& counters, PooledPixels<words>& pixels, \
                                        PooledResult& result) {                                                     \
    return HWY_DYNAMIC_DISPATCH(finish_##words)(bin, counters, pixels, result);                                     \
  }
BEAMPIPE_COMPOSE(1) BEAMPIPE_COMPOSE(2) BEAMPIPE_COMPOSE(4) BEAMPIPE_COMPOSE(8)
#undef BEAMPIPE_COMPOSE
}  // namespace beampipe
#endif
