// Depth planes and face normals of triangles, a block of them at once. In double precision, as the vertices are.
#pragma once

#include <array>
#include <cstddef>

#include "simd/scalar.h"
#include "simd/vertex_transform.h"

namespace beampipe {

// Slopes of the depth plane through three snapped vertices, per pixel.
template <class Real>
struct Slopes {
  Real dzdx, dzdy;
};

// The depth plane of a triangle: z at the anchor, which is one of its vertices, in pixels.
template <class Real>
struct AnchoredPlane {
  Real z{}, dzdx{}, dzdy{}, anchor_x{}, anchor_y{};
};

template <class Real>
struct Vector {
  Real x, y, z;
};

namespace scalar {
#include "simd/triangle_setup-inl.h"
}
using namespace scalar;

inline constexpr std::size_t kSetupBlock = 16;  // triangles

// A column of numbers for each coordinate of each corner. Lanes are across triangles. Of triangles past `count`, all
// results are unspecified.
struct ScreenCorners {
  alignas(64) double x[3][kSetupBlock], y[3][kSetupBlock], z[3][kSetupBlock];  // as in ScreenVertex
};
struct DepthPlaneColumns {
  alignas(64) double z[kSetupBlock], dzdx[kSetupBlock], dzdy[kSetupBlock], anchor_x[kSetupBlock], anchor_y[kSetupBlock];
};
struct MeshCorners {
  alignas(64) double x[3][kSetupBlock], y[3][kSetupBlock], z[3][kSetupBlock];  // in the mesh's space
  alignas(64) double side[kSetupBlock];                                        // 1 or -1, as in unit_normal
};
struct NormalColumns {
  alignas(64) float x[kSetupBlock], y[kSetupBlock], z[kSetupBlock];
};

// depth_plane_of, for triangles 0 .. count - 1 of a block. The same bits as the formula on double, on every target.
void depth_planes(const ScreenCorners& corners, std::size_t count, DepthPlaneColumns& planes);

// The same for unit_normal. `to_world`: column-major.
void unit_normals(const std::array<double, 16>& to_world, const MeshCorners& corners, std::size_t count,
                  NormalColumns& normals);

}  // namespace beampipe
