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

  // Computes the colours of all owners that are left, for of_final() and of_cover(). The modelled machine shades owners
  // as they become final, so this leaves them alone if their requests for texels are kept.
  void shade_all(PooledPixels<Words>& pixels) {
    if (bin_.shader.is_flat() || bin_.shading.at != OwnerPlace::covered) return;
    if (result_.texels && result_.texels->are_kept()) return;
    std::vector<Invocation> invocations;
    const auto add = [&](std::uint32_t pixel, std::uint32_t number, float u, float v) {
      const std::uint32_t triangle = bin_.list[number];
      shaded_at_.push_back(bin_.shader.is_flat(triangle) ? kNotShaded : static_cast<std::uint32_t>(invocations.size()));
      if (shaded_at_.back() != kNotShaded) invocations.push_back({triangle, bin_.shader.place(pixel, u, v)});
    };
    for (std::uint32_t pixel = 0; pixel < pixels.words.size(); ++pixel) {
      first_shaded_.push_back(static_cast<std::uint32_t>(shaded_at_.size()));
      const PixelWord& word = pixels.words[pixel];
      if (word.kind == PixelKind::covered) add(pixel, word.number, 0.5f, 0.5f);
      if (word.kind != PixelKind::open) continue;
      const RecordView<Words> record = RecordStore<Words>::view(word.record_size, word.record);
      for (std::size_t k = 0; k < word.shape.owners; ++k) {
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
    const bool is_filtered = bin_.shading.at == OwnerPlace::adaptive;
    return shade(speck.pixel, speck.triangle, {speck.centroid_u, speck.centroid_v},
                 is_filtered ? std::sqrt(speck.alpha) : 1.0f);
  }

 private:
  // By shade_all(), if it has shaded this one.
  glm::vec3 shaded(std::uint32_t pixel, std::size_t k, std::uint32_t number, const glm::vec2& centroid,
                   const Mask& owned) {
    const std::uint32_t at = first_shaded_.empty() ? kNotShaded : shaded_at_[first_shaded_[pixel] + k];
    if (at == kNotShaded) return shade_owner(pixel, number, centroid, owned);
    result_.shaded.push_back({bin_.list[number]});
    if (result_.shadings) ++(*result_.shadings)[pixel];
    return colors_[at];
  }

  glm::vec3 shade_owner(std::uint32_t pixel, std::uint32_t number, const glm::vec2& centroid, const Mask& owned) {
    const std::uint32_t triangle = bin_.list[number];
    if (bin_.shading.at == OwnerPlace::covered || bin_.shader.is_flat(triangle))
      return shade(pixel, triangle, centroid);
    if (bin_.shading.at == OwnerPlace::visible) return shade_at_mean(pixel, triangle, owned, 1.0f);
    if (bin_.shading.at == OwnerPlace::adaptive) return shade_adaptively(pixel, triangle, owned);
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
    ++work_.measured;
    const WideMask words = positions.wide();
    const PositionSums sums = position_sums(bin_.positions.patterns.data(), Words, words.words.data());
    const auto count = static_cast<float>(positions.count());
    return shade(pixel, triangle, {mean_position(sums.x, count), mean_position(sums.y, count)}, width);
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

  // May light vary by more in the area than is tolerated?
  bool varies(std::uint32_t pixel, std::uint32_t triangle, const Area& area) {
    result_.decisions += bin_.shader.work(triangle).range;
    const float range = bin_.shader.light_range(triangle, pixel, area.at.x, area.at.y, area.footprint, result_.texels);
    end_request(result_.texels);
    return range * (area.count / kPositions) > bin_.shading.tolerance;
  }

  // Halves the pixel in both directions where light varies, up to twice.
  glm::vec3 shade_adaptively(std::uint32_t pixel, std::uint32_t triangle, const Mask& owned) {
    const Area whole = area_of(owned, Mask::filled(true), glm::vec2(0.5f), 1.0f);
    if (!varies(pixel, triangle, whole)) return shade(pixel, triangle, whole.at, whole.footprint);
    glm::vec3 sum(0.0f);
    const auto add = [&](const Area& area) { sum += area.count * shade(pixel, triangle, area.at, area.footprint); };
    const auto middle_of = [](std::size_t column, std::size_t row, float width) {
      return (glm::vec2(column, row) + 0.5f) * width;
    };
    for (std::size_t q = 0; q < 4; ++q) {
      const Mask quarter(bin_.positions.quarters[q]), here = owned & quarter;
      if (here.none()) continue;
      const Area area = area_of(here, quarter, middle_of(q % 2, q / 2, 0.5f), 0.5f);
      if (!varies(pixel, triangle, area)) {
        add(area);
        continue;
      }
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t column = 2 * (q % 2) + i % 2, row = 2 * (q / 2) + i / 2;
        const Mask sixteenth(bin_.positions.sixteenths[4 * row + column]), there = owned & sixteenth;
        if (!there.none()) add(area_of(there, sixteenth, middle_of(column, row, 0.25f), 0.25f));
      }
    }
    return sum / whole.count;
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
  // What shade_all() has shaded: the colours, and where those of each pixel's owners are.
  static constexpr std::uint32_t kNotShaded = ~0u;
  std::vector<glm::vec3> colors_;
  std::vector<std::uint32_t> first_shaded_, shaded_at_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
