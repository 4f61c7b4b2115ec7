#include "stages/beam/compose_beam.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "simd/conserve.h"
#include "simd/window_owners.h"
#include "stages/beam/compose_beam_cost.h"
#include "stages/beam/specks.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kNoOwner = ~0u;

// The aggregate while a window is added to it.
struct PixelAggregate {
  WideMask mask;
  Taken<float> taken{0.0f, 0.0f};
  glm::vec3 color{0.0f};  // times area
};

template <std::size_t Words>
PixelAggregate load(const StoredAggregate<Words>& stored) {
  PixelAggregate aggregate;
  std::memcpy(aggregate.mask.words.data(), stored.mask, sizeof stored.mask);
  aggregate.taken.area = stored.area;
  aggregate.color = {stored.color[0], stored.color[1], stored.color[2]};
  return aggregate;
}

template <std::size_t Words>
void store(const PixelAggregate& aggregate, StoredAggregate<Words>& stored) {
  std::memcpy(stored.mask, aggregate.mask.words.data(), sizeof stored.mask);
  stored.area = aggregate.taken.area;
  for (int c = 0; c < 3; ++c) stored.color[c] = HalfBits(aggregate.color[c]);
}

template <std::size_t Words>
void tell_stored(const StoredAggregate<Words>& stored, PixelObserver& observer) {
  const PixelAggregate aggregate = load(stored);
  observer.composes(static_cast<std::uint32_t>(aggregate.mask.count()), aggregate.taken.area, aggregate.color);
}

class PixelComposer {
 public:
  explicit PixelComposer(const PositionSet& positions) : positions_(positions) {}

