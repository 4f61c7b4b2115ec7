#include "stages/beam/claim.h"

#include <algorithm>
#include <array>

#include "simd/plane_order.h"
#include "stages/beam/claim_cost.h"

namespace beampipe {
namespace {

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
    ++work.masks;
    WideMask claimed = fragment.mask & pixel.positions_in(Pixel::kEmpty);
    const WideMask deferred = fragment.mask & pixel.positions_in(Pixel::kDeferred);
    if (fragment.z_min < pixel.dropped && !deferred.none())
      claimed = claimed | (nearer(fragment.plane, {pixel.dropped, 0, 0}) & deferred);
    std::size_t free = Layers;
    for (std::size_t k = 0; k < Layers; ++k) {
      const WideMask owned = pixel.positions_in(layer_state(k)), contested = owned & fragment.mask;
      WideMask won;
      if (!contested.none()) won = nearer(fragment.plane, owner_plane(k, fragment, pixel)) & contested;
      if (won == owned) free = k;  // the layer is empty, or it was emptied just now
      claimed = claimed | won;
    }
    if (claimed.none()) return;
    ++work.claims;
    if (free == Layers) free = make_room(fragment, claimed, pixel);
    if (free == Layers) return;  // the fragment itself was dropped
    put(claimed, layer_state(free), pixel);
    pixel.set_triangle(free, fragment.triangle);
  }

  ClaimWork<Pixel::kSettled + 1> work;

 private:
  static std::uint32_t layer_state(std::size_t layer) { return Pixel::kFirstLayer + static_cast<std::uint32_t>(layer); }

  WideMask nearer(const DepthPlane<float>& plane, const DepthPlane<float>& other) {
    ++work.planes_compared;
    WideMask mask;
    nearer_positions(plane, other, positions_.patterns.data(), Words, mask.words.data());
    return mask;
  }

  float nearest(const DepthPlane<float>& plane, const WideMask& mask) {
    ++work.nearest_found;
    return nearest_depth(plane, positions_.patterns.data(), Words, mask.words.data());
  }

  void put(const WideMask& mask, std::uint32_t state, Pixel& pixel) {
    ++work.put[state];
    pixel.put(mask, state);
  }

  DepthPlane<float> owner_plane(std::size_t layer, const Fragment& fragment, const Pixel& pixel) {
    ++work.planes_made;
    if (remade_) remade_->push_back(pixel.triangle(layer));
    const auto index = static_cast<std::int32_t>(fragment.pixel);
    return pixel_plane(triangles_.triangles[pixel.triangle(layer)], tile_.x0 + index % tile_.width(),
                       tile_.y0 + index / tile_.width());
  }

  // Drops the farthest of the owners and of the fragment, which has claimed positions. Returns the layer that became
  // free, or Layers if it was the fragment that was dropped.
  std::size_t make_room(const Fragment& fragment, const WideMask& claimed, Pixel& pixel) {
    ++work.rooms_made;
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

  // May the speck be visible next to any of the three positions that are nearest to it?
  bool shows(const Fragment& fragment, const Pixel& pixel) {
    const auto& nearest = positions_.nearest_to(fragment.centroid_u, fragment.centroid_v);
    return std::any_of(nearest.begin(), nearest.end(), [&](std::uint8_t position) {
      ++work.specks_looked_up;
      const std::uint32_t state = pixel.states.at(position);
      if (state == Pixel::kEmpty || state == Pixel::kDeferred) return true;
      if (state == Pixel::kSettled) return false;
      ++work.specks_compared;
      const DepthPlane<float> owner = owner_plane(state - Pixel::kFirstLayer, fragment, pixel);
      return fragment.centroid_z <= depth_at(owner, fragment.centroid_u - 0.5f, fragment.centroid_v - 0.5f);
    });
  }

  const SetupTriangles& triangles_;
  const Tile& tile_;
  const PositionSet& positions_;
  std::vector<std::uint32_t>* const remade_;
};

}  // namespace

template <std::size_t Words, std::size_t Layers>
void claim(const SetupTriangles& triangles, const std::vector<Fragment>& fragments, const Tile& tile,
           const PositionSet& positions, StageCounters& counters, std::vector<OwnerPixel<Words, Layers>>& pixels,
           std::vector<std::uint32_t>* remade) {
  PixelClaim<Words, Layers> claims(triangles, tile, positions, remade);
  for (const Fragment& fragment : fragments) claims.add(fragment, pixels[fragment.pixel]);
  claims.work.fragments = fragments.size();
  charge<Words, Layers>(claims.work, counters);
}

#define BEAMPIPE_CLAIM(words, layers)                                                                             \
  template void claim<words, layers>(const SetupTriangles&, const std::vector<Fragment>&, const Tile&,            \
                                     const PositionSet&, StageCounters&, std::vector<OwnerPixel<words, layers>>&, \
                                     std::vector<std::uint32_t>*);
BEAMPIPE_OWNER_PIXELS(BEAMPIPE_CLAIM)
#undef BEAMPIPE_CLAIM

}  // namespace beampipe
