// The scalar twin of compose_window: one window of one pixel after the other, position by position.

#include "simd/conserve.h"
#include "simd/position_mask.h"
#include "tests/stages/beam_pixels.h"
#include "tests/stages/scene_twins.h"

namespace beampipe::compose_twins_test {

using namespace twins;

constexpr std::size_t kWords = 8, kPositions = 32 * kWords;

using Stored = StoredAggregate<kWords>;

class ComposeTwins : public SceneTwins {
 protected:
  // Composes `fragments`, which belong to one pixel.
  void compose(const Fragment* fragments, std::size_t count, Stored& pixel) {
    WideMask taken;
    std::copy_n(pixel.mask, kWords, taken.words.begin());
    std::vector<Seen> seen = owners(fragments, count, taken);
    std::vector<Float> speck_areas(count, Float(0.0f));
    find_specks(fragments, seen, taken, speck_areas);
    Float area = real(pixel.area), positions = real(static_cast<float>(taken.count()));
    Float color[3] = {converted(real(pixel.color[0])), converted(real(pixel.color[1])),
                      converted(real(pixel.color[2]))};
    for (const std::size_t i : whole_first(seen)) {
      const Float alpha = real(fragments[i].alpha);
      Float part;
      if (seen[i].covered.value > 0) {
        part = visible_area(alpha, seen[i].covered, seen[i].visible, real(float(kPositions)),
                            Taken<Float>{area, positions});
        positions = positions + seen[i].visible;
      } else {
        part = lesser(speck_areas[i], Float(1.0f) - area);
      }
      area = area + part;
      const Float share = part / alpha;
      for (int c = 0; c < 3; ++c) color[c] = color[c] + share * real(fragments[i].color[c]);
      taken = taken | seen[i].owned;
    }
    static_cast<void>(positions == real(float(kPositions)));
    if (positions.value == float(kPositions)) {  // nothing of the background is visible
      const Float scale = real(1.0f) / area;
      for (Float& channel : color) channel = channel * scale;
      area = real(1.0f);
    }
    std::copy_n(taken.words.begin(), kWords, pixel.mask);
    pixel.area = area.value;
    for (int c = 0; c < 3; ++c) pixel.color[c] = HalfBits(converted(color[c]).value);
  }

  const PositionSet positions_{cell_patterns(kPositions)};
  std::uint64_t tests_ = 0;  // depths that were compared

 private:
  struct Seen {
    WideMask owned;
    Float covered{0.0f}, visible{0.0f};
  };

  Float number_in(const WideMask& mask) {
    Float sum = bit_count(bits(mask.words[0]));
    for (std::size_t w = 1; w < kWords; ++w) sum = sum + bit_count(bits(mask.words[w]));
    return sum;
  }

