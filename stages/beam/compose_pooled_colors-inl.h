// The colours of the surfaces that compose_pooled adds to pixels. Inlined into kernels, once per SIMD target.
#if defined(BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_COLORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_COLORS_INL_H_
#undef BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_COLORS_INL_H_
#else
#define BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_COLORS_INL_H_
#endif

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hwy/highway.h"
#include "simd/plane_order.h"
#include "stages/beam/compose_pooled_cost.h"
#include "stages/beam/owner_rules.h"
#include "stages/beam/owners_bin.h"
#include "stages/beam/register_mask-inl.h"
#include "stages/data/pooled_pixels.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace {

template <std::size_t Words>
class OwnerColors {
 public:
  using Mask = HWY_NAMESPACE::Mask<Words>;

  OwnerColors(const OwnersBin& bin, OwnersResult& result, PooledWork& work) : bin_(bin), result_(result), work_(work) {}

  // Are there colours for shade_together()? If requests for texels are kept, their order matters.
  bool are_shaded_together() const {
    const OwnerPlace at = bin_.shading.at;
    return !bin_.shader.is_flat() && at != OwnerPlace::quarters && at != OwnerPlace::sixteenths &&
           !(result_.texels && result_.texels->are_kept());
  }

  // Computes colours side by side, for of_final() and of_cover(), until forget(). wanted[pixel]: bit k: that of owner
  // k; of a covered pixel, any bit.
  void shade_together(const PooledPixels<Words>& pixels, const std::vector<std::uint32_t>& wanted) {
    std::vector<WaitingOwner> owners;
    const auto add = [&](std::uint32_t pixel, std::uint32_t number, const glm::vec2& centroid, const Mask& owned) {
      const std::uint32_t triangle = bin_.list[number];
      if (bin_.shader.is_flat(triangle)) return;
      shaded_at_.back() = static_cast<std::uint32_t>(owners.size());
      owners.push_back({pixel, triangle, centroid, owned.wide()});
    };
    for (std::uint32_t pixel = 0; pixel < pixels.words.size(); ++pixel) {
      first_shaded_.push_back(static_cast<std::uint32_t>(shaded_at_.size()));
      if (wanted[pixel] == 0) continue;
      const PixelWord& word = pixels.words[pixel];
      if (word.kind == PixelKind::covered) {
        shaded_at_.push_back(kNotShaded);
        add(pixel, word.number, glm::vec2(0.5f), Mask::filled(true));
      }
      if (word.kind != PixelKind::open) continue;
      const RecordView<Words> record = RecordStore<Words>::view(word.record_size, word.record);
      for (std::size_t k = 0; k < word.shape.owners; ++k) {
        const OwnerSlot& slot = record.slots[k];
        shaded_at_.push_back(kNotShaded);
        if (wanted[pixel] >> k & 1 && !slot.is_merged())
          add(pixel, slot.triangle(), slot.centroid(), Mask(record.owned(k)));
      }
    }
    if (is_adaptive()) {
      shade_adaptively(owners);
    } else {
      std::vector<Invocation> invocations;
      for (const WaitingOwner& owner : owners) {
        const glm::vec2 at = bin_.shading.at == OwnerPlace::visible ? mean_of(Mask(owner.owned)) : owner.at;
        invocations.push_back({owner.triangle, bin_.shader.place(owner.pixel, at.x, at.y)});
      }
      for (const glm::vec3& color : bin_.shader.colors(invocations, result_.texels)) shaded_.push_back({color, 1});
    }
  }

  void forget() {
    shaded_.clear();
    first_shaded_.clear();
    shaded_at_.clear();
  }

  // Of owner k of a pixel, which becomes final. `owned`: its positions.
  glm::vec3 of_final(std::uint32_t pixel, std::size_t k, const OwnerSlot& slot, const Mask& owned) {
    if (slot.is_merged()) return slot.color();
    return shaded(pixel, k, slot.triangle(), slot.centroid(), owned);
  }

  // Of the triangle that covers a pixel. `number`: in the list.
  glm::vec3 of_cover(std::uint32_t pixel, std::uint32_t number) {
    return shaded(pixel, 0, number, glm::vec2(0.5f), Mask::filled(true));
  }

  // Of an owner that is not final.
  glm::vec3 of(std::uint32_t pixel, const OwnerSlot& slot, const Mask& owned) {
    return slot.is_merged() ? slot.color() : shade_owner(pixel, slot.triangle(), slot.centroid(), owned);
  }

  glm::vec3 of_speck(const Fragment& speck) {
    return shade(speck.pixel, speck.triangle, {speck.centroid_u, speck.centroid_v},
                 is_adaptive() ? std::sqrt(speck.alpha) : 1.0f);
  }

 private:
  bool is_adaptive() const { return bin_.shading.at == OwnerPlace::adaptive; }

