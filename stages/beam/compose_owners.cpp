#include "stages/beam/compose_owners.h"

#include <algorithm>
#include <array>
#include <bit>

#include "simd/conserve.h"
#include "simd/plane_order.h"
#include "simd/prefetch.h"
#include "stages/beam/compose_owners_cost.h"
#include "stages/beam/owner_rules.h"
#include "stages/data/pixel_depth.h"

// One version for vectors of 256 bits, which hold a whole mask, and one without vectors: each takes a minute to
// compile.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/beam/compose_owners.cpp"
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

template <std::size_t Words, std::size_t Slots>
class OwnerComposer {
 public:
  using Pixel = OpenPixel<Words, Slots>;
  using Pixels = OpenPixels<Words, Slots>;
  using Mask = HWY_NAMESPACE::Mask<Words>;

  OwnerComposer(const OwnersBin& bin, OwnersResult& result) : bin_(bin), result_(result) {}

  enum class Outcome { hidden, composed, merged };  // merged: two owners became one

  // `number`: of the fragment's triangle in the list. Whether closed pixels hide the fragment is decided here, although
  // the raster has left out many already: so pictures do not depend on how far the raster is ahead.
  Outcome add(const Fragment& fragment, std::uint32_t number, Pixels& pixels, ClosedDepth& closed) {
    ++work.fragments;
    pixel_ = fragment.pixel;
    if (closed.is_hidden(pixel_, fragment.z_min)) return Outcome::hidden;
    Pixel& pixel = pixels.pixels[pixel_];
    depths_ = &pixels.depths[pixel_];
    observer_ = observer_at(bin_.observers, pixel_);
    const Mask mask(fragment.mask);
    if (mask.none()) {
      if (observer_) observer_->arrives(fragment, {});
      add_speck(fragment, pixel);
      return Outcome::composed;
    }
    ++work.masks;
    const ByState met = by_state(mask, pixel);
    const bool meets_empty = met.found >> Pixel::kEmpty & 1;
    const std::uint64_t contested = met.found >> Pixel::kFirstSlot & kAllSlots;  // bit k: slot k
    const Mask claimed = met.positions[Pixel::kEmpty] | positions_won(fragment, met, contested, pixel);
    if (observer_) observer_->arrives(fragment, claimed.wide());
    if (claimed.none()) return Outcome::composed;
    ++work.claims;
    // An owner that has no position left has lost its slot.
    const std::uint64_t left = by_state(without(Mask::filled(true), claimed), pixel).found;
    const std::uint64_t owners = left >> Pixel::kFirstSlot & kAllSlots, losers = contested & ~owners;
    for (std::uint64_t slots = losers; slots != 0; slots &= slots - 1)
      pixel.slots[static_cast<std::size_t>(std::countr_zero(slots))].clear();
    // Does this fragment close the pixel, or may it close it nearer than before?
    const bool closes = (meets_empty || losers != 0) && !(left >> Pixel::kEmpty & 1);
    std::size_t room = owners == kAllSlots ? Slots : static_cast<std::size_t>(std::bit_width(kAllSlots & ~owners)) - 1;
    bool merged = false;
    if (room == Slots) {
      put(claimed, Pixel::kEmpty, pixel);
      room = make_room(fragment, mask, claimed, number, pixel, merged);
    }
    if (room < Slots) {
      put(claimed, Pixel::owned_by(room), pixel);
      pixel.slots[room] = slot_of(fragment, mask, number);
      depths_->set(room, fragment.plane, fragment.z_max);
    }
    if (closes) close(pixel, closed);
    return merged ? Outcome::merged : Outcome::composed;
  }

  // Computes the colours of all owners that are left, for finish(). The modelled machine shades owners as they become
  // final, so this leaves them alone if their requests for texels are kept.
  void shade_all(const Pixels& pixels) {
    if (bin_.shader.is_flat() || bin_.shade_at != OwnerPlace::covered) return;
    if (result_.texels && result_.texels->are_kept()) return;
    std::vector<Invocation> invocations;
    shaded_at_.assign(pixels.pixels.size() * Slots, kNotShaded);
    for (std::uint32_t i = 0; i < pixels.pixels.size(); ++i) {
      for (std::size_t k = 0; k < Slots; ++k) {
        const OwnerSlot& slot = pixels.pixels[i].slots[k];
        if (slot.is_free() || slot.is_merged()) continue;
        const std::uint32_t triangle = bin_.list[slot.triangle()];
        if (bin_.shader.is_flat(triangle)) continue;
        const glm::vec2 centroid = slot.centroid();
        shaded_at_[i * Slots + k] = static_cast<std::uint32_t>(invocations.size());
        invocations.push_back({triangle, bin_.shader.place(i, centroid.x, centroid.y)});
      }
    }
    colors_ = bin_.shader.colors(invocations, result_.texels);
  }

