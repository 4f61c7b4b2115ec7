// What the depth test reads of a triangle's cells: their numbers and the triangle's depth there.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/depth_compare.h"
#include "simd/depth_plane.h"
#include "simd/triangle_setup.h"

namespace beampipe {

// A tile of pixels, which are grids of cells.
struct TileOfCells {
  std::int32_t x0, y0, width;   // pixels
  int log2_columns, log2_rows;  // of a pixel's cells
};

// Cells of one triangle, in frame coordinates, and the samples of them that it covers.
struct TriangleCells {
  std::uint32_t triangle;
  const std::int32_t *x, *y;
  const std::uint32_t* masks;
};

// So many elements after the last one are read and written too.
inline constexpr std::size_t kTestedSlack = 16;

// Sets items[i], of which nothing has passed, and planes[i]: the triangle's depth from the upper left corner of cell i,
// and its slopes per 1/256 px. Cells are numbered pixel by pixel. Lanes are across cells. The same bits as cell_plane()
// on every target.
void set_tested_cells(const TileOfCells& tile, const AnchoredPlane<double>& depth, const TriangleCells& cells,
                      std::size_t count, SampleAccess* items, CellPlane<float>* planes);

}  // namespace beampipe
