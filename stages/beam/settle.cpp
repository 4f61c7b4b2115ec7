#include "stages/beam/settle.h"

#include <algorithm>
#include <array>

#include "simd/conserve.h"
#include "stages/beam/settle_cost.h"

namespace beampipe {
namespace {

// An owner, and how much of it is visible.
struct Owner {
  const Fragment* fragment;
  float covered, visible;  // mask positions
};

float visible_part(const Owner& owner) { return owner.visible / owner.covered; }

// Lists the owners that have fragments, those with the largest visible part first, as in sorted order. Returns their
// number. [begin, end): the fragments, in the order of the layers.
template <std::size_t Words, std::size_t Layers>
std::size_t list_owners(const Fragment* begin, const Fragment* end, const OwnerPixel<Words, Layers>& pixel,
                        std::array<Owner, Layers>& owners) {
  std::size_t count = 0;
  const Fragment* fragment = begin;
  for (std::uint32_t k = 0; k < Layers; ++k) {
    const WideMask owned = pixel.positions_in(OwnerPixel<Words, Layers>::kFirstLayer + k);
    if (owned.none() || fragment == end || fragment->triangle != pixel.triangle(k)) continue;
    const Owner owner{fragment, static_cast<float>(fragment->mask.count()), static_cast<float>(owned.count())};
    std::size_t place = count++;
    for (; place > 0 && visible_part(owner) > visible_part(owners[place - 1]); --place)
      owners[place] = owners[place - 1];
    owners[place] = owner;
    ++fragment;
  }
  return count;
}

// Returns the number of owners whose areas were added. [begin, end): as in list_owners.
template <std::size_t Words, std::size_t Layers>
std::size_t settle_pixel(const Fragment* begin, const Fragment* end, bool last_pass, OwnerPixel<Words, Layers>& pixel) {
  using Pixel = OwnerPixel<Words, Layers>;
  constexpr auto kPositions = static_cast<float>(32 * Words);
  const bool speck = pixel.owner[0] & Pixel::kSpeck;
  const WideMask deferred = pixel.positions_in(Pixel::kDeferred);
  WideMask settled = pixel.positions_in(Pixel::kSettled);
  Taken<float> taken{pixel.area / kAreaUnits, static_cast<float>(settled.count())};
  glm::vec3 color = taken.area * glm::vec3(pixel.color[0], pixel.color[1], pixel.color[2]);  // times area
  for (std::uint32_t k = 0; k < Layers; ++k) settled = settled | pixel.positions_in(Pixel::kFirstLayer + k);
  std::array<Owner, Layers> seen;
  const std::size_t count = list_owners(begin, end, pixel, seen);
  for (std::size_t i = 0; i < count; ++i) {
    const Owner& owner = seen[i];
    const float area = speck ? owner.visible * (1 / kPositions)
                             : visible_area(owner.fragment->alpha, owner.covered, owner.visible, kPositions, taken);
    taken.area += area;
    taken.positions += owner.visible;
    color += area / owner.fragment->alpha * owner.fragment->color;
  }
  float scale = 1;
  if (deferred.none() || last_pass) {
    // If all positions are covered, nothing of the background is visible. Positions that no pass has decided are
    // assumed to look like the rest.
    const auto undecided = static_cast<float>(deferred.count());
    const bool full = settled.count() + deferred.count() == 32 * static_cast<int>(Words);
    if (taken.area > 0) scale = full ? 1 / taken.area : std::min(kPositions / (kPositions - undecided), 1 / taken.area);
    settled = settled | deferred | pixel.positions_in(Pixel::kEmpty);
  }
  if (taken.area > 0)
    for (int c = 0; c < 3; ++c) pixel.color[c] = HalfBits(color[c] / taken.area);
  pixel.area = static_cast<std::uint16_t>(std::min(taken.area * scale, 1.0f) * kAreaUnits + 0.5f);
  pixel.put(settled, Pixel::kSettled);
  pixel.put(without(deferred, settled), Pixel::kEmpty);
  pixel.dropped = kNoDepth;
  return count;
}

}  // namespace

template <std::size_t Words, std::size_t Layers>
std::vector<Pair> owners(const SetupTriangles& triangles, const std::vector<OwnerPixel<Words, Layers>>& pixels,
                         const Tile& tile, StageCounters& counters) {
  using Pixel = OwnerPixel<Words, Layers>;
  std::vector<Pair> pairs;
  std::uint64_t claimed = 0;  // pixels
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::size_t before = pairs.size();
    const auto x = tile.x0 + static_cast<std::int32_t>(i) % tile.width();
    const auto y = tile.y0 + static_cast<std::int32_t>(i) / tile.width();
    for (std::size_t k = 0; k < Layers; ++k) {
      if (pixels[i].positions_in(Pixel::kFirstLayer + static_cast<std::uint32_t>(k)).none()) continue;
      const SetupTriangle& triangle = triangles.triangles[pixels[i].triangle(k)];
      Pair& pair = pairs.emplace_back();
      pair = {pixels[i].triangle(k), static_cast<std::uint32_t>(pairs.size() - 1), x, y, false, 0, 0};
      set_depths(triangle, vertex_bounds(triangle.vertex_z), pair);
    }
    claimed += pairs.size() > before;
  }
  charge_owners<Words, Layers>(claimed, pairs.size(), counters);
  return pairs;
}

template <std::size_t Words, std::size_t Layers>
void settle(const std::vector<Fragment>& fragments, bool last_pass, StageCounters& counters,
            std::vector<OwnerPixel<Words, Layers>>& pixels) {
  const Fragment* fragment = fragments.data();
  const Fragment* const end = fragment + fragments.size();
  SettleWork work;
  work.fragments = fragments.size();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Fragment* const begin = fragment;
    while (fragment != end && fragment->pixel == i) ++fragment;
    if (!is_unfinished(pixels[i])) continue;
    const std::size_t owners = settle_pixel(begin, fragment, last_pass, pixels[i]);
    if (begin == fragment) continue;  // a pixel without owners stays cleared in memory and shows the background
    ++work.pixels;
    work.owners += owners;
    work.comparisons += owners * (owners - 1) / 2;
    work.unfinished += is_unfinished(pixels[i]);
  }
  charge<Words, Layers>(work, counters);
}

template <std::size_t Words, std::size_t Layers>
std::vector<PixelColor> settled_colors(const std::vector<OwnerPixel<Words, Layers>>& pixels) {
  std::vector<PixelColor> colors;
  colors.reserve(pixels.size());
  for (const OwnerPixel<Words, Layers>& pixel : pixels) {
    const float area = pixel.area / kAreaUnits;
    colors.push_back({area, area * glm::vec3(pixel.color[0], pixel.color[1], pixel.color[2])});
  }
  return colors;
}

#define BEAMPIPE_SETTLE(words, layers)                                                                                 \
  template std::vector<Pair> owners(const SetupTriangles&, const std::vector<OwnerPixel<words, layers>>&, const Tile&, \
                                    StageCounters&);                                                                   \
  template void settle(const std::vector<Fragment>&, bool, StageCounters&, std::vector<OwnerPixel<words, layers>>&);   \
  template std::vector<PixelColor> settled_colors(const std::vector<OwnerPixel<words, layers>>&);
BEAMPIPE_OWNER_PIXELS(BEAMPIPE_SETTLE)
#undef BEAMPIPE_SETTLE

}  // namespace beampipe
