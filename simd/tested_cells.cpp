#include "simd/tested_cells.h"

#include "simd/depth_bounds.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/tested_cells.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

#include "simd/depth_bounds-inl.h"

void set_tested_cells_kernel(const TileOfCells& tile, const AnchoredPlane<double>& depth, const TriangleCells& cells,
                             std::size_t count, SampleAccess* items, CellPlane<float>* planes) {
  const IntTag di;
  const WordTag dw;
  const FloatTag df;
  const int columns = tile.log2_columns, rows = tile.log2_rows;
  const Doubles cell_width(1.0 / (1 << columns)), cell_height(1.0 / (1 << rows));  // pixels; exact
  const AnchoredPlane<Doubles> plane{Doubles(depth.z), Doubles(depth.dzdx), Doubles(depth.dzdy),
                                     Doubles(depth.anchor_x), Doubles(depth.anchor_y)};
  const double unit = 1.0 / kSubpixelUnits;
  const auto dzdx = hn::Set(df, static_cast<float>(depth.dzdx * unit));
  const auto dzdy = hn::Set(df, static_cast<float>(depth.dzdy * unit));
  const Ints last_column((1 << columns) - 1), last_row((1 << rows) - 1);
  const auto x0 = hn::Set(di, tile.x0), y0 = hn::Set(di, tile.y0), width = hn::Set(di, tile.width);
  const auto triangle = hn::Set(dw, cells.triangle);
  for (std::size_t i = 0; i < count; i += hn::Lanes(df)) {
    const Ints x(hn::LoadU(di, cells.x + i)), y(hn::LoadU(di, cells.y + i));
    const auto pixel_x = hn::Sub(hn::ShiftRightSame(x.raw, columns), x0);
    const auto pixel_y = hn::Sub(hn::ShiftRightSame(y.raw, rows), y0);
    const auto pixel = hn::ShiftLeftSame(hn::Add(hn::Mul(pixel_y, width), pixel_x), columns + rows);
    const auto in_pixel = hn::Or(hn::ShiftLeftSame((y & last_row).raw, columns), (x & last_column).raw);
    const Floats z = to_float(depth_at(plane, Doubles(x) * cell_width, Doubles(y) * cell_height));
    hn::StoreInterleaved4(hn::BitCast(dw, hn::Or(pixel, in_pixel)), triangle, hn::LoadU(dw, cells.masks + i),
                          hn::Zero(dw), dw, &items[i].cell);
    hn::StoreInterleaved3(z.raw, dzdx, dzdy, df, &planes[i].z);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(set_tested_cells_kernel);
void set_tested_cells(const TileOfCells& tile, const AnchoredPlane<double>& depth, const TriangleCells& cells,
                      std::size_t count, SampleAccess* items, CellPlane<float>* planes) {
  HWY_DYNAMIC_DISPATCH(set_tested_cells_kernel)(tile, depth, cells, count, items, planes);
}
}  // namespace beampipe
#endif
