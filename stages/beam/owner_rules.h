// The rules by which a pixel's surfaces share its mask positions, as templates: the composer runs them on masks and
// numbers, and the stage's costs come from running them on masks and numbers that count.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/conserve.h"
#include "simd/depth_plane.h"
#include "simd/plane_gap.h"
#include "simd/plane_order.h"
#include "simd/scalar.h"
#include "stages/beam/specks.h"
#include "stages/data/mix_bits.h"
#include "stages/data/owner_slot.h"
#include "stages/data/pixel_sums.h"

namespace beampipe {

// ---- Partition: a pixel's positions by their state ----

namespace scalar {
#include "stages/beam/position_states-inl.h"
}
using namespace scalar;

// ---- What is known of a surface ----

template <class Float>
struct SurfaceArea {
  Float covered, visible;  // positions that its triangle covers, and that it owns
  Float error;             // its exact area minus `covered`, in positions

  Float fraction() const { return visible / covered; }
};

// The mean of positions along one axis, from the sum of their coordinates in 1/256 px.
template <class Int, class Float>
Float mean_position(const Int& sum, const Float& count) {
  return to_float(sum) * (Float(1.0f) / (count * Float(kSubpixelUnits)));
}

// The sides, (right, down) and (0, height), of a parallelogram whose points have the mean and the second moments of an
// area that is known by `count` of `all` positions of a pixel. Sums are of coordinates in 1/256 px.
template <class Float>
struct Sides {
  Float right, down, height;
};
template <class Int, class Float>
Sides<Float> sides_of(const Int (&sums)[2], const Int (&squares)[3], const Float& count, const Float& all) {
  const Float x = mean_position(sums[0], count), y = mean_position(sums[1], count), own = Float(1.0f) / all;
  const Float scale = Float(1.0f) / (count * Float(kSubpixelUnits * kSubpixelUnits));
  const auto spread = [&](const Int& sum, const Float& product) {
    return Float(12.0f) * (to_float(sum) * scale - product);
  };
  // A position stands for an area of its own.
  const Float right = square_root(greater(spread(squares[0], x * x), Float(0.0f)) + own);
  const Float down = spread(squares[1], x * y) / right;
  return {right, down, square_root(greater(spread(squares[2], y * y) - down * down, Float(0.0f)) + own)};
}

// Where sums round what a surface adds: a number above 0 and up to 1 that differs between surfaces. It depends on
// `content`, what the surface is, and not on the order of triangles. Its eight bits are exact in the sum of a float and
// the largest addend.
template <class Bits>
auto rounding_threshold(Bits content) {
  using Float = decltype(to_float(mix_bits(content)));
  return (to_float(mix_bits(content) >> 24) + Float(1.0f)) * Float(0x1p-8f);
}

// ---- Retire: nothing can hide a surface any more ----

// Is a surface in front of the watermark in the whole pixel, or behind it somewhere in the whole pixel?
enum class Finality { is_final, is_open, depends_on_positions };
template <class Float>
Finality finality_of(const DepthPlane<Float>& plane, const Float& watermark) {
  const Float reach = reach_in_pixel(plane.dzdu, plane.dzdv);
  if (plane.z - reach > watermark) return Finality::is_open;
  return plane.z + reach <= watermark ? Finality::is_final : Finality::depends_on_positions;
}

// The area, 0..1, that a surface adds to those that were retired before. What is left of a merged surface may be less
// than the error of its mask.
template <class Float>
Float retired_area(const SurfaceArea<Float>& surface, const Float& positions, const Taken<Float>& taken) {
  const Float exact = greater(surface.covered + surface.error, Float(0.0f)) / positions;
  return visible_area(exact, surface.covered, surface.visible, positions, taken);
}

// What is final in a pixel.
template <class Int, class Bits>
struct FinalSums {
  Int area;  // units of FixedSum
  std::array<Bits, ColorSums::kCount> colors;

