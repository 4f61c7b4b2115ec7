#include "stages/beam/compose_layers.h"

#include <algorithm>

#include "stages/beam/casav_fragment.h"
#include "stages/beam/compose_layers_cost.h"

namespace beampipe {
namespace {

bool is_empty(const Aggregate& aggregate) { return aggregate.mask == 0; }

// An aggregate that is merged into a nearer one, as a fragment is.
MergeFragment as_fragment(const Aggregate& aggregate) { return {aggregate, 0u, 0u}; }

// Merges what lies farther away into what is nearer.
Aggregate merged(const Aggregate& nearer, const MergeFragment& farther, const CasavMerging& merging, MergeWork& work) {
  Aggregate result = nearer;
  MergeSteps steps;
  merge(&farther, 1, merging.positions, merging.rules, &result, &steps);
  work.add(steps);
  result.thickness = std::max(result.thickness, farther.surface.thickness);  // a fragment has none, an aggregate may
  return result;
}

}  // namespace

AggregateLayers::AggregateLayers(std::size_t pixels, std::size_t layers, const CasavMerging& merging,
                                 const PixelObservers* observers)
    : layers_(layers), merging_(merging), observers_(observers), aggregates_(pixels * layers, kEmptyAggregate) {}

Aggregate AggregateLayers::stored(const Aggregate& aggregate) const {
  if (merging_.storage == CasavStorage::text) return TextAggregate(aggregate);
  return SlidesAggregate(aggregate);
}

void AggregateLayers::add(const std::vector<Fragment>& fragments, StageCounters& counters, std::vector<float>& merges) {
  LayersWork work;
  std::vector<MergeFragment> all(layers_ + 1);  // of one pixel, near to far
  for (const Fragment& fragment : fragments) {
    Aggregate* const layers = aggregates_.data() + fragment.pixel * layers_;
    const MergeFragment incoming = merge_fragment(fragment);
    ++work.fragments;
    PixelObserver* const observer = observer_at(observers_, fragment.pixel);
    if (layers_ == 1) {
      const Aggregate before = layers[0];
      merges[fragment.pixel] += !is_empty(before);
      layers[0] = stored(merged(before, incoming, merging_, work.merging));
      if (observer) observer->overwrites(!is_empty(before)), observer->enters(!is_empty(before), fragment);
      if (observer && !is_empty(before)) tell_merge(0, before, incoming, layers[0], merging_, *observer);
      continue;
    }
    std::size_t count = 0, place = 0;
    for (; count < layers_ && !is_empty(layers[count]); ++count) {
      all[count] = as_fragment(layers[count]);
      place += layers[count].z_min <= incoming.surface.z_min;
    }
    std::move_backward(all.begin() + static_cast<std::ptrdiff_t>(place),
                       all.begin() + static_cast<std::ptrdiff_t>(count),
                       all.begin() + static_cast<std::ptrdiff_t>(count) + 1);
    all[place] = incoming;
    ++count;
    if (observer) observer->overwrites(count - 1), observer->enters(place, fragment);
    if (count > layers_) {
      std::size_t closest = 0;
      float least = depth_between(all[0].surface, all[1].surface);
      for (std::size_t k = 1; k + 1 < count; ++k)
        if (const float gap = depth_between(all[k].surface, all[k + 1].surface); gap < least) least = gap, closest = k;
      const Aggregate together = merged(all[closest].surface, all[closest + 1], merging_, work.merging);
      if (observer) tell_merge(closest, all[closest].surface, all[closest + 1], stored(together), merging_, *observer);
      all[closest] = as_fragment(together);
      all.erase(all.begin() + static_cast<std::ptrdiff_t>(closest) + 1);
      all.emplace_back();
      --count;
      ++merges[fragment.pixel];
    }
    for (std::size_t k = 0; k < count; ++k) layers[k] = stored(all[k].surface);
  }
  charge(work, layers_, merging_.rules, merging_.storage, counters);
}

std::vector<Aggregate> AggregateLayers::finish(StageCounters& counters) const {
  LayersWork work;
  std::vector<Aggregate> result;
  for (std::size_t first = 0; first < aggregates_.size(); first += layers_) {
    Aggregate pixel = aggregates_[first];
    PixelObserver* const observer = observer_at(observers_, result.size());
    if (observer) observer->arrivals_end();
    for (std::size_t k = 1; k < layers_ && !is_empty(aggregates_[first + k]); ++k) {
      const Aggregate nearer = pixel;
      pixel = merged(nearer, as_fragment(aggregates_[first + k]), merging_, work.merging);
      if (observer) tell_merge(0, nearer, as_fragment(aggregates_[first + k]), pixel, merging_, *observer);
    }
    if (observer) observer->finishes_aggregate();
    work.finished += !is_empty(pixel);
    result.push_back(pixel);
  }
  charge(work, layers_, merging_.rules, merging_.storage, counters);
  return result;
}

}  // namespace beampipe
