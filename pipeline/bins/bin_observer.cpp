#include "pipeline/bins/bin_observer.h"

#include <algorithm>
#include <functional>

#include "pipeline/bins/render_bins.h"
#include "stages/beam/alpha_mask.h"
#include "stages/beam/beam_fragment.h"
#include "stages/raster/conservative_raster.h"

namespace beampipe {
namespace {

glm::vec2 place_in_pixel(const SamplePattern& pattern, std::size_t s) {
  return glm::vec2(pattern.x[s], pattern.y[s]) * (1.0f / kSubpixelUnits);
}

std::vector<glm::vec2> places_of(const std::vector<SamplePattern>& patterns) {
  std::vector<glm::vec2> places;
  for (const SamplePattern& pattern : patterns)
    for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s)
      places.push_back(place_in_pixel(pattern, s));
  return places;
}

std::vector<glm::vec2> places_of(const Sampling& sampling) {
  std::vector<glm::vec2> places;
  for (std::int32_t row = 0; row < sampling.grid.rows; ++row)
    for (std::int32_t column = 0; column < sampling.grid.columns; ++column)
      for (const glm::vec2& place : places_of(std::vector{sampling.pattern}))
        places.push_back(glm::vec2(column, row) / glm::vec2(sampling.grid.columns, sampling.grid.rows) + place);
  return places;
}

std::vector<SamplePattern> patterns_of(const BeamFragmentOptions& options) {
  return options.grid ? cell_patterns(options.grid->count()) : options.positions;
}

bool is_in(const Tile& pixel, const SampleFragment& fragment, const CellGrid& grid) {
  return grid.pixel_x(fragment.x) == pixel.x0 && grid.pixel_y(fragment.y) == pixel.y0;
}

}  // namespace

BinObserver::BinObserver(const FrameContext& context, const Tile& tile)
    : context_(context), tile_(tile), pixels_(tile.pixels()) {
  if (context.sinks.weights)
    for (auto& pixel : pixels_) pixel = std::make_unique<PixelObserver>();
  if (!context.sinks.histories) return;
  for (const PixelAddress& at : *context.run.pixels)
    if (tile.holds(at)) pixels_[tile.index(at)] = std::make_unique<PixelObserver>();
}

void BinObserver::add_positions(const std::vector<glm::vec2>& positions) {
  positions_ += positions.size();
  for (const auto& pixel : pixels_)
    if (pixel) pixel->add_positions(positions);
}

void BinObserver::has_masks(const BeamFragmentOptions& options) {
  masks_ = &options;
  if (options.mask != MaskSource::none) add_positions(places_of(patterns_of(options)));
}

std::size_t BinObserver::first_sample(const Sampling& sampling) {
  for (const Round& round : rounds_)
    if (round.sampling == &sampling) return round.first;
  rounds_.push_back({&sampling, positions_});
  add_positions(places_of(sampling));
  return rounds_.back().first;
}

void BinObserver::has_fragments(const Sampling& sampling, const std::vector<SampleFragment>& before_alpha,
                                const std::vector<SampleFragment>& fragments) {
  first_sample(sampling);
  const auto is_same = [&](const Round& round) { return round.sampling == &sampling; };
  Round& round = *std::find_if(rounds_.begin(), rounds_.end(), is_same);
  const auto is_observed = [&](const SampleFragment& fragment) {
    return pixels_[tile_.index(sampling.grid.pixel_x(fragment.x), sampling.grid.pixel_y(fragment.y))] != nullptr;
  };
  std::ranges::copy_if(before_alpha, std::back_inserter(round.before_alpha), is_observed);
  std::ranges::copy_if(fragments, std::back_inserter(round.fragments), is_observed);
}