  // All owners are final. `index`: of the pixel in the tile. Returns its colour.
  PixelColor finish(std::uint32_t index, Pixels& pixels) {
    ++work.finished;
    pixel_ = index;
    observer_ = observer_at(bin_.observers, pixel_);
    if (observer_) observer_->arrivals_end();
    Pixel& pixel = pixels.pixels[index];
    if (const OwnerSlot* slot = only_owner(pixel)) {
      const auto k = static_cast<std::size_t>(slot - pixel.slots);
      const glm::vec3 color = final_color(*slot, k, Mask::filled(true));
      if (observer_) observer_->adds(bin_.list[slot->triangle()], 1.0, color);
      return {1.0f, color};
    }
    std::size_t count = 0;
    for (std::size_t k = 0; k < Slots; ++k)
      if (!pixel.slots[k].is_free()) list_owner(pixel, k, owners_[count++]);
    if (count == 0 && pixel.area <= 0) {  // nothing is seen
      ++work.settlings;
      return {0.0f, glm::vec3(0.0f)};
    }
    return limited(pixel, settle(count, pixel));
  }

  OwnersWork work;

 private:
  static constexpr auto kPositions = static_cast<float>(32 * Words);
  static constexpr std::uint64_t kAllSlots = (std::uint64_t{1} << Slots) - 1;

  struct Owner {
    OwnerSlot slot;
    std::size_t index = 0;  // of the slot; Slots: it has none yet
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

  // Positions by their state. Bit s of `found`: is any of them in state s?
  struct ByState {
    Mask positions[std::size_t{1} << Pixel::kBits];
    std::uint64_t found;
  };
  HWY_INLINE static ByState by_state(const Mask& positions, const Pixel& pixel) {
    ByState result;
    result.positions[0] = positions;
    for (std::size_t b = 0; b < Pixel::kBits; ++b) {
      const Mask plane(pixel.states.planes[b]);
      for (std::size_t state = 0; state < std::size_t{1} << b; ++state) {
        Mask& here = result.positions[state];
        result.positions[state | std::size_t{1} << b] = here & plane;
        here = without(here, plane);
      }
    }
    result.found = 0;
    for (std::size_t state = 0; state < Pixel::kFinal; ++state)
      result.found |= std::uint64_t{!result.positions[state].none()} << state;
    return result;
  }

  // As in PositionStates. No branch depends on the state, because it is hard to predict.
  HWY_INLINE static Mask positions_in(std::uint32_t state, const Pixel& pixel) {
    Mask positions = Mask::filled(true);
    for (std::size_t b = 0; b < Pixel::kBits; ++b)
      positions = without(positions, Mask(pixel.states.planes[b]) ^ Mask::filled(state >> b & 1));
    return positions;
  }
  HWY_INLINE void put(const Mask& positions, std::uint32_t state, Pixel& pixel) {
    ++work.puts;
    for (std::size_t b = 0; b < Pixel::kBits; ++b) {
      const Mask plane(pixel.states.planes[b]);
      (without(plane, positions) | (positions & Mask::filled(state >> b & 1))).store(pixel.states.planes[b]);
    }
  }

  HWY_INLINE static OwnerSlot slot_of(const Fragment& fragment, const Mask& mask, std::uint32_t number) {
    const auto covered = static_cast<std::uint32_t>(mask.count());
    OwnerSlot slot;
    slot.set(number, fragment.alpha * kPositions - static_cast<float>(covered), covered, fragment.centroid_u,
             fragment.centroid_v);
    return slot;
  }

  // Of the owner in slot k.
  DepthPlane<float> plane_of(std::size_t k, const OwnerSlot& slot) {
    ++work.planes;
    if (bin_.lists_fetches) result_.fetched.push_back(bin_.list[slot.triangle()]);
    return depths_->plane(k);
  }

