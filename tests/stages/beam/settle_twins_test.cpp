// The scalar twins of the end of a pass in streaming order: which owners a pixel has, and what they add to it.
#include "simd/conserve.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/claim.h"
#include "stages/beam/settle.h"
#include "stages/data/fragment_geometry.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"
#include "tests/stages/counted_states.h"
#include "tests/stages/scene_twins.h"

namespace beampipe {
namespace {

template <std::size_t Words, std::size_t Layers>
class PassTwin {
 public:
  using Pixel = OwnerPixel<Words, Layers>;

  PassTwin(const SetupTriangles& triangles, OperationCounts& counts) : triangles_(triangles), counts_(counts) {}

  // The depth bounds of each owner of the pixel (x, y).
  std::vector<Pair> owners(const Pixel& pixel, std::int32_t x, std::int32_t y) {
    std::vector<Pair> pairs;
    for (std::uint32_t k = 0; k < Layers; ++k) {
      if (none(find(pixel, Pixel::kFirstLayer + k))) continue;
      const SetupTriangle& triangle = triangles_.triangles[pixel.triangle(k)];
      const ScreenDepth& depth = triangle.depth;
      const Real dzdx = real64(depth.dzdx), dzdy = real64(depth.dzdy);
      const Real z = real64(depth.z) + dzdx * (real64(x + 0.5) - real64(depth.anchor_x)) +
                     dzdy * (real64(y + 0.5) - real64(depth.anchor_y));
      const Float corners[3] = {real(triangle.vertex_z[0]), real(triangle.vertex_z[1]), real(triangle.vertex_z[2])};
      const auto bounds = pair_bounds<Float>({to_float(z), to_float(dzdx), to_float(dzdy)}, vertex_bounds(corners));
      pairs.push_back({pixel.triangle(k), 0, x, y, false, bounds.nearest.value, bounds.farthest.value});
    }
    return pairs;
  }

  // `fragments`: of the pixel's owners, those that have area.
  void settle(const std::vector<Fragment>& fragments, bool last_pass, Pixel& pixel) {
    const Float one(1.0f), positions = real(32.0f * Words), units(65535.0f);
    Mask settled = find(pixel, Pixel::kSettled), deferred = find(pixel, Pixel::kDeferred);
    Float area = to_float(integer(pixel.area)) / units, taken = count(settled);
    std::array<Float, 3> color;
    for (std::size_t c = 0; c < 3; ++c) color[c] = converted(real(pixel.color[c])) * area;
    struct Owner {
      const Fragment* fragment;
      Float covered, visible, part;
      std::size_t rank = 0;
    };
    std::vector<Owner> seen;
    for (std::uint32_t k = 0; k < Layers; ++k) {
      const Mask owned = find(pixel, Pixel::kFirstLayer + k);
      settled = either(settled, owned);
      if (none(owned) || seen.size() == fragments.size()) continue;
      const Fragment& fragment = fragments[seen.size()];
      if (fragment.triangle != pixel.triangle(k)) continue;
      Mask covered;
      for (std::size_t w = 0; w < Words; ++w) covered[w] = bits(fragment.mask.words[w]);
      Owner owner{&fragment, count(covered), count(owned), Float()};
      owner.part = owner.visible / owner.covered;
      seen.push_back(owner);
    }
    // Sorted by the visible part, the largest first; equal parts keep their order.
    for (std::size_t i = 0; i < seen.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) ++(seen[i].part > seen[j].part ? seen[j].rank : seen[i].rank);
    const bool speck = pixel.owner[0] & Pixel::kSpeck;
    for (std::size_t rank = 0; rank < seen.size(); ++rank) {
      const Owner& owner =
          *std::find_if(seen.begin(), seen.end(), [&](const Owner& other) { return other.rank == rank; });
      const Float alpha = real(owner.fragment->alpha);
      const Float added =
          select(speck, owner.visible * Float(1.0f / (32 * Words)),
                 visible_area(alpha, owner.covered, owner.visible, positions, Taken<Float>{area, taken}));
      area = area + added, taken = taken + owner.visible;
      const Float share = added / alpha;
      for (std::size_t c = 0; c < 3; ++c)
        color[c] = color[c] + share * real(owner.fragment->color[static_cast<int>(c)]);
    }
    Float scale = real(1.0f);
    if (none(deferred) || last_pass) {  // the background shows nothing, or only at positions that no pass decided
      const Float undecided = count(deferred);
      const bool full = count(settled) + undecided == positions;
      const Float inverse = one / area, rest = positions / (positions - undecided);
      if (area.value > 0) scale = select(full, inverse, lesser(rest, inverse));
      settled = either(settled, either(deferred, find(pixel, Pixel::kEmpty)));
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const Float mean = converted(color[c] / area);
      if (area.value > 0) pixel.color[c] = HalfBits(mean.value);
    }
    pixel.area = static_cast<std::uint16_t>(to_integer(lesser(area * scale, one) * units + Float(0.5f)).value);
    put(settled, Pixel::kSettled, pixel);
    for (std::size_t w = 0; w < Words; ++w) deferred[w] = deferred[w] & ~settled[w];
    put(deferred, Pixel::kEmpty, pixel);
    pixel.dropped = kNoDepth;
  }

