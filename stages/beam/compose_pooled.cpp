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

// Versions for AVX2 and AVX-512, both with vectors of 256 bits, which hold a whole mask, and one without vectors.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/beam/compose_pooled.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/plane_sides-inl.h"
#include "stages/beam/compose_pooled_colors-inl.h"
#include "stages/beam/compose_pooled_pixel-inl.h"
#include "stages/beam/register_mask-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace {

#include "stages/beam/position_states-inl.h"

// Of numbers, beside those of vectors.
using beampipe::greater, beampipe::lesser, beampipe::magnitude;

// Works on one pixel at a time: takes its state apart, applies the rules, and puts it together again.
template <std::size_t Words>
class PooledComposer {
 public:
  using Mask = HWY_NAMESPACE::Mask<Words>;

  PooledComposer(const OwnersBin& bin, PooledPixels<Words>& pixels, PooledResult& result)
      : bin_(bin), pixels_(pixels), result_(result), at_(pixels, result, work), colors_(bin, result, work) {}

  // `number`: of the fragment's triangle in the list. Whether closed pixels hide the fragment is decided here, although
  // the raster has left out many already: so how far the raster is ahead changes no visibility. It may change when a
  // collection comes, and so the order in which surfaces retire. Returns whether the fragment was not hidden.
  bool add(const Fragment& fragment, std::uint32_t number, ClosedDepth& closed) {
    ++work.fragments;
    at_.number = number;
    if (bin_.watermarks && pixels_.pool.wants_collection()) collect((*bin_.watermarks)[number], closed);
    work.whole += fragment.whole;
    if (closed.is_hidden(fragment.pixel, fragment.z_min)) return false;
    look_at(fragment.pixel);
    const Mask mask(fragment.mask);
    if (mask.none()) {
      if (observer_) observer_->arrives(fragment, {});
      add_speck(fragment);
      return true;
    }
    if (at_.word().kind == PixelKind::covered) {
      const Side side = side_of(fragment);
      if (side == Side::farther || (side == Side::nearer && fragment.whole)) {
        if (observer_) observer_->arrives(fragment, side == Side::nearer ? fragment.mask : WideMask{});
        if (side == Side::nearer) cover(fragment, number, closed);
        return true;
      }
    } else if (at_.word().kind == PixelKind::untouched && fragment.whole) {
      if (observer_) observer_->arrives(fragment, fragment.mask);
      cover(fragment, number, closed);
      return true;
    }
    at_.open();
    share(fragment, mask, number, closed);
    return true;
  }

  // Computes the colours of all owners that are left, for finish().
  void shade_all() {
    if (!colors_.are_shaded_together()) return;
    colors_.shade_together(pixels_, std::vector<std::uint32_t>(pixels_.words.size(), ~0u));
  }

