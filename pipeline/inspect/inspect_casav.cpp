#include "pipeline/inspect/inspect_casav.h"

#include "pipeline/inspect/linear_weights.h"
#include "stages/beam/compose_layers.h"
#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"
#include "stages/raster/bin_sort.h"

namespace beampipe {
namespace {

glm::vec3 color_of(const Aggregate& aggregate) { return {aggregate.color[0], aggregate.color[1], aggregate.color[2]}; }

// What the pixel is after the first fragments. `count`: how many of those in `order` it has seen.
HeldSurface surface_of(const Aggregate& aggregate, const std::vector<std::uint32_t>& order, std::size_t count) {
  HeldSurface held{{order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count)}};
  held.positions = static_cast<std::uint32_t>(std::popcount(aggregate.mask));
  held.area = aggregate.alpha;
  if (aggregate.alpha > 0) held.color = color_of(aggregate) / aggregate.alpha;
  return held;
}

WideMask mask_of(std::uint32_t word) {
  WideMask mask;
  mask.words[0] = word;
  return mask;
}

// The fragments in the order in which they are composed, shaded, and their places in the history.
struct CasavFragments {
  std::vector<Fragment> fragments;
  std::vector<std::uint32_t> places;

  void add(const InspectedPixel& pixel, const Pair& pair, const BeamFragmentOptions& options, PixelHistory& history) {
    const std::optional<Fragment> fragment = pixel.arrive(pair, options, history);
    if (!fragment) return;
    fragments.push_back(*fragment);
    places.push_back(static_cast<std::uint32_t>(history.fragments.size() - 1));
  }
};

// Adds the terms, what became of each fragment, and the picture's pixel.
void finish(const InspectedPixel& pixel, const CasavFragments& of, const std::vector<double>& weights,
            const Aggregate& aggregate, PixelHistory& history) {
  for (std::size_t k = 0; k < of.fragments.size(); ++k) {
    const Fragment& fragment = of.fragments[k];
    HistoryFragment& noted = history.fragments[of.places[k]];
    noted.fate = weights[k] > 0 ? Fate::composed : Fate::hidden;
    if (weights[k] > 0)
      history.terms.push_back({of.places[k], weights[k], glm::dvec3(fragment.color) / double{fragment.alpha}});
  }
  StageCounters unused;
  const glm::vec3& background = pixel.context.frame.background;
  history.terms.push_back({kNobody, 1.0 - double{aggregate.alpha}, background});
  history.pixel = resolve(pixel_colors({aggregate}), background, 0, unused).front();
}

}  // namespace

PixelHistory inspect_casav(const InspectedPixel& pixel, const CasavInspection& how) {
  PixelHistory history = pixel.history(
      how.sort == SortKey::centroid ? "near to far, by the depth at the centroid" : "near to far, by the nearest depth",
      how.fragments.positions);
  StageCounters unused;
  CasavFragments arrived;
  for (const Pair& pair : pixel.pairs(pixel.list)) arrived.add(pixel, pair, how.fragments, history);
  shade(pixel.shader(), arrived.fragments, unused);
  // The history has them from near to far, and before them what is no fragment.
  const ABuffer sorted = a_buffer(sort_records(arrived.fragments, how.sort), 1, 0, 0, unused);
  std::vector<HistoryFragment> noted;
  for (const HistoryFragment& each : history.fragments)
    if (each.fate == Fate::no_area || each.fate == Fate::cut_out) noted.push_back(each);
  CasavFragments of;
  for (const std::uint32_t record : sorted.records) {
    of.fragments.push_back(arrived.fragments[record]);
    of.places.push_back(static_cast<std::uint32_t>(noted.size()));
    noted.push_back(history.fragments[arrived.places[record]]);
  }
  history.fragments = noted;

  ABuffer first{{0, 0}, {}};  // the first fragments, near to far
  Aggregate aggregate = kEmptyAggregate;
  for (std::size_t k = 0; k < of.fragments.size(); ++k) {
    HistoryStep step{HistoryStep::Kind::composed, of.places[k]};
    step.before = {surface_of(aggregate, of.places, k)};
    const std::uint32_t mask_before = aggregate.mask;
    first.records.push_back(static_cast<std::uint32_t>(k));
    ++first.first[1];
    aggregate = how.compose(of.fragments, first, how.storage);
    take_positions(mask_of(aggregate.mask & ~mask_before), of.places[k], history);
    step.after = surface_of(aggregate, of.places, k + 1);
    history.steps.push_back(step);
    note_missed(of.places[k], history);
  }
  const std::vector<double> weights = linear_weights(of.fragments, [&](const std::vector<Fragment>& fragments) {
    return color_of(how.compose(fragments, first, CasavStorage::float32));
  });
  finish(pixel, of, weights, aggregate, history);
  return history;
}

PixelHistory inspect_casav_layers(const InspectedPixel& pixel, const CasavLayersInspection& how) {
  PixelHistory history = pixel.history(
      how.sorts ? "near to far, by the nearest depth in the bin" : "order of the trace", how.fragments.positions);
  StageCounters unused;
  const TriangleList list =
      how.sorts ? bin_sort(pixel.context.triangles, pixel.list, pixel.bin, unused).triangles : pixel.list;
  CasavFragments of;
  for (const Pair& pair : pixel.pairs(list)) of.add(pixel, pair, how.fragments, history);
  shade(pixel.shader(), of.fragments, unused);
  const auto composed = [&](AggregateLayers& layers) {
    return layers.finish(how.positions, how.rules, unused).front();
  };
  AggregateLayers layers(1, how.layers, how.storage);
  Aggregate aggregate = kEmptyAggregate;
  std::vector<float> merges(1);
  for (std::size_t k = 0; k < of.fragments.size(); ++k) {
    HistoryStep step{HistoryStep::Kind::composed, of.places[k]};
    step.before = {surface_of(aggregate, of.places, k)};
    const std::uint32_t mask_before = aggregate.mask;
    layers.add({of.fragments[k]}, how.positions, how.rules, unused, merges);
    aggregate = composed(layers);
    take_positions(mask_of(aggregate.mask & ~mask_before), of.places[k], history);
    step.after = surface_of(aggregate, of.places, k + 1);
    history.steps.push_back(step);
    note_missed(of.places[k], history);
  }
  const std::vector<double> weights = linear_weights(of.fragments, [&](const std::vector<Fragment>& fragments) {
    AggregateLayers unpacked(1, how.layers, CasavStorage::float32);
    unpacked.add(fragments, how.positions, how.rules, unused, merges);
    return color_of(composed(unpacked));
  });
  finish(pixel, of, weights, aggregate, history);
  return history;
}

}  // namespace beampipe
