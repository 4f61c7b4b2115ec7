// The stages count the same for whole batches as their scalar twins count item by item, on numbers that count and with
// the real data of every procedural scene.
#include <gtest/gtest.h>

#include "simd/depth_compare.h"
#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/claim.h"
#include "stages/beam/merge_sort.h"
#include "stages/beam/settle.h"
#include "stages/data/fragment_geometry.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/raster/conservative_raster.h"
#include "stages/raster/sample_raster.h"
#include "stages/samples/accumulate.h"
#include "stages/samples/test_depth.h"
#include "tests/stages/counted_states.h"
#include "tests/stages/scene_twins.h"

namespace beampipe {
namespace {

class TwinCounts : public SceneTwins {
 protected:
  template <std::size_t Words, std::size_t Layers>
  void expect_equal_claims();
};

TEST_P(TwinCounts, Sort) {
  StageCounters raster, ignored, sorting;
  std::vector<Pair> pairs;
  conservative_raster(triangles_, list_, tile_, raster, pairs);
  std::vector<Fragment> fragments;
  BeamFragmentOptions options;
  options.mask = MaskSource::exact;
  options.positions = {hammersley_pattern()};
  beam_fragment(triangles_, pairs, tile_, options, ignored, fragments);
  const ABuffer buffer = a_buffer(sort_records(fragments, SortKey::centroid), tile_.pixels(), 42, 42, sorting);

  std::vector<std::vector<std::uint32_t>> arrived(tile_.pixels());
  for (std::uint32_t i = 0; i < fragments.size(); ++i) arrived[fragments[i].pixel].push_back(i);
  std::vector<std::uint32_t> scratch;
  for (std::size_t pixel = 0; pixel < tile_.pixels(); ++pixel) {
    merge_sort(arrived[pixel].data(), arrived[pixel].size(), scratch,
               [&](std::uint32_t i) { return real(fragments[i].centroid_z); });
    ASSERT_TRUE(std::equal(arrived[pixel].begin(), arrived[pixel].end(), buffer.records.begin() + buffer.first[pixel]));
  }
  EXPECT_EQ(sorting.ops, twin_);
}

TEST_P(TwinCounts, DepthTest) {
  const Sampling sampling{CellGrid{}, standard_pattern(8)};
  StageCounters raster, counters;
  std::vector<SampleFragment> fragments;
  std::vector<SampleAccess> accesses;
  sample_raster({triangles_, tile_, sampling}, list_, raster, fragments);
  SampleTile surface(tile_, sampling), stored(tile_, sampling);
  depth_test({triangles_, tile_, sampling}, fragments, counters, surface, accesses);
  for (const SampleFragment& fragment : fragments) {
    const ScreenDepth& plane = triangles_.triangles[fragment.triangle].depth;
    const ScreenDepthOf<Real> counted = {real(plane.z), real(plane.dzdx), real(plane.dzdy), real(plane.anchor_x),
                                         real(plane.anchor_y)};
    const auto in_cell =
        cell_plane(counted, real(static_cast<double>(fragment.x)), real(static_cast<double>(fragment.y)));
    const auto first = static_cast<std::size_t>(fragment.y * tile_.width() + fragment.x) * 8;
    for (std::size_t s = 0; s < 8; ++s) {
      if (!(fragment.mask >> s & 1)) continue;
      Float depth;
      const bool passes =
          depth_test_scalar(in_cell, real(static_cast<float>(sampling.pattern.x[s])),
                            real(static_cast<float>(sampling.pattern.y[s])), real(stored.depth[first + s]), depth);
      if (passes) stored.depth[first + s] = depth.value;
    }
  }
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(surface.depth, stored.depth);
  EXPECT_EQ(counters.lanes_used, counters.items_in);
  EXPECT_EQ(counters.lanes_issued, fragments.size() * 8);
}

// Claims word by word and position by position, on numbers that count.
template <std::size_t Words, std::size_t Layers>
class ClaimTwin {
 public:
  using Pixel = OwnerPixel<Words, Layers>;
  static constexpr std::size_t kBits = std::bit_width(Pixel::kSettled);
  using Mask = std::array<Bits, Words>;

  ClaimTwin(const SetupTriangles& triangles, const Tile& tile, const PositionSet& positions, OperationCounts& counts)
      : triangles_(triangles), tile_(tile), positions_(positions), counts_(counts) {}

