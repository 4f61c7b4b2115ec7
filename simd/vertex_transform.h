// The vertices of a draw in clip space and on the screen. In double precision, so that the only rounding that matters
// is the one to 1/256 px.
//
// Clip space: x, y and z of a vertex in view lie in [-w, w]. Screen: x to the right and y down, in pixels from the
// upper left corner of the picture; depth from -1 near to 0 far.
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
  ScreenVertex<double> screen;  // x and y are snapped to 1/256 px; all are 0 unless in view
  std::int32_t x, y;            // the same x and y in 1/256 px
  bool finite, in_view;
};

// From object space to the screen.
struct VertexTransform {
  std::array<double, 16> to_clip;  // column-major
  double width, height;            // pixels
};

// `positions` holds x, y, z of each vertex; `ws` its w, or null if w is 1 everywhere. Returns how many vertices are in
// view. Lanes are across vertices. The same bits as the formulas on double, on every target.
std::size_t transform_vertices(const float* positions, std::size_t count, const VertexTransform& transform,
                               ProjectedVertex* out, const float* ws = nullptr);

namespace scalar {
#include "simd/vertex_transform-inl.h"
}
using namespace scalar;

// Sets `screen`, x and y of a vertex with w > 0.
inline void place_on_screen(const VertexTransform& transform, ProjectedVertex& vertex) {
  const auto snap = [](double pixels) { return static_cast<std::int32_t>(std::floor(to_grid(pixels))); };
  vertex.screen = project<double>(vertex.clip, transform.width, transform.height);
  vertex.x = snap(vertex.screen.x), vertex.y = snap(vertex.screen.y);
  vertex.screen.x = vertex.x * (1.0 / kSubpixelUnits), vertex.screen.y = vertex.y * (1.0 / kSubpixelUnits);
}

inline ProjectedVertex transform_vertex_scalar(const VertexTransform& transform, float x, float y, float z,
                                               const float* w = nullptr) {
  ProjectedVertex vertex{};
  vertex.clip = w ? transform_vertex<double>(transform.to_clip, x, y, z, *w)
                  : transform_vertex<double>(transform.to_clip, x, y, z);
  vertex.finite = std::isfinite(vertex.clip.x + vertex.clip.y + vertex.clip.z + vertex.clip.w);
  vertex.in_view = vertex.finite && in_view(vertex.clip);
  if (vertex.in_view) place_on_screen(transform, vertex);
  return vertex;
}

}  // namespace beampipe
