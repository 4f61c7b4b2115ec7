#include "stages/compose_window.h"

#include <algorithm>

#include "simd/conserve.h"
#include "simd/depth_test.h"
#include "stages/counting.h"
#include "stages/depth_test.h"

namespace beampipe {
namespace {

// A speck of a smooth surface counts as part of the surface that owns the position beside it when it lies at most this
// far behind, in pixels of that surface's slope: a quarter of the distance between positions of a 256-bit mask.
constexpr float kSurfaceReach = 1.0f / 64.0f;

// Specks whose nearest position is the same have at most so many times that position's share of the pixel together;
// more is several surfaces on top of each other. Twice is about the most that lies nearest to one position; four times
// leaves dense meshes alone.
constexpr float kSpeckShares = 4.0f;

// What is kept from one window to the next, as it is worked on.
struct PixelAggregate {
  WideMask mask;
  Taken<float> taken{0.0f, 0.0f};
  glm::vec3 color{0.0f};  // times area
};

template <std::size_t Words, class Channel>
PixelAggregate load(const StoredAggregate<Words, Channel>& stored) {
  PixelAggregate aggregate;
  std::copy_n(stored.mask, Words, aggregate.mask.words.begin());
  aggregate.taken = {stored.area, static_cast<float>(aggregate.mask.count())};
  aggregate.color = {stored.color[0], stored.color[1], stored.color[2]};
  return aggregate;
}

template <std::size_t Words, class Channel>
void store(const PixelAggregate& aggregate, StoredAggregate<Words, Channel>& stored) {
  std::copy_n(aggregate.mask.words.begin(), Words, stored.mask);
  stored.area = aggregate.taken.area;
  for (int c = 0; c < 3; ++c) stored.color[c] = Channel(aggregate.color[c]);
}

// A fragment of the window and what is seen of it.
struct Seen {
  const Fragment* fragment;
  float covered = 0, visible = 0;  // mask positions
  WideMask owned;
  float area = 0;  // of a tiny fragment, that shows
};

class PixelComposer {
 public:
  explicit PixelComposer(const PositionSet& positions) : positions_(positions) {
    const auto samples = static_cast<std::size_t>(positions.count());
    depth_.resize(samples + kSampleSlack);
    owner_.resize(samples + kSampleSlack);
  }

  // Adds fragments [begin, end), all of one pixel, in primitive order.
  void add_window(const Fragment* const* begin, const Fragment* const* end, PixelAggregate& aggregate) {
    seen_.clear();
    for (const Fragment* const* fragment = begin; fragment != end; ++fragment)
      seen_.push_back({*fragment, 0, 0, {}, 0});
    find_owners(aggregate.mask);
    find_tiny(aggregate.mask);
    // Whole fragments first, tiny ones among them: what they took beyond their positions is then known to those that
    // are partly hidden.
    const auto whole = [](const Seen& seen) { return seen.covered > 0 ? seen.visible / seen.covered : 1.0f; };
    std::stable_sort(seen_.begin(), seen_.end(), [&](const Seen& a, const Seen& b) { return whole(a) > whole(b); });
    for (const Seen& seen : seen_) {
      const Fragment& fragment = *seen.fragment;
      float area = std::min(seen.area, 1.0f - aggregate.taken.area);
      if (seen.covered > 0) {
        if (seen.visible == 0) continue;
        area = visible_area(fragment.alpha, seen.covered, seen.visible, static_cast<float>(positions_.count()),
                            aggregate.taken);
      }
      aggregate.taken.area += area;
      aggregate.taken.positions += seen.visible;
      aggregate.mask = aggregate.mask | seen.owned;
      const float share = area / fragment.alpha;
      aggregate.color += share * fragment.color;
    }
  }

  std::uint64_t depth_tests() const { return depth_tests_; }
  std::uint64_t additions() const { return additions_; }

 private:
  void find_owners(const WideMask& taken) {
    additions_ += seen_.size();
    for (Seen& seen : seen_) seen.covered = static_cast<float>(seen.fragment->mask.count());
    single_ = seen_.size() == 1;
    if (single_) {
      seen_[0].owned = without(seen_[0].fragment->mask, taken);
      seen_[0].visible = static_cast<float>(seen_[0].owned.count());
      return;
    }
    std::fill(depth_.begin(), depth_.end(), kFarDepth);
    std::fill(owner_.begin(), owner_.end(), kNoTriangle);
    for (std::size_t word = 0; word < positions_.patterns.size(); ++word) {
      items_.clear();
      for (std::uint32_t i = 0; i < seen_.size(); ++i) {
        const std::uint32_t mask = seen_[i].fragment->mask.words[word] & ~taken.words[word];
        if (mask == 0) continue;
        const DepthPlane<float>& plane = seen_[i].fragment->plane;
        const float corner = plane.z - 0.5f * plane.dzdu - 0.5f * plane.dzdv;
        items_.push_back({0, mask, i, corner, plane.dzdu / kSubpixelUnits, plane.dzdv / kSubpixelUnits});
        depth_tests_ += static_cast<std::uint64_t>(std::popcount(mask));
      }
      const std::size_t first = word * kMaxMaskSamples;
      depth_test(items_.data(), items_.size(), positions_.patterns[word],
                 {depth_.data() + first, owner_.data() + first});
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(positions_.count()); ++i) {
      if (owner_[i] == kNoTriangle) continue;
      seen_[owner_[i]].owned.set(i);
      seen_[owner_[i]].visible += 1;
    }
  }

