// Which mask positions of a pixel a triangle covers: the exact edge tests that msaa:N makes for its samples.
//
// The positions (cell_patterns in simd/sample_pattern.h) are the same 8 in every cell of a grid. So the value of an
// edge changes by the same amount from one cell to the next, for all 8. An edge with the whole pixel inside tests
// nothing.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/scalar.h"
#include "simd/triangle_in_pixel.h"
#include "simd/wide_mask.h"

namespace beampipe {

// 32, 64, 128 or 256 positions.
struct PositionGrid {
  CellCounts cells;
  int cell_width = 0, cell_height = 0;  // 1/256 px
  SamplePattern first_cells;            // 16 positions, those of the first two cells of the first row

  explicit PositionGrid(int count);
  int count() const { return 8 * cells.columns * cells.rows; }
};

// Edges whose slopes a and b are all below this take 32-bit integers: their values at positions are below 2^29. Beyond
// +-kDecidedByC, c decides the sign on its own.
inline constexpr std::int32_t kSmallSlope = 1 << 20, kDecidedByC = 1 << 30;

// How many edges of the triangles were tested, those with the whole pixel inside left out.
struct EdgesTested {
  std::uint64_t narrow = 0, wide = 0;  // with 32 and with 64 bits

  void operator+=(const EdgesTested& more) { narrow += more.narrow, wide += more.wide; }
};

// masks[i] = the positions that in[i] covers, by the top-left rule. Lanes are across positions.
EdgesTested position_masks(const TriangleInPixel* in, std::size_t count, const PositionGrid& grid, WideMask* masks);

// ---- The scalar twin: one edge after the other. Wide is std::int64_t, double or a counting
// number; Int is std::int32_t too. ----

// Edge k. A position is inside if the edge's value there is >= 0.
template <class Wide>
EdgeInPixel<Wide> edge_for_positions(const TriangleInPixelOf<Wide>& in, int k) {
  EdgeInPixel<Wide> edge = edge_in_pixel(in, k);
  edge.c = edge.c - Wide(owns_its_samples(edge.a, edge.b) ? 0 : 1);
  return edge;
}

// Is the whole pixel inside?
template <class Wide>
bool is_pixel_inside(const EdgeInPixel<Wide>& edge) {
  const Wide zero(0);
  return edge.c + Wide(kSubpixelUnits) * (lesser(edge.a, zero) + lesser(edge.b, zero)) >= zero;
}

template <class Wide>
auto narrowed(const EdgeInPixel<Wide>& edge) {
  const Wide c = lesser(greater(edge.c, Wide(-kDecidedByC)), Wide(kDecidedByC));
  return EdgeInPixel<decltype(low_word(c))>{low_word(edge.a), low_word(edge.b), low_word(c)};
}

template <class Wide>
bool has_small_slopes(const EdgeInPixel<Wide>& edge) {
  return greater(magnitude(edge.a), magnitude(edge.b)) < Wide(kSmallSlope);
}

// mask &= the positions inside the edge. Each word is shifted in from its last position to its first.
template <class Int, class Word>
void cut_mask(const EdgeInPixel<Int>& edge, const PositionGrid& grid, Word* mask) {
  const Int right = edge.a * Int(grid.cell_width), down = edge.b * Int(grid.cell_height);
  const int last_column = grid.cells.columns - 1, last_row = grid.cells.rows - 1;
  Int in_row[8];  // at the positions of the row's last cell
  for (std::size_t s = 0; s < 8; ++s)
    in_row[s] = edge.a * Int(grid.first_cells.x[s] + last_column * grid.cell_width) +
                (edge.b * Int(grid.first_cells.y[s] + last_row * grid.cell_height) + edge.c);
  int word = grid.count() / kMaxMaskSamples - 1, shifted = 0;
  Word outside{};
  for (int row = last_row; row >= 0; --row) {
    Int at[8];
    for (std::size_t s = 0; s < 8; ++s) at[s] = in_row[s];
    for (int column = last_column; column >= 0; --column) {
      for (std::size_t s = 8; s-- > 0; ++shifted) outside = shift_in_sign(outside, at[s]);
      if (shifted == kMaxMaskSamples) mask[word] = mask[word] & ~outside, --word, shifted = 0;
      for (std::size_t s = 0; s < 8 && column > 0; ++s) at[s] = at[s] - right;
    }
    for (std::size_t s = 0; s < 8 && row > 0; ++s) in_row[s] = in_row[s] - down;
  }
}

template <class Wide>
WideMask position_mask_scalar(const TriangleInPixelOf<Wide>& in, const PositionGrid& grid) {
  using Word = decltype(sign_bit(in.x[0]));
  const auto count = static_cast<std::size_t>(grid.count() / kMaxMaskSamples);
  Word words[kMaxMaskWords];
  for (std::size_t w = 0; w < count; ++w) words[w] = Word(~0u);
  for (int k = 0; k < 3; ++k) {
    const EdgeInPixel<Wide> edge = edge_for_positions(in, k);
    if (is_pixel_inside(edge)) continue;
    if (has_small_slopes(edge)) {
      cut_mask(narrowed(edge), grid, words);
    } else {
      cut_mask(edge, grid, words);
    }
  }
  WideMask mask;
  for (std::size_t w = 0; w < count; ++w) mask.words[w] = plain(words[w]);
  return mask;
}

}  // namespace beampipe