 private:
  using Mask = std::array<Bits, Words>;

  Bits bits(std::uint32_t word) { return Bits(word, counts_); }
  Float real(float value) { return Float(value, counts_); }
  Real real64(double value) { return Real(value, counts_); }
  Int integer(std::int64_t value) { return Int(value, counts_); }

  static bool none(const Mask& mask) {
    return std::all_of(mask.begin(), mask.end(), [](const Bits& word) { return word.value == 0; });
  }
  static Float count(const Mask& mask) {
    Float sum = bit_count(mask[0]);
    for (std::size_t w = 1; w < Words; ++w) sum = sum + bit_count(mask[w]);
    return sum;
  }
  Mask find(const Pixel& pixel, std::uint32_t state) { return find_counted(pixel, state, counts_); }
  void put(const Mask& mask, std::uint32_t state, Pixel& pixel) { put_counted(mask, state, pixel, counts_); }

  const SetupTriangles& triangles_;
  OperationCounts& counts_;
};

class SettleTwins : public SceneTwins {
 protected:
  template <std::size_t Words, std::size_t Layers>
  void expect_equal() {
    using Pixel = OwnerPixel<Words, Layers>;
    const PositionGrid grid(32 * Words);
    const PositionSet positions(cell_patterns(32 * Words));
    const BeamFragmentOptions options = grid_options(grid, 0);
    const std::vector<glm::vec3> colors = shade_triangles(triangles_, trace_.frames[0].lighting);
    StageCounters ignored;
    std::vector<Pair> pairs;
    std::vector<Fragment> fragments;
    conservative_raster(triangles_, list_, tile_, ignored, pairs);
    beam_fragment(triangles_, pairs, tile_, options, ignored, fragments);
    std::vector<Pixel> pixels(tile_.pixels(), cleared_pixel<Words, Layers>());
    PassTwin<Words, Layers> twin(triangles_, twin_);
    for (const bool last_pass : {false, true}) {
      claim(triangles_, fragments, tile_, positions, ignored, pixels);
      std::vector<Pixel> twins = pixels;
      StageCounters counters;
      const std::vector<Pair> found = owners(triangles_, pixels, tile_, counters);
      twin_ = {};
      std::size_t next = 0;
      for (std::size_t i = 0; i < twins.size(); ++i) {
        const OperationCounts before = twin_;
        const std::size_t first = next;
        const auto x = static_cast<std::int32_t>(i) % tile_.width(), y = static_cast<std::int32_t>(i) / tile_.width();
        for (const Pair& pair : twin.owners(twins[i], x, y)) {
          ASSERT_EQ(found.at(next).triangle, pair.triangle) << i;
          ASSERT_EQ(found[next].nearest, pair.nearest) << i;
          ASSERT_EQ(found[next++].farthest, pair.farthest) << i;
        }
        if (next == first) twin_ = before;  // a pixel without owners is known to be clear
      }
      EXPECT_EQ(next, found.size());
      EXPECT_EQ(counters.ops, twin_);
      std::vector<Fragment> seen;
      beam_fragment(triangles_, found, tile_, options, ignored, seen);
      shade_visible(colors, seen, ignored);
      counters = {}, twin_ = {};
      settle(seen, last_pass, counters, pixels);
      std::vector<std::vector<Fragment>> of_pixel(twins.size());
      for (const Fragment& fragment : seen) of_pixel[fragment.pixel].push_back(fragment);
      for (std::size_t i = 0; i < twins.size(); ++i) {
        const OperationCounts before = twin_;
        if (is_unfinished(twins[i])) twin.settle(of_pixel[i], last_pass, twins[i]);
        if (of_pixel[i].empty()) twin_ = before;
        ASSERT_EQ(pixels[i].area, twins[i].area) << i;
        for (int c = 0; c < 3; ++c) ASSERT_EQ(pixels[i].color[c].bits, twins[i].color[c].bits) << i;
        for (std::uint32_t state = 0; state <= Pixel::kSettled; ++state)
          ASSERT_EQ(pixels[i].positions_in(state), twins[i].positions_in(state)) << i;
      }
      EXPECT_EQ(counters.ops, twin_);
    }
  }
};

TEST_P(SettleTwins, Settle) {
  expect_equal<4, 5>();
  expect_equal<4, 1>();
}

BEAMPIPE_ON_EVERY_SCENE(SettleTwins);

}  // namespace
}  // namespace beampipe
