#include "stages/beam/compose_casav.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "stages/beam/casav_fragment.h"
#include "stages/beam/compose_casav_cost.h"

namespace beampipe {
namespace {

// Rounds the colour to fp16, as compose_over stores it.
Aggregate stored_over(Aggregate aggregate) {
  for (float& channel : aggregate.color) channel = rounded_to_half(channel);
  return aggregate;
}

// By value, so that nothing points to an aggregate that is kept in registers.
void tell_over(bool is_first, const Fragment& fragment, Aggregate before, Aggregate after, PixelObserver& observer) {
  observer.enters(!is_first, fragment);
  if (!is_first) observer.joins(0, {before, merge_fragment(fragment).surface, after, 1.0f, 1.0f - before.alpha});
}

void finish_aggregates(const PixelObservers* observers) {
  if (!observers) return;
  for (const auto& observer : *observers)
    if (observer) observer->finishes_aggregate();
}

// Of a pixel while its list is merged: for each position the depth of the nearest surface there. Depths are below 1.
struct PositionDepths {
  std::array<float, kMaxMaskSamples> nearest;
  PositionDepths() { nearest.fill(1.0f); }
};

// The positions at which the fragment is in front of all surfaces before it.
std::uint32_t put_in_front(const Aggregate& fragment, const SamplePattern& pattern, PositionDepths& depths,
                           MergeWork& work) {
  std::uint32_t front = 0;
  for (std::uint32_t left = fragment.mask; left != 0; left &= left - 1) {
    const auto s = static_cast<std::size_t>(std::countr_zero(left));
    const Nearest<float> now =
        nearest_with(fragment, position_u(pattern, s), position_v(pattern, s), depths.nearest[s]);
    depths.nearest[s] = now.depth;
    if (now.is_fragment) front |= 1u << s;
    ++work.kept_depths;
  }
  return front;
}

template <class Stored>
std::vector<Aggregate> compose_stored(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                      const CasavMerging& by, MergeWork& work, const PixelObservers* observers) {
  const std::size_t pixels = buffer.first.size() - 1;
  // Round r merges the r-th fragment of every pixel that has one. These merges are independent, so each runs in a lane.
  // Pixels with the longest lists come first, so the pixels of a round are the first ones.
  std::vector<std::uint32_t> order(pixels);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return buffer.record_count(a) > buffer.record_count(b); });
  std::vector<Stored> stored(pixels, Stored(kEmptyAggregate));
  std::vector<Aggregate> merging(pixels);
  std::vector<MergeFragment> arriving(pixels);
  std::vector<MergeSteps> steps(pixels);
  const bool keeps_depths = by.rules.partition == MergeRules::Partition::given;
  std::vector<PositionDepths> depths(keeps_depths ? pixels : 0);
  std::size_t active = pixels;
  for (std::uint32_t round = 0;; ++round) {
    while (active > 0 && buffer.record_count(order[active - 1]) <= round) --active;
    if (active == 0) break;
    for (std::size_t i = 0; i < active; ++i) {
      arriving[i] = merge_fragment(fragments[buffer.records[buffer.first[order[i]] + round]]);
      merging[i] = stored[i];
      if (keeps_depths) arriving[i].front = put_in_front(arriving[i].surface, by.positions.pattern, depths[i], work);
    }
    const std::vector<Aggregate> before = observers ? merging : std::vector<Aggregate>{};
    merge(arriving.data(), active, by.positions, by.rules, merging.data(), steps.data());
    for (std::size_t i = 0; i < active; ++i) {
      stored[i] = Stored(merging[i]), work.add(steps[i]);
      PixelObserver* const observer = observer_at(observers, order[i]);
      if (!observer) continue;
      observer->enters(round > 0, fragments[buffer.records[buffer.first[order[i]] + round]]);
      if (round > 0) tell_merge(0, before[i], arriving[i], stored[i], by, *observer);
    }
  }
  finish_aggregates(observers);
  std::vector<Aggregate> aggregates(pixels);
  for (std::size_t i = 0; i < pixels; ++i) aggregates[order[i]] = stored[i];
  return aggregates;
}

}  // namespace

std::vector<Aggregate> compose(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                               const CasavMerging& merging, StageCounters& counters, const PixelObservers* observers) {
  MergeWork work;
  std::vector<Aggregate> aggregates = merging.storage == CasavStorage::slides
                                          ? compose_stored<SlidesAggregate>(fragments, buffer, merging, work, observers)
                                          : compose_stored<TextAggregate>(fragments, buffer, merging, work, observers);
  const std::uint32_t bytes = casav_aggregate_bytes(merging.storage);
  charge_merges(buffer, casav_merges_cost(work, merging.rules, merging.storage), bytes, bytes, counters);
  counters.position_tests += position_tests(work);
  return aggregates;
}

std::vector<Aggregate> compose_over(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                    StageCounters& counters, const PixelObservers* observers) {
  const std::size_t pixels = buffer.first.size() - 1;
  std::vector<Aggregate> aggregates;
  aggregates.reserve(pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    Aggregate aggregate = kEmptyAggregate;
    PixelObserver* const observer = observer_at(observers, pixel);
    for (std::uint32_t i = buffer.first[pixel]; i < buffer.first[pixel + 1]; ++i) {
      const Fragment& fragment = fragments[buffer.records[i]];
      const Aggregate before = aggregate;
      aggregate = stored_over(over_formula(merge_fragment(fragment), before));
      if (observer) tell_over(i == buffer.first[pixel], fragment, before, aggregate, *observer);
    }
    aggregates.push_back(aggregate);
  }
  finish_aggregates(observers);
  charge_merges(buffer, over_cost() * buffer.records.size(), kOverFragmentBytes, kOverBytes, counters);
  return aggregates;
}

}  // namespace beampipe
