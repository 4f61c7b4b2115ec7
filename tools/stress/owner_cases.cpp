// Cases that are hard on who owns what in a pixel: more visible surfaces than a pixel may keep, surfaces at equal
// depths and with equal sort keys, and bins with very many triangles.
#include <cmath>
#include <numbers>

#include "pipeline/sampling.h"
#include "stages/data/mix_bits.h"
#include "tools/stress/case_parts.h"

namespace beampipe {
namespace {

constexpr const char* kMerged = "if there are more surfaces than slots, two share a mean colour and one depth plane";
constexpr const char* kCounted = "each surface's count of positions is wrong at its edges, and counts limit the areas";

// Parts that add up to 1 cover at least 1 - 1/e of a pixel if they are independent.
constexpr double kLostByOver = 1 / std::numbers::e;

constexpr glm::vec3 kColors[] = {kRed, kGreen, kBlue};
constexpr double kColorGap = 0.625;  // the largest difference of a channel between these colours

// What masks with so many positions do with triangles that hide nothing of each other, as parts of the worst pixel.
struct Counts {
  double error = 0;   // of each triangle's count, summed: no colour is farther than this from what counting gives
  double unseen = 0;  // the triangles that cover no position
};

Counts count_alone(const Trace& trace, int positions) {
  const SamplePlaces places = places_of(cell_patterns(positions));
  const Frame& frame = trace.frames[0];
  std::vector<Counts> pixels(std::size_t{frame.width} * frame.height);
  for (const glm::uvec3& triangle : trace.meshes[0].triangles) {
    Trace alone = trace;
    alone.meshes[0].triangles = {triangle};
    alone.meshes[0].colors.resize(1);
    const ExactPicture areas = exact_areas(alone, frame), counts = exact_samples(alone, frame, places);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const auto x = static_cast<int>(i % frame.width), y = static_cast<int>(i / frame.width);
      const double area = areas.at(x, y).a, counted = counts.at(x, y).a;
      pixels[i].error += std::abs(area - counted);
      if (counted == 0) pixels[i].unseen += area;
    }
  }
  Counts worst;
  for (const Counts& pixel : pixels) worst = {std::max(worst.error, pixel.error), std::max(worst.unseen, pixel.unseen)};
  return worst;
}

// Where positions are counted, a result is within three of them of what counting gives.
StatedLimit limit_of_counts(const Trace& trace, double more, const char* reason) {
  const auto limit = [trace, more](int positions) {
    return count_alone(trace, positions).error + 3.0 / positions + more;
  };
  return {limit, reason};
}

// Columns of one pixel's width and kRows pixels' height, with upright strips side by side. All strips of a column are
// visible. Their depths at the top are in front of all of those below, so that none of them is final while triangles
// of the bin are still to come.
constexpr int kStrips[] = {5, 6, 8, 32}, kRows = 4;
constexpr double kTip = 2000;  // where the sides of a strip meet, in pixels below the picture's top

// The left side of a column's strip, in steps of 1/256 px, so that no side is on a grid of positions.
double side_of_strip(int i, int count) {
  const bool is_inside = i > 0 && i < count;
  return std::round((i + (is_inside ? 0.3 * std::sin(2.4 * i) : 0.0)) / count * 256) / 256;
}

Screen strips() {
  Screen screen(std::size(kStrips), kRows);
  for (int column = 0; column < static_cast<int>(std::size(kStrips)); ++column) {
    const int count = kStrips[column];
    for (int i = 0; i < count; ++i) {
      const double left = column + side_of_strip(i, count), right = column + side_of_strip(i + 1, count);
      const auto depth = [&](double y) { return 0.2 + 1e-6 * i + y / 5000; };
      screen.triangle({left, -1, depth(-1)}, {right, -1, depth(-1)}, {(left + right) / 2, kTip, depth(kTip)},
                      kColors[i % 3]);
    }
  }
  return screen;
}

// Where positions alone tell how much of a surface is hidden. Measured: up to four positions.
StatedLimits estimated() {
  return {{ErrorSource::estimated_areas, {[](int positions) { return 5.0 / positions; }, kMask}}};
}

StatedLimits limits_of_strips(const Trace& trace) {
  // The strips leave gaps, which are wider the lower they are. A mask may have none, and then strips that cover no
  // position have no room.
  const auto full = [trace](int positions) { return (kRows + 1) / kTip + count_alone(trace, positions).unseen; };
  return together({{{ErrorSource::estimated_areas, {full, kFull}}}, merge_limits(0.45, kLostByOver)});
}

HardCase full_lists() {
  HardCase result{
      "full_lists", "5, 6, 8 and 32 strips in a pixel, all visible, none final before the last", {}, {}, {}};
  result.trace = strips().trace();
  result.limits = limits_of_strips(result.trace);
  result.limits[ErrorSource::counted_positions] = limit_of_counts(result.trace, 0, kCounted);
  return result;
}

HardCase full_lists_hidden() {
  HardCase result{"full_lists_hidden", "the same, half hidden by a triangle that comes after them", {}, {}, {}};
  Screen screen = strips();
  for (int column = 0; column < static_cast<int>(std::size(kStrips)); ++column)
    screen.triangle({column + 0.5, 1}, {column + 1, 1}, {column + 0.75, kTip}, 0.2001, kBlue);
  result.trace = screen.trace();
  result.limits = together({limits_of_strips(result.trace), estimated()});
  // A surface made of several shows their mean colour. If the part V of it is seen and the part H is hidden, the colour
  // is wrong by at most V H / (V + H) of the difference, which is largest if both are half of the pixel.
  result.limits[ErrorSource::counted_positions] = limit_of_counts(result.trace, kColorGap / 4, kMerged);
  result.limits[ErrorSource::merges_of_layers] = {kColorGap / 4, kMerged};
  return result;
}

// `count`: the triangles that may be at equal depth.
StatedLimits limits_of_stack(int count) {
  StatedLimits limits = together({estimated(), merge_limits(0.45, 0.75)});
  if (count > 1) limits[ErrorSource::double_counting] = {0.75 * count, kTwice};
  return limits;
}

// Triangles around one point, each turned against the one before, at exactly the same depth: the first one wins.
HardCase stack(int count) {
  constexpr double kMiddle = 2, kRadius = 2.1;
  Screen screen(4, 4);
  for (int i = 0; i < count; ++i) {
    const auto corner = [&](double part) {
      const double angle = 2 * std::numbers::pi * (part / 3 + 0.37 * i);
      return glm::dvec2(kMiddle + kRadius * std::cos(angle), kMiddle + kRadius * std::sin(angle));
    };
    screen.triangle(corner(0), corner(1), corner(2), 0.5, kColors[i % 3]);
  }
  return {"stack_" + std::to_string(count),
          std::to_string(count) + " triangles at exactly the same depth, of which the first one wins",
          screen.trace(),
          {},
          limits_of_stack(count)};
}

// All within one step of the sort's 24-bit keys, which at this depth is 2^-18. Each starts farther to the right.
HardCase equal_keys(bool nearer) {
  constexpr int kCount = 32;
  Screen screen(16, 16);
  for (int i = 0; i < kCount; ++i) {
    const double x = nearer ? 0.5 * i + 0.15 : 16 - 0.5 * (i + 1) + 0.15;
    screen.triangle({x, -16}, {x, 32}, {x + 48, 8}, 0.5 + (nearer ? kCount - 1 - i : 0) * 0x1p-24, kColors[i % 3]);
  }
  return {nearer ? "equal_keys" : "equal_depths",
          nearer ? "32 triangles with one sort key, each nearer by 2^-24 than the one before"
                 : "32 triangles at one depth, each larger than the one before, which stays visible",
          screen.trace(),
          {},
          limits_of_stack(nearer ? 1 : kCount)};
}

}  // namespace

