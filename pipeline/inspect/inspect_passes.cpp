#include "pipeline/inspect/inspect_passes.h"

#include <algorithm>
#include <functional>
#include <map>

#include "pipeline/inspect/linear_weights.h"
#include "pipeline/units/raster_units.h"
#include "stages/beam/claim.h"
#include "stages/beam/settle.h"
#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"

namespace beampipe {
namespace {

// Sends the pixel's fragments through the passes.
template <std::size_t Words, std::size_t Layers>
class PassReplay {
 public:
  using Pixel = OwnerPixel<Words, Layers>;

  PassReplay(const InspectedPixel& pixel, int passes) : pixel_(pixel), passes_(passes) {}

  // Returns the settled pixel. `claimed(pass, pair, before, after)` is called after each fragment, and `settled(owners,
  // before)` before each settling, with shaded fragments, which it may change.
  template <class Claimed, class Settled>
  PixelColor run(Claimed&& claimed, Settled&& settled) const {
    std::vector<Pixel> pixels(1, cleared_pixel<Words, Layers>());
    ClosedDepth closed(pixel_.quad);
    StageCounters unused;
    for (int pass = 1; is_unfinished(pixels[0]); ++pass) {
      for_each_batch(pixel_.list, [&](const TriangleList& batch) {
        for (const Pair& pair : pixel_.pairs(batch, &closed, Closing::by_raster)) {
          const std::vector<Fragment> fragments = fragments_of({pair});
          const Pixel before = pixels[0];
          claim(pixel_.context.triangles, fragments, pixel_.tile, positions_, unused, pixels);
          claimed(pass, pair, fragments, before, pixels[0]);
        }
      });
      std::vector<Fragment> owned = fragments_of(owners(pixel_.context.triangles, pixels, pixel_.tile, unused));
      shade_visible(pixel_.shader(), owned, unused);
      settled(owned, pixels[0]);
      settle(owned, pass == passes_, unused, pixels);
      close_finished(pixels, pixel_.tile, closed);
    }
    return settled_colors(pixels).front();
  }

  const BeamFragmentOptions& options() const { return options_; }
  const PositionSet& positions() const { return positions_; }

 private:
  std::vector<Fragment> fragments_of(const std::vector<Pair>& pairs) const {
    std::vector<Fragment> fragments;
    PixelHistory unused = pixel_.history("", positions_.patterns);
    for (const Pair& pair : pairs)
      if (const std::optional<Fragment> fragment = pixel_.arrive(pair, options_, unused))
        fragments.push_back(*fragment);
    return fragments;
  }

  const InspectedPixel& pixel_;
  int passes_;
  const PositionSet& positions_ = cell_positions(32 * Words);
  PositionGrid grid_ = PositionGrid(32 * Words);
  BeamFragmentOptions options_ = grid_options(grid_, 0);
};

// Whose each position is: the triangle of a layer, or kNobody.
template <std::size_t Words, std::size_t Layers>
std::vector<std::uint32_t> triangles_in(const OwnerPixel<Words, Layers>& pixel) {
  std::vector<std::uint32_t> triangles(32 * Words, kNobody);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t state = pixel.states.at(i);
    if (state >= OwnerPixel<Words, Layers>::kFirstLayer && state < OwnerPixel<Words, Layers>::kDeferred)
      triangles[i] = pixel.triangle(state - OwnerPixel<Words, Layers>::kFirstLayer);
  }
  return triangles;
}

}  // namespace