  // Fragments that cover no position. Each asks the owners of the three nearest positions whether it lies before them,
  // or on the same surface. Around one position the two sides of a thin closed body both cover no position: the side
  // with the lesser area is taken for hidden by the other.
  void find_tiny(const WideMask& taken) {
    if (std::none_of(seen_.begin(), seen_.end(), [](const Seen& seen) { return seen.covered == 0; })) return;
    front_.assign(static_cast<std::size_t>(positions_.count()), 0.0f);
    back_.assign(static_cast<std::size_t>(positions_.count()), 0.0f);
    for (Seen& seen : seen_) {
      if (seen.covered > 0) continue;
      const Fragment& fragment = *seen.fragment;
      const std::array<std::uint8_t, 3>& nearest = positions_.nearest_to(fragment.centroid_u, fragment.centroid_v);
      float votes = 0;
      for (const std::uint8_t position : nearest) votes += !taken.test(position) && is_nearer(fragment, position);
      seen.area = fragment.alpha * votes / 3.0f;
      (fragment.front ? front_ : back_)[nearest[0]] += seen.area;
    }
    for (Seen& seen : seen_) {
      if (seen.covered > 0) continue;
      const std::size_t place = positions_.nearest_to(seen.fragment->centroid_u, seen.fragment->centroid_v)[0];
      if ((front_[place] >= back_[place]) != seen.fragment->front) seen.area = 0;
      seen.area *= std::min(
          1.0f, kSpeckShares / (static_cast<float>(positions_.count()) * std::max(front_[place], back_[place])));
    }
  }

  bool is_nearer(const Fragment& fragment, std::size_t position) const {
    if (single_ || owner_[position] == kNoTriangle) return true;
    const Fragment& owner = *seen_[owner_[position]].fragment;
    const float u = fragment.centroid_u - 0.5f, v = fragment.centroid_v - 0.5f;
    return fragment.centroid_z <=
           depth_at(owner.plane, u, v) + kSurfaceReach * (magnitude(owner.plane.dzdu) + magnitude(owner.plane.dzdv));
  }

  const PositionSet& positions_;
  std::vector<Seen> seen_;
  std::vector<CellDepth> items_;
  std::vector<float> depth_;          // of the window at hand, per position
  std::vector<std::uint32_t> owner_;  // index into seen_
  std::vector<float> front_, back_;   // area of tiny fragments that face either way, by nearest position
  bool single_ = false;
  std::uint64_t depth_tests_ = 0, additions_ = 0;
};

// Adding one fragment: its masks word by word, its visible area, and its colour.
OperationCounts addition_cost(std::size_t words) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    const Counted<std::uint32_t> mask(~0u, counts);
    Counted<std::uint32_t> taken_mask = mask;
    Counted<float> covered = one, visible = one;
    for (std::size_t i = 0; i < words; ++i) {
      const Counted<std::uint32_t> owned = mask & ~taken_mask;
      taken_mask = taken_mask | owned;
      covered = covered + bit_count(mask);
      visible = visible + bit_count(owned);
    }
    Taken<Counted<float>> taken{one, one};
    const Counted<float> area = visible_area(one, covered, visible, one, taken);
    taken = {taken.area + area, taken.positions + visible};
    const Counted<float> share = area / one;
    Counted<float> color[3] = {one, one, one};
    for (Counted<float>& channel : color) channel = channel + share * one;
  });
}

OperationCounts depth_compare_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> depth;
    depth_test_scalar(one, one, one, one, one, one, depth);
  });
}

}  // namespace

