#include "pipeline/inspect/inspect_owners.h"

#include <map>

#include "stages/picture/resolve.h"
#include "stages/raster/bin_sort.h"

namespace beampipe {
namespace {

// What the stages have recorded of the pixel, as a history.
class OwnerHistory {
 public:
  OwnerHistory(const OwnerWeights& recorded, PixelHistory& history) : recorded_(recorded), history_(history) {}

  // The fragment in the history with this number in the bin's list.
  void add_fragment(std::uint32_t number) {
    fragment_of_[number] = static_cast<std::uint32_t>(history_.fragments.size() - 1);
  }

  // Adds what was recorded since the last call. `fragment`: the one that came, or kNobody.
  void add_steps(std::uint32_t fragment) {
    for (; merges_ < recorded_.merges(0).size(); ++merges_) {
      const OwnerWeights::Merge& merge = recorded_.merges(0)[merges_];
      HistoryStep step{HistoryStep::Kind::merged, fragment};
      step.before = {surface(merge.one, merge.owned_by_one, merge.color_of_one),
                     surface(merge.other, merge.owned_by_other, merge.color_of_other)};
      step.after = surface(merge.one, merge.owned_by_one | merge.owned_by_other,
                           merge.part * merge.color_of_one + (1 - merge.part) * merge.color_of_other);
      const auto& others = step.before[1].fragments;
      step.after->fragments.insert(step.after->fragments.end(), others.begin(), others.end());
      history_.steps.push_back(step);
    }
    for (; finals_ < recorded_.finals(0).size(); ++finals_) {
      const OwnerWeights::Final& final_one = recorded_.finals(0)[finals_];
      if (final_one.speck) continue;
      HistoryStep step{HistoryStep::Kind::settled, fragment};
      step.before = {surface(final_one.parts, final_one.owned, final_one.color)};
      step.before[0].area = final_one.area;
      history_.steps.push_back(step);
    }
  }

  bool has_new_speck() const { return finals_ < recorded_.finals(0).size() && recorded_.finals(0).back().speck; }

  // The positions of a fragment that became a part of another owner at once.
  WideMask merged_positions(std::uint32_t number) const {
    for (std::size_t i = merges_; i < recorded_.merges(0).size(); ++i) {
      const OwnerWeights::Merge& merge = recorded_.merges(0)[i];
      if (merge.one.front().number == number && merge.one.size() == 1) return merge.owned_by_one;
      if (merge.other.front().number == number && merge.other.size() == 1) return merge.owned_by_other;
    }
    return {};
  }

  void add_terms(const glm::vec3& background, float area) {
    for (const OwnerWeights::Weight& each : recorded_.of_pixel(0))
      history_.terms.push_back({fragment_of_.at(each.number), each.weight, each.color});
    history_.terms.push_back({kNobody, 1.0 - double{area}, background});
    if (const OwnerWeights::Estimates* found = recorded_.estimates(0)) {
      const auto packed = [](const PixelColor& color) { return glm::dvec4(color.color, color.alpha); };
      history_.estimates = {packed(found->analytic), packed(found->counted), packed(found->result)};
    }
  }

 private:
  HeldSurface surface(const std::vector<OwnerWeights::Part>& parts, const WideMask& owned,
                      const glm::vec3& color) const {
    HeldSurface held;
    for (const OwnerWeights::Part& part : parts) held.fragments.push_back(fragment_of_.at(part.number));
    held.positions = static_cast<std::uint32_t>(owned.count());
    held.area = held.positions / static_cast<double>(history_.positions.size());
    held.color = color;
    return held;
  }

  const OwnerWeights& recorded_;
  PixelHistory& history_;
  std::map<std::uint32_t, std::uint32_t> fragment_of_;  // by number in the list
  std::size_t merges_ = 0, finals_ = 0;                 // of those recorded, how many are in the history
};

}  // namespace

template <std::size_t Words, std::size_t Slots>
PixelHistory inspect_owners(const InspectedPixel& pixel, OwnerOrder order, OwnerPlace shade_at) {
  constexpr int kPositions = 32 * Words;
  const bool sorts = order == OwnerOrder::near_first;
  StageCounters unused;
  OrderedList ordered{pixel.list, {}};
  if (sorts) ordered = bin_sort(pixel.context.triangles, pixel.list, pixel.bin, unused);
  const TriangleList& list = ordered.triangles;
  const PositionSet& positions = cell_positions(kPositions);
  const PositionGrid grid(kPositions);
  const BeamFragmentOptions options = grid_options(grid, 0);
  OwnerWeights recorded(1);
  const OwnersBin bin{pixel.context.triangles,
                      list,
                      sorts ? &ordered.watermarks : nullptr,
                      pixel.tile,
                      positions,
                      pixel.shader(),
                      false,
                      &recorded,
                      shade_at};
  OpenPixels<Words, Slots> pixels(1);
  ClosedDepth closed(pixel.tile);
  OwnersResult result;
  PixelHistory history =
      pixel.history(sorts ? "near to far, by the nearest depth in the bin" : "order of the trace", positions.patterns);
  OwnerHistory steps(recorded, history);
  std::uint32_t number = 0;
  for (const Pair& pair : pixel.pairs(list)) {
    while (list[number] != pair.triangle) ++number;
    const std::optional<Fragment> fragment = pixel.arrive(pair, options, history);
    if (!fragment) continue;
    const auto index = static_cast<std::uint32_t>(history.fragments.size() - 1);
    steps.add_fragment(number);
    std::vector<float> composed(1), merged(1);
    compose_owners(bin, {*fragment}, number, unused, pixels, closed, {composed, merged}, result);
    HistoryFragment& noted = history.fragments[index];
    if (composed[0] == 0) {
      noted.fate = Fate::closed_off;
    } else if (fragment->mask.none()) {
      noted.fate = steps.has_new_speck() ? Fate::speck : Fate::speck_hidden;
    } else {
      WideMask taken = steps.merged_positions(number);
      const OpenPixel<Words, Slots>& state = pixels.pixels[0];
      for (std::size_t k = 0; k < Slots && taken.none(); ++k)
        if (!state.slots[k].is_free() && !state.slots[k].is_merged() && state.slots[k].triangle() == number)
          taken = state.states.positions_in(OpenPixel<Words, Slots>::owned_by(k));
      take_positions(taken, index, history);
      noted.fate = taken.none() ? Fate::hidden : Fate::owner;
    }
    note_missed(index, history);
    steps.add_steps(index);
  }
  const PixelColor color = finish_owners(bin, unused, pixels, result).front();
  steps.add_steps(kNobody);
  history.pixel = resolve(std::vector{color}, pixel.context.frame.background, 0, unused).front();
  steps.add_terms(pixel.context.frame.background, color.alpha);
  return history;
}

#define BEAMPIPE_INSPECT(words, slots) \
  template PixelHistory inspect_owners<words, slots>(const InspectedPixel&, OwnerOrder, OwnerPlace);
BEAMPIPE_OPEN_PIXELS(BEAMPIPE_INSPECT)
#undef BEAMPIPE_INSPECT

}  // namespace beampipe
