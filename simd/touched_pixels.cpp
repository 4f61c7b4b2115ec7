#include "simd/touched_pixels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/touched_pixels.cpp"
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

// Two quads in the order of a row's bits: columns, rows, quads and bits of their pixels.
constexpr std::size_t kGroup = 8;
alignas(32) constexpr std::int32_t kColumn[kGroup] = {0, 1, 0, 1, 2, 3, 2, 3};
alignas(32) constexpr std::int32_t kRow[kGroup] = {0, 0, 1, 1, 0, 0, 1, 1};
alignas(32) constexpr std::int32_t kQuad[kGroup] = {0, 0, 0, 0, 1, 1, 1, 1};
alignas(32) constexpr std::int32_t kBit[kGroup] = {1, 2, 4, 8, 16, 32, 64, 128};

// Appends the touched pixels of a row. Vectors are compressed, because no processor predicts which pixels are touched.
HWY_INLINE std::size_t append_row(const PixelRow& row, std::size_t count, TouchedPixels& out) {
  const hn::CappedTag<std::int32_t, kGroup> d;
  const std::size_t lanes = hn::Lanes(d);
  std::int32_t x = row.x, quad = static_cast<std::int32_t>(row.quad);
  std::uint64_t full = row.pixels.full;
  for (std::uint64_t touched = row.pixels.touched; touched != 0; touched >>= kGroup, full >>= kGroup) {
    for (std::size_t lane = 0; lane < kGroup; lane += lanes) {
      const std::uint8_t bits[8] = {static_cast<std::uint8_t>((touched & 0xff) >> lane)};
      const auto mask = hn::LoadMaskBits(d, bits);
      const auto append = [&](auto values, void* column) {
        hn::StoreU(hn::Compress(values, mask), d, static_cast<std::int32_t*>(column) + count);
      };
      append(hn::Add(hn::Set(d, x), hn::Load(d, kColumn + lane)), out.x);
      append(hn::Add(hn::Set(d, row.y), hn::Load(d, kRow + lane)), out.y);
      append(hn::Add(hn::Set(d, quad), hn::Load(d, kQuad + lane)), out.quad);
      append(hn::And(hn::Set(d, static_cast<std::int32_t>(full & 0xff)), hn::Load(d, kBit + lane)), out.full);
      count += hn::CountTrue(d, mask);
    }
    x += 4, quad += 2;
  }
  return count;
}

HWY_INLINE void find_bounds(std::size_t count, const AnchoredPlane<double>& plane, const DepthBounds<float>& vertices,
                            TouchedPixels& pixels) {
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

std::size_t touched_pixels_kernel(const PixelRow* rows, std::size_t count, const AnchoredPlane<double>& plane,
                                  const DepthBounds<float>& vertices, TouchedPixels& out) {
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < count; ++i) pixels = append_row(rows[i], pixels, out);
  find_bounds(pixels, plane, vertices, out);
  return pixels;
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(touched_pixels_kernel);
std::size_t touched_pixels(const PixelRow* rows, std::size_t count, const AnchoredPlane<double>& plane,
                           const DepthBounds<float>& vertices, TouchedPixels& out) {
  return HWY_DYNAMIC_DISPATCH(touched_pixels_kernel)(rows, count, plane, vertices, out);
}
}  // namespace beampipe
#endif
