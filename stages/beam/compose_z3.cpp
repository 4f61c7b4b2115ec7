#include "stages/beam/compose_z3.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "simd/plane_order.h"
#include "stages/cost/plane_cost.h"

namespace beampipe {
namespace {

// A layer as it is worked on.
struct Layer {
  DepthPlane<float> plane;
  glm::vec3 color;
  WideMask positions;

  float count() const { return static_cast<float>(positions.count()); }
};

Z3Layer packed(const Layer& layer) {
  return {layer.plane.z,
          {UpperHalf(layer.plane.dzdu), UpperHalf(layer.plane.dzdv)},
          {HalfBits(layer.color.r), HalfBits(layer.color.g), HalfBits(layer.color.b)}};
}

Layer unpacked(const Z3Layer& layer, const WideMask& positions) {
  return {{layer.z, layer.slopes[0], layer.slopes[1]}, {layer.color[0], layer.color[1], layer.color[2]}, positions};
}

float merge_loss(const Layer& a, const Layer& b, LayerMerge merge) {
  if (merge == LayerMerge::depth) return std::abs(a.plane.z - b.plane.z);
  const glm::vec3 difference = a.color - b.color;
  return glm::dot(difference, difference) * a.count() * b.count() / (a.count() + b.count());
}

Layer merged(const Layer& a, const Layer& b) {
  const float share = a.count() / (a.count() + b.count()), rest = 1 - share;
  return {{share * a.plane.z + rest * b.plane.z, share * a.plane.dzdu + rest * b.plane.dzdu,
           share * a.plane.dzdv + rest * b.plane.dzdv},
          share * a.color + rest * b.color,
          a.positions | b.positions};
}

using Real = Counted<float>;

// Of a layer, from the stored formats, or into them: two slopes and a colour.
OperationCounts format_cost() { return {0, 0, 0, 0, 0, 5}; }

// A fragment's slopes into the stored format and back, as those are that they are compared with; its colour from fp16.
OperationCounts arrival_cost() { return {0, 0, 0, 0, 0, 2 * 2 + 3}; }

// Of a word: each layer's positions and those that the fragment covers; what is lost by either, branch-free.
template <std::size_t Layers, std::size_t Bits>
OperationCounts contest_cost() {
  OperationCounts counts;
  for (std::uint32_t k = 0; k < Layers; ++k) counts += find_cost<Bits>(k + 1);
  // Contested; arriving without (contested without nearer); layer without what is both.
  counts.bit += Layers * (1 + 4 + 3);
  return counts;
}

// Two layers into one: which two lose the least, and their mean.
OperationCounts merge_cost(std::size_t layers, std::size_t words, LayerMerge merge) {
  return count_operations([&](OperationCounts& counts) {
    const Real one(1.0f, counts);
    const std::size_t pairs = layers * (layers - 1) / 2;
    for (std::size_t pair = 0; pair < pairs; ++pair) {
      if (merge == LayerMerge::depth) {
        magnitude(one - one);
      } else {
        const Real difference = one - one;
        (difference * difference + difference * difference + (one - one) * (one - one)) * one* one / (one + one);
      }
      static_cast<void>(one < one);
    }
    const std::size_t counted = merge == LayerMerge::depth ? 2 : layers;
    for (std::size_t w = 0; w < counted * words; ++w) bit_count(Counted<std::uint32_t>(0, counts));
    counts.add += counted * (words - 1);
    const Real share = one / (one + one), rest = one - share;
    for (int value = 0; value < 3 + 3; ++value) share* one + rest* one;  // plane and colour
    counts.bit += words;
  });
}

template <std::size_t Words, std::size_t Layers>
class PixelLayers {
 public:
  PixelLayers(const PositionSet& positions, LayerMerge merge) : patterns_(positions.patterns), merge_(merge) {}