  // The positions that the fragment takes from owners. `contested`: the slots of these owners.
  HWY_INLINE Mask positions_won(const Fragment& fragment, const ByState& met, std::uint64_t contested,
                                const Pixel& pixel) {
    Mask won = Mask::filled(false);
    if (contested == 0) return won;
    const auto contests = static_cast<std::uint64_t>(std::popcount(contested));
    work.contests += contests, work.planes += contests;
    if (bin_.lists_fetches)
      for (std::uint64_t slots = contested; slots != 0; slots &= slots - 1)
        result_.fetched.push_back(bin_.list[pixel.slots[std::countr_zero(slots)].triangle()]);
    const PlaneSides<Slots> sides = plane_sides<Slots>(fragment.plane, depths_->planes());
    for (std::size_t k = 0; k < Slots; ++k)
      won = won | (met.positions[Pixel::owned_by(k)] & Mask::repeated(sides.nearer[k]));
    for (std::uint64_t slots = contested & sides.crossing; slots != 0; slots &= slots - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(slots));
      won = won | positions_won_from(k, pixel.slots[k], fragment,
                                     Mask(fragment.mask) & positions_in(Pixel::owned_by(k), pixel));
    }
    return won;
  }

  // The contested positions that the fragment takes from the owner of slot k.
  Mask positions_won_from(std::size_t k, const OwnerSlot& slot, const Fragment& fragment, const Mask& contested) {
    ++work.planes_compared;
    const DepthPlane<float> owner = depths_->plane(k);
    const bool is_earlier = fragment.triangle < bin_.list[slot.triangle()];
    const DepthPlane<float>&one = is_earlier ? owner : fragment.plane, &other = is_earlier ? fragment.plane : owner;
    const WideMask where = contested.wide();
    WideMask nearer;
    nearer_positions(one, other, bin_.positions.patterns.data(), Words, nearer.words.data(), where.words.data());
    return is_earlier ? without(contested, Mask(nearer)) : Mask(nearer);
  }

  // Settles the owners that are final or, if there are none, makes one owner of two. Returns the slot that became free;
  // Slots if the fragment is one of the two, because then its positions already have an owner.
  std::size_t make_room(const Fragment& fragment, const Mask& mask, const Mask& claimed, std::uint32_t number,
                        Pixel& pixel, bool& merged) {
    DepthPlane<float> planes[Slots];
    for (std::size_t k = 0; k < Slots; ++k) planes[k] = plane_of(k, pixel.slots[k]);
    if (bin_.watermarks) {
      std::size_t count = 0;
      for (std::size_t k = 0; k < Slots; ++k)
        if (is_final(pixel, k, planes[k], (*bin_.watermarks)[number])) list_owner(pixel, k, owners_[count++]);
      if (count > 0) {
        settle(count, pixel);
        return owners_[order_.front().owner].index;
      }
    }
    for (std::size_t k = 0; k < Slots; ++k) {
      list_owner(pixel, k, owners_[k]);
      owners_[k].plane = planes[k];
    }
    owners_.back() = {slot_of(fragment, mask, number), Slots, claimed, static_cast<float>(claimed.count()),
                      fragment.plane};
    for (Owner& owner : owners_) measure(owner);
    merged = true;
    return merge_closest(pixel);
  }

  // Is the owner nowhere farther than the watermark? Its plane over the whole pixel most often says that it is, or that
  // it is not.
  bool is_final(const Pixel& pixel, std::size_t k, const DepthPlane<float>& plane, float watermark) {
    ++work.finality_tests;
    const Finality finality = finality_of(plane, watermark);
    if (finality != Finality::depends_on_positions) return finality == Finality::is_final;
    ++work.farthest_found;
    const WideMask owned = positions_in(Pixel::owned_by(k), pixel).wide();
    return farthest_depth(plane, bin_.positions.patterns.data(), Words, owned.words.data()) <= watermark;
  }