  // All owners are final. `pixel`: index in the tile. Returns its colour.
  PixelColor finish(std::uint32_t pixel) {
    ++work.finished;
    look_at(pixel);
    if (observer_ && at_.word().kind != PixelKind::finished) observer_->arrivals_end();
    switch (at_.word().kind) {
      case PixelKind::untouched:
        return {0.0f, glm::vec3(0.0f)};
      case PixelKind::finished:
        return {1.0f, glm::vec3(at_.word().color[0], at_.word().color[1], at_.word().color[2])};
      case PixelKind::covered: {
        const glm::vec3 color = colors_.of_cover(pixel, at_.word().number);
        if (observer_) observer_->adds(bin_.list[at_.word().number], 1.0, color);
        return {1.0f, color};
      }
      case PixelKind::open:
        break;
    }
    at_.open();
    if (at_.shape.owners > 0) retire_owners((1u << at_.shape.owners) - 1);
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

  void look_at(std::uint32_t pixel) {
    at_.look_at(pixel);
    observer_ = observer_at(bin_.observers, pixel);
  }

  // Puts the pixel's state together again, in as few bytes as it takes.
  void store(ClosedDepth& closed) {
    if (at_.is_finished()) {
      if (observer_) observer_->arrivals_end();
      at_.finish(limited());
      closed.close(at_.index, kInFront);
    } else if (at_.is_covered_by_one()) {
      at_.cover(at_.record.slots[0].triangle(), {at_.record.plane(0), at_.record.farthest(0)});
    } else {
      at_.store();
    }
  }

  // ---- Claim: a fragment takes the positions where it is nearer ----

  enum class Side { nearer, farther, crossing };

  // Where the fragment lies in a pixel that one triangle covers. Nobody else owns a position there, so this is the only
  // contest.
  Side side_of(const Fragment& fragment) {
    ++work.contests;
    fetch_plane(at_.word().number);
    const PlaneGap<float> gap = plane_gap(fragment.plane, at_.cover_depth().plane);
    return is_nearer(gap) ? Side::nearer : is_farther(gap) ? Side::farther : Side::crossing;
  }

  void cover(const Fragment& fragment, std::uint32_t number, ClosedDepth& closed) {
    ++work.claims, ++work.covers;
    at_.cover(number, {fragment.plane, fragment.z_max});
    closed.close(at_.index, fragment.z_max);
  }

  void share(const Fragment& fragment, const Mask& mask, std::uint32_t number, ClosedDepth& closed) {
    std::uint32_t contested = 0;          // bit k: owner k
    constexpr std::size_t kTogether = 4;  // read beyond the last owner, so that the number of rounds varies less
    for (std::size_t first = 0; first < at_.shape.owners; first += kTogether)
      for (std::size_t k = first; k < first + kTogether; ++k)
        contested |= std::uint32_t{is_met(at_.owned(k), mask)} << k;
    contested &= (1u << at_.shape.owners) - 1;
    const bool met_empty = at_.shape.has_empty && is_met(at_.empty, mask);
    work.masks_tested += std::size_t{at_.shape.owners} + at_.shape.has_empty;
    ++work.masks;
    const Mask claimed = claim_of(at_.empty, mask, positions_won(fragment, mask, contested));
    if (observer_) observer_->arrives(fragment, claimed.wide());
    if (claimed.none()) return;
    ++work.claims;
    if (met_empty) {
      ++work.takes;
      at_.shape.has_empty = take_from(at_.empty, claimed);
    }
    const std::size_t before = at_.shape.owners;
    take_away(claimed, contested);
    // Does this fragment close the pixel, or may it close it nearer than before?
    const bool closes = (met_empty || at_.shape.owners < before) && !at_.shape.has_empty;
    at_.make_room_for(at_.shape.owners + 1u);
    at_.record.set(at_.shape.owners, slot_of(fragment, mask, number), fragment.plane, fragment.z_max);
    at_.own(at_.shape.owners++, claimed);
    ++at_.new_slots;
    if (at_.shape.owners > pixels_.most_owners) make_one_less(number);
    if (!at_.has_room()) fit(number);
    if (closes) close(closed);
    store(closed);
  }

  // Into what the frame's pool allows.
  void fit(std::uint32_t number) {
    ++(*result_.maps.refusals)[at_.index];
    if (at_.shape.has_sums) {
      ++(*result_.maps.lost_specks)[at_.index];
      forget_specks();
    }
    while (!at_.has_room()) make_one_less(number);
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
    work.takes += static_cast<std::uint64_t>(std::popcount(contested));
    std::uint32_t gone = 0;
    for (std::uint32_t left = contested; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      Mask positions = at_.owned(k);
      gone |= std::uint32_t{!take_from(positions, claimed)} << k;
      at_.own(k, positions);
    }
    forget(gone);
  }

  // Bit k: owner k.
  void forget(std::uint32_t gone) {
    if (gone == 0) return;
    auto kept = static_cast<std::size_t>(std::countr_zero(gone));
    for (std::size_t k = kept + 1; k < at_.shape.owners; ++k)
      if (!(gone >> k & 1)) keep(k, kept++);
    at_.shape.owners = static_cast<std::uint8_t>(kept);
  }

  void keep(std::size_t from, std::size_t to) {
    at_.record.move(from, to);
    at_.own(to, at_.owned(from));
    work.bytes_read += sizeof(OwnerSlot), work.bytes_written += sizeof(OwnerSlot);
  }

  // Of owner k.
  DepthPlane<float> plane_of(std::size_t k) {
    work.bytes_read += sizeof(OwnerSlot);
    fetch_plane(at_.record.slots[k].triangle());
    return at_.record.plane(k);
  }
  // `number`: in the list.
  HWY_INLINE void fetch_plane(std::uint32_t number, bool has_vertices = false) {
    ++work.planes;
    work.vertices_bounded += has_vertices;
    if (bin_.lists_fetches) [[unlikely]]
      result_.fetched.push_back({bin_.list[number], has_vertices});
  }

  // The positions that the fragment takes from owners. `contested`: bit k: owner k has positions in its mask.
  HWY_INLINE Mask positions_won(const Fragment& fragment, const Mask& mask, std::uint32_t contested) {
    Mask won = nowhere();
    if (contested == 0) return won;
    if (at_.word().kind != PixelKind::covered) charge_contests(contested);
    constexpr std::size_t kAtOnce = 8;
    for (std::size_t first = 0; first < at_.shape.owners; first += kAtOnce) {
      const PlaneSides<kAtOnce> sides = plane_sides<kAtOnce>(
          fragment.plane, {at_.record.z() + first, at_.record.dzdu() + first, at_.record.dzdv() + first});
      const std::uint64_t met = (contested >> first) & 0xff;
      work.wins += static_cast<std::uint64_t>(std::popcount(met & sides.nearer));
      for (std::uint64_t left = met & sides.nearer; left != 0; left &= left - 1)
        won = with_won(won, at_.owned(first + static_cast<std::size_t>(std::countr_zero(left))), mask);
      for (std::uint64_t left = met & sides.crossing; left != 0; left &= left - 1) {
        const std::size_t k = first + static_cast<std::size_t>(std::countr_zero(left));
        won = with_won(won, positions_won_from(k, fragment, at_.owned(k) & mask), mask);
      }
    }
    return won;
  }

  // Bit k: owner k.
  void charge_contests(std::uint32_t contested) {
    const auto count = static_cast<std::uint64_t>(std::popcount(contested));
    work.contests += count;
    work.planes += count;
    work.bytes_read += count * sizeof(OwnerSlot);
    if (!bin_.lists_fetches) return;
    for (std::uint32_t left = contested; left != 0; left &= left - 1)
      result_.fetched.push_back({bin_.list[at_.record.slots[std::countr_zero(left)].triangle()]});
  }

  // The contested positions that the fragment takes from owner k. At equal depth the triangle that comes first in the
  // trace has them.
  Mask positions_won_from(std::size_t k, const Fragment& fragment, const Mask& contested) {
    ++work.planes_compared;
    const DepthPlane<float> owner = at_.record.plane(k);
    const bool is_earlier = fragment.triangle < bin_.list[at_.record.slots[k].triangle()];
    const DepthPlane<float>&one = is_earlier ? owner : fragment.plane, &other = is_earlier ? fragment.plane : owner;
    const WideMask where = contested.wide();
    WideMask nearer;
    nearer_positions(one, other, bin_.positions.offsets.data(), Words, nearer.words.data(), where.words.data());
    return is_earlier ? without(contested, Mask(nearer)) : Mask(nearer);
  }

  // A pixel without empty positions hides what lies behind all of its owners.
  void close(ClosedDepth& closed) {
    work.bounds_found += at_.shape.owners;
    work.bytes_read += at_.shape.owners * sizeof(OwnerSlot);
    float farthest = kInFront;
    for (std::size_t k = 0; k < at_.shape.owners; ++k) {
      fetch_plane(at_.record.slots[k].triangle(), !at_.record.slots[k].is_merged());
      farthest = std::max(farthest, at_.record.farthest(k));
    }
    closed.close(at_.index, farthest);
    if (!bin_.watermarks && at_.shape.has_sums && hides_specks(farthest)) forget_specks();
  }

  // Does a pixel that is closed there hide all specks that it has seen?
  bool hides_specks(float farthest) {
    ++work.speck_depths;
    work.bytes_read += sizeof(PixelSums);
    return at_.record.head->nearest_speck > farthest;
  }

  void forget_specks() {
    if (observer_) observer_->forgets_specks();
    at_.forget_sums();
  }

  // ---- Retire: nothing can hide a surface any more ----

  // Retires what is in front of the watermark, in all pixels.
  void collect(float watermark, ClosedDepth& closed) {
    work.words_scanned += pixels_.words.size();
    std::vector<std::uint32_t>& written = result_.collections.emplace_back();
    pixels_.pool.collected();
    const auto retire_from = [&](std::uint32_t pixel, std::uint32_t owners) {
      retire_owners(owners);
      store(closed);
      written.push_back(pixel);
    };
    // Visits to records are listed pixel by pixel.
    const bool together = colors_.are_shaded_together() && !result_.lists_visits;
    std::vector<std::uint32_t> final_owners(together ? pixels_.words.size() : 0);  // bit k: owner k
    for (std::uint32_t pixel = 0; pixel < pixels_.words.size(); ++pixel) {
      look_at(pixel);
      if (at_.word().kind != PixelKind::open) continue;
      at_.look_at_record();
      at_.count_read(0);
      const Candidates candidates = find_candidates(watermark);
      if (candidates.none()) continue;
      at_.open();
      const std::uint32_t owners = final_among(candidates, watermark);
      if (together) {
        final_owners[pixel] = owners;
      } else if (owners != 0) {
        retire_from(pixel, owners);
      }
    }
    if (!together) return;
    colors_.shade_together(pixels_, final_owners);
    for (std::uint32_t pixel = 0; pixel < pixels_.words.size(); ++pixel) {
      if (final_owners[pixel] == 0) continue;
      look_at(pixel);
      at_.take_apart();
      retire_from(pixel, final_owners[pixel]);
    }
    colors_.forget();
  }

  // Owners that are final, and those for which it depends on their positions. Bit k: owner k.
  struct Candidates {
    std::uint32_t final = 0, perhaps = 0;

    bool none() const { return (final | perhaps) == 0; }
  };

  // By the owners' planes over the whole pixel, which most often decide it.
  Candidates find_candidates(float watermark) {
    Candidates found;
    for (std::size_t k = 0; k < at_.shape.owners; ++k) {
      ++work.finality_tests;
      const Finality finality = finality_of(plane_of(k), watermark);
      found.final |= std::uint32_t{finality == Finality::is_final} << k;
      found.perhaps |= std::uint32_t{finality == Finality::depends_on_positions} << k;
    }
    return found;
  }

  // Those that are final. Bit k: owner k.
  std::uint32_t final_among(const Candidates& candidates, float watermark) {
    std::uint32_t found = candidates.final;
    for (std::uint32_t left = candidates.perhaps; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      found |= std::uint32_t{farthest_of(k) <= watermark} << k;
    }
    return found;
  }

  // At least one. Bit k: owner k.
  void retire_owners(std::uint32_t owners) {
    std::size_t count = 0;
    for (std::uint32_t left = owners; left != 0; left &= left - 1)
      list_owner(static_cast<std::size_t>(std::countr_zero(left)), owners_[count++]);
    retire(count);
  }

  // The farthest depth of owner k at its positions.
  float farthest_of(std::size_t k) {
    ++work.farthest_found;
    const WideMask positions = at_.owned(k).wide();
    return farthest_depth(plane_of(k), bin_.positions.offsets.data(), Words, positions.words.data());
  }

  // All but the plane and the mean.
  void list_owner(std::size_t k, Owner& owner) {
    ++work.listed;
    work.bytes_read += sizeof(OwnerSlot);
    owner.slot = at_.record.slots[k];
    owner.index = k;
    owner.owned = at_.owned(k);
    owner.visible = static_cast<float>(owner.owned.count());
  }

  // Adds owners_[0 .. count - 1] to what is final. Those that show the largest part of their positions come first: what
  // they take beyond their positions is then known when the others are added.
  void retire(std::size_t count) {
    ++work.retirements;
    at_.use_sums();
    sort_by_fraction(count);
    FinalSums<std::int32_t, std::uint32_t> sums = at_.sums();
    auto final_positions = static_cast<float>(at_.final.count());
    for (std::size_t i = 0; i < count; ++i) {
      const Owner& owner = owners_[order_[i].owner];
      ++work.retired;
      const glm::vec3 color = colors_.of_final(at_.index, owner.index, owner.slot, owner.owned);
      const float channels[] = {color[0], color[1], color[2]};
      const float area = add_final(owner.area(), channels, owner.slot.content(), kPositions, final_positions, sums);
      if (observer_) observer_->settles(owner.owned.wide(), color, area, owner.visible / kPositions);
      final_positions += owner.visible;
      at_.final = at_.final | owner.owned;
    }
    at_.set_sums(sums);
    at_.shape.has_final = !at_.final.none();
    std::uint32_t gone = 0;
    for (std::size_t i = 0; i < count; ++i) gone |= 1u << owners_[i].index;
    forget(gone);
  }

  // Sets order_. Equal ones keep their order.
  void sort_by_fraction(std::size_t count) {
    if (count > 1) work.fractions += count;
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

  // Retires the owners that are final or, if there are none, makes one owner of two.
  void make_one_less(std::uint32_t number) {
    if (bin_.watermarks) {
      const float watermark = (*bin_.watermarks)[number];
      if (const std::uint32_t final_owners = final_among(find_candidates(watermark), watermark)) {
        retire_owners(final_owners);
        return;
      }
    }
    for (std::size_t k = 0; k < at_.shape.owners; ++k) {
      list_owner(k, owners_[k]);
      owners_[k].plane = plane_of(k);
      measure(owners_[k]);
    }
    merge_closest();
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

  // Are owners i and j as far apart in the trace as the other two, or farther?
  bool is_as_far_in_trace(std::size_t i, std::size_t j, std::size_t first, std::size_t second) {
    ++work.ties;
    return distance_in_trace(trace_number(owners_[i]), trace_number(owners_[j])) >=
           distance_in_trace(trace_number(owners_[first]), trace_number(owners_[second]));
  }

  void merge_closest() {
    ++work.merges;
    std::size_t first = 0, second = 1;
    float least = loss_of(owners_[0], owners_[1]);
    for (std::size_t j = 2; j < at_.shape.owners; ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        const float loss = loss_of(owners_[i], owners_[j]);
        if (loss > least || (loss == least && is_as_far_in_trace(i, j, first, second))) continue;
        least = loss, first = i, second = j;
      }
    }
    Owner &one = owners_[first], &other = owners_[second];
    const Owner& larger = one.visible >= other.visible ? one : other;
    const bool counted = one.slot.error_is_limited() || other.slot.error_is_limited();
    const MergedParts<float> parts = merged_parts(one.area(), other.area(), counted);
    const glm::vec3 color_of_one = colors_.of(at_.index, one.slot, one.owned),
                    color_of_other = colors_.of(at_.index, other.slot, other.owned);
    if (observer_)
      observer_->merges({one.owned.wide(), color_of_one, parts.one}, {other.owned.wide(), color_of_other, parts.other});
    const float channels[] = {color_of_one[0], color_of_one[1], color_of_one[2]},
                channels_of_other[] = {color_of_other[0], color_of_other[1], color_of_other[2]};
    const OwnerSlot slot(merged_slot(larger.slot.triangle(), parts, channels, channels_of_other, one.slot.content(),
                                     other.slot.content()));
    ++at_.new_slots;
    at_.record.set(first, slot, larger.plane, pair_bounds(larger.plane, {kInFront, kNoDepth}).farthest);
    at_.own(first, one.owned | other.owned);
    for (std::size_t k = second; k + 1 < at_.shape.owners; ++k) keep(k + 1, k);
    --at_.shape.owners;
  }

  // ---- Specks own no position ----

  // Each of the three positions nearest to a speck votes for it, if it is free or its owner is not nearer. Of specks
  // that face towards the viewer and specks that face away, those with the smaller area are the hidden sides of thin
  // bodies.
  void add_speck(const Fragment& fragment) {
    if (at_.word().kind == PixelKind::open) at_.look_at_record();
    ++work.specks[at_.word().kind == PixelKind::open ? at_.shape.planes() : 0];
    const float votes = votes_for(fragment);
    if (votes == 0) return;
    ++work.specks_seen;
    const bool keeps_positions = at_.word().kind == PixelKind::open;
    if (!keeps_positions) at_.open();
    RecordShape with_sums = at_.shape;
    with_sums.has_sums = true;
    if (!at_.has_room(with_sums)) {
      ++(*result_.maps.refusals)[at_.index], ++(*result_.maps.lost_specks)[at_.index];
      return;
    }
    at_.use_sums();
    if (!bin_.watermarks) {
      ++work.speck_depths;
      at_.record.head->nearest_speck = lesser(at_.record.head->nearest_speck, fragment.centroid_z);
    }
    FixedSum& facing = at_.record.head->sums.specks[fragment.front];
    const std::int32_t opposite = at_.record.head->sums.specks[!fragment.front].units;
    FinalSums<std::int32_t, std::uint32_t> sums = at_.sums();
    std::int32_t same = facing.units;
    const float threshold = speck_threshold(fragment.alpha, fragment.centroid_z);
    const float area = add_speck_area(fragment.alpha, votes, threshold, opposite, sums.area, same);
    facing.units = static_cast<std::uint16_t>(same);
    if (area > 0) {
      ++work.specks_added;
      const glm::vec3 color = colors_.of_speck(fragment);
      if (observer_) observer_->adds_speck(fragment.triangle, area, color);
      sums.add(area, {area * color[0], area * color[1], area * color[2], 0.0f, 0.0f, 0.0f}, threshold);
      at_.set_sums(sums);
    }
    if (keeps_positions) {
      at_.store_sums();
    } else {
      at_.store();
    }
  }

  float votes_for(const Fragment& speck) {
    if (at_.word().kind == PixelKind::untouched) return 3.0f;
    if (at_.word().kind == PixelKind::covered) {
      fetch_plane(at_.word().number);
      return is_nearer_than(speck, at_.cover_depth().plane) ? 3.0f : 0.0f;
    }
    float votes = 0;
    at_.count_read(3 * at_.shape.planes() * sizeof(std::uint32_t));
    for (const std::uint8_t position : bin_.positions.nearest_to(speck.centroid_u, speck.centroid_v)) {
      const auto has = [&](const std::uint32_t* words) { return words[position / 32] >> (position % 32) & 1; };
      std::size_t k = 0;
      while (k < at_.shape.owners && !has(at_.record.owned(k))) ++k;
      if (k < at_.shape.owners) {
        votes += is_nearer_than(speck, plane_of(k));
      } else {
        votes += at_.shape.has_empty && has(at_.record.head->empty);
      }
    }
    return votes;
  }

  bool is_nearer_than(const Fragment& speck, const DepthPlane<float>& plane) {
    ++work.speck_comparisons;
    return is_on_or_before(speck.centroid_z, plane, speck.centroid_u - 0.5f, speck.centroid_v - 0.5f);
  }

  // ---- Limit: the analytic estimate, no farther from the counted one than the tolerances allow ----

  HWY_INLINE PixelColor limited() {
    const float count = static_cast<float>(at_.final.count());
    if (at_.area <= 0 && count == 0) return {0.0f, glm::vec3(0.0f)};
    ++work.limited;
    work.bytes_read += sizeof(PixelSums);
    const std::array<float, ColorSums::kCount> sums = at_.record.head->sums.colors.values();
    const Estimate<float> analytic{at_.area, {sums[0], sums[1], sums[2]}},
        counted{count / kPositions, {sums[3], sums[4], sums[5]}};
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
  PixelAtHand<Words> at_;
  PixelObserver* observer_ = nullptr;  // of the pixel at hand; null: nobody looks at it
  OwnerColors<Words> colors_;
  std::array<Owner, kMostOwners + 1> owners_;
  std::array<Place, kMostOwners + 1> order_;
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
    const std::uint64_t merges = composer.work.merges;
    const std::size_t chunks = pixels.pool.beyond_guaranteed();
    if (fragment.triangle >= pixels.closes_at) pixels.pool.close();
    tile.maps.fragments[fragment.pixel] += composer.add(fragment, number, tile.closed);
    if (composer.work.merges != merges) [[unlikely]]
      tile.maps.merges[fragment.pixel] += static_cast<float>(composer.work.merges - merges);
    if (tile.result.lists_claims && pixels.pool.beyond_guaranteed() != chunks)
      tile.result.claims.push_back(
          {fragment.triangle, static_cast<std::int32_t>(pixels.pool.beyond_guaranteed() - chunks)});
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