  // Each open position goes to the fragment that is nearest there. Depths are compared only if there are several.
  std::vector<Seen> owners(const Fragment* fragments, std::size_t count, const WideMask& taken) {
    std::vector<Seen> seen(count);
    WideMask once, twice;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t w = 0; w < kWords; ++w) {
        const Bits mask = bits(fragments[i].mask.words[w]), open = mask & ~bits(taken.words[w]);
        twice.words[w] = (bits(twice.words[w]) | (bits(once.words[w]) & open)).value;
        once.words[w] = (bits(once.words[w]) | open).value;
        seen[i].owned.words[w] = open.value;
      }
      seen[i].covered = number_in(fragments[i].mask);
    }
    if (!twice.none()) contest(fragments, twice, seen);
    for (Seen& fragment : seen) {
      for (const std::uint32_t word : fragment.owned.words) bits(0) | bits(word);  // joined to what is taken
      fragment.visible = number_in(fragment.owned);
    }
    return seen;
  }

  void contest(const Fragment* fragments, const WideMask& twice, std::vector<Seen>& seen) {
    std::vector<Float> nearest(kPositions, real(std::numeric_limits<float>::infinity()));
    std::vector<std::size_t> owner(kPositions);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const DepthPlane<float>& plane = fragments[i].plane;
      const Float half(0.5f), unit(256.0f), dzdu = real(plane.dzdu), dzdv = real(plane.dzdv);
      const Float corner = real(plane.z) - half * dzdu - half * dzdv, dzdx = dzdu / unit, dzdy = dzdv / unit;
      for (std::size_t at = 0; at < kPositions; ++at) {
        if (!seen[i].owned.test(at) || !twice.test(at)) continue;
        const SamplePattern& pattern = positions_.patterns[at / 32];
        const Float depth = corner + dzdx * real(float(pattern.x[at % 32])) + dzdy * real(float(pattern.y[at % 32]));
        ++tests_;
        if (depth < nearest[at]) nearest[at] = depth, owner[at] = i;
      }
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      for (std::size_t w = 0; w < kWords; ++w) {
        std::uint32_t won = 0;
        for (std::size_t s = 0; s < 32; ++s) won |= std::uint32_t{owner[32 * w + s] == i} << s;
        std::uint32_t& owned = seen[i].owned.words[w];
        owned = (bits(owned) & (~bits(twice.words[w]) | bits(won))).value;
      }
    }
  }

  // Fragments that are completely visible come first, then those that are partly hidden, the most visible first.
  std::vector<std::size_t> whole_first(const std::vector<Seen>& seen) {
    std::vector<std::size_t> order, partial;
    std::vector<float> part(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].visible == seen[i].covered) {
        order.push_back(i);
      } else if (seen[i].visible.value > 0) {
        part[i] = (seen[i].visible / seen[i].covered).value;
        partial.push_back(i);
      }
    }
    std::sort(partial.begin(), partial.end(), [&](std::size_t a, std::size_t b) {
      ++twin_.add;  // a comparison of keys
      return part[a] > part[b] || (part[a] == part[b] && a < b);
    });
    order.insert(order.end(), partial.begin(), partial.end());
    return order;
  }

  std::optional<std::size_t> owner_at(std::size_t position, const std::vector<Seen>& seen) const {
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (seen[i].owned.test(position)) return i;
    return {};
  }

  // Each speck is compared with the owners of the three nearest positions: is it in front of them or on the same
  // surface? Its area is multiplied by the part of them for which that is true. If the specks at a position show both
  // sides of a surface, the side with less area is dropped.
  void find_specks(const Fragment* fragments, const std::vector<Seen>& seen, const WideMask& taken,
                   std::vector<Float>& areas) {
    std::vector<Float> sides[2];
    for (auto& side : sides) side.assign(kPositions, real(0.0f));
    std::vector<std::size_t> place(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].covered.value > 0) continue;
      const Fragment& fragment = fragments[i];
      const auto near = [&](float u) {
        return lesser(greater(converted(real(u) * Float(64.0f)), real(0.0f)), real(63.0f));
      };
      near(fragment.centroid_u), near(fragment.centroid_v);
      Float votes(0.0f);
      twin_.fetch += 1;  // the three
      const auto& nearest = positions_.nearest_to(fragment.centroid_u, fragment.centroid_v);
      for (const std::uint8_t position : nearest) {
        const bool is_free = (bits(taken.words[position / 32u]) & bits(1u << position % 32u)).value == 0;
        twin_.fetch += 1;  // the owner
        const auto owner = owner_at(position, seen);
        const bool shows = is_free && (!owner || is_before(fragment, fragments[*owner].plane));
        votes = votes + real(shows ? 1.0f : 0.0f);
      }
      areas[i] = real(fragment.alpha) * votes / Float(3.0f);
      place[i] = nearest[0];
      Float& side = sides[fragment.front][place[i]];
      side = side + areas[i];
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].covered.value > 0) continue;
      const Float &back = sides[0][place[i]], &front = sides[1][place[i]];
      if ((front >= back) != fragments[i].front) areas[i].value = 0;
      const Float limit = Float(4.0f) / (real(float(kPositions)) * greater(front, back));
      areas[i] = areas[i] * lesser(Float(1.0f), limit);
    }
  }

  // It may be at most 1/64 px of the surface's slope behind the surface.
  bool is_before(const Fragment& fragment, const DepthPlane<float>& plane) {
    const Float half(0.5f), dzdu = real(plane.dzdu), dzdv = real(plane.dzdv);
    const Float u = real(fragment.centroid_u) - half, v = real(fragment.centroid_v) - half;
    const Float depth = real(plane.z) + dzdu * u + dzdv * v;
    return real(fragment.centroid_z) <= depth + Float(1.0f / 64) * (magnitude(dzdu) + magnitude(dzdv));
  }
};

TEST_P(ComposeTwins, ComposeWindow) {
  const PositionGrid grid(kPositions);
  StageCounters ignored;
  std::vector<Fragment> fragments = fragments_of(triangles_, tile_, grid_options(grid, 0));
  shade_visible(shade_triangles(triangles_, trace_.frames[0].lighting), fragments, ignored);
  std::stable_sort(fragments.begin(), fragments.end(), [](const auto& a, const auto& b) { return a.pixel < b.pixel; });
  std::vector<Stored> pixels(tile_.pixels()), twins = pixels;
  StageCounters counters;
  twin_ = {}, tests_ = 0;
  for (std::size_t half = 0; half < 2; ++half) {  // two windows of each pixel
    std::vector<Fragment> window;
    for (std::size_t begin = 0, end = 0; begin < fragments.size(); begin = end) {
      while (end < fragments.size() && fragments[end].pixel == fragments[begin].pixel) ++end;
      const std::size_t middle = (begin + end) / 2, first = window.size();
      for (std::size_t i = half ? middle : begin; i < (half ? end : middle); ++i) window.push_back(fragments[i]);
      if (window.size() > first) compose(&window[first], window.size() - first, twins[fragments[begin].pixel]);
    }
    std::vector<float> areas;
    compose_window(window, positions_, counters, pixels, areas);
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    ASSERT_TRUE(std::equal(pixels[i].mask, pixels[i].mask + kWords, twins[i].mask)) << i;
    ASSERT_EQ(float(pixels[i].area), float(twins[i].area)) << i;
    for (int c = 0; c < 3; ++c) ASSERT_EQ(float(pixels[i].color[c]), float(twins[i].color[c])) << i;
  }
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(counters.lanes_used, tests_);
  EXPECT_EQ(counters.lanes_issued, fragments.size() * kPositions);
}

BEAMPIPE_ON_EVERY_SCENE(ComposeTwins);

}  // namespace beampipe::compose_twins_test
