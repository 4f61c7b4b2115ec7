#include "stages/beam/compose_z3.h"

#include <algorithm>
#include <array>
#include <limits>

#include "simd/plane_order.h"
#include "stages/beam/compose_z3_cost.h"

namespace beampipe {
namespace {

// A layer, and the positions that it owns. It stays in its format until it is merged.
struct Layer {
  Z3Layer surface;
  WideMask positions;

  DepthPlane<float> plane() const { return {surface.z, surface.slopes[0], surface.slopes[1]}; }
  glm::vec3 color() const { return {surface.color[0], surface.color[1], surface.color[2]}; }
  float count() const { return static_cast<float>(positions.count()); }
};

Z3Layer packed(const DepthPlane<float>& plane, const glm::vec3& color) {
  return {plane.z,
          {UpperHalf(plane.dzdu), UpperHalf(plane.dzdv)},
          {HalfBits(color.r), HalfBits(color.g), HalfBits(color.b)}};
}

Layer merged(const Layer& a, const Layer& b) {
  const float share = a.count() / (a.count() + b.count()), rest = 1 - share;
  const DepthPlane<float> one = a.plane(), other = b.plane();
  return {packed({share * one.z + rest * other.z, share * one.dzdu + rest * other.dzdu,
                  share * one.dzdv + rest * other.dzdv},
                 share * a.color() + rest * b.color()),
          a.positions | b.positions};
}

template <std::size_t Words>
class PixelLayers {
 public:
  explicit PixelLayers(const PositionSet& positions) : offsets_(positions.offsets) {}

  // `observer` may be null.
  void add(const Fragment& fragment, Z3Pixel<Words>& pixel, PixelObserver* observer) {
    std::array<Layer, kZ3Layers + 1> layers;
    std::size_t used = 0;
    auto owners = pixel.owners;  // a copy, because the words of a packed pixel may not be aligned
    Layer arriving{packed(fragment.plane, fragment.color / fragment.alpha), fragment.mask};
    for (std::uint32_t k = 0; k < kZ3Layers; ++k) {
      Layer layer{pixel.layers[k], owners.positions_in(k + 1)};
      const WideMask contested = layer.positions & fragment.mask;
      if (!contested.none()) {
        WideMask nearer;
        nearer_positions(arriving.plane(), layer.plane(), offsets_.data(), Words, nearer.words.data());
        ++work.planes_compared;
        arriving.positions = without(arriving.positions, without(contested, nearer));
        layer.positions = without(layer.positions, contested & nearer);
      }
      if (!layer.positions.none()) layers[used++] = layer;
    }
    if (observer) observer->arrives(fragment, arriving.positions);
    if (arriving.positions.none()) return;
    ++work.taken;
    layers[used++] = arriving;
    if (used > kZ3Layers) merge_two(layers, observer), --used;
    for (std::uint32_t k = 0; k < used; ++k) {
      pixel.layers[k] = layers[k].surface;
      owners.put(layers[k].positions, k + 1);
    }
    pixel.owners = owners;
  }

  Z3Work work;

 private:
  void merge_two(std::array<Layer, kZ3Layers + 1>& layers, PixelObserver* observer) {
    ++work.merges;
    std::size_t first = 0, second = 1;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < layers.size(); ++i)
      for (std::size_t j = i + 1; j < layers.size(); ++j)
        if (const float distance = std::abs(layers[i].surface.z - layers[j].surface.z); distance < least) {
          least = distance;
          first = i, second = j;
        }
    const Layer &one = layers[first], &other = layers[second];
    if (observer) {
      const double share = double{one.count()} / (one.count() + other.count());
      observer->merges({one.positions, one.color(), share}, {other.positions, other.color(), 1 - share});
    }
    layers[first] = merged(one, other);
    std::swap(layers[second], layers.back());
  }

  const std::vector<PositionOffsets>& offsets_;
};

}  // namespace

template <std::size_t Words>
void compose_z3(const std::vector<Fragment>& fragments, const PositionSet& positions, StageCounters& counters,
                std::vector<Z3Pixel<Words>>& pixels, std::vector<float>& merges, const PixelObservers* observers) {
  PixelLayers<Words> layers(positions);
  for (const Fragment& fragment : fragments) {
    const std::uint64_t before = layers.work.merges;
    layers.add(fragment, pixels[fragment.pixel], observer_at(observers, fragment.pixel));
    merges[fragment.pixel] += static_cast<float>(layers.work.merges - before);
  }
  layers.work.fragments = fragments.size();
  charge<Words>(layers.work, counters);
}

template <std::size_t Words>
std::vector<PixelColor> z3_colors(const std::vector<Z3Pixel<Words>>& pixels, const PixelObservers* observers) {
  std::vector<PixelColor> colors;
  for (const Z3Pixel<Words>& pixel : pixels) {
    PixelColor sum{0, glm::vec3(0.0f)};
    const auto owners = pixel.owners;
    PixelObserver* const observer = observer_at(observers, colors.size());
    if (observer) observer->arrivals_end();
    for (std::uint32_t k = 0; k < kZ3Layers; ++k) {
      const Layer layer{pixel.layers[k], owners.positions_in(k + 1)};
      const float share = layer.count() / (32 * Words);
      sum.alpha += share;
      sum.color += share * layer.color();
      if (observer && share > 0) observer->settles(layer.positions, layer.color(), share, share);
    }
    if (observer) observer->finishes();
    colors.push_back(sum);
  }
  return colors;
}

#define BEAMPIPE_Z3(words)                                                                            \
  template void compose_z3(const std::vector<Fragment>&, const PositionSet&, StageCounters&,          \
                           std::vector<Z3Pixel<words>>&, std::vector<float>&, const PixelObservers*); \
  template std::vector<PixelColor> z3_colors(const std::vector<Z3Pixel<words>>&, const PixelObservers*);
BEAMPIPE_Z3(1)
BEAMPIPE_Z3(4)
#undef BEAMPIPE_Z3

}  // namespace beampipe