  // By shade_together(), if it has shaded this one.
  glm::vec3 shaded(std::uint32_t pixel, std::size_t k, std::uint32_t number, const glm::vec2& centroid,
                   const Mask& owned) {
    const std::uint32_t at = first_shaded_.empty() ? kNotShaded : shaded_at_[first_shaded_[pixel] + k];
    if (at == kNotShaded) return shade_owner(pixel, number, centroid, owned);
    const Shaded& found = shaded_[at];
    result_.shaded.insert(result_.shaded.end(), found.times, {bin_.list[number]});
    if (result_.shadings) (*result_.shadings)[pixel] += static_cast<float>(found.times);
    return found.color;
  }

  glm::vec3 shade_owner(std::uint32_t pixel, std::uint32_t number, const glm::vec2& centroid, const Mask& owned) {
    const std::uint32_t triangle = bin_.list[number];
    if (bin_.shading.at == OwnerPlace::covered || bin_.shader.is_flat(triangle))
      return shade(pixel, triangle, centroid);
    if (bin_.shading.at == OwnerPlace::visible) return shade_at_mean(pixel, triangle, owned, 1.0f);
    if (is_adaptive()) return shade_adaptively(pixel, triangle, owned);
    if (bin_.shading.at == OwnerPlace::quarters)
      return shade_parts(pixel, triangle, owned, bin_.positions.quarters, 0.5f);
    return shade_parts(pixel, triangle, owned, bin_.positions.sixteenths, 0.25f);
  }

  // The mean of what is owned in each part of the pixel. `width`: of a part, in pixels.
  template <class Parts>
  glm::vec3 shade_parts(std::uint32_t pixel, std::uint32_t triangle, const Mask& owned, const Parts& parts,
                        float width) {
    glm::vec3 sum(0.0f);
    for (const WideMask& part : parts)
      if (const Mask here = owned & Mask(part); !here.none())
        sum += static_cast<float>(here.count()) * shade_at_mean(pixel, triangle, here, width);
    return sum / static_cast<float>(owned.count());
  }

  glm::vec3 shade_at_mean(std::uint32_t pixel, std::uint32_t triangle, const Mask& positions, float width) {
    return shade(pixel, triangle, mean_of(positions), width);
  }

  glm::vec2 mean_of(const Mask& positions) {
    ++work_.measured;
    const WideMask words = positions.wide();
    const PositionSums sums = position_sums(bin_.positions.patterns.data(), Words, words.words.data());
    const auto count = static_cast<float>(positions.count());
    return {mean_position(sums.x, count), mean_position(sums.y, count)};
  }

  // What is owned of an area: its mean position, and the footprint of its positions.
  struct Area {
    glm::vec2 at;
    Footprint footprint;
    float count;  // of positions
  };
  // `middle`, `width`: of the whole area, which has the positions `all`.
  Area area_of(const Mask& owned, const Mask& all, const glm::vec2& middle, float width) {
    const auto count = static_cast<float>(owned.count());
    if (owned == all) return {middle, Footprint(width), count};
    ++work_.measured;
    static const UnitCost of_footprint = footprint_cost(Words);
    result_.decisions += of_footprint;
    const WideMask words = owned.wide();
    const SamplePattern* const patterns = bin_.positions.patterns.data();
    const PositionSums sums = position_sums(patterns, Words, words.words.data());
    const PositionSquares squares = position_squares(patterns, Words, words.words.data());
    const Sides<float> sides =
        sides_of({sums.x, sums.y}, {squares.xx, squares.xy, squares.yy}, count, static_cast<float>(kPositions));
    return {{mean_position(sums.x, count), mean_position(sums.y, count)},
            Footprint(sides.right, sides.down, sides.height),
            count};
  }

  Area whole_of(const Mask& owned) { return area_of(owned, Mask::filled(true), glm::vec2(0.5f), 1.0f); }

  // Calls visit(q, area) for each quarter of the pixel of which something is owned.
  template <class Visit>
  void for_each_quarter(const Mask& owned, Visit&& visit) {
    for (std::size_t q = 0; q < 4; ++q) {
      const Mask quarter(bin_.positions.quarters[q]), here = owned & quarter;
      if (!here.none()) visit(q, area_of(here, quarter, middle_of(q % 2, q / 2, 0.5f), 0.5f));
    }
  }

