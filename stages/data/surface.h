// What vertex_setup hands on for triangles whose surface varies: the vertices' attributes, and where in its triangle a
// point of the screen lies, in perspective.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "simd/scalar.h"

namespace beampipe {

// A vertex as the fragment shader sees it. Attributes that the mesh does not have are 0, and its colour is white.
template <class Real>
struct SurfaceVertexOf {
  std::array<Real, 3> to_eye{};   // world space, not normalised
  std::array<Real, 3> normal{};   // world space, not normalised
  std::array<Real, 3> tangent{};  // world space, not normalised
  Real tangent_sign{};            // of the bitangent
  std::array<std::array<Real, 2>, 2> uvs{};
  std::array<Real, 4> color{Real(1.0f), Real(1.0f), Real(1.0f), Real(1.0f)};
};
using SurfaceVertex = SurfaceVertexOf<float>;

// A quantity that is linear on the screen: its value at the anchor, and its slopes per pixel.
template <class Real>
struct ScreenPlane {
  Real value{}, dx{}, dy{};
};

// Weights of a triangle's second and third vertex; the first one has the rest. `dx` and `dy`: per pixel.
template <class Real>
struct Barycentrics {
  Real second{}, third{};
};

// Weights divided by w are linear on the screen; with 1 / w, which is linear too, they give the weights in perspective.
// All three are multiplied by the smallest w.
template <class Real>
struct BarycentricPlanes {
  ScreenPlane<Real> inverse_w, second, third;
};

// Outside of its triangle a weight grows without limit where the triangle's plane comes near the eye. This is as far as
// it may go.
inline constexpr float kMostWeight = 16.0f;

namespace scalar {
#include "stages/data/surface-inl.h"
}
using namespace scalar;

inline constexpr std::uint32_t kFlatSurface = ~0u;
inline constexpr std::uint32_t kProgramSurface = kFlatSurface - 1;  // the draw's program shades it

// One for each setup triangle.
struct SetupSurface {
  std::uint32_t material = kFlatSurface;    // index into Trace::materials; or one of the above
  std::uint32_t trace_triangle = 0;         // index into the triangles of its draw's mesh
  std::array<std::uint32_t, 3> vertices{};  // of that triangle: indices into SetupTriangles::vertices
  bool is_opaque = true;                    // it hides what lies behind it, wherever it covers
  bool is_blended = false;                  // by its material
  bool turned = false;                      // the viewer sees its back: vertices' normals are turned around
  bool has_own_normal = false;              // the mesh has no normals: FlatAttributes::normal is used
  glm::vec4 tangent{0.0f};           // of the triangle, w: sign of the bitangent; where a normal texture needs it
  float anchor_x = 0, anchor_y = 0;  // pixels, frame coordinates
  BarycentricPlanes<float> planes;   // through snapped corners, or of programs through those that are not snapped
};

// Size in the modelled machine: three planes, which have the depth plane's anchor, the material, and the numbers of
// three vertices.
inline constexpr std::uint64_t kSurfaceBytes = 9 * 4 + 4 + 3 * 4;

}  // namespace beampipe
