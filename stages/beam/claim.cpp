#include "stages/beam/claim.h"

#include <algorithm>
#include <array>

#include "simd/plane_order.h"
#include "stages/cost/plane_cost.h"

namespace beampipe {
namespace {

template <std::size_t States>
struct ClaimCounts {
  std::uint64_t masks = 0;  // fragments that cover a position
  std::uint64_t claims = 0, rooms_made = 0, planes_made = 0, planes_compared = 0, nearest_found = 0;
  std::uint64_t specks_looked_up = 0, specks_compared = 0;  // positions beside fragments that cover none
  std::array<std::uint64_t, States> put{};                  // by state
};

template <std::size_t Words, std::size_t Layers>
class PixelClaim {
 public:
  using Pixel = OwnerPixel<Words, Layers>;

  PixelClaim(const SetupTriangles& triangles, const Tile& tile, const PositionSet& positions,
             std::vector<std::uint32_t>* remade)
      : triangles_(triangles), tile_(tile), positions_(positions), remade_(remade) {}

  void add(const Fragment& fragment, Pixel& pixel) {
    if (fragment.mask.none()) {
      if (shows(fragment, pixel)) pixel.owner[0] |= Pixel::kSpeck;
      return;
    }
    ++counts.masks;
    WideMask claimed = fragment.mask & pixel.positions_in(Pixel::kEmpty);
    const WideMask deferred = fragment.mask & pixel.positions_in(Pixel::kDeferred);
    if (fragment.z_min < pixel.dropped && !deferred.none())
      claimed = claimed | (nearer(fragment.plane, {pixel.dropped, 0, 0}) & deferred);
    std::size_t free = Layers;
    for (std::size_t k = 0; k < Layers; ++k) {
      const WideMask owned = pixel.positions_in(layer_state(k)), contested = owned & fragment.mask;
      WideMask won;
      if (!contested.none()) won = nearer(fragment.plane, owner_plane(k, fragment, pixel)) & contested;
      if (won == owned) free = k;  // empty, now or before
      claimed = claimed | won;
    }
    if (claimed.none()) return;
    ++counts.claims;
    if (free == Layers) free = make_room(fragment, claimed, pixel);
    if (free == Layers) return;  // the fragment itself was dropped
    put(claimed, layer_state(free), pixel);
    pixel.set_triangle(free, fragment.triangle);
  }

  ClaimCounts<Pixel::kSettled + 1> counts;

 private:
  static std::uint32_t layer_state(std::size_t layer) { return Pixel::kFirstLayer + static_cast<std::uint32_t>(layer); }

  WideMask nearer(const DepthPlane<float>& plane, const DepthPlane<float>& other) {
    ++counts.planes_compared;
    WideMask mask;
    nearer_positions(plane, other, positions_.patterns.data(), Words, mask.words.data());
    return mask;
  }

  float nearest(const DepthPlane<float>& plane, const WideMask& mask) {
    ++counts.nearest_found;
    return nearest_depth(plane, positions_.patterns.data(), Words, mask.words.data());
  }

  void put(const WideMask& mask, std::uint32_t state, Pixel& pixel) {
    ++counts.put[state];
    pixel.put(mask, state);
  }

  DepthPlane<float> owner_plane(std::size_t layer, const Fragment& fragment, const Pixel& pixel) {
    ++counts.planes_made;
    if (remade_) remade_->push_back(pixel.triangle(layer));
    const auto index = static_cast<std::int32_t>(fragment.pixel);
    return pixel_plane(triangles_.triangles[pixel.triangle(layer)], tile_.x0 + index % tile_.width(),
                       tile_.y0 + index / tile_.width());
  }

  // Drops the farthest of the owners and the fragment that has claimed positions. Returns the layer that is free then,
  // or Layers when it was the fragment.
  std::size_t make_room(const Fragment& fragment, const WideMask& claimed, Pixel& pixel) {
    ++counts.rooms_made;
    std::size_t farthest = Layers;
    float depth = nearest(fragment.plane, claimed);
    WideMask dropped = claimed;
    for (std::size_t k = 0; k < Layers; ++k) {
      const WideMask owned = without(pixel.positions_in(layer_state(k)), claimed);
      const float layer_depth = nearest(owner_plane(k, fragment, pixel), owned);
      if (layer_depth <= depth) continue;
      farthest = k;
      depth = layer_depth;
      dropped = owned;
    }
    put(dropped, Pixel::kDeferred, pixel);
    pixel.dropped = std::min(pixel.dropped, depth);
    return farthest;
  }

