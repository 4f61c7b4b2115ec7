// Setup triangles: the result of vertex_setup and the input of every raster stage.
//
// Screen space: x points right and y points down. Pixel (0, 0) is the upper left one and covers [0, 1] x [0, 1].
// Positions are integers in 1/256 px. Depth is linear in screen space, -1 at the near plane and 0 at the far plane:
// (z / w - 1) / 2. As in reversed Z, float precision is highest near 0, i.e. far away. Depths of draws whose state puts
// them elsewhere (stages/geometry/depth_order.h) lie between -2 and 1.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "simd/depth_bounds.h"
#include "stages/data/draw_placement.h"
#include "stages/data/surface.h"

namespace beampipe {

// A triangle's depth plane. Three vertices give the same bits in any order. Real is double or a number that counts.
template <class Real>
struct ScreenDepthOf : AnchoredPlane<Real> {
  // Depth at (x, y), in pixels.
  Real at(Real x, Real y) const { return depth_at(*this, x, y); }
};
using ScreenDepth = ScreenDepthOf<double>;

struct SetupTriangle {
  // Vertices in 1/256 px, |x| and |y| <= 2^23, ordered such that the inside is at E >= 0 for every edge (see Edge).
  std::int32_t x[3], y[3];
  float vertex_z[3];
  ScreenDepth depth;
  bool front;  // the trace's vertices are counter-clockwise on screen
};

// A triangle's inputs for flat shading; they are the same at every pixel.
struct FlatAttributes {
  glm::vec3 kd;
  glm::vec3 normal;  // world space, unit length, towards the viewer
  bool lit;          // by Lambert's law; else the colour is kd
};

struct SetupTriangles {
  // In primitive order, except that opaque triangles that win against earlier ones at equal depth come first, the last
  // one first. Clipping may turn one triangle into several in a row.
  std::vector<SetupTriangle> triangles;
  std::vector<FlatAttributes> attributes;  // one per triangle
  std::vector<std::uint32_t> draws;        // one per triangle: index into Frame::draws
  std::vector<SetupSurface> surfaces;      // one per triangle; empty if all triangles are flat
  // One per triangle, if vertex_setup numbers them: index into the triangles of its draw's mesh.
  std::vector<std::uint32_t> trace_triangles;
  std::vector<SurfaceVertex> vertices;    // of the draws with materials
  std::vector<DrawPlacement> placements;  // one per draw of the frame; empty if no draw has state
  DrawOrder order =
      DrawOrder::by_depth;  // in the API's order, triangles are in primitive order, and depths lie in -1..0

  bool is_opaque(std::uint32_t triangle) const { return surfaces.empty() || surfaces[triangle].is_opaque; }

  static constexpr std::uint64_t kTriangleBytes =
      sizeof(SetupTriangle) + sizeof(FlatAttributes) + sizeof(std::uint32_t);

  void reserve(std::size_t count) {
    triangles.reserve(count);
    attributes.reserve(count);
    draws.reserve(count);
  }
  // Triangles alone.
  void clear() {
    triangles.clear();
    attributes.clear();
    draws.clear();
    surfaces.clear();
    trace_triangles.clear();
  }
};

// Edge from vertex k to vertex k + 1: E(x, y) = a x + b y + c, with x and y in 1/256 px. E >= 0 inside. `owns` is the
// top-left rule: a sample exactly on the edge belongs to the triangle if this is a left edge (a > 0) or a horizontal
// top edge (a = 0, b > 0).
struct Edge {
  std::int32_t a, b;
  std::int64_t c;
  bool owns;

  std::int64_t at(std::int64_t x, std::int64_t y) const { return a * x + b * y + c; }
};

inline Edge edge_of(const SetupTriangle& triangle, int k) {
  const int next = (k + 1) % 3;
  Edge edge;
  edge.a = triangle.y[k] - triangle.y[next];
  edge.b = triangle.x[next] - triangle.x[k];
  edge.c = -(std::int64_t{edge.a} * triangle.x[k] + std::int64_t{edge.b} * triangle.y[k]);
  edge.owns = edge.a > 0 || (edge.a == 0 && edge.b > 0);
  return edge;
}

}  // namespace beampipe