  // The owner of all positions of a pixel that nothing else is known of; null if there is no such owner.
  static const OwnerSlot* only_owner(const Pixel& pixel) {
    if (pixel.area > 0) return nullptr;
    const OwnerSlot* only = nullptr;
    for (const OwnerSlot& slot : pixel.slots) {
      if (slot.is_free()) continue;
      if (only || slot.is_merged()) return nullptr;
      only = &slot;
    }
    if (!only || only->covered() != kPositions) return nullptr;
    const Mask owned = positions_in(Pixel::owned_by(static_cast<std::size_t>(only - pixel.slots)), pixel);
    return owned == Mask::filled(true) ? only : nullptr;
  }

  // All but the plane and the mean.
  void list_owner(const Pixel& pixel, std::size_t k, Owner& owner) {
    ++work.listed;
    owner.slot = pixel.slots[k];
    owner.index = k;
    owner.owned = positions_in(Pixel::owned_by(k), pixel);
    owner.visible = static_cast<float>(owner.owned.count());
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

  std::size_t merge_closest(Pixel& pixel) {
    ++work.merges;
    std::size_t first = 0, second = 1;
    float least = loss_of(owners_[0], owners_[1]);
    for (std::size_t j = 2; j < owners_.size(); ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        const float loss = loss_of(owners_[i], owners_[j]);
        if (loss > least || (loss == least && distance_in_trace(i, j) >= distance_in_trace(first, second))) continue;
        least = loss, first = i, second = j;
      }
    }
    Owner &one = owners_[first], &other = owners_[second];  // only the other one may be without a slot
    const Owner& larger = one.visible >= other.visible ? one : other;
    const float error_of_one = one.area().fraction() * one.area().fraction() * one.slot.error();
    const float error_of_other = other.area().fraction() * other.area().fraction() * other.slot.error();
    // The mean is weighted by areas. Once an error has reached its limit, areas are not known any more.
    const bool counted = one.slot.error_is_limited() || other.slot.error_is_limited();
    const float part = counted ? one.visible : std::max(one.visible + error_of_one, kLeastArea);
    const float other_part = counted ? other.visible : std::max(other.visible + error_of_other, kLeastArea);
    const glm::vec3 color_of_other = color_of(other.slot, other.owned), color_of_one = color_of(one.slot, one.owned);
    const glm::vec3 color = (part * color_of_one + other_part * color_of_other) * (1 / (part + other_part));
    if (observer_) {
      const double share = part / (part + other_part);
      observer_->merges({one.owned.wide(), color_of_one, share}, {other.owned.wide(), color_of_other, 1 - share});
    }
    put(one.owned | other.owned, Pixel::owned_by(one.index), pixel);
    depths_->set(one.index, larger.plane, pair_bounds(larger.plane, {kInFront, kNoDepth}).farthest);
    pixel.slots[one.index].set_merged(larger.slot.triangle(), error_of_one + error_of_other, color,
                                      merge_threshold(one.slot.content(), other.slot.content()));
    if (other.index < Slots) pixel.slots[other.index].clear();
    return other.index;
  }

  // Of the owner in slot k, which shade_all() may have shaded.
  glm::vec3 final_color(const OwnerSlot& slot, std::size_t k, const Mask& owned) {
    const std::uint32_t at = shaded_at_.empty() ? kNotShaded : shaded_at_[pixel_ * Slots + k];
    if (at == kNotShaded) return color_of(slot, owned);
    result_.shaded.push_back({bin_.list[slot.triangle()]});
    return colors_[at];
  }

