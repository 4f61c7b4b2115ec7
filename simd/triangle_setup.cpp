#include "simd/triangle_setup.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/triangle_setup.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

#include "simd/triangle_setup-inl.h"

using D = hn::CappedTag<double, 8>;
using Reals = Lanes<D>;

HWY_INLINE Reals load(const double* column) { return Reals(hn::Load(D(), column)); }
HWY_INLINE void store(Reals values, double* column) { hn::Store(values.raw, D(), column); }
HWY_INLINE void store(Reals values, float* column) {
  const hn::Rebind<float, D> d;
  hn::Store(hn::DemoteTo(d, values.raw), d, column);
}

void depth_planes_kernel(const ScreenCorners& corners, std::size_t count, DepthPlaneColumns& planes) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const auto vertex = [&](int k) {
      return ScreenVertex<Reals>{load(corners.x[k] + i), load(corners.y[k] + i), load(corners.z[k] + i)};
    };
    const AnchoredPlane<Reals> plane = depth_plane_of(vertex(0), vertex(1), vertex(2));
    store(plane.z, planes.z + i), store(plane.dzdx, planes.dzdx + i), store(plane.dzdy, planes.dzdy + i);
    store(plane.anchor_x, planes.anchor_x + i), store(plane.anchor_y, planes.anchor_y + i);
  }
}

void unit_normals_kernel(const std::array<double, 16>& to_world, const MeshCorners& corners, std::size_t count,
                         NormalColumns& normals) {
  std::array<Reals, 16> matrix;
  for (std::size_t i = 0; i < 16; ++i) matrix[i] = Reals(to_world[i]);
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const auto corner = [&](int k) {
      return Vector<Reals>{load(corners.x[k] + i), load(corners.y[k] + i), load(corners.z[k] + i)};
    };
    const Vector<Reals> of_mesh[3] = {corner(0), corner(1), corner(2)};
    const Vector<Reals> normal = unit_normal(matrix, of_mesh, load(corners.side + i));
    store(normal.x, normals.x + i), store(normal.y, normals.y + i), store(normal.z, normals.z + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(depth_planes_kernel);
void depth_planes(const ScreenCorners& corners, std::size_t count, DepthPlaneColumns& planes) {
  HWY_DYNAMIC_DISPATCH(depth_planes_kernel)(corners, count, planes);
}
HWY_EXPORT(unit_normals_kernel);
void unit_normals(const std::array<double, 16>& to_world, const MeshCorners& corners, std::size_t count,
                  NormalColumns& normals) {
  HWY_DYNAMIC_DISPATCH(unit_normals_kernel)(to_world, corners, count, normals);
}
}  // namespace beampipe
#endif