  // Calls visit(area) for each sixteenth of the pixel in quarter q of which something is owned.
  template <class Visit>
  void for_each_sixteenth(const Mask& owned, std::size_t q, Visit&& visit) {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t column = 2 * (q % 2) + i % 2, row = 2 * (q / 2) + i / 2;
      const Mask sixteenth(bin_.positions.sixteenths[4 * row + column]), here = owned & sixteenth;
      if (!here.none()) visit(area_of(here, sixteenth, middle_of(column, row, 0.25f), 0.25f));
    }
  }

  static glm::vec2 middle_of(std::size_t column, std::size_t row, float width) {
    return (glm::vec2(column, row) + 0.5f) * width;
  }

  // Does light vary by more in the area than is tolerated? `range`: by how much it may vary.
  bool varies(const Area& area, float range) const {
    return range * (area.count / kPositions) > bin_.shading.tolerance;
  }

  bool shader_varies(std::uint32_t pixel, std::uint32_t triangle, const Area& area) {
    result_.decisions += bin_.shader.work(triangle).range;
    const float range = bin_.shader.light_range(triangle, pixel, area.at.x, area.at.y, area.footprint, result_.texels);
    end_request(result_.texels);
    return varies(area, range);
  }

  // Halves the pixel in both directions where light varies, up to twice.
  glm::vec3 shade_adaptively(std::uint32_t pixel, std::uint32_t triangle, const Mask& owned) {
    const Area whole = whole_of(owned);
    if (!shader_varies(pixel, triangle, whole)) return shade(pixel, triangle, whole.at, whole.footprint);
    glm::vec3 sum(0.0f);
    const auto add = [&](const Area& area) { sum += area.count * shade(pixel, triangle, area.at, area.footprint); };
    for_each_quarter(owned, [&](std::size_t q, const Area& area) {
      if (shader_varies(pixel, triangle, area)) {
        for_each_sixteenth(owned, q, add);
      } else {
        add(area);
      }
    });
    return sum / whole.count;
  }

  // One of the owners that are shaded together.
  struct WaitingOwner {
    std::uint32_t pixel, triangle;
    glm::vec2 at;  // the centroid of what its triangle covers
    WideMask owned;
  };

  // The areas of some owners, and how far their light may vary.
  struct Areas {
    std::vector<Area> areas;
    std::vector<Invocation> invocations;
    std::vector<float> ranges;

    void reserve(std::size_t count) {
      areas.reserve(count);
      invocations.reserve(count);
    }
  };
  void add(const WaitingOwner& owner, const Area& area, Areas& areas) {
    areas.areas.push_back(area);
    areas.invocations.push_back({owner.triangle, bin_.shader.place(owner.pixel, area.at.x, area.at.y), area.footprint});
  }
  void find_ranges(Areas& areas) {
    for (const Invocation& invocation : areas.invocations)
      result_.decisions += bin_.shader.work(invocation.triangle).range;
    areas.ranges = bin_.shader.light_ranges(areas.invocations, result_.texels);
  }

  // The same for all at once: first all pixels, then all quarters, then all that is to be shaded.
  void shade_adaptively(const std::vector<WaitingOwner>& owners) {
    Areas wholes, quarters, pieces;
    for (Areas* const areas : {&wholes, &pieces}) areas->reserve(owners.size());
    for (const WaitingOwner& owner : owners) add(owner, whole_of(Mask(owner.owned)), wholes);
    find_ranges(wholes);
    const auto is_halved = [&](std::size_t i) { return varies(wholes.areas[i], wholes.ranges[i]); };
    for (std::size_t i = 0; i < owners.size(); ++i)
      if (is_halved(i))
        for_each_quarter(Mask(owners[i].owned), [&](std::size_t, const Area& area) { add(owners[i], area, quarters); });
    find_ranges(quarters);
    std::size_t quarter = 0;
    for (std::size_t i = 0; i < owners.size(); ++i) {
      const std::size_t before = pieces.areas.size();
      const Mask owned(owners[i].owned);
      const auto add_piece = [&](const Area& area) { add(owners[i], area, pieces); };
      if (!is_halved(i)) {
        add_piece(wholes.areas[i]);
      } else {
        for (std::size_t q = 0; q < 4; ++q) {
          if ((owned & Mask(bin_.positions.quarters[q])).none()) continue;
          const Area& area = quarters.areas[quarter];
          if (varies(area, quarters.ranges[quarter++])) {
            for_each_sixteenth(owned, q, add_piece);
          } else {
            add_piece(area);
          }
        }
      }
      shaded_.push_back({glm::vec3(0.0f), static_cast<std::uint32_t>(pieces.areas.size() - before)});
    }
    const std::vector<glm::vec3> colors = bin_.shader.colors(pieces.invocations, result_.texels);
    std::size_t piece = 0;
    for (std::size_t i = 0; i < owners.size(); ++i) {
      glm::vec3& color = shaded_[i].color;
      if (!is_halved(i)) {
        color = colors[piece++];
        continue;
      }
      for (std::uint32_t n = 0; n < shaded_[i].times; ++n, ++piece) color += pieces.areas[piece].count * colors[piece];
      color /= wholes.areas[i].count;
    }
  }

  // `footprint`: the area that the colour stands for.
  glm::vec3 shade(std::uint32_t pixel, std::uint32_t triangle, const glm::vec2& at, const Footprint& footprint = {}) {
    result_.shaded.push_back({triangle});
    if (result_.shadings && !bin_.shader.is_flat(triangle)) ++(*result_.shadings)[pixel];
    const glm::vec3 color = bin_.shader.color(triangle, pixel, at.x, at.y, footprint, result_.texels);
    end_request(result_.texels);
    return color;
  }

  static constexpr int kPositions = 32 * Words;

  const OwnersBin& bin_;
  OwnersResult& result_;
  PooledWork& work_;
  // What shade_together() has shaded, and where those of each pixel's owners are.
  struct Shaded {
    glm::vec3 color;
    std::uint32_t times;
  };
  static constexpr std::uint32_t kNotShaded = ~0u;
  std::vector<Shaded> shaded_;
  std::vector<std::uint32_t> first_shaded_, shaded_at_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
