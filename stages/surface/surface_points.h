// What the fragment shader of a material gets from a triangle and its vertices: of one point, or of several side by
// side, with a point in each lane, to the same bits.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <tuple>
#include <type_traits>

#include "stages/data/setup_triangle.h"
#include "stages/surface/invocation.h"
#include "stages/surface/surface_formulas.h"

namespace beampipe {

// At which points of their pixels triangles are shaded.
struct PointRules {
  bool at_centres = false;  // of pixels, or at a point of the triangle near it, for one pixel
  bool in_quads = false;    // slopes are differences between the centres of neighbours in 2x2 quads of pixels
};

// The members of Invocation.
template <class Real, class Int>
struct InvocationOf {
  Int triangle, x, y;
  Real u, v;
  Real footprint_xx, footprint_xy, footprint_yy;
};

namespace scalar {
#include "stages/surface/surface_points-inl.h"
}
using namespace scalar;

struct RowsOfOneTriangle {
  std::uint32_t triangle;

  template <class Columns, class RowOf>
  Columns get(const RowOf& row_of) const {
    return std::bit_cast<Columns>(row_of(triangle));
  }
};

// Calls visit(point) with the SurfacePoint of the invocation.
template <class Visit>
void with_point(const SetupTriangles& triangles, const PointRules& rules, const Invocation& invocation, Visit&& visit) {
  const RowsOfOneTriangle rows{invocation.triangle};
  const auto at = std::bit_cast<InvocationOf<float, std::int32_t>>(invocation);
  visit(SurfacePoint(triangles, rows, at, rules));
}

// So many that lanes are full, and so few that all about them stays in the nearest cache.
inline constexpr std::size_t kMostPoints = 64;

// A number for each point. Those of points that nobody asked for have any value.
using PointColumn = std::array<float, kMostPoints>;

using TexturePoints = TexturePlace<PointColumn>;

// set_inputs() of each point and, for each set of texture coordinates, place(). `invocations`: at most kMostPoints, of
// triangles whose shader is `shader`. `inputs` and places may be null.
void find_points(const SetupTriangles& triangles, const ShaderInputs& shader, const PointRules& rules,
                 std::span<const Invocation> invocations, PointInputs<PointColumn>* inputs,
                 const std::array<TexturePoints*, 2>& places);

}  // namespace beampipe
