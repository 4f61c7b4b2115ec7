#include "tools/evaluate/captured_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "simd/sample_pattern.h"
#include "stages/data/ordered_tile.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/raster/sample_raster.h"
#include "stages/samples/alpha_test.h"
#include "stages/samples/ordered_test.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kChunk = 4096;  // triangles that are rasterized at once

enum class Match { nothing, equal, close, far, only_here, only_there };

struct PixelMatch {
  Match match;
  double difference = 0;
};

PixelMatch match_at(const CapturedPictures& captured, const SampledDepths& found, std::size_t pixel) {
  const bool here = found.draw[pixel] != kNoDraw, there = captured.depth[pixel] != captured.clear_depth;
  if (!here || !there) return {here ? Match::only_here : there ? Match::only_there : Match::nothing};
  const double difference = std::abs(found.depth[pixel] - captured.depth[pixel]);
  return {difference <= CapturedCheck::kEqual   ? Match::equal
          : difference <= CapturedCheck::kClose ? Match::close
                                                : Match::far,
          difference};
}

}  // namespace

double part_of(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(whole);
}

DrawDifferences::DrawDifferences(std::size_t draws) : draws_(draws + 1) {
  for (std::uint32_t i = 0; i < draws; ++i) draws_[i].draw = i;
}

void DrawDifferences::add(std::uint32_t draw, bool is_differing, double difference) {
  DrawDifference& found = draw == kNoDraw ? draws_.back() : draws_.at(draw);
  ++found.pixels;
  found.differing += is_differing;
  found.largest = std::max(found.largest, difference);
}

std::vector<DrawDifference> DrawDifferences::sorted() const {
  std::vector<DrawDifference> draws = draws_;
  std::erase_if(draws, [](const DrawDifference& draw) { return draw.differing == 0; });
  std::stable_sort(draws.begin(), draws.end(),
                   [](const DrawDifference& a, const DrawDifference& b) { return a.differing > b.differing; });
  return draws;
}

SampledDepths sampled_depths(const Trace& trace, const Frame& frame, const TextureSet* textures) {
  StageCounters ignored;
  SetupTriangles triangles = vertex_setup(trace, frame, ignored, false, DrawOrder::of_api);
  if (textures) without_refused(triangles, frame, textures->programs());
  const SurfaceShader shader(triangles, trace, frame, textures, {});
  const Tile whole{0, 0, static_cast<std::int32_t>(frame.width), static_cast<std::int32_t>(frame.height)};
  const TileShader whole_shader(shader, whole);
  const Sampling first{CellGrid{}, only(standard_pattern(static_cast<int>(frame.capture.pictures.samples)), 0)};
  const auto in_pixel = [](std::int32_t place) { return static_cast<float>(place) / kSubpixelUnits; };
  const glm::vec2 at(in_pixel(first.pattern.x[0]), in_pixel(first.pattern.y[0]));
  const SampledTriangles samples{triangles, whole, first};
  const RopRules rules(trace, frame, frame.background);
  constexpr bool kHasStencil = true;
  OrderedTile surface(whole, 1, rules.clear_depth, kHasStencil, rules.clear_color);
  std::vector<std::uint32_t> owner(whole.pixels());  // the triangle that wrote depth last
  std::vector<SampleFragment> fragments;
  std::vector<OrderedAccess> accesses;
  for (std::uint32_t begin = 0; begin < triangles.triangles.size(); begin += kChunk) {
    TriangleList list(std::min<std::size_t>(kChunk, triangles.triangles.size() - begin));
    std::iota(list.begin(), list.end(), begin);
    fragments.clear();
    sample_raster(samples, list, ignored, fragments);
    if (!shader.is_flat()) {
      const std::vector<glm::vec2> centres(fragments.size(), glm::vec2(0.5f));
      alpha_test(whole_shader, {whole, first, AlphaCoverage::test, centres}, ignored, fragments);
    }
    ordered_test(samples, rules, ignored, surface, fragments, accesses);
    for (const OrderedAccess& access : accesses)
      if (access.written != 0 && rules.of(triangles, access.triangle).writes_depth)
        owner[access.cell] = access.triangle;
  }

  SampledDepths found{std::vector<double>(whole.pixels()), std::vector<std::uint32_t>(whole.pixels(), kNoDraw)};
  for (std::size_t pixel = 0; pixel < whole.pixels(); ++pixel) {
    if (surface.depth[pixel] == rules.clear_depth) continue;
    found.draw[pixel] = triangles.draws[owner[pixel]];
    const double x = static_cast<double>(pixel % frame.width), y = static_cast<double>(pixel / frame.width);
    const double depth = shader.has_verdict(owner[pixel])  // its shader may write another depth
                             ? surface.depth[pixel]
                             : triangles.triangles[owner[pixel]].depth.at(x + at.x, y + at.y);
    found.depth[pixel] = std::clamp(depth + 1, 0.0, 1.0);
  }
  return found;
}

double CapturedCheck::coverage() const { return part_of(both, here + there - both); }
double CapturedCheck::close_part() const { return part_of(close, both); }
double CapturedCheck::equal_part() const { return part_of(equal, both); }

CapturedCheck check_captured(const Frame& frame, const SampledDepths& found) {
  const CapturedPictures& captured = frame.capture.pictures;
  if (captured.depth.empty() || captured.depth.size() != found.draw.size())
    throw std::invalid_argument("the frame has no captured depth");
  CapturedCheck check;
  DrawDifferences draws(frame.draws.size());
  for (std::size_t pixel = 0; pixel < found.draw.size(); ++pixel) {
    const auto [match, difference] = match_at(captured, found, pixel);
    if (match == Match::nothing) continue;
    const bool here = match != Match::only_there, there = match != Match::only_here;
    check.here += here, check.there += there, check.both += here && there;
    check.equal += match == Match::equal;
    check.close += match == Match::equal || match == Match::close;
    check.largest = std::max(check.largest, difference);
    draws.add(found.draw[pixel], match != Match::equal && match != Match::close, difference);
  }
  check.draws = draws.sorted();
  return check;
}

std::vector<std::uint8_t> difference_picture(const Frame& frame, const SampledDepths& found) {
  using Rgb = std::array<std::uint8_t, 3>;
  constexpr Rgb kColors[] = {{48, 48, 48}, {32, 128, 48}, {224, 200, 32}, {220, 40, 32}, {48, 96, 240}, {224, 48, 224}};
  std::vector<std::uint8_t> picture;
  picture.reserve(3 * found.draw.size());
  for (std::size_t pixel = 0; pixel < found.draw.size(); ++pixel) {
    const Rgb& color = kColors[static_cast<std::size_t>(match_at(frame.capture.pictures, found, pixel).match)];
    picture.insert(picture.end(), color.begin(), color.end());
  }
  return picture;
}

}  // namespace beampipe