  void add(const Fragment& fragment, Pixel& pixel) {
    if (fragment.mask.none()) {
      if (shows(fragment, pixel)) pixel.owner[0] |= Pixel::kSpeck;
      return;
    }
    Mask covered;
    for (std::size_t w = 0; w < Words; ++w) covered[w] = bits(fragment.mask.words[w]);
    Mask claimed = both(find(Pixel::kEmpty, pixel), covered);
    const Mask deferred = both(find(Pixel::kDeferred, pixel), covered);
    const bool may = fragment.z_min < pixel.dropped && any(deferred);
    claimed = either(claimed,
                     both(may ? nearer(plane(fragment), {real(pixel.dropped), real(0), real(0)}) : none(), deferred));
    std::size_t free = Layers;
    for (std::uint32_t k = 0; k < Layers; ++k) {
      const Mask owned = find(Pixel::kFirstLayer + k, pixel), contested = both(owned, covered);
      const Mask won = both(any(contested) ? nearer(plane(fragment), owner(k, fragment, pixel)) : none(), contested);
      if (same(won, owned)) free = k;
      claimed = either(claimed, won);
    }
    if (!any(claimed)) return;
    if (free == Layers) free = make_room(fragment, claimed, pixel);
    if (free == Layers) return;
    put(claimed, Pixel::kFirstLayer + static_cast<std::uint32_t>(free), pixel);
    pixel.set_triangle(free, fragment.triangle);
  }

 private:
  using Plane = DepthPlane<Float>;
  Bits bits(std::uint32_t word) { return Bits(word, counts_); }
  Float real(float value) { return Float(value, counts_); }
  Real real64(double value) { return Real(value, counts_); }
  Plane plane(const Fragment& fragment) {
    return {real(fragment.plane.z), real(fragment.plane.dzdu), real(fragment.plane.dzdv)};
  }
  Plane owner(std::uint32_t k, const Fragment& fragment, const Pixel& pixel) {
    const ScreenDepth& depth = triangles_.triangles[pixel.triangle(k)].depth;
    const auto at = static_cast<std::int32_t>(fragment.pixel);
    const ScreenDepthOf<Real> counted = {real64(depth.z), real64(depth.dzdx), real64(depth.dzdy),
                                         real64(depth.anchor_x), real64(depth.anchor_y)};
    const Real z = counted.at(real64(tile_.x0 + at % tile_.width() + 0.5), real64(tile_.y0 + at / tile_.width() + 0.5));
    return {to_float(z), to_float(real64(depth.dzdx)), to_float(real64(depth.dzdy))};
  }

  Mask none() {
    Mask mask;
    mask.fill(bits(0));
    return mask;
  }
  static bool any(const Mask& mask) {
    return std::any_of(mask.begin(), mask.end(), [](const Bits& word) { return word.value != 0; });
  }
  static bool same(const Mask& a, const Mask& b) {
    return std::equal(a.begin(), a.end(), b.begin(), [](const Bits& x, const Bits& y) { return x.value == y.value; });
  }
  static Mask both(Mask a, const Mask& b) {
    for (std::size_t w = 0; w < Words; ++w) a[w] = a[w] & b[w];
    return a;
  }

  Mask find(std::uint32_t state, const Pixel& pixel) { return find_counted(pixel, state, counts_); }
  void put(const Mask& mask, std::uint32_t state, Pixel& pixel) { put_counted(mask, state, pixel, counts_); }

  template <class Body>
  void each_position(Body&& body) {
    for (std::size_t w = 0; w < Words; ++w)
      for (std::size_t s = 0; s < 32; ++s)
        body(w, s, real(position_u(positions_.patterns[w], s)), real(position_v(positions_.patterns[w], s)));
  }
  Mask nearer(const Plane& a, const Plane& b) {
    Mask mask = none();
    each_position([&](std::size_t w, std::size_t s, const Float& u, const Float& v) {
      mask[w].value |= std::uint32_t{nearer_formula(a, b, u, v)} << s;
    });
    return mask;
  }
  Float nearest(const Plane& of, const Mask& mask) {
    Float depth = real(kNoDepth);
    each_position([&](std::size_t w, std::size_t s, const Float& u, const Float& v) {
      depth = nearest_formula(of, u, v, mask[w].value >> s & 1, depth);
    });
    return depth;
  }

  std::size_t make_room(const Fragment& fragment, const Mask& claimed, Pixel& pixel) {
    std::size_t farthest = Layers;
    Float depth = nearest(plane(fragment), claimed);
    Mask dropped = claimed;
    for (std::uint32_t k = 0; k < Layers; ++k) {
      Mask owned = find(Pixel::kFirstLayer + k, pixel);
      for (std::size_t w = 0; w < Words; ++w) owned[w] = owned[w] & ~claimed[w];
      const Float layer_depth = nearest(owner(k, fragment, pixel), owned);
      if (layer_depth <= depth) continue;
      farthest = k, depth = layer_depth, dropped = owned;
    }
    put(dropped, Pixel::kDeferred, pixel);
    pixel.dropped = lesser(real(pixel.dropped), depth).value;
    return farthest;
  }

