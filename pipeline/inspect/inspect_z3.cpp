#include "pipeline/inspect/inspect_z3.h"

#include <map>

#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"

namespace beampipe {
namespace {

// A layer with the fragments that it came from, and the part of its colour that each has.
struct KnownLayer {
  WideMask positions;
  std::map<std::uint32_t, double> parts;
};

// Replays a pixel one fragment at a time. A layer does not say which fragments it came from; its positions before and
// after do.
template <std::size_t Words, std::size_t Layers>
class LayerHistory {
 public:
  // `colors`: of the fragments in the history, as layers store them.
  LayerHistory(const PositionSet& positions, const std::vector<glm::vec3>& colors, PixelHistory& history)
      : positions_(positions), colors_(colors), history_(history), pixels_(1) {}

  void add(const Fragment& fragment, std::uint32_t place) {
    WideMask claimed = fragment.mask;
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      layers_[k].positions = kept_by(k, fragment);
      claimed = without(claimed, layers_[k].positions);
    }
    std::erase_if(layers_, [](const KnownLayer& layer) { return layer.positions.none(); });
    const bool merged = compose(fragment, pixels_);
    take_positions(claimed, place, history_);
    note_missed(place, history_);
    history_.fragments[place].fate = fragment.mask.none() ? Fate::speck_hidden
                                     : claimed.none()     ? Fate::hidden
                                                          : Fate::owner;
    if (claimed.none()) return;
    layers_.push_back({claimed, {{place, 1.0}}});
    if (merged) merge_two(place);
    sort_as_stored();
  }

  void add_terms() {
    for (const KnownLayer& layer : layers_)
      for (const auto& [fragment, part] : layer.parts)
        history_.terms.push_back({fragment, layer.positions.count() / kPositions * part, colors_[fragment]});
  }

  const std::vector<Z3Pixel<Words, Layers>>& pixels() const { return pixels_; }

 private:
  static constexpr double kPositions = 32.0 * Words;

  // Returns whether two layers were merged.
  bool compose(const Fragment& fragment, std::vector<Z3Pixel<Words, Layers>>& pixels) const {
    StageCounters unused;
    std::vector<float> merges(1);
    compose_z3({fragment}, positions_, unused, pixels, merges);
    return merges[0] > 0;
  }

  // Which positions does layer k keep when the fragment comes? The stage is asked with a pixel that has only this
  // layer, which is black, and a white fragment.
  WideMask kept_by(std::size_t k, const Fragment& fragment) const {
    std::vector<Z3Pixel<Words, Layers>> alone(1);
    alone[0] = {};
    alone[0].layers[0] = pixels_[0].layers[k];
    for (HalfBits& channel : alone[0].layers[0].color) channel = HalfBits(0.0f);
    auto owners = alone[0].owners;
    owners.put(layers_[k].positions, 1);
    alone[0].owners = owners;
    Fragment white = fragment;
    white.color = glm::vec3(fragment.alpha);
    compose(white, alone);
    owners = alone[0].owners;
    for (std::uint32_t layer = 0; layer < 2; ++layer)
      if (alone[0].layers[layer].color[0] < 0.5f) return owners.positions_in(layer + 1) & layers_[k].positions;
    return {};
  }

  // The stage has merged the two layers whose positions are together in one.
  void merge_two(std::uint32_t place) {
    const auto owners = pixels_[0].owners;
    for (std::size_t j = 1; j < layers_.size(); ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        const WideMask both = layers_[i].positions | layers_[j].positions;
        bool found = false;
        for (std::uint32_t state = 1; state <= Layers; ++state) found = found || owners.positions_in(state) == both;
        if (!found) continue;
        HistoryStep step{HistoryStep::Kind::merged, place};
        step.before = {surface(layers_[i]), surface(layers_[j])};
        const double part = double(layers_[i].positions.count()) / both.count();
        KnownLayer merged{both, {}};
        for (const auto& [fragment, of] : layers_[i].parts) merged.parts[fragment] += part * of;
        for (const auto& [fragment, of] : layers_[j].parts) merged.parts[fragment] += (1 - part) * of;
        layers_[i] = merged;
        layers_.erase(layers_.begin() + static_cast<std::ptrdiff_t>(j));
        step.after = surface(merged);
        history_.steps.push_back(step);
        return;
      }
    }
  }

  HeldSurface surface(const KnownLayer& layer) const {
    HeldSurface held;
    for (const auto& [fragment, part] : layer.parts) {
      held.fragments.push_back(fragment);
      held.color += static_cast<float>(part) * colors_[fragment];
    }
    held.positions = static_cast<std::uint32_t>(layer.positions.count());
    held.area = held.positions / kPositions;
    return held;
  }

  // From here on layers_[k] is layer k of the pixel.
  void sort_as_stored() {
    const auto owners = pixels_[0].owners;
    std::vector<KnownLayer> sorted;
    for (std::uint32_t state = 1; state <= Layers; ++state)
      for (const KnownLayer& layer : layers_)
        if (layer.positions == owners.positions_in(state)) sorted.push_back(layer);
    layers_ = sorted;
  }

  const PositionSet& positions_;
  const std::vector<glm::vec3>& colors_;
  PixelHistory& history_;
  std::vector<Z3Pixel<Words, Layers>> pixels_;
  std::vector<KnownLayer> layers_;
};

}  // namespace

template <std::size_t Words, std::size_t Layers>
PixelHistory inspect_z3(const InspectedPixel& pixel) {
  constexpr int kPositions = 32 * Words;
  const PositionSet& positions = cell_positions(kPositions);
  const PositionGrid grid(kPositions);
  const BeamFragmentOptions options = grid_options(grid, 0);
  StageCounters unused;
  PixelHistory history = pixel.history("order of the trace", positions.patterns);
  std::vector<Fragment> fragments;
  std::vector<std::uint32_t> places;
  for (const Pair& pair : pixel.pairs(pixel.list)) {
    const std::optional<Fragment> fragment = pixel.arrive(pair, options, history);
    if (!fragment) continue;
    fragments.push_back(*fragment);
    places.push_back(static_cast<std::uint32_t>(history.fragments.size() - 1));
  }
  shade(pixel.shader(), fragments, unused);
  std::vector<glm::vec3> colors(history.fragments.size());
  for (std::size_t i = 0; i < fragments.size(); ++i)
    for (int c = 0; c < 3; ++c) colors[places[i]][c] = HalfBits(fragments[i].color[c] / fragments[i].alpha);
  LayerHistory<Words, Layers> layers(positions, colors, history);
  for (std::size_t i = 0; i < fragments.size(); ++i) layers.add(fragments[i], places[i]);
  layers.add_terms();
  const PixelColor color = z3_colors(layers.pixels()).front();
  const glm::vec3& background = pixel.context.frame.background;
  history.terms.push_back({kNobody, 1.0 - double{color.alpha}, background});
  history.pixel = resolve(std::vector{color}, background, 0, unused).front();
  return history;
}

#define BEAMPIPE_INSPECT(words, layers) template PixelHistory inspect_z3<words, layers>(const InspectedPixel&);
BEAMPIPE_Z3_PIXELS(BEAMPIPE_INSPECT)
#undef BEAMPIPE_INSPECT

}  // namespace beampipe
