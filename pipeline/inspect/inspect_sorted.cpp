#include "pipeline/inspect/inspect_sorted.h"

#include <algorithm>

#include "simd/window_owners.h"
#include "stages/beam/a_buffer.h"
#include "stages/beam/compose_beam.h"
#include "stages/beam/windows.h"
#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"

namespace beampipe {
namespace {

template <std::size_t Words, class Channel>
WideMask mask_of(const StoredAggregate<Words, Channel>& aggregate) {
  WideMask mask;
  std::memcpy(mask.words.data(), aggregate.mask, sizeof aggregate.mask);
  return mask;
}

// The surface that an aggregate is: its fragments are all that own positions so far.
template <std::size_t Words, class Channel>
HeldSurface surface_of(const StoredAggregate<Words, Channel>& aggregate, const PixelHistory& history) {
  HeldSurface held;
  for (const HistoryTerm& term : history.terms)
    if (term.weight > 0) held.fragments.push_back(term.fragment);
  held.positions = static_cast<std::uint32_t>(mask_of(aggregate).count());
  held.area = aggregate.area;
  const float area = std::max<float>(aggregate.area, 1e-12f);
  held.color = glm::vec3(aggregate.color[0], aggregate.color[1], aggregate.color[2]) / area;
  return held;
}

// The fragments of a window become part of the history. `taken`: positions of earlier windows.
void add_window(const std::vector<Fragment>& fragments, const std::vector<std::uint32_t>& places,
                const std::vector<float>& areas, const WideMask& taken, const PositionSet& positions,
                PixelHistory& history) {
  std::vector<MaskedPlane> planes;
  for (const Fragment& fragment : fragments) planes.push_back({fragment.mask, corner_plane(fragment.plane)});
  std::vector<Ownership> owned(fragments.size());
  window_owners(planes.data(), planes.size(), taken, positions.patterns.data(), owned.data());
  for (std::size_t i = 0; i < fragments.size(); ++i) take_positions(owned[i].owned, places[i], history);
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    HistoryFragment& noted = history.fragments[places[i]];
    note_missed(places[i], history);
    noted.fate = owned[i].covered == 0  ? areas[i] > 0 ? Fate::speck : Fate::speck_hidden
                 : owned[i].visible > 0 ? Fate::owner
                                        : Fate::hidden;
    if (areas[i] != 0)
      history.terms.push_back({places[i], areas[i], glm::dvec3(fragments[i].color) / double{fragments[i].alpha}});
  }
}

}  // namespace

template <std::size_t Words, class Channel>
PixelHistory inspect_sorted(const InspectedPixel& pixel) {
  constexpr int kPositions = 32 * Words;
  StageCounters unused;
  const PositionSet& positions = cell_positions(kPositions);
  const PositionGrid grid(kPositions);
  const BeamFragmentOptions options = grid_options(grid, 0);
  PixelHistory history = pixel.history("near to far, in windows whose depths overlap", positions.patterns);
  ClosedDepth closed(pixel.quad);
  const std::vector<Pair> pairs = pixel.pairs(pixel.list, &closed, Closing::by_raster);
  const ABuffer lists = a_buffer(sort_records(pairs, pixel.tile), 1, 0, 0, unused);
  std::vector<StoredAggregate<Words, Channel>> pixels(1);
  Windows windows(pairs, lists, 0);
  std::vector<Pair> window, whole;
  while (windows.next([&](std::uint32_t) { return !is_closed(pixels[0]); }, unused, window, whole)) {
    HistoryStep step{HistoryStep::Kind::composed};
    step.before = {surface_of(pixels[0], history)};
    std::vector<Fragment> fragments;
    std::vector<std::uint32_t> places;  // in the history
    for (const Pair& pair : window) {
      const std::optional<Fragment> fragment = pixel.arrive(pair, options, history);
      if (!fragment) continue;
      fragments.push_back(*fragment);
      places.push_back(static_cast<std::uint32_t>(history.fragments.size() - 1));
    }
    shade_visible(pixel.shader(), fragments, unused);
    const WideMask taken = mask_of(pixels[0]);
    std::vector<float> areas;
    compose_window(fragments, positions, unused, pixels, areas);
    add_window(fragments, places, areas, taken, positions, history);
    compose_whole(whole, pixel.tile, pixel.shader(), unused, pixels);
    for (const Pair& pair : whole) {
      pixel.arrive(pair, options, history);
      const auto place = static_cast<std::uint32_t>(history.fragments.size() - 1);
      take_positions(first_words(Words), place, history);
      history.fragments[place].fate = Fate::owner;
      history.terms.push_back({place, 1.0, pixel.shader().color(pair.triangle, 0, 0.5f, 0.5f)});
    }
    step.after_fragment = static_cast<std::uint32_t>(history.fragments.size() - 1);
    step.after = surface_of(pixels[0], history);
    history.steps.push_back(step);
  }
  for (const Pair& pair : pixel.pairs(pixel.list)) {  // what no window had
    const auto is_known = [&](const HistoryFragment& each) { return each.triangle == pair.triangle; };
    if (std::any_of(history.fragments.begin(), history.fragments.end(), is_known)) continue;
    if (pixel.arrive(pair, options, history)) {
      history.fragments.back().fate = Fate::closed_off;
      note_missed(static_cast<std::uint32_t>(history.fragments.size() - 1), history);
    }
  }
  if (is_closed(pixels[0])) {  // the areas of a closed pixel are scaled so that their sum is 1
    double sum = 0;
    for (const HistoryTerm& term : history.terms) sum += term.weight;
    for (HistoryTerm& term : history.terms) term.weight /= sum;
  }
  const glm::vec3& background = pixel.context.frame.background;
  history.terms.push_back({kNobody, 1.0 - double{pixels[0].area}, background});
  history.pixel = resolve(composed_colors(pixels), background, 0, unused).front();
  return history;
}

#define BEAMPIPE_INSPECT(words, channel) template PixelHistory inspect_sorted<words, channel>(const InspectedPixel&);
BEAMPIPE_STORED_AGGREGATES(BEAMPIPE_INSPECT)
#undef BEAMPIPE_INSPECT

}  // namespace beampipe
