// Which mask positions or samples a surface takes that lets part of the light through.
//
// A surface of opacity a takes the part a of the positions that it covers. The positions of several surfaces must be
// independent of each other: of those that the first leaves, the second must take its part. So each draw ranks the
// positions by a dimension of a Sobol sequence: any two dimensions together are evenly distributed. Within a draw,
// triangles with the same first vertex, such as the halves of a rectangle, share a dimension.
//
// Source of the direction numbers: Joe and Kuo 2008, "Constructing Sobol sequences with better two-dimensional
// projections", new-joe-kuo-6.
#pragma once

#include <array>
#include <cstdint>

#include "stages/data/mix_bits.h"

namespace beampipe {

inline constexpr std::size_t kOpacityDimensions = 16;

namespace sobol {

// A primitive polynomial by its degree and inner coefficients, and the first direction numbers.
struct Direction {
  std::uint32_t degree, coefficients;
  std::array<std::uint32_t, 6> numbers;
};
inline constexpr std::array<Direction, kOpacityDimensions - 1> kDirections = {{{1, 0, {1}},
                                                                               {2, 1, {1, 3}},
                                                                               {3, 1, {1, 3, 1}},
                                                                               {3, 2, {1, 1, 1}},
                                                                               {4, 1, {1, 1, 3, 3}},
                                                                               {4, 4, {1, 3, 5, 13}},
                                                                               {5, 2, {1, 1, 5, 5, 17}},
                                                                               {5, 4, {1, 1, 5, 5, 5}},
                                                                               {5, 7, {1, 1, 7, 11, 19}},
                                                                               {5, 11, {1, 1, 5, 1, 1}},
                                                                               {5, 13, {1, 1, 1, 3, 11}},
                                                                               {5, 14, {1, 3, 5, 5, 31}},
                                                                               {6, 1, {1, 3, 3, 9, 7, 49}},
                                                                               {6, 13, {1, 1, 1, 15, 21, 21}},
                                                                               {6, 16, {1, 3, 1, 13, 27, 49}}}};

constexpr int kBits = 8;

// Column b: what bit b of an index adds to its rank.
using Columns = std::array<std::uint8_t, kBits>;

constexpr std::array<Columns, kOpacityDimensions> make_columns() {
  std::array<Columns, kOpacityDimensions> columns{};
  for (int b = 0; b < kBits; ++b) columns[0][b] = static_cast<std::uint8_t>(1u << (kBits - 1 - b));
  for (std::size_t d = 1; d < kOpacityDimensions; ++d) {
    const Direction& direction = kDirections[d - 1];
    std::array<std::uint32_t, kBits> m{};
    for (std::uint32_t b = 0; b < kBits; ++b) {
      if (b < direction.degree) {
        m[b] = direction.numbers[b];
      } else {
        m[b] = m[b - direction.degree] ^ m[b - direction.degree] << direction.degree;
        for (std::uint32_t k = 1; k < direction.degree; ++k)
          if (direction.coefficients >> (direction.degree - 1 - k) & 1) m[b] ^= m[b - k] << k;
      }
      columns[d][b] = static_cast<std::uint8_t>(m[b] << (kBits - 1 - b));
    }
  }
  return columns;
}
inline constexpr std::array<Columns, kOpacityDimensions> kColumns = make_columns();

}  // namespace sobol

// The positions that a part of a draw takes in a pixel. Positions: at most 256.
class OpacityRanks {
 public:
  // (x, y): the pixel. `part`: of the draw; SetupSurface::first_vertex.
  OpacityRanks(std::uint32_t draw, std::int32_t x, std::int32_t y, std::uint32_t part = 0)
      : columns_(sobol::kColumns[(draw + mix_bits(part)) % kOpacityDimensions]) {
    const std::uint32_t of_part = mix_bits(draw + 1) + mix_bits(part);
    const std::uint32_t random =
        mix_bits(mix_bits(of_part + static_cast<std::uint32_t>(x)) + static_cast<std::uint32_t>(y));
    flip_ = static_cast<std::uint8_t>(random);
    offset_ = static_cast<float>(random >> 16) * (1.0f / 65536.0f);
  }

  // 0..256, different for all positions.
  float rank(std::uint32_t position) const {
    std::uint32_t rank = flip_;
    for (std::uint32_t b = 0; b < sobol::kBits; ++b) rank ^= (position >> b & 1) * columns_[b];
    return static_cast<float>(rank) + offset_;
  }

  bool takes(std::uint32_t position, float opacity) const { return rank(position) < opacity * 256.0f; }

 private:
  const sobol::Columns& columns_;
  std::uint8_t flip_;  // both differ from pixel to pixel
  float offset_;
};

}  // namespace beampipe