  template <class Float>
  void add(const Float& shown, const Float (&addends)[ColorSums::kCount], const Float& threshold) {
    area = FixedSum::sum(area, shown, threshold);
    ColorSums::add_to(colors.data(), addends, threshold);
  }
};

// Adds a surface that became final. `content`: of its slot; `final_positions`: those of surfaces that were added
// before. Returns the area that it shows.
template <class Float, class Int, class Bits>
[[gnu::always_inline]] inline Float add_final(const SurfaceArea<Float>& surface, const Float (&color)[3],
                                              const Bits& content, const Float& positions, const Float& final_positions,
                                              FinalSums<Int, Bits>& sums) {
  const Float area = retired_area(surface, positions, {FixedSum::value(sums.area), final_positions});
  const Float counted = surface.visible / positions;
  sums.add(
      area,
      {area * color[0], area * color[1], area * color[2], counted * color[0], counted * color[1], counted * color[2]},
      rounding_threshold(content));
  return area;
}

// ---- Merge: two surfaces become one ----

// The distance in depth of two planes at (u, v), in pixels from the pixel's centre.
template <class Float>
Float depth_gap(const DepthPlane<Float>& plane, const DepthPlane<Float>& other, Float u, Float v) {
  return magnitude(depth_at(plane, u, v) - depth_at(other, u, v));
}

template <class Float>
struct PlacedSurface {
  Float visible;  // positions that it owns
  DepthPlane<Float> plane;
  Float u, v;  // the mean of these positions, in pixels from the pixel's centre
};

// How much depth changes, over all positions, if two surfaces become one.
template <class Float>
Float merge_loss(const PlacedSurface<Float>& one, const PlacedSurface<Float>& other) {
  return lesser(one.visible, other.visible) *
         (depth_gap(one.plane, other.plane, one.u, one.v) + depth_gap(one.plane, other.plane, other.u, other.v));
}

// Of surfaces at equal depth, those become one that lie closest in the trace: the fewest triangles come between them.
template <class Int>
Int distance_in_trace(const Int& one, const Int& other) {
  return greater(one, other) - lesser(one, other);
}

inline constexpr float kLeastArea = 1e-3f;  // positions; keeps the weights of a mean positive

// The parts of two surfaces in their mean colour, and the error of both together. The mean is weighted by areas. Once
// an error has reached its limit, areas are not known any more: `counted`.
template <class Float>
struct MergedParts {
  Float one, other;  // together 1
  Float error;
};
template <class Float>
MergedParts<Float> merged_parts(const SurfaceArea<Float>& one, const SurfaceArea<Float>& other, bool counted) {
  const auto left_error = [](const SurfaceArea<Float>& surface) {
    const Float fraction = surface.fraction();
    return fraction * fraction * surface.error;
  };
  const Float error_of_one = left_error(one), error_of_other = left_error(other);
  const auto weight = [&](const SurfaceArea<Float>& surface, const Float& error) {
    return select(counted, surface.visible, greater(surface.visible + error, Float(kLeastArea)));
  };
  const Float weight_of_one = weight(one, error_of_one), weight_of_other = weight(other, error_of_other);
  const Float scale = Float(1.0f) / (weight_of_one + weight_of_other);
  return {weight_of_one * scale, weight_of_other * scale, error_of_one + error_of_other};
}

// The slot of the surface that two become. `number`: of the triangle whose plane it keeps; `content`: of both slots, by
// which its colour is rounded.
template <class Float, class Bits>
std::array<Bits, 2> merged_slot(const Bits& number, const MergedParts<Float>& parts, const Float (&color)[3],
                                const Float (&color_of_other)[3], const Bits& content, const Bits& content_of_other) {
  const auto mean = [&](int c) { return parts.one * color[c] + parts.other * color_of_other[c]; };
  const Float means[] = {mean(0), mean(1), mean(2)};
  return OwnerSlot::words_of_merged(
      number, parts.error, means, rounding_threshold(content + content_of_other + content_of_other + content_of_other));
}

// ---- Specks ----

// What sums are rounded by to which a speck is added.
template <class Float>
Float speck_threshold(const Float& alpha, const Float& depth) {
  return rounding_threshold(bits_of(alpha) ^ bits_of(depth));
}

// Adds a speck for which so many of three positions vote to the area of the specks that face as it does. `opposite`: of
// those that face the other way; `area`: of what is final. All three in units of FixedSum. Returns what the speck adds
// to the pixel, if it is above 0.
template <class Float, class Int>
Float add_speck_area(const Float& alpha, const Float& votes, const Float& threshold, const Int& opposite,
                     const Int& area, Int& same) {
  const Float others = FixedSum::value(opposite), before = greater(FixedSum::value(same), others);
  same = FixedSum::sum(same, alpha * votes / Float(3.0f), threshold);
  return lesser(greater(FixedSum::value(same), others) - before, Float(1.0f) - FixedSum::value(area));
}

// ---- Limit: two estimates of a pixel become one ----

// How far the analytic estimate of a pixel may be from the count of its positions: in positions for areas; for colours,
// in positions of the brighter one of the two mean colours. An edge through a grid of 256 positions leaves the count
// wrong by one position, as a standard deviation.
inline constexpr float kAreaTolerance = 2.0f, kColorTolerance = 3.0f;

template <class Float>
struct Estimate {
  Float area;      // 0..1
  Float color[3];  // linear RGB times area
};

// The analytic estimate, moved towards the counted one as far as the tolerances demand.
template <class Float>
[[gnu::always_inline]] inline Estimate<Float> limited_estimate(const Estimate<Float>& analytic,
                                                               const Estimate<Float>& counted, Float positions) {
  const Float zero(0.0f), one(1.0f);
  const auto limited = [](Float x, Float middle, Float tolerance) {
    return lesser(greater(x, middle - tolerance), middle + tolerance);
  };
  const Float analytic_area = greater(analytic.area, Float(1 / FixedSum::kUnits));  // 0 has no colour
  Estimate<Float> result;
  result.area = select(counted.area == one, one,
                       lesser(limited(analytic.area, counted.area, Float(kAreaTolerance) / positions), one));
  const Float scale = result.area / analytic_area;
  Float brightest = zero;
  for (int c = 0; c < 3; ++c) {
    brightest = greater(brightest, analytic.color[c] / analytic_area);
    brightest = greater(brightest,
                        select(counted.area > zero, counted.color[c] / greater(counted.area, one / positions), zero));
  }
  const Float tolerance = Float(kColorTolerance) / positions * brightest;
  for (int c = 0; c < 3; ++c) result.color[c] = limited(scale * analytic.color[c], counted.color[c], tolerance);
  return result;
}

}  // namespace beampipe
