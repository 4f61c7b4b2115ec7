#include "stages/claim.h"

#include <algorithm>

#include "simd/plane_order.h"
#include "stages/plane_cost.h"

namespace beampipe {
namespace {

struct ClaimCounts {
  std::uint64_t claims = 0, planes_compared = 0, nearest_found = 0;
};

template <std::size_t Words, std::size_t Layers>
class PixelClaim {
 public:
  using Pixel = OwnerPixel<Words, Layers>;

  PixelClaim(const SetupTriangles& triangles, const Tile& tile, const PositionSet& positions)
      : triangles_(triangles), tile_(tile), positions_(positions) {}

  void add(const Fragment& fragment, Pixel& pixel) {
    if (fragment.mask.none()) {
      if (shows(fragment, pixel)) pixel.owner[0] |= Pixel::kSpeck;
      return;
    }
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
    pixel.put(claimed, layer_state(free));
    pixel.set_triangle(free, fragment.triangle);
  }

  ClaimCounts counts;

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

  DepthPlane<float> owner_plane(std::size_t layer, const Fragment& fragment, const Pixel& pixel) const {
    const auto index = static_cast<std::int32_t>(fragment.pixel);
    return pixel_plane(triangles_.triangles[pixel.triangle(layer)], tile_.x0 + index % tile_.width(),
                       tile_.y0 + index / tile_.width());
  }

  // Drops the farthest of the owners and the fragment that has claimed positions. Returns the layer that is free then,
  // or Layers when it was the fragment.
  std::size_t make_room(const Fragment& fragment, const WideMask& claimed, Pixel& pixel) {
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
    pixel.put(dropped, Pixel::kDeferred);
    pixel.dropped = std::min(pixel.dropped, depth);
    return farthest;
  }

  // May a fragment that covers no position be seen beside the three positions that are nearest to it?
  bool shows(const Fragment& fragment, const Pixel& pixel) const {
    const auto& nearest = positions_.nearest_to(fragment.centroid_u, fragment.centroid_v);
    return std::any_of(nearest.begin(), nearest.end(), [&](std::uint8_t position) {
      const std::uint32_t state = pixel.states.at(position);
      if (state == Pixel::kEmpty || state == Pixel::kDeferred) return true;
      if (state == Pixel::kSettled) return false;
      const DepthPlane<float> owner = owner_plane(state - Pixel::kFirstLayer, fragment, pixel);
      return fragment.centroid_z <= depth_at(owner, fragment.centroid_u - 0.5f, fragment.centroid_v - 0.5f);
    });
  }

  const SetupTriangles& triangles_;
  const Tile& tile_;
  const PositionSet& positions_;
};

OperationCounts nearest_cost() {  // per position
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    nearest_scalar({one, one, one}, one, one, true, one);
  });
}

// What every fragment does to the states: three masks in and out, by words of 32 positions.
template <std::size_t Words, std::size_t Layers>
OperationCounts state_cost() {
  constexpr std::size_t kStateBits = std::bit_width(OwnerPixel<Words, Layers>::kSettled);
  return count_operations([](OperationCounts& counts) {
    const Counted<std::uint32_t> ones(~0u, counts);
    for (std::size_t w = 0; w < Words; ++w) {
      for (std::size_t state = 0; state < Layers + 2; ++state) {  // empty, deferred, every layer; with the fragment's
        Counted<std::uint32_t> mask = ones;
        for (std::size_t b = 0; b < kStateBits; ++b) mask = mask & ones;
      }
      for (std::size_t b = 0; b < kStateBits; ++b) ones | ones;  // put
    }
  });
}

}  // namespace

template <std::size_t Words, std::size_t Layers>
void claim(const SetupTriangles& triangles, const std::vector<Fragment>& fragments, const Tile& tile,
           const PositionSet& positions, StageCounters& counters, std::vector<OwnerPixel<Words, Layers>>& pixels) {
  PixelClaim<Words, Layers> claims(triangles, tile, positions);
  for (const Fragment& fragment : fragments) claims.add(fragment, pixels[fragment.pixel]);

  constexpr std::uint64_t kPositions = 32 * Words, kPlaneBytes = 3 * sizeof(float);
  const ClaimCounts& done = claims.counts;
  counters.items_in += fragments.size();
  counters.items_out += done.claims;
  counters.ops += state_cost<Words, Layers>() * fragments.size();
  counters.ops += nearer_cost() * (kPositions * done.planes_compared);
  counters.ops += nearest_cost() * (kPositions * done.nearest_found);
  counters.bytes_read += fragments.size() * (streaming_fragment_bytes(Words) + sizeof(OwnerPixel<Words, Layers>)) +
                         (done.planes_compared + done.nearest_found) * kPlaneBytes;
  counters.bytes_written += done.claims * sizeof(OwnerPixel<Words, Layers>);
  counters.lanes_used += done.claims;
  counters.lanes_issued += fragments.size();
}

#define BEAMPIPE_CLAIM(words, layers)                                                                  \
  template void claim<words, layers>(const SetupTriangles&, const std::vector<Fragment>&, const Tile&, \
                                     const PositionSet&, StageCounters&, std::vector<OwnerPixel<words, layers>>&);
BEAMPIPE_OWNER_PIXELS(BEAMPIPE_CLAIM)
#undef BEAMPIPE_CLAIM

}  // namespace beampipe