  // May a fragment that covers no position be seen beside the three positions that are nearest to it?
  bool shows(const Fragment& fragment, const Pixel& pixel) {
    const auto& nearest = positions_.nearest_to(fragment.centroid_u, fragment.centroid_v);
    return std::any_of(nearest.begin(), nearest.end(), [&](std::uint8_t position) {
      ++counts.specks_looked_up;
      const std::uint32_t state = pixel.states.at(position);
      if (state == Pixel::kEmpty || state == Pixel::kDeferred) return true;
      if (state == Pixel::kSettled) return false;
      ++counts.specks_compared;
      const DepthPlane<float> owner = owner_plane(state - Pixel::kFirstLayer, fragment, pixel);
      return fragment.centroid_z <= depth_at(owner, fragment.centroid_u - 0.5f, fragment.centroid_v - 0.5f);
    });
  }

  const SetupTriangles& triangles_;
  const Tile& tile_;
  const PositionSet& positions_;
  std::vector<std::uint32_t>* const remade_;
};

OperationCounts nearest_cost() {  // per position
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    nearest_formula({one, one, one}, one, one, true, one);
  });
}

template <class Pixel>
constexpr std::size_t kStateBits = std::bit_width(Pixel::kSettled);

// Of a word of a fragment's mask: what is empty, deferred and owned by each layer; what of each it covers; all but the
// empty ones again with what is nearer, and into what is claimed.
template <std::size_t Layers, class Pixel>
OperationCounts contest_cost() {
  OperationCounts counts = find_cost<kStateBits<Pixel>>(Pixel::kEmpty);
  for (std::uint32_t state = Pixel::kFirstLayer; state <= Pixel::kDeferred; ++state)
    counts += find_cost<kStateBits<Pixel>>(state);
  counts.bit += (Layers + 2) + 2 * (Layers + 1);
  return counts;
}

// Of a word, when the farthest owner is looked for: each layer's positions without what is claimed.
template <std::size_t Layers, class Pixel>
OperationCounts room_cost() {
  OperationCounts counts;
  for (std::uint32_t state = Pixel::kFirstLayer; state < Pixel::kDeferred; ++state)
    counts += find_cost<kStateBits<Pixel>>(state);
  counts.bit += 2 * Layers;
  return counts;
}

// Of a position beside a fragment that covers none: which it is and its state; and, where it has an owner, whether that
// is nearer at the fragment's centroid.
OperationCounts speck_state_cost(std::size_t bits) { return {0, 1, 2 * bits, 1, 0, 0}; }
OperationCounts speck_depth_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), half(0.5f);
    static_cast<void>(one <= depth_at(DepthPlane<Counted<float>>{one, one, one}, one - half, one - half));
  });
}

}  // namespace

template <std::size_t Words, std::size_t Layers>
void claim(const SetupTriangles& triangles, const std::vector<Fragment>& fragments, const Tile& tile,
           const PositionSet& positions, StageCounters& counters, std::vector<OwnerPixel<Words, Layers>>& pixels,
           std::vector<std::uint32_t>* remade) {
  PixelClaim<Words, Layers> claims(triangles, tile, positions, remade);
  for (const Fragment& fragment : fragments) claims.add(fragment, pixels[fragment.pixel]);

  constexpr std::uint64_t kPositions = 32 * Words;
  using Pixel = OwnerPixel<Words, Layers>;
  const auto& done = claims.counts;
  counters.items_in += fragments.size();
  counters.items_out += done.claims;
  counters.ops += contest_cost<Layers, Pixel>() * (Words * done.masks);
  counters.ops += nearer_cost() * (kPositions * done.planes_compared);
  counters.ops += room_cost<Layers, Pixel>() * (Words * done.rooms_made);
  counters.ops += nearest_cost() * (kPositions * done.nearest_found);
  counters.ops.add += done.rooms_made * (Layers + 1);  // which is the farthest; what the pixel has dropped
  counters.ops += plane_cost() * done.planes_made;
  for (std::uint32_t state = 0; state < done.put.size(); ++state)
    counters.ops += put_cost<kStateBits<Pixel>>(state) * (Words * done.put[state]);
  counters.ops += speck_state_cost(kStateBits<Pixel>) * done.specks_looked_up;
  counters.ops += speck_depth_cost() * done.specks_compared;
  counters.bytes_read +=
      fragments.size() * (streaming_fragment_bytes(Words) + sizeof(Pixel)) + done.planes_made * sizeof(ScreenDepth);
  counters.bytes_written += done.claims * sizeof(Pixel);
  counters.lanes_used += done.claims;
  counters.lanes_issued += fragments.size();
}

#define BEAMPIPE_CLAIM(words, layers)                                                                             \
  template void claim<words, layers>(const SetupTriangles&, const std::vector<Fragment>&, const Tile&,            \
                                     const PositionSet&, StageCounters&, std::vector<OwnerPixel<words, layers>>&, \
                                     std::vector<std::uint32_t>*);
BEAMPIPE_OWNER_PIXELS(BEAMPIPE_CLAIM)
#undef BEAMPIPE_CLAIM

}  // namespace beampipe
