// Clipping of triangles in clip space: to the near and far planes, and to a rectangle of the screen or the guard band.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simd/vertex_transform.h"

namespace beampipe {

// How far from the viewport's origin a snapped vertex may lie, on every side, in pixels: 2^23 in 1/256 px.
inline constexpr double kGuardBand = 32768.0;

// Sides of a rectangle of the screen, in pixels. A side at the guard band stands for none.
struct ScreenLimits {
  double left = -kGuardBand, top = -kGuardBand, right = kGuardBand, bottom = kGuardBand;
};

// Clip planes as inner products that are >= 0 inside: near, far, left, right, bottom and top.
inline constexpr std::size_t kPlanes = 6, kDepthPlanes = 2;
using ClipPlanes = std::array<std::array<double, 4>, kPlanes>;

// `width`, `height`: of the frame, in pixels.
ClipPlanes clip_planes(double width, double height, const ScreenLimits& limits = {});

template <class Real>
Real plane_distance(const std::array<Real, 4>& plane, const ClipVertex<Real>& v) {
  return plane[0] * v.x + plane[1] * v.y + plane[2] * v.z + plane[3] * v.w;
}

// The point where an edge crosses the plane, from its inner to its outer vertex.
template <class Real>
ClipVertex<Real> crossing(const ClipVertex<Real>& in, const ClipVertex<Real>& out, Real t) {
  return {in.x + t * (out.x - in.x), in.y + t * (out.y - in.y), in.z + t * (out.z - in.z), in.w + t * (out.w - in.w)};
}

// Where on the edge that is: 0 at the inner vertex, 1 at the outer one.
template <class Real>
Real crossing_place(Real in_distance, Real out_distance) {
  return in_distance / (in_distance - out_distance);
}

// Do all three vertices lie outside the same side of the view volume?
template <class Real>
bool outside_view(const std::array<ClipVertex<Real>, 3>& v) {
  bool left = true, right = true, below = true, above = true, before = true, behind = true;
  for (const ClipVertex<Real>& p : v) {
    const Real minus_w = Real(0.0) - p.w;
    left &= p.x<minus_w, right &= p.x> p.w;
    below &= p.y<minus_w, above &= p.y> p.w;
    before &= p.z<minus_w, behind &= p.z> p.w;
  }
  return left | right | below | above | before | behind;
}

// A vertex of a clipped triangle. `second` and `third` are the weights of the triangle's vertices in it, as in
// Barycentrics.
struct ClippedVertex : ClipVertex<double> {
  double second = 0, third = 0;
};
using Polygon = std::vector<ClippedVertex>;

// Clips to one plane (Sutherland and Hodgman). A crossing is always computed from the inner to the outer vertex, so two
// triangles that share the edge get the same point. Adds the number of crossings to `crossings`. The part outside goes
// to `outside`, unless that is null.
Polygon clip_to_plane(const Polygon& polygon, const std::array<double, 4>& plane, std::uint64_t& crossings,
                      Polygon* outside = nullptr);

}  // namespace beampipe