  // `owned`: positions of the pixel.
  glm::vec3 color_of(const OwnerSlot& slot, const Mask& owned) {
    if (slot.is_merged()) return slot.color();
    const std::uint32_t triangle = bin_.list[slot.triangle()];
    if (bin_.shade_at == OwnerPlace::covered || bin_.shader.is_flat(triangle)) {
      const glm::vec2 centroid = slot.centroid();
      return shade(triangle, centroid.x, centroid.y);
    }
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

  // Adds owners_[0 .. count - 1] to what is final. Those that show the largest part of their positions come first: what
  // they take beyond their positions is then known when the others are added. Returns how many positions are final.
  float settle(std::size_t count, Pixel& pixel) {
    ++work.settlings;
    sort_by_fraction(count);
    auto final_positions = static_cast<float>(positions_in(Pixel::kFinal, pixel).count());
    for (std::size_t i = 0; i < count; ++i) {
      const Owner* const owner = &owners_[order_[i].owner];
      ++work.settled;
      const float area = retired_area(owner->area(), kPositions, Taken<float>{pixel.area, final_positions});
      const glm::vec3 color = final_color(owner->slot, owner->index, owner->owned);
      const float counted = owner->visible / kPositions;
      if (observer_) observer_->settles(owner->owned.wide(), color, area, counted);
      final_positions += owner->visible;
      const float threshold = rounding_threshold(owner->slot.content());
      pixel.area.add(area, threshold);
      pixel.colors.add({area * color[0], area * color[1], area * color[2], counted * color[0], counted * color[1],
                        counted * color[2]},
                       threshold);
      put(owner->owned, Pixel::kFinal, pixel);
      pixel.slots[owner->index].clear();
    }
    return final_positions;
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

  // A pixel without empty positions hides what lies behind all of its owners.
  void close(const Pixel& pixel, ClosedDepth& closed) {
    float farthest = kInFront;
    for (std::size_t k = 0; k < Slots; ++k) {
      const OwnerSlot& slot = pixel.slots[k];
      if (slot.is_free()) continue;
      ++work.bounds_found;
      work.vertices_bounded += !slot.is_merged();
      plane_of(k, slot);
      farthest = std::max(farthest, depths_->farthest(k));
    }
    closed.close(pixel_, farthest);
  }

  // Each of the three positions nearest to a speck votes for it, if it is free or its owner is not nearer. Of specks
  // that face towards the viewer and specks that face away, those with the smaller area are the hidden sides of thin
  // bodies.
  void add_speck(const Fragment& fragment, Pixel& pixel) {
    ++work.specks;
    float votes = 0;
    for (const std::uint8_t position : bin_.positions.nearest_to(fragment.centroid_u, fragment.centroid_v)) {
      const std::uint32_t state = pixel.states.at(position);
      if (state == Pixel::kFinal) continue;
      votes += state == Pixel::kEmpty || is_nearer(fragment, state - Pixel::kFirstSlot, pixel);
    }
    if (votes == 0) return;
    FixedSum &same = pixel.specks[fragment.front], &opposite = pixel.specks[!fragment.front];
    const float before = greater(same, opposite);
    const float threshold = rounding_threshold(std::bit_cast<std::uint32_t>(fragment.alpha) ^
                                               std::bit_cast<std::uint32_t>(fragment.centroid_z));
    same.add(fragment.alpha * votes / 3.0f, threshold);
    const float area = speck_area<float>(same, opposite, before, pixel.area);
    if (area <= 0) return;
    ++work.specks_added;
    const glm::vec3 color = shade(fragment.triangle, fragment.centroid_u, fragment.centroid_v);
    if (observer_) observer_->adds_speck(fragment.triangle, area, color);
    pixel.area.add(area, threshold);
    pixel.colors.add({area * color[0], area * color[1], area * color[2], 0, 0, 0}, threshold);
  }

  bool is_nearer(const Fragment& speck, std::size_t k, const Pixel& pixel) {
    ++work.speck_comparisons;
    return is_on_or_before(speck.centroid_z, plane_of(k, pixel.slots[k]), speck.centroid_u - 0.5f,
                           speck.centroid_v - 0.5f);
  }

  // `count`: of positions, all of which are final. The analytic estimate, no farther from the counted one than the
  // tolerances allow.
  PixelColor limited(const Pixel& pixel, float count) {
    if (pixel.area <= 0) return {0.0f, glm::vec3(0.0f)};
    ++work.limited;
    Estimate<float> analytic{pixel.area, {}}, counted{count / kPositions, {}};
    for (std::size_t c = 0; c < 3; ++c) analytic.color[c] = pixel.colors[c], counted.color[c] = pixel.colors[c + 3];
    const Estimate<float> result = limited_estimate(analytic, counted, kPositions);
    if (observer_) observer_->finishes(color_of(analytic), color_of(counted), color_of(result));
    return color_of(result);
  }

  static PixelColor color_of(const Estimate<float>& estimate) {
    return {estimate.area, {estimate.color[0], estimate.color[1], estimate.color[2]}};
  }

  const OwnersBin& bin_;
  OwnersResult& result_;
  std::uint32_t pixel_ = 0;               // index within the tile
  OwnerDepths<Slots>* depths_ = nullptr;  // of this pixel
  PixelObserver* observer_ = nullptr;     // of this pixel; null: nobody looks at it
  std::array<Owner, Slots + 1> owners_;   // of one pixel, and the fragment that needs a slot
  std::array<Place, Slots> order_;
  // What shade_all() has shaded: the colours, and where that of each pixel's slots is.
  static constexpr std::uint32_t kNotShaded = ~0u;
  std::vector<glm::vec3> colors_;
  std::vector<std::uint32_t> shaded_at_;
};

template <std::size_t Words, std::size_t Slots>
void compose(const OwnersBin& bin, const OwnersBatch& batch, StageCounters& counters,
             const OwnersTile<Words, Slots>& tile) {
  const std::vector<Fragment>& fragments = batch.fragments;
  OpenPixels<Words, Slots>& pixels = tile.pixels;
  OwnerComposer<Words, Slots> composer(bin, tile.result);
  auto number = static_cast<std::uint32_t>(batch.first);
  constexpr std::size_t kAhead = 4;  // fragments
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    if (i + kAhead < fragments.size()) {
      prefetch(pixels.pixels[fragments[i + kAhead].pixel]);
      prefetch(pixels.depths[fragments[i + kAhead].pixel]);
    }
    const Fragment& fragment = fragments[i];
    while (bin.list[number] != fragment.triangle) ++number;
    using Outcome = typename OwnerComposer<Words, Slots>::Outcome;
    const Outcome outcome = composer.add(fragment, number, pixels, tile.closed);
    tile.maps.fragments[fragment.pixel] += outcome != Outcome::hidden;
    tile.maps.merges[fragment.pixel] += outcome == Outcome::merged;
  }
  charge<Words, Slots>(composer.work, counters);
}

template <std::size_t Words, std::size_t Slots>
std::vector<PixelColor> finish(const OwnersBin& bin, StageCounters& counters, OpenPixels<Words, Slots>& pixels,
                               OwnersResult& result) {
  OwnerComposer<Words, Slots> composer(bin, result);
  std::vector<PixelColor> colors(pixels.pixels.size());
  composer.shade_all(pixels);
  for (std::uint32_t i = 0; i < colors.size(); ++i) colors[i] = composer.finish(i, pixels);
  charge<Words, Slots>(composer.work, counters);
  return colors;
}

}  // namespace