template <std::size_t Words, std::size_t Layers>
PixelHistory inspect_passes(const InspectedPixel& pixel, int passes) {
  using Pixel = OwnerPixel<Words, Layers>;
  const PassReplay<Words, Layers> replay(pixel, passes);
  PixelHistory history = pixel.history("order of the trace, again in each pass", replay.positions().patterns);
  std::map<std::uint32_t, std::uint32_t> place_of;  // in the history, by triangle
  std::map<std::uint32_t, glm::dvec3> colors;       // by triangle; of those that were settled
  for (const Pair& pair : pixel.pairs(pixel.list)) {
    if (pixel.arrive(pair, replay.options(), history)) history.fragments.back().fate = Fate::closed_off;
    place_of[pair.triangle] = static_cast<std::uint32_t>(history.fragments.size() - 1);
  }
  int last_pass = 1;
  const auto note_claim = [&](int pass, const Pair& pair, const std::vector<Fragment>& fragments, const Pixel& before,
                              const Pixel& after) {
    const std::uint32_t place = place_of.at(pair.triangle);
    if (pass != last_pass) history.steps.push_back({HistoryStep::Kind::pass, place});
    last_pass = pass;
    if (fragments.empty()) return;
    HistoryFragment& noted = history.fragments[place];
    if (fragments[0].mask.none()) {
      if (noted.fate != Fate::speck) noted.fate = before.owner[0] == after.owner[0] ? Fate::speck_hidden : Fate::speck;
      return;
    }
    if (noted.fate == Fate::closed_off) noted.fate = Fate::hidden;
    const std::vector<std::uint32_t> triangles_before = triangles_in(before), triangles = triangles_in(after);
    std::map<std::uint32_t, std::uint32_t> dropped;  // positions by triangle
    WideMask taken;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint32_t earlier = triangles_before[i];
      if (triangles[i] == pair.triangle && earlier != pair.triangle) taken.set(i);
      if (earlier != kNobody && after.states.at(i) == Pixel::kDeferred) ++dropped[earlier];
    }
    for (const auto& [triangle, positions] : dropped) {
      HistoryStep step{HistoryStep::Kind::dropped, place};
      step.before = {HeldSurface{{place_of.at(triangle)}, positions, positions / (32.0 * Words)}};
      history.steps.push_back(step);
    }
    if (!taken.none()) noted.fate = Fate::owner;
    take_positions(taken, place, history);
  };
  const auto note_settling = [&](const std::vector<Fragment>& owned, const Pixel& before) {
    const std::vector<std::uint32_t> triangles = triangles_in(before);
    for (const Fragment& fragment : owned) {
      HistoryStep step{HistoryStep::Kind::settled};
      HeldSurface& surface = step.before.emplace_back();
      surface.fragments = {place_of.at(fragment.triangle)};
      surface.positions = static_cast<std::uint32_t>(std::count(triangles.begin(), triangles.end(), fragment.triangle));
      surface.area = surface.positions / (32.0 * Words);
      surface.color = fragment.color / fragment.alpha;
      history.steps.push_back(step);
      colors[fragment.triangle] = glm::dvec3(fragment.color) / double{fragment.alpha};
    }
  };
  const PixelColor color = replay.run(note_claim, note_settling);
  // A fragment comes again in each pass, so what counts is who has its positions in the end.
  for (std::uint32_t place = 0; place < history.fragments.size(); ++place) {
    history.fragments[place].lost.clear();
    note_missed(place, history);
  }

  // Colours decide nothing, and the pixel is linear in them, up to the rounding of its mean colour.
  const auto ignore_claim = [](int, const Pair&, const std::vector<Fragment>&, const Pixel&, const Pixel&) {};
  std::vector<Fragment> of_triangles;
  for (const auto& [triangle, unused] : colors) {
    Fragment& fragment = of_triangles.emplace_back();
    fragment.triangle = triangle, fragment.alpha = 1.0f;
  }
  const std::vector<double> weights = linear_weights(of_triangles, [&](const std::vector<Fragment>& fragments) {
    const auto recolor = [&](std::vector<Fragment>& owned, const Pixel&) {
      for (Fragment& each : owned)
        for (const Fragment& colored : fragments)
          if (colored.triangle == each.triangle) each.color = each.alpha * colored.color;
    };
    return replay.run(ignore_claim, recolor).color;
  });
  for (std::size_t i = 0; i < weights.size(); ++i)
    history.terms.push_back({place_of.at(of_triangles[i].triangle), weights[i], colors.at(of_triangles[i].triangle)});
  StageCounters unused;
  const glm::vec3& background = pixel.context.frame.background;
  history.terms.push_back({kNobody, 1.0 - double{color.alpha}, background});
  history.pixel = resolve(std::vector{color}, background, 0, unused).front();
  return history;
}

#define BEAMPIPE_INSPECT(words, layers) template PixelHistory inspect_passes<words, layers>(const InspectedPixel&, int);
BEAMPIPE_OWNER_PIXELS(BEAMPIPE_INSPECT)
#undef BEAMPIPE_INSPECT

}  // namespace beampipe