  // Adds a window's fragments, which are all of one pixel and in primitive order. Sets areas[i] to what fragment i
  // adds.
  void add_window(const Fragment* fragments, std::size_t count, PixelAggregate& aggregate, float* areas) {
    work_.fragments += count;
    ++work_.windows;
    aggregate.taken.positions = find_owners(fragments, count, aggregate.mask);
    bool specks = false;
    for (std::size_t i = 0; i < count; ++i) {
      areas[i] = 0;
      specks |= ownership_[i].covered == 0;
    }
    if (specks) find_specks(fragments, count, aggregate.mask, areas);
    // First specks and fragments that are completely visible. What they take beyond their positions is then known when
    // the fragments that are partly hidden are added.
    partial_.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
      const Ownership& seen = ownership_[i];
      if (seen.visible == seen.covered) {
        add(fragments[i], seen, aggregate, areas[i]);
      } else if (seen.visible > 0) {
        partial_.push_back({static_cast<float>(seen.visible) / static_cast<float>(seen.covered), i});
      }
    }
    work_.partial += partial_.size();
    std::sort(partial_.begin(), partial_.end(), [this](const Partial& a, const Partial& b) {
      ++work_.order_tests;
      return a.visible > b.visible || (a.visible == b.visible && a.fragment < b.fragment);
    });
    for (const Partial& next : partial_)
      add(fragments[next.fragment], ownership_[next.fragment], aggregate, areas[next.fragment]);
  }

  // Tells of the window that was added last. Specks have areas only if they are visible.
  void tell_window(const Fragment* fragments, std::size_t count, const float* areas, PixelObserver& observer) const {
    for (std::size_t i = 0; i < count; ++i) observer.takes(fragments[i].triangle, ownership_[i].owned);
    for (std::size_t i = 0; i < count; ++i) {
      const Fragment& fragment = fragments[i];
      observer.arrives(fragment, ownership_[i].owned);
      observer.adds(fragment.triangle, areas[i], glm::dvec3(fragment.color) / double{fragment.alpha});
      if (ownership_[i].covered == 0 && areas[i] > 0) observer.shows_speck(fragment.triangle);
    }
  }

  // If all positions are taken, nothing of the background can be visible. The rest of the area, which rounding leaves,
  // is distributed over the surfaces. `observer` may be null.
  void close(PixelAggregate& aggregate, PixelObserver* observer) {
    if (aggregate.taken.positions != static_cast<float>(positions_.count())) return;
    if (observer) observer->scales(1.0 / double{aggregate.taken.area});
    aggregate.color *= 1.0f / aggregate.taken.area;
    aggregate.taken.area = 1.0f;
    ++work_.closed;
  }

  const ComposeWork& work() const { return work_; }

 private:
  // Finds who owns which positions. Returns the number of positions that earlier windows have taken.
  float find_owners(const Fragment* fragments, std::size_t count, const WideMask& taken) {
    planes_.resize(count);
    ownership_.resize(count);
    for (std::size_t i = 0; i < count; ++i) planes_[i] = {fragments[i].mask, corner_plane(fragments[i].plane)};
    const WindowCounts counts =
        window_owners(planes_.data(), count, taken, positions_.patterns.data(), ownership_.data());
    work_.depth_tests += counts.tests;
    if (counts.tests > 0) work_.contestants += count;
    return static_cast<float>(counts.taken);
  }

  // `area`: a speck's area on input; the area that was added on output.
  void add(const Fragment& fragment, const Ownership& seen, PixelAggregate& aggregate, float& area) {
    work_.visible += seen.covered > 0;
    area = seen.covered > 0
               ? visible_area(fragment.alpha, static_cast<float>(seen.covered), static_cast<float>(seen.visible),
                              static_cast<float>(positions_.count()), aggregate.taken)
               : std::min(area, 1.0f - aggregate.taken.area);
    aggregate.taken.area += area;
    aggregate.taken.positions += static_cast<float>(seen.visible);
    aggregate.mask = aggregate.mask | seen.owned;
    const float share = area / fragment.alpha;
    aggregate.color += share * fragment.color;
  }

  // Sets the areas of the specks. Each of the three positions nearest to a speck votes for it if the speck lies in
  // front of the position's owner or on the same surface. If the specks around one position face both ways, they may be
  // the two sides of a thin closed body; then the side with the smaller area counts as hidden behind the other.
  void find_specks(const Fragment* fragments, std::size_t count, const WideMask& taken, float* areas) {
    const auto positions = static_cast<std::size_t>(positions_.count());
    list_owners(count);
    front_.resize(positions);
    back_.resize(positions);
    for (std::size_t i = 0; i < count; ++i) {
      if (ownership_[i].covered > 0) continue;
      ++work_.specks;
      const Fragment& fragment = fragments[i];
      const std::array<std::uint8_t, 3>& nearest = positions_.nearest_to(fragment.centroid_u, fragment.centroid_v);
      float votes = 0;
      for (const std::uint8_t position : nearest)
        votes += !taken.test(position) && is_nearer(fragment, fragments, owner_of(position, count));
      areas[i] = fragment.alpha * votes / 3.0f;
      (fragment.front ? front_ : back_)[nearest[0]] += areas[i];
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (ownership_[i].covered > 0) continue;
      const std::size_t place = positions_.nearest_to(fragments[i].centroid_u, fragments[i].centroid_v)[0];
      if ((front_[place] >= back_[place]) != fragments[i].front) areas[i] = 0;
      areas[i] *= std::min(
          1.0f, kSpeckShares / (static_cast<float>(positions_.count()) * std::max(front_[place], back_[place])));
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (ownership_[i].covered > 0) continue;
      const std::size_t place = positions_.nearest_to(fragments[i].centroid_u, fragments[i].centroid_v)[0];
      front_[place] = back_[place] = 0;
    }
  }

  // The owner of a position is searched in windows of up to this many fragments, and looked up in a table in larger
  // ones.
  static constexpr std::size_t kSearched = 32;

  void list_owners(std::size_t count) {
    if (count <= kSearched) return;
    owner_.assign(static_cast<std::size_t>(positions_.count()), kNoOwner);
    for (std::uint32_t i = 0; i < count; ++i)
      for (std::size_t w = 0; w < kMaxMaskWords; ++w)
        for (std::uint32_t left = ownership_[i].owned.words[w]; left != 0; left &= left - 1)
          owner_[w * kMaxMaskSamples + static_cast<std::size_t>(std::countr_zero(left))] = i;
  }

  std::uint32_t owner_of(std::size_t position, std::size_t count) const {
    if (count > kSearched) return owner_[position];
    for (std::uint32_t i = 0; i < count; ++i)
      if (ownership_[i].owned.test(position)) return i;
    return kNoOwner;
  }

  bool is_nearer(const Fragment& fragment, const Fragment* fragments, std::uint32_t owner) {
    if (owner == kNoOwner) return true;
    ++work_.surface_tests;
    return is_on_or_before(fragment.centroid_z, fragments[owner].plane, fragment.centroid_u - 0.5f,
                           fragment.centroid_v - 0.5f);
  }

  const PositionSet& positions_;
  // Of the current window, per fragment:
  std::vector<MaskedPlane> planes_;
  std::vector<Ownership> ownership_;
  struct Partial {
    float visible;  // the visible part of its positions, 0..1
    std::uint32_t fragment;
  };
  std::vector<Partial> partial_;  // fragments that are partly hidden
  // Per position:
  std::vector<std::uint32_t> owner_;  // index of the fragment
  std::vector<float> front_, back_;   // area of the nearest specks that face either way; zeros between windows
  ComposeWork work_;
};

}  // namespace

