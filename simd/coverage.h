// Analytic coverage of a pixel by a triangle: area, centroid and depth range of the triangle clipped to the pixel.
//
// Pixel-local coordinates: u to the right, v down, the pixel is [0,1] x [0,1]. Edge k runs from vertex k to vertex
// (k + 1) % 3 and is E_k(u,v) = a_k u + b_k v + c_k, positive inside. Depth is z + dzdu (u - 1/2) + dzdv (v - 1/2).
#pragma once

#include <cstddef>

#include "simd/scalar.h"

namespace beampipe {

// One (pixel, triangle). Vertices and slopes are exact: integers in 1/256 px scaled by powers of two. Corner values are
// the exact integers rounded to float, in the order (0,0), (1,0), (0,1), (1,1); reversing an edge negates them exactly.
template <class Float>
struct CoverageInput {
  Float u[3], v[3];     // vertices, pixels
  Float a[3], b[3];     // edge slopes
  Float corner[3][4];   // edge values at the pixel's corners
  Float z, dzdu, dzdv;  // depth plane: at the pixel's centre, and its change per pixel
  Float vertex_z[3];
};

template <class Float>
struct Coverage {
  Float alpha;                   // area, 0..1; absolute error below 5e-7
  Float centroid_u, centroid_v;  // of the clipped triangle, inside the pixel
  Float z_min, z_max;            // over the clipped triangle
};

// out[i] = coverage of in[i]; lanes are across i. Bit-identical to coverage_scalar on every target.
void coverage(const CoverageInput<float>* in, std::size_t count, Coverage<float>* out);

// ---- Scalar twin: one lane, also for counting numbers ----

template <class Float>
struct EdgeIntegral {
  Float area, moment_u, moment_v;
};

// By Green's theorem the clipped area is the sum over edges of +-(integral of clamp(u_edge(v), 0, 1) dv), v over the
// edge's extent within [0,1]; the first moments likewise. The sign is the edge's direction, so the two triangles of a
// shared edge add exactly opposite numbers: the areas of a tessellation sum to the whole's.
template <class Float>
EdgeIntegral<Float> edge_integral(Float v0, Float v1, Float a, Float b, Float c, Float c_right) {
  const Float zero(0.0f), one(1.0f), half(0.5f), sixth(1.0f / 6.0f);
  const Float low = lesser(greater(lesser(v0, v1), zero), one);
  const Float high = lesser(greater(greater(v0, v1), zero), one);
  const bool vertical = b == zero, horizontal = a == zero;
  const Float safe_a = select(horizontal, one, a), safe_b = select(vertical, one, b);
  // Where the edge crosses u = 0 and u = 1, clamped to its extent. A vertical edge counts as wholly between.
  const Float at_left = select(vertical, low, lesser(greater((zero - c) / safe_b, low), high));
  const Float at_right = select(vertical, high, lesser(greater((zero - c_right) / safe_b, low), high));
  const Float v_in = lesser(at_left, at_right), v_out = greater(at_left, at_right);
  const Float u_in = lesser(greater((zero - (b * v_in + c)) / safe_a, zero), one);
  const Float u_out = lesser(greater((zero - (b * v_out + c)) / safe_a, zero), one);
  const Float inner = v_out - v_in;
  // Beyond u = 1 the whole width counts: above the crossing where u grows with v, else below it.
  const bool u_grows = a * b <= zero;
  const Float from = select(u_grows, at_right, low), to = select(u_grows, high, at_right);
  const Float beyond = to - from;
  const Float sum_u = u_in + u_out;
  const Float area = half * sum_u * inner + beyond;
  const Float moment_u = sixth * (u_in * sum_u + u_out * u_out) * inner + half * beyond;
  const Float moment_v =
      sixth * (v_in * (sum_u + u_in) + v_out * (sum_u + u_out)) * inner + half * beyond * (from + to);
  const Float sign = select(horizontal, zero, select(a < zero, one, zero - one));
  return {sign * area, sign * moment_u, sign * moment_v};
}

template <class Float>
Coverage<Float> coverage_scalar(const CoverageInput<Float>& in) {
  const Float zero(0.0f), one(1.0f), half(0.5f);
  Float area = zero, moment_u = zero, moment_v = zero;
  for (int k = 0; k < 3; ++k) {
    const EdgeIntegral<Float> edge =
        edge_integral(in.v[k], in.v[(k + 1) % 3], in.a[k], in.b[k], in.corner[k][0], in.corner[k][1]);
    area = area + edge.area;
    moment_u = moment_u + edge.moment_u;
    moment_v = moment_v + edge.moment_v;
  }
  Coverage<Float> out;
  out.alpha = lesser(greater(area, zero), one);

  // The centroid, kept inside the part of the pixel that the triangle's bounds reach: the moments of a speck are noise.
  const Float safe_area = select(area > zero, area, one);
  const Float u_low = greater(lesser(lesser(in.u[0], in.u[1]), in.u[2]), zero);
  const Float u_high = lesser(greater(greater(in.u[0], in.u[1]), in.u[2]), one);
  const Float v_low = greater(lesser(lesser(in.v[0], in.v[1]), in.v[2]), zero);
  const Float v_high = lesser(greater(greater(in.v[0], in.v[1]), in.v[2]), one);
  out.centroid_u = lesser(greater(moment_u / safe_area, u_low), u_high);
  out.centroid_v = lesser(greater(moment_v / safe_area, v_low), v_high);

  // Depth range: over the vertices of the clipped polygon, which are the triangle's vertices inside the pixel, the
  // pixel's corners inside the triangle, and the crossings of edges with the pixel's border.
  const Float z_nearest = lesser(lesser(in.vertex_z[0], in.vertex_z[1]), in.vertex_z[2]);
  const Float z_farthest = greater(greater(in.vertex_z[0], in.vertex_z[1]), in.vertex_z[2]);
  const auto plane = [&](Float u, Float v) {
    const Float z = in.z + in.dzdu * (u - half) + in.dzdv * (v - half);
    return lesser(greater(z, z_nearest), z_farthest);
  };
  out.z_min = z_farthest, out.z_max = z_nearest;
  const auto include = [&](bool valid, Float z) {
    out.z_min = select(valid, lesser(out.z_min, z), out.z_min);
    out.z_max = select(valid, greater(out.z_max, z), out.z_max);
  };
  for (int k = 0; k < 3; ++k) {
    const bool inside_u = (in.u[k] >= zero) & (in.u[k] <= one), inside_v = (in.v[k] >= zero) & (in.v[k] <= one);
    include(inside_u & inside_v, in.vertex_z[k]);
  }
  const Float corner_u[4] = {zero, one, zero, one}, corner_v[4] = {zero, zero, one, one};
  for (int i = 0; i < 4; ++i) {
    const bool inside = (in.corner[0][i] >= zero) & (in.corner[1][i] >= zero) & (in.corner[2][i] >= zero);
    include(inside, plane(corner_u[i], corner_v[i]));
  }
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Float* corner = in.corner[k];
    const auto crossing = [&](int from, int to) {  // parameter 0..1 along the border between two corners
      const Float difference = corner[from] - corner[to];
      return corner[from] / select(difference == zero, one, difference);
    };
    for (int side = 0; side < 2; ++side) {  // u = 0 and u = 1, then v = 0 and v = 1
      const Float border = side == 0 ? zero : one;
      const bool straddles_u = (in.u[k] < border) != (in.u[next] < border);
      const bool along_v = (corner[side] < zero) != (corner[side + 2] < zero);
      include(straddles_u & along_v, plane(border, crossing(side, side + 2)));
      const bool straddles_v = (in.v[k] < border) != (in.v[next] < border);
      const bool along_u = (corner[2 * side] < zero) != (corner[2 * side + 1] < zero);
      include(straddles_v & along_u, plane(crossing(2 * side, 2 * side + 1), border));
    }
  }
  return out;
}

}  // namespace beampipe
