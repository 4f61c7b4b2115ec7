#include "simd/depth_bounds.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/depth_bounds.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// This order: a formula finds only those above it.
#include "simd/depth_plane-inl.h"
//
#include "simd/depth_bounds-inl.h"

void find_pair_bounds_kernel(const AnchoredPlane<double>& plane, const DepthBounds<float>& vertices, std::size_t count,
                             PixelBounds& pixels) {
  const FloatTag d;
  const AnchoredPlane<Doubles> planes{Doubles(plane.z), Doubles(plane.dzdx), Doubles(plane.dzdy),
                                      Doubles(plane.anchor_x), Doubles(plane.anchor_y)};
  const Floats dzdu(static_cast<float>(plane.dzdx)), dzdv(static_cast<float>(plane.dzdy));
  const DepthBounds<Floats> anywhere{Floats(vertices.nearest), Floats(vertices.farthest)};
  const Doubles half(0.5);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto centre = [&](const std::int32_t* column) {
      return Doubles(Ints(hn::Load(IntTag(), column + i))) + half;
    };
    const Floats z = to_float(depth_at(planes, centre(pixels.x), centre(pixels.y)));
    const DepthBounds<Floats> bounds = pair_bounds<Floats>({z, dzdu, dzdv}, anywhere);
    hn::Store(bounds.nearest.raw, d, pixels.nearest + i), hn::Store(bounds.farthest.raw, d, pixels.farthest + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(find_pair_bounds_kernel);
void find_pair_bounds(const AnchoredPlane<double>& plane, const DepthBounds<float>& vertices, std::size_t count,
                      PixelBounds& pixels) {
  HWY_DYNAMIC_DISPATCH(find_pair_bounds_kernel)(plane, vertices, count, pixels);
}
}  // namespace beampipe
#endif
