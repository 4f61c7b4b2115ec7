// A draw's vertices in clip space and on screen. Double precision: one rounding to 1/256 px is all that a vertex gets.
//
// Clip space: x, y and z of what is in view lie in [-w, w]. Screen: stages/data/setup_triangle.h.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "simd/sample_pattern.h"
#include "simd/scalar.h"

namespace beampipe {

template <class Real>
struct ClipVertex {
  Real x, y, z, w;
};

template <class Real>
struct ScreenVertex {
  Real x, y, z;  // pixels, pixels, depth
};

struct ProjectedVertex {
  ClipVertex<double> clip;
  ScreenVertex<double> screen;  // x and y snapped; 0 unless in view
  std::int32_t x, y;            // 1/256 px
  bool finite, in_view;
};

// From objects to the screen.
struct VertexTransform {
  std::array<double, 16> to_clip;  // column-major
  double width, height;            // pixels
};

// `positions`: x, y, z of each vertex. Returns how many are in view. Lanes are across vertices.
std::size_t transform_vertices(const float* positions, std::size_t count, const VertexTransform& transform,
                               ProjectedVertex* out);

// ---- Scalar twins, Real is double or a counting number ----

template <class Real>
ClipVertex<Real> transform_vertex(const std::array<Real, 16>& m, Real x, Real y, Real z) {
  const auto row = [&](std::size_t r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
  return {row(0), row(1), row(2), row(3)};
}

template <class Real>
bool in_view(const ClipVertex<Real>& v) {
  return (v.w > Real(0.0)) & (magnitude(v.x) <= v.w) & (magnitude(v.y) <= v.w) & (magnitude(v.z) <= v.w);
}

// Viewport transform. Depth goes from [-1, 1] to [-1, 0].
template <class Real>
ScreenVertex<Real> project(const ClipVertex<Real>& v, Real width, Real height) {
  const Real half(0.5), one(1.0);
  const Real inverse_w = one / v.w;
  return {(v.x * inverse_w + one) * half * width, (one - v.y * inverse_w) * half * height,
          (v.z * inverse_w - one) * half};
}

// Before it is rounded down to an integer: pixels in 1/256 px.
template <class Real>
Real to_grid(Real pixels) {
  return pixels * Real(double{kSubpixelUnits}) + Real(0.5);
}

// Of a vertex with w > 0: sets what is known on screen.
inline void place_on_screen(const VertexTransform& transform, ProjectedVertex& vertex) {
  const auto snap = [](double pixels) { return static_cast<std::int32_t>(std::floor(to_grid(pixels))); };
  vertex.screen = project<double>(vertex.clip, transform.width, transform.height);
  vertex.x = snap(vertex.screen.x), vertex.y = snap(vertex.screen.y);
  vertex.screen.x = vertex.x * (1.0 / kSubpixelUnits), vertex.screen.y = vertex.y * (1.0 / kSubpixelUnits);
}

inline ProjectedVertex transform_vertex_scalar(const VertexTransform& transform, float x, float y, float z) {
  ProjectedVertex vertex{};
  vertex.clip = transform_vertex<double>(transform.to_clip, x, y, z);
  vertex.finite = std::isfinite(vertex.clip.x + vertex.clip.y + vertex.clip.z + vertex.clip.w);
  vertex.in_view = vertex.finite && in_view(vertex.clip);
  if (vertex.in_view) place_on_screen(transform, vertex);
  return vertex;
}

}  // namespace beampipe