// A plane in one bin of 32 x 32 pixels: 128 triangles in each pixel, with corners off any grid.
HardCase crowded_bin() {
  constexpr int kPixels = 32, kCells = 8 * kPixels;
  Screen screen(kPixels, kPixels);
  const auto at = [&](int x, int y) {
    const auto off = [&](int along, std::uint32_t salt) {
      if (along % kCells == 0) return 0.0;
      const auto place = static_cast<std::uint32_t>(y * (kCells + 1) + x);
      return static_cast<double>(mix_bits(2 * place + salt) % 25) / 256 - 12.0 / 256;
    };
    return glm::dvec3(x / 8.0 + off(x, 0), y / 8.0 + off(y, 1), 0.3 + 0.001 * x + 0.0005 * y);
  };
  for (int y = 0; y < kCells; ++y)
    for (int x = 0; x < kCells; ++x) {
      screen.triangle(at(x, y), at(x + 1, y), at(x + 1, y + 1), kRed);
      screen.triangle(at(x, y), at(x + 1, y + 1), at(x, y + 1), kRed);
    }
  HardCase result{"crowded_bin", "131,072 triangles in one bin, which cover it without a gap", {}, {}, {}};
  result.limits = merge_limits(0.45, kLostByOver);
  result.picture = ExactPicture{.elsewhere = glm::dvec4(glm::dvec3(kRed), 1.0)};
  result.trace = screen.trace();
  return result;
}

std::vector<HardCase> owner_cases() {
  return {full_lists(), full_lists_hidden(), stack(2),         stack(5),
          stack(6),     stack(50),           equal_keys(true), equal_keys(false)};
}

}  // namespace beampipe
