#include "pipeline/inspect/inspected_pixel.h"

#include <algorithm>

#include "pipeline/bins/bands.h"
#include "stages/beam/alpha_mask.h"

namespace beampipe {
namespace {

void count_move(std::uint32_t fragment, std::vector<PositionMove>& moves) {
  const auto known =
      std::find_if(moves.begin(), moves.end(), [&](const auto& each) { return each.fragment == fragment; });
  if (known == moves.end()) {
    moves.push_back({fragment, 1});
  } else {
    ++known->positions;
  }
}

}  // namespace

InspectedPixel::InspectedPixel(const FrameContext& frame_context, PixelAddress pixel, std::int32_t bin_size)
    : context(frame_context), at(pixel) {
  const auto x = static_cast<std::int32_t>(pixel.x), y = static_cast<std::int32_t>(pixel.y);
  const TileGrid grid(context.frame, bin_size);
  const auto number = static_cast<std::size_t>(y / grid.size * grid.columns + x / grid.size);
  bin = grid.tiles.at(number);
  quad = {x & ~1, y & ~1, std::min((x | 1) + 1, bin.x1), std::min((y | 1) + 1, bin.y1)};
  tile = {x, y, x + 1, y + 1};
  list = bin_triangles(context.triangles, grid, {number, number + 1}).front();
}

std::vector<Pair> InspectedPixel::pairs(const TriangleList& triangles, ClosedDepth* closed, Closing closing) const {
  std::vector<Pair> pairs;
  StageCounters unused;
  conservative_raster(context.triangles, triangles, quad, unused, pairs, {closed, PairDepths::bounds, closing});
  std::erase_if(pairs, [&](const Pair& pair) { return pair.x != tile.x0 || pair.y != tile.y0; });
  return pairs;
}

PixelHistory InspectedPixel::history(const std::string& order, const std::vector<SamplePattern>& positions) const {
  PixelHistory history;
  history.at = at, history.order = order;
  for (const SamplePattern& pattern : positions)
    for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s)
      history.positions.push_back(glm::vec2(pattern.x[s], pattern.y[s]) * (1.0f / kSubpixelUnits));
  history.owners.assign(history.positions.size(), kNobody);
  return history;
}

std::optional<Fragment> InspectedPixel::arrive(const Pair& pair, const BeamFragmentOptions& options,
                                               PixelHistory& history) const {
  history.fragments.push_back(history_fragment(context, pair));
  HistoryFragment& noted = history.fragments.back();
  std::vector<Fragment> fragments;
  StageCounters unused;
  beam_fragment(context.triangles, {pair}, tile, options, unused, fragments);
  if (fragments.empty()) {
    noted.fate = Fate::no_area;
    return {};
  }
  noted.area = fragments.front().alpha;
  if (context.has_alpha())
    alpha_mask(shader(), options.grid ? cell_patterns(options.grid->count()) : options.positions, unused, fragments);
  if (fragments.empty()) {
    noted.fate = Fate::cut_out;
    return {};
  }
  const Fragment& fragment = fragments.front();
  noted.area = fragment.alpha;
  noted.is_tiny = fragment.tiny;
  if (options.mask != MaskSource::none) noted.mask = bits_of(fragment.mask, history.positions.size());
  return fragment;
}

double InspectedPixel::area_of(const Pair& pair) const {
  BeamFragmentOptions options;
  options.mask = MaskSource::none;
  std::vector<Fragment> fragments;
  StageCounters unused;
  beam_fragment(context.triangles, {pair}, tile, options, unused, fragments);
  return fragments.empty() ? 0.0 : double{fragments.front().alpha};
}

HistoryFragment history_fragment(const FrameContext& context, const Pair& pair) {
  const SetupTriangle& triangle = context.triangles.triangles[pair.triangle];
  HistoryFragment fragment{.triangle = pair.triangle,
                           .draw = context.triangles.draws[pair.triangle],
                           .corners = {},
                           .nearest = pair.nearest,
                           .farthest = pair.farthest,
                           .is_front = triangle.front};
  for (int k = 0; k < 3; ++k) fragment.corners[k] = glm::dvec2(triangle.x[k], triangle.y[k]) / double{kSubpixelUnits};
  return fragment;
}

std::vector<bool> bits_of(const WideMask& mask, std::size_t count) {
  std::vector<bool> bits(count);
  for (std::size_t i = 0; i < count; ++i) bits[i] = mask.test(i);
  return bits;
}

void take_positions(const WideMask& mask, std::uint32_t fragment, PixelHistory& history) {
  for (std::size_t i = 0; i < history.owners.size(); ++i) {
    std::uint32_t& owner = history.owners[i];
    if (!mask.test(i) || owner == fragment) continue;
    count_move(owner, history.fragments[fragment].taken);
    if (owner != kNobody) count_move(fragment, history.fragments[owner].lost);
    owner = fragment;
  }
}

void note_missed(std::uint32_t fragment, PixelHistory& history, std::size_t first) {
  HistoryFragment& noted = history.fragments[fragment];
  for (std::size_t i = first; i < noted.mask.size(); ++i)
    if (noted.mask[i] && history.owners[i] != fragment && history.owners[i] != kNobody)
      count_move(history.owners[i], noted.lost);
}

}  // namespace beampipe
