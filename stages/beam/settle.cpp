#include "stages/beam/settle.h"

#include <algorithm>
#include <array>

#include "simd/conserve.h"
#include "stages/beam/claim.h"
#include "stages/cost/plane_cost.h"
#include "stages/raster/pair_bounds.h"

namespace beampipe {
namespace {

constexpr float kAreaUnits = 65535.0f;  // of a whole pixel

// An owner and what is seen of it.
struct Owner {
  const Fragment* fragment;
  float covered, visible;  // mask positions
};

float whole(const Owner& owner) { return owner.visible / owner.covered; }

// Returns how many owners' areas it has added.
template <std::size_t Words, std::size_t Layers>
std::size_t settle_pixel(const Fragment* begin, const Fragment* end, bool last_pass, OwnerPixel<Words, Layers>& pixel) {
  using Pixel = OwnerPixel<Words, Layers>;
  constexpr auto kPositions = static_cast<float>(32 * Words);
  const bool speck = pixel.owner[0] & Pixel::kSpeck;
  const WideMask deferred = pixel.positions_in(Pixel::kDeferred);
  std::array<Owner, Layers> seen;
  std::size_t count = 0;
  WideMask settled = pixel.positions_in(Pixel::kSettled);
  Taken<float> taken{pixel.area / kAreaUnits, static_cast<float>(settled.count())};
  glm::vec3 color = taken.area * glm::vec3(pixel.color[0], pixel.color[1], pixel.color[2]);  // times area
  const Fragment* fragment = begin;
  for (std::uint32_t k = 0; k < Layers; ++k) {
    const WideMask owned = pixel.positions_in(Pixel::kFirstLayer + k);
    settled = settled | owned;
    if (owned.none() || fragment == end || fragment->triangle != pixel.triangle(k)) continue;
    // Whole ones first, as in sorted order.
    const Owner owner{fragment, static_cast<float>(fragment->mask.count()), static_cast<float>(owned.count())};
    std::size_t place = count++;
    for (; place > 0 && whole(owner) > whole(seen[place - 1]); --place) seen[place] = seen[place - 1];
    seen[place] = owner;
    ++fragment;
  }
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
    // A pixel that is covered everywhere leaves nothing for the background. What no pass decided is like the rest.
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

using Real = Counted<float>;

// Population counts of a mask's words, added up.
void count_mask(OperationCounts& counts, std::size_t words) {
  Real sum;
  for (std::size_t w = 0; w < words; ++w) {
    const Real bits = bit_count(Counted<std::uint32_t>(0, counts));
    sum = w == 0 ? bits : sum + bits;
  }
}

// Of one owner: how much of it is seen, its area, its colour.
OperationCounts owner_cost(std::size_t words) {
  return count_operations([&](OperationCounts& counts) {
    const Real one(1.0f, counts);
    count_mask(counts, words), count_mask(counts, words);
    one / one;  // the share that is seen, by which owners are sorted
    Taken<Real> taken{one, one};
    const Real area = select(true, one * one, visible_area(one, one, one, one, taken));  // beside specks, or not
    taken = {taken.area + area, taken.positions + one};
    const Real share = area / one;
    for (int c = 0; c < 3; ++c) one + share* one;
  });
}

// Of one pixel besides: its state's masks, its colour and area from their formats and back.
template <std::size_t Words, std::size_t Layers>
OperationCounts pixel_cost() {
  using Pixel = OwnerPixel<Words, Layers>;
  constexpr std::size_t kBits = std::bit_width(Pixel::kSettled);
  OperationCounts masks;
  for (std::uint32_t state = Pixel::kFirstLayer; state <= Pixel::kSettled; ++state) masks += find_cost<kBits>(state);
  masks += put_cost<kBits>(Pixel::kSettled);
  masks += put_cost<kBits>(Pixel::kEmpty);
  masks.bit += Layers + 2;  // owners' positions joined to the settled ones; without, of what is deferred still
  const OperationCounts numbers = count_operations([](OperationCounts& counts) {
    const Real one(1.0f, counts), units(kAreaUnits);
    count_mask(counts, Words);  // settled
    Real area = to_float(Counted<std::int64_t>(0, counts)) / units, color[3] = {one, one, one};
    for (Real& channel : color) channel = converted(channel) * area;
    area = lesser(area * one, one);  // scaled to what is covered
    for (Real& channel : color) channel = converted(channel / area);
    to_integer(area * units + one);
  });
  OperationCounts all = masks * Words;
  return all += numbers;
}

// Of one pixel behind which there is no pass: all positions settled, those undecided counted, and the scale.
template <std::size_t Words, std::size_t Layers>
OperationCounts finish_cost() {
  using Pixel = OwnerPixel<Words, Layers>;
  OperationCounts masks = find_cost<std::bit_width(Pixel::kSettled)>(Pixel::kEmpty);
  masks.bit += 2;
  OperationCounts all = masks * Words;
  return all += count_operations([](OperationCounts& counts) {
           const Real one(1.0f, counts);
           count_mask(counts, Words), count_mask(counts, Words);  // settled, deferred
           const Real inverse = one / one, rest = one / (one - one);
           select(one + one == one, inverse, lesser(rest, inverse));
         });
}

// Of one pixel: which positions each layer owns.
template <std::size_t Words, std::size_t Layers>
OperationCounts owners_cost() {
  using Pixel = OwnerPixel<Words, Layers>;
  OperationCounts masks;
  for (std::uint32_t state = Pixel::kFirstLayer; state < Pixel::kDeferred; ++state)
    masks += find_cost<std::bit_width(Pixel::kSettled)>(state);
  return masks * Words;
}

}  // namespace

template <std::size_t Words, std::size_t Layers>
std::vector<PixelTriangle> owners(const SetupTriangles& triangles, const std::vector<OwnerPixel<Words, Layers>>& pixels,
                                  const Tile& tile, StageCounters& counters) {
  using Pixel = OwnerPixel<Words, Layers>;
  std::vector<PixelTriangle> pairs;
  std::uint64_t claimed = 0;  // pixels
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::size_t before = pairs.size();
    const auto x = tile.x0 + static_cast<std::int32_t>(i) % tile.width();
    const auto y = tile.y0 + static_cast<std::int32_t>(i) / tile.width();
    for (std::size_t k = 0; k < Layers; ++k)
      if (!pixels[i].positions_in(Pixel::kFirstLayer + static_cast<std::uint32_t>(k)).none())
        pairs.push_back(
            pixel_triangle(triangles, pixels[i].triangle(k), static_cast<std::uint32_t>(pairs.size()), x, y, false));
    claimed += pairs.size() > before;
  }
  counters.ops += owners_cost<Words, Layers>() * claimed;
  counters.ops += pair_bounds_cost() * pairs.size();
  counters.ops += vertex_bounds_cost() * pairs.size();
  counters.bytes_read += claimed * sizeof(Pixel);
  counters.bytes_written += pairs.size() * kPairWithDepthBytes;
  return pairs;
}

template <std::size_t Words, std::size_t Layers>
void settle(const std::vector<Fragment>& fragments, bool last_pass, StageCounters& counters,
            std::vector<OwnerPixel<Words, Layers>>& pixels) {
  const Fragment* fragment = fragments.data();
  const Fragment* const end = fragment + fragments.size();
  std::uint64_t worked_on = 0, unfinished = 0, seen = 0, compared = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Fragment* const begin = fragment;
    while (fragment != end && fragment->pixel == i) ++fragment;
    if (!is_unfinished(pixels[i])) continue;
    const std::size_t owners = settle_pixel(begin, fragment, last_pass, pixels[i]);
    if (begin == fragment) continue;  // what nothing has claimed stays cleared in memory, and is the background
    ++worked_on;
    seen += owners;
    compared += owners * (owners - 1) / 2;  // to sort them
    unfinished += is_unfinished(pixels[i]);
  }
  counters.items_in += fragments.size();
  counters.items_out += unfinished;
  counters.ops += pixel_cost<Words, Layers>() * worked_on;
  counters.ops += finish_cost<Words, Layers>() * (worked_on - unfinished);
  counters.ops += owner_cost(Words) * seen;
  counters.ops.add += compared;
  counters.bytes_read +=
      worked_on * sizeof(OwnerPixel<Words, Layers>) + fragments.size() * streaming_fragment_bytes(Words);
  counters.bytes_written += worked_on * sizeof(OwnerPixel<Words, Layers>);
  counters.lanes_used += fragments.size();
  counters.lanes_issued += fragments.size();
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

#define BEAMPIPE_SETTLE(words, layers)                                                                               \
  template std::vector<PixelTriangle> owners(const SetupTriangles&, const std::vector<OwnerPixel<words, layers>>&,   \
                                             const Tile&, StageCounters&);                                           \
  template void settle(const std::vector<Fragment>&, bool, StageCounters&, std::vector<OwnerPixel<words, layers>>&); \
  template std::vector<PixelColor> settled_colors(const std::vector<OwnerPixel<words, layers>>&);
BEAMPIPE_OWNER_PIXELS(BEAMPIPE_SETTLE)
#undef BEAMPIPE_SETTLE

}  // namespace beampipe