void BinObserver::finish(const TriangleList& list, const std::string& order, const std::vector<glm::vec4>& picture) {
  const FrameSinks& sinks = context_.sinks;
  if (sinks.weights) {
    std::vector<PixelWeights> weights;
    for (const auto& pixel : pixels_) weights.push_back(pixel->history.weights());
    copy_to_frame(weights, tile_, context_.frame, *sinks.weights);
  }
  for (std::size_t i = 0; sinks.histories && i < context_.run.pixels->size(); ++i) {
    const PixelAddress at = (*context_.run.pixels)[i];
    if (!tile_.holds(at)) continue;
    const std::size_t index = tile_.index(at);
    PixelObserver& observer = *pixels_[index];
    const auto x = static_cast<std::int32_t>(at.x), y = static_cast<std::int32_t>(at.y);
    complete(list, {x, y, x + 1, y + 1}, observer);
    observer.history.at = at, observer.history.order = order, observer.history.has_samples = masks_ == nullptr;
    observer.history.pixel = picture[index];
    (*sinks.histories)[i] = observer.history;
  }
}

// Adds the triangles that touch the pixel and that no stage saw there, and what is known of all of them.
void BinObserver::complete(const TriangleList& list, const Tile& pixel, PixelObserver& observer) const {
  for (const Round& round : rounds_) {
    const CellGrid& grid = round.sampling->grid;
    const auto samples = static_cast<std::size_t>(round.sampling->pattern.count);
    for (const SampleFragment& each : round.fragments)
      if (is_in(pixel, each, grid))
        observer.would_cover(
            each.triangle, round.first + static_cast<std::size_t>(grid.in_pixel(each.x, each.y)) * samples, each.mask);
  }
  for (const Round& round : rounds_)
    for (const SampleFragment& each : round.before_alpha)
      if (is_in(pixel, each, round.sampling->grid)) observer.fragment_of(each.triangle, Fate::cut_out);
  const Tile quad{pixel.x0 & ~1, pixel.y0 & ~1, std::min((pixel.x0 | 1) + 1, tile_.x1),
                  std::min((pixel.y0 | 1) + 1, tile_.y1)};  // what is rasterized
  std::vector<Pair> pairs;
  StageCounters unused;
  conservative_raster(context_.triangles, list, quad, unused, pairs);
  for (const Pair& pair : pairs)
    if (pair.x == pixel.x0 && pair.y == pixel.y0) describe(pair, pixel, observer);
}

void BinObserver::describe(const Pair& pair, const Tile& pixel, PixelObserver& observer) const {
  BeamFragmentOptions area_alone;
  area_alone.mask = MaskSource::none;
  const BeamFragmentOptions& options = masks_ ? *masks_ : area_alone;
  std::vector<Fragment> fragments;
  StageCounters unused;
  beam_fragment(context_.triangles, {pair}, pixel, options, unused, fragments);
  Fate fate = fragments.empty() ? Fate::no_area : masks_ ? Fate::closed_off : Fate::no_sample;
  const double area = fragments.empty() ? 0 : fragments.front().alpha;
  if (masks_ && context_.has_alpha() && !fragments.empty()) {
    alpha_mask({context_.shader, pixel}, patterns_of(options), options.alpha, unused, fragments);
    if (fragments.empty()) fate = Fate::cut_out;
  }
  const std::uint32_t index = observer.fragment_of(pair.triangle, fate);
  HistoryFragment& noted = observer.history.fragments[index];
  for (const Fragment& fragment : fragments) {  // one, or none, and what is discarded after its tests
    if (fragment.is_discarded) continue;
    noted.area = fragment.alpha;
    if (!masks_) continue;
    noted.is_tiny = fragment.tiny;
    for (std::size_t first = 0; first < positions_; first += 32)
      observer.would_cover(pair.triangle, first, fragment.mask.words[first / 32]);
  }
  if (fragments.empty()) noted.area = area;
  if (!masks_) {
    noted.mask.resize(positions_);
    noted.is_tiny = std::ranges::none_of(noted.mask, std::identity());
  }
  const SetupTriangle& triangle = context_.triangles.triangles[pair.triangle];
  noted.draw = context_.triangles.draws[pair.triangle];
  for (int k = 0; k < 3; ++k) noted.corners[k] = glm::dvec2(triangle.x[k], triangle.y[k]) / double{kSubpixelUnits};
  noted.nearest = pair.nearest, noted.farthest = pair.farthest;
  noted.is_front = triangle.front;
}

}  // namespace beampipe
