// The colours of the surfaces that compose_pooled adds to pixels. Inlined into kernels, once per SIMD target.
#if defined(BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_COLORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_COLORS_INL_H_
#undef BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_COLORS_INL_H_
#else
#define BEAMPIPE_STAGES_BEAM_COMPOSE_POOLED_COLORS_INL_H_
#endif

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
    if (bin_.shader.is_flat() || bin_.shade_at != OwnerPlace::covered) return;
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
      const RecordView<Words> record = pixels.records.view(word.record_size, word.number);
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
    return shade(speck.pixel, speck.triangle, {speck.centroid_u, speck.centroid_v});
  }

 private:
  // By shade_all(), if it has shaded this one.
  glm::vec3 shaded(std::uint32_t pixel, std::size_t k, std::uint32_t number, const glm::vec2& centroid,
                   const Mask& owned) {
    const std::uint32_t at = first_shaded_.empty() ? kNotShaded : shaded_at_[first_shaded_[pixel] + k];
    if (at == kNotShaded) return shade_owner(pixel, number, centroid, owned);
    result_.shaded.push_back({bin_.list[number]});
    return colors_[at];
  }

  glm::vec3 shade_owner(std::uint32_t pixel, std::uint32_t number, const glm::vec2& centroid, const Mask& owned) {
    const std::uint32_t triangle = bin_.list[number];
    if (bin_.shade_at == OwnerPlace::covered || bin_.shader.is_flat(triangle)) return shade(pixel, triangle, centroid);
    if (bin_.shade_at == OwnerPlace::visible) return shade_at_mean(pixel, triangle, owned, 1.0f);
    if (bin_.shade_at == OwnerPlace::quarters)
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

  // `width`: of the area that the colour stands for, in pixels.
  glm::vec3 shade(std::uint32_t pixel, std::uint32_t triangle, const glm::vec2& at, float width = 1.0f) {
    result_.shaded.push_back({triangle});
    const glm::vec3 color = bin_.shader.color(triangle, pixel, at.x, at.y, width, result_.texels);
    end_request(result_.texels);
    return color;
  }

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