// Highway's tables hold functions, not templates.
#define BEAMPIPE_KERNELS(words, slots)                                                                       \
  void compose_##words##_##slots(const OwnersBin& bin, const OwnersBatch& batch, StageCounters& counters,    \
                                 const OwnersTile<words, slots>& tile) {                                     \
    compose<words, slots>(bin, batch, counters, tile);                                                       \
  }                                                                                                          \
  std::vector<PixelColor> finish_##words##_##slots(const OwnersBin& bin, StageCounters& counters,            \
                                                   OpenPixels<words, slots>& pixels, OwnersResult& result) { \
    return finish<words, slots>(bin, counters, pixels, result);                                              \
  }
BEAMPIPE_OPEN_PIXELS(BEAMPIPE_KERNELS)
#undef BEAMPIPE_KERNELS

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
#define BEAMPIPE_COMPOSE(words, slots)                                                            \
  HWY_EXPORT(compose_##words##_##slots);                                                          \
  template <>                                                                                     \
  void compose_owners(const OwnersBin& bin, const OwnersBatch& batch, StageCounters& counters,    \
                      const OwnersTile<words, slots>& tile) {                                     \
    HWY_DYNAMIC_DISPATCH(compose_##words##_##slots)(bin, batch, counters, tile);                  \
  }                                                                                               \
  HWY_EXPORT(finish_##words##_##slots);                                                           \
  template <>                                                                                     \
  std::vector<PixelColor> finish_owners(const OwnersBin& bin, StageCounters& counters,            \
                                        OpenPixels<words, slots>& pixels, OwnersResult& result) { \
    return HWY_DYNAMIC_DISPATCH(finish_##words##_##slots)(bin, counters, pixels, result);         \
  }
BEAMPIPE_OPEN_PIXELS(BEAMPIPE_COMPOSE)
#undef BEAMPIPE_COMPOSE
}  // namespace beampipe
#endif