template <std::size_t Words>
void compose_window(const std::vector<Fragment>& fragments, const PositionSet& positions, StageCounters& counters,
                    std::vector<StoredAggregate<Words>>& pixels, std::vector<float>& areas,
                    const PixelObservers* observers) {
  PixelComposer composer(positions);
  areas.resize(fragments.size());
  for (std::size_t begin = 0, end = 0; begin < fragments.size(); begin = end) {
    const std::uint32_t pixel = fragments[begin].pixel;
    while (end < fragments.size() && fragments[end].pixel == pixel) ++end;
    PixelAggregate aggregate = load(pixels[pixel]);
    composer.add_window(fragments.data() + begin, end - begin, aggregate, areas.data() + begin);
    PixelObserver* const observer = observer_at(observers, pixel);
    if (observer) composer.tell_window(fragments.data() + begin, end - begin, areas.data() + begin, *observer);
    composer.close(aggregate, observer);
    store(aggregate, pixels[pixel]);
    if (observer) tell_stored(pixels[pixel], *observer);
  }
  charge<Words>(composer.work(), counters);
}

template <std::size_t Words>
void compose_whole(const WholePixels& whole, StageCounters& counters, std::vector<StoredAggregate<Words>>& pixels,
                   const PixelObservers* observers) {
  for (const Pair& pair : whole.pairs) {
    const std::size_t index = whole.tile.index(pair.x, pair.y);
    const glm::vec3 color =
        whole.shader.color(pair.triangle, static_cast<std::uint32_t>(index), 0.5f, 0.5f, 1.0f, whole.texels);
    end_request(whole.texels);
    auto& pixel = pixels[index];
    std::memset(pixel.mask, 0xff, sizeof pixel.mask);
    pixel.area = 1.0f;
    for (int c = 0; c < 3; ++c) pixel.color[c] = HalfBits(color[c]);
    if (PixelObserver* const observer = observer_at(observers, index)) {
      observer->takes(pair.triangle, first_words(Words));
      observer->adds(pair.triangle, 1.0, color);
      tell_stored(pixel, *observer);
    }
  }
  charge_whole<Words>(whole.pairs.size(), counters);
}

#define BEAMPIPE_COMPOSE(words)                                                                                   \
  template void compose_window(const std::vector<Fragment>&, const PositionSet&, StageCounters&,                  \
                               std::vector<StoredAggregate<words>>&, std::vector<float>&, const PixelObservers*); \
  template void compose_whole(const WholePixels&, StageCounters&, std::vector<StoredAggregate<words>>&,           \
                              const PixelObservers*);
BEAMPIPE_COMPOSE(1)
BEAMPIPE_COMPOSE(8)
#undef BEAMPIPE_COMPOSE

}  // namespace beampipe