  // Returns whether the fragment took any position.
  bool add(const Fragment& fragment, Z3Pixel<Words, Layers>& pixel) {
    std::array<Layer, Layers + 1> layers;
    std::size_t used = 0;
    auto owners = pixel.owners;  // a pixel is packed: its words need not be where words should
    Layer arriving = unpacked(packed({fragment.plane, fragment.color / fragment.alpha, {}}), fragment.mask);
    for (std::uint32_t k = 0; k < Layers; ++k) {
      Layer layer = unpacked(pixel.layers[k], owners.positions_in(k + 1));
      const WideMask contested = layer.positions & fragment.mask;
      if (!contested.none()) {
        WideMask nearer;
        nearer_positions(arriving.plane, layer.plane, patterns_.data(), Words, nearer.words.data());
        ++planes_compared;
        arriving.positions = without(arriving.positions, without(contested, nearer));
        layer.positions = without(layer.positions, contested & nearer);
      }
      if (!layer.positions.none()) layers[used++] = layer;
    }
    if (arriving.positions.none()) return false;
    layers[used++] = arriving;
    if (used > Layers) merge_two(layers), --used;
    for (std::uint32_t k = 0; k < used; ++k) {
      pixel.layers[k] = packed(layers[k]);
      owners.put(layers[k].positions, k + 1);
    }
    pixel.owners = owners;
    return true;
  }

  std::uint64_t planes_compared = 0, merges = 0;

 private:
  void merge_two(std::array<Layer, Layers + 1>& layers) {
    ++merges;
    std::size_t first = 0, second = 1;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < layers.size(); ++i)
      for (std::size_t j = i + 1; j < layers.size(); ++j)
        if (const float loss = merge_loss(layers[i], layers[j], merge_); loss < least) {
          least = loss;
          first = i, second = j;
        }
    layers[first] = merged(layers[first], layers[second]);
    std::swap(layers[second], layers.back());
  }

  const std::vector<SamplePattern>& patterns_;
  LayerMerge merge_;
};

}  // namespace

template <std::size_t Words, std::size_t Layers>
void compose_z3(const std::vector<Fragment>& fragments, const PositionSet& positions, LayerMerge merge,
                StageCounters& counters, std::vector<Z3Pixel<Words, Layers>>& pixels, std::vector<float>& merges) {
  PixelLayers<Words, Layers> layers(positions, merge);
  std::uint64_t taken = 0;
  for (const Fragment& fragment : fragments) {
    const std::uint64_t before = layers.merges;
    taken += layers.add(fragment, pixels[fragment.pixel]);
    merges[fragment.pixel] += static_cast<float>(layers.merges - before);
  }
  constexpr std::uint64_t kFragmentBytes = 4 + 4 * Words + 12 + 6;  // pixel, mask, depth plane, colour
  counters.items_in += fragments.size();
  counters.items_out += taken;
  constexpr std::size_t kBits = std::bit_width(Layers);
  counters.ops += arrival_cost() * fragments.size();
  counters.ops += format_cost() * ((fragments.size() + taken) * Layers);
  counters.ops += contest_cost<Layers, kBits>() * (Words * fragments.size());
  counters.ops += nearer_cost() * (32 * Words * layers.planes_compared);
  counters.ops += merge_cost(Layers + 1, Words, merge) * layers.merges;
  for (std::uint32_t k = 0; k < Layers; ++k) counters.ops += put_cost<kBits>(k + 1) * (Words * taken);
  counters.bytes_read += fragments.size() * (kFragmentBytes + sizeof(Z3Pixel<Words, Layers>));
  counters.bytes_written += taken * sizeof(Z3Pixel<Words, Layers>);
  counters.lanes_used += taken;
  counters.lanes_issued += fragments.size();
}

template <std::size_t Words, std::size_t Layers>
std::vector<PixelColor> z3_colors(const std::vector<Z3Pixel<Words, Layers>>& pixels) {
  std::vector<PixelColor> colors;
  for (const Z3Pixel<Words, Layers>& pixel : pixels) {
    PixelColor sum{0, glm::vec3(0.0f)};
    const auto owners = pixel.owners;
    for (std::uint32_t k = 0; k < Layers; ++k) {
      const Layer layer = unpacked(pixel.layers[k], owners.positions_in(k + 1));
      const float share = layer.count() / (32 * Words);
      sum.alpha += share;
      sum.color += share * layer.color;
    }
    colors.push_back(sum);
  }
  return colors;
}

#define BEAMPIPE_Z3(words, layers)                                                                       \
  template void compose_z3(const std::vector<Fragment>&, const PositionSet&, LayerMerge, StageCounters&, \
                           std::vector<Z3Pixel<words, layers>>&, std::vector<float>&);                   \
  template std::vector<PixelColor> z3_colors(const std::vector<Z3Pixel<words, layers>>&);
BEAMPIPE_Z3_PIXELS(BEAMPIPE_Z3)
#undef BEAMPIPE_Z3

}  // namespace beampipe