  bool shows(const Fragment& fragment, const Pixel& pixel) {
    const auto& nearest = positions_.nearest_to(fragment.centroid_u, fragment.centroid_v);
    for (const std::uint32_t candidate : nearest) {
      const std::uint32_t position = fetch(&candidate, Counted<std::int32_t>(0, counts_)).value;
      Bits state = bits(0);
      for (std::size_t b = 0; b < kBits; ++b) {
        const std::uint32_t bit = (bits(pixel.states.planes[b][position / 32]) & bits(1u << position % 32)).value != 0;
        state = state | bits(bit << b);
      }
      if (state < bits(Pixel::kFirstLayer) || state.value == Pixel::kDeferred) return true;
      if (state.value == Pixel::kSettled) continue;
      const Plane of = owner(state.value - Pixel::kFirstLayer, fragment, pixel);
      const Float u = real(fragment.centroid_u) - real(0.5f), v = real(fragment.centroid_v) - real(0.5f);
      if (real(fragment.centroid_z) <= depth_at(of, u, v)) return true;
    }
    return false;
  }

  const SetupTriangles& triangles_;
  const Tile& tile_;
  const PositionSet& positions_;
  OperationCounts& counts_;
};

template <std::size_t Words, std::size_t Layers>
void TwinCounts::expect_equal_claims() {
  const PositionSet positions(cell_patterns(32 * Words));
  StageCounters raster, ignored, counters;
  std::vector<Pair> pairs;
  std::vector<Fragment> fragments;
  conservative_raster(triangles_, list_, tile_, raster, pairs);
  beam_fragment(triangles_, pairs, tile_, {MaskSource::exact, positions.patterns, nullptr, nullptr, 66, 0}, ignored,
                fragments);
  std::vector<OwnerPixel<Words, Layers>> pixels(tile_.pixels(), cleared_pixel<Words, Layers>()), twins = pixels;
  std::vector<std::uint32_t> remade;
  claim(triangles_, fragments, tile_, positions, counters, pixels, &remade);
  twin_ = {};
  ClaimTwin<Words, Layers> twin(triangles_, tile_, positions, twin_);
  for (const Fragment& fragment : fragments) twin.add(fragment, twins[fragment.pixel]);
  EXPECT_EQ(counters.lanes_used, counters.items_out);
  EXPECT_EQ(counters.lanes_issued, fragments.size());
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(counters.bytes_read, fragments.size() * (streaming_fragment_bytes(Words) + sizeof pixels[0]) +
                                     remade.size() * sizeof(ScreenDepth));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    ASSERT_EQ(pixels[i].owner[0], twins[i].owner[0]) << i;
    ASSERT_EQ(pixels[i].dropped, twins[i].dropped) << i;
    for (std::uint32_t state = 0; state <= OwnerPixel<Words, Layers>::kSettled; ++state)
      ASSERT_EQ(pixels[i].positions_in(state), twins[i].positions_in(state)) << i;
  }
}

TEST_P(TwinCounts, Claim) {
  expect_equal_claims<4, 5>();
  expect_equal_claims<4, 1>();  // many owners are dropped
}

TEST_P(TwinCounts, Accumulate) {
  const Sampling sampling{CellGrid{}, standard_pattern(8)};
  StageCounters raster;
  std::vector<SampleFragment> fragments;
  sample_raster({triangles_, tile_, sampling}, list_, raster, fragments);
  const std::vector<glm::vec3> colors(triangles_.triangles.size(), glm::vec3(0.5f));
  for (const DoubleCounting counting : {DoubleCounting::none, DoubleCounting::saturate}) {
    StageCounters counters;
    Accumulator accumulator(tile_, 8, AccumulatorFormat::fp16, counting);
    accumulate(fragments, colors, {}, tile_, counters, accumulator);
    twin_ = {};
    for (const SampleFragment& fragment : fragments) {
      Float share = bit_count(Bits(fragment.mask, twin_)) * real(1.0f / 8);
      if (counting == DoubleCounting::saturate) share = greater(lesser(share, real(1.0f) - real(0.0f)), real(0.0f));
      for (int channel = 0; channel < 4; ++channel) converted(converted(real(0.0f)) + real(0.5f) * share);
    }
    EXPECT_EQ(counters.lanes_used, fragments.size());
    EXPECT_EQ(counters.lanes_issued, fragments.size());
    EXPECT_EQ(counters.ops, twin_);
  }
}

BEAMPIPE_ON_EVERY_SCENE(TwinCounts);

}  // namespace
}  // namespace beampipe