PositionSet::PositionSet(std::vector<SamplePattern> words) : patterns(std::move(words)) {
  for (int y = 0; y < kPlaces; ++y) {
    for (int x = 0; x < kPlaces; ++x) {
      // Squared distance in 1/256 px, then the position's number: ties go to the lower one.
      std::array<std::pair<int, int>, kMaxMaskWords * kMaxMaskSamples> by_distance;
      for (int i = 0; i < count(); ++i) {
        const SamplePattern& pattern = patterns[static_cast<std::size_t>(i / kMaxMaskSamples)];
        const auto s = static_cast<std::size_t>(i % kMaxMaskSamples);
        constexpr int kPlace = kSubpixelUnits / kPlaces;
        const int dx = pattern.x[s] - (x * kPlace + kPlace / 2), dy = pattern.y[s] - (y * kPlace + kPlace / 2);
        by_distance[static_cast<std::size_t>(i)] = {dx * dx + dy * dy, i};
      }
      std::partial_sort(by_distance.begin(), by_distance.begin() + 3, by_distance.begin() + count());
      nearest.push_back({static_cast<std::uint8_t>(by_distance[0].second),
                         static_cast<std::uint8_t>(by_distance[1].second),
                         static_cast<std::uint8_t>(by_distance[2].second)});
    }
  }
}

const std::array<std::uint8_t, 3>& PositionSet::nearest_to(float u, float v) const {
  const auto place = [](float x) { return std::clamp(static_cast<int>(x * kPlaces), 0, kPlaces - 1); };
  return nearest[static_cast<std::size_t>(place(v) * kPlaces + place(u))];
}

namespace {

template <std::size_t Words, class Channel>
std::vector<PixelColor> compose_stored(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                       const PositionSet& positions, StageCounters& counters, PixelWindows& windows) {
  using Stored = StoredAggregate<Words, Channel>;
  constexpr int kPositions = 32 * Words;
  const std::size_t pixels = buffer.first.size() - 1;
  PixelComposer composer(positions);
  std::vector<PixelColor> colors(pixels);
  windows = {std::vector<float>(pixels), std::vector<float>(pixels)};
  std::vector<const Fragment*> window;
  std::uint64_t looked_at = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    Stored stored{};
    int taken = 0;
    const auto at = [&](std::uint32_t i) -> const Fragment& { return fragments[buffer.fragments[i]]; };
    const std::uint32_t end = buffer.first[pixel + 1];
    for (std::uint32_t i = buffer.first[pixel]; i < end && taken < kPositions;) {
      window.clear();
      float farthest = at(i).z_max;
      do {
        window.push_back(&at(i));
        farthest = std::max(farthest, at(i).z_max);
      } while (++i < end && at(i).z_min <= farthest);
      std::sort(window.begin(), window.end());  // primitive order: of equal depths the earlier wins
      PixelAggregate aggregate = load(stored);
      composer.add_window(window.data(), window.data() + window.size(), aggregate);
      taken = aggregate.mask.count();
      if (taken == kPositions) {  // nothing is left for the background: what rounding left goes to what is there
        aggregate.color *= 1.0f / aggregate.taken.area;
        aggregate.taken.area = 1.0f;
      }
      store(aggregate, stored);
      windows.largest[pixel] = std::max(windows.largest[pixel], static_cast<float>(window.size()));
      windows.merges[pixel] += static_cast<float>(window.size());
      looked_at += window.size();
    }
    colors[pixel] = {stored.area, {stored.color[0], stored.color[1], stored.color[2]}};
  }
  counters.items_in += buffer.fragments.size();
  counters.items_out += pixels;
  counters.ops += addition_cost(Words) * composer.additions();
  counters.ops += depth_compare_cost() * composer.depth_tests();
  counters.bytes_read += looked_at * conserving_fragment_bytes(kPositions);
  counters.bytes_written += pixels * sizeof(Stored);
  counters.lanes_used += composer.depth_tests();
  counters.lanes_issued += looked_at * std::uint64_t{kPositions};
  return colors;
}

template <class Channel>
std::vector<PixelColor> compose_channels(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                         const PositionSet& positions, StageCounters& counters, PixelWindows& windows) {
  switch (positions.patterns.size()) {
    case 1:
      return compose_stored<1, Channel>(fragments, buffer, positions, counters, windows);
    case 2:
      return compose_stored<2, Channel>(fragments, buffer, positions, counters, windows);
    case 4:
      return compose_stored<4, Channel>(fragments, buffer, positions, counters, windows);
    default:
      return compose_stored<8, Channel>(fragments, buffer, positions, counters, windows);
  }
}

}  // namespace

std::vector<PixelColor> compose_window(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                       const PositionSet& positions, Storage storage, StageCounters& counters,
                                       PixelWindows& windows) {
  return storage == Storage::packed ? compose_channels<HalfBits>(fragments, buffer, positions, counters, windows)
                                    : compose_channels<float>(fragments, buffer, positions, counters, windows);
}

}  // namespace beampipe
