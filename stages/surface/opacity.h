// Which mask positions or samples a surface takes that lets part of the light through.
//
// A surface of opacity a takes the part a of the positions that it covers. The positions of several surfaces must be
// independent of each other: of those that the first leaves, the second must take its part. So each sheet
// (stages/surface/sheets.h) ranks the positions in an order of its own, and takes those of the lowest ranks.
//
// Of 2^m positions, a rank has m bits, and each bit is the parity of some bits of the position's number: of those that
// are set in an element of the field GF(2^m). Bit by bit, order k uses the elements b0 g^k, b1 g^k, ..., where b0, b1,
// ... is a basis of the field. Different orders have different leading bits, so that of two sheets of opacity 1/2 each
// takes half of the other's positions. As m powers of g in a row are a basis, the leading bits of m orders k in a row
// do not depend on each other. And where the field has subfields, their elements come first in the basis: with 256
// positions, the two leading bits of one order depend on those of only two others, where the factor between them lies
// in GF(4), and the four leading bits on those of 14 others, where it lies in GF(16).
//
// Source of the primitive polynomials: Lidl and Niederreiter, "Finite Fields", table C.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "stages/data/mix_bits.h"

namespace beampipe {

namespace opacity {

constexpr int kMostBits = 8;  // of a position's number

// Column b: what bit b of a position's number adds to its rank, whose leading bit is bit 7.
using Columns = std::array<std::uint8_t, kMostBits>;

struct Orders {
  std::array<Columns, 1 << kMostBits> columns{};
  std::uint32_t count = 0;
};

// In GF(2^bits).
constexpr std::uint32_t product(std::uint32_t a, std::uint32_t b, int bits) {
  constexpr std::array<std::uint32_t, kMostBits + 1> kPolynomials = {1, 3, 7, 11, 19, 37, 67, 131, 285};
  std::uint32_t product = 0;
  for (; b != 0; b >>= 1) {
    if (b & 1) product ^= a;
    a <<= 1;
    if (a >> bits & 1) a ^= kPolynomials[static_cast<std::size_t>(bits)];
  }
  return product;
}

struct Basis {
  std::array<std::uint32_t, kMostBits> elements{};
  std::array<bool, 1 << kMostBits> spanned{true};
  std::size_t count = 0;

  constexpr void add(std::uint32_t element) {
    if (spanned[element]) return;
    elements[count++] = element;
    const std::array<bool, 1 << kMostBits> before = spanned;
    for (std::uint32_t i = 0; i < before.size(); ++i)
      if (before[i]) spanned[i ^ element] = true;
  }
};

// The small subfields first. 2 is a primitive element.
constexpr Basis basis_of_field(int bits) {
  Basis basis;
  const std::uint32_t powers = (1u << bits) - 1;
  std::array<std::uint32_t, 1 << kMostBits> power_of_2{};
  for (std::uint32_t e = 0, power = 1; e < powers; ++e, power = product(power, 2, bits)) power_of_2[e] = power;
  for (const int of_subfield : {2, 3, 4}) {
    if (bits % of_subfield != 0 || of_subfield >= bits) continue;
    const std::uint32_t step = powers / ((1u << of_subfield) - 1);
    for (std::uint32_t e = 0; e < powers; e += step) basis.add(power_of_2[e]);
  }
  for (std::uint32_t e = 0; e < powers; ++e) basis.add(power_of_2[e]);
  return basis;
}

// g = 2^11: of all g that generate the fields of 32, 64, 128 and 256 elements, it leaves about the least errors where 2
// to 16 sheets of the same or of random opacity lie on each other. Orders whose leading bit is the same for all 8
// positions of a cell are left out (cell_patterns() in simd/sample_pattern.h): they would take whole cells.
constexpr Orders make_orders(int bits) {
  constexpr std::uint32_t kStep = 11, kInCell = 7;
  Orders orders;
  const std::uint32_t powers = (1u << bits) - 1;
  std::uint32_t generator = 1;
  for (std::uint32_t e = 0; e < kStep; ++e) generator = product(generator, 2, bits);
  const Basis basis = basis_of_field(bits);
  std::uint32_t factor = 1;
  for (std::uint32_t k = 0; k < powers; ++k, factor = product(factor, generator, bits)) {
    if ((product(basis.elements[0], factor, bits) & kInCell) == 0) continue;
    Columns& columns = orders.columns[orders.count++];
    for (int b = 0; b < bits; ++b) {
      const std::uint32_t row = product(basis.elements[static_cast<std::size_t>(b)], factor, bits);
      for (int p = 0; p < bits; ++p)
        columns[static_cast<std::size_t>(p)] |= static_cast<std::uint8_t>((row >> p & 1) << (kMostBits - 1 - b));
    }
  }
  if (orders.count == 0) orders.count = 1;  // a single position has one order
  return orders;
}

// By the bits of a position's number.
inline constexpr std::array<Orders, kMostBits + 1> kOrders = {make_orders(0), make_orders(1), make_orders(2),
                                                              make_orders(3), make_orders(4), make_orders(5),
                                                              make_orders(6), make_orders(7), make_orders(8)};

}  // namespace opacity

// The positions that a sheet takes in a pixel.
class OpacityRanks {
 public:
  // (x, y): the pixel. `positions`: a power of two, 1..256.
  OpacityRanks(std::uint32_t sheet, std::int32_t x, std::int32_t y, std::uint32_t positions)
      : columns_(columns_of(sheet, opacity::kOrders[static_cast<std::size_t>(std::countr_zero(positions))])) {
    const std::uint32_t random =
        mix_bits(mix_bits(mix_bits(sheet + 1) + static_cast<std::uint32_t>(x)) + static_cast<std::uint32_t>(y));
    flip_ = static_cast<std::uint8_t>(random);
    offset_ = static_cast<float>(random >> 16) * (1.0f / 65536.0f);
  }

  // 0..256, different for all positions.
  float rank(std::uint32_t position) const {
    std::uint32_t rank = flip_;
    for (std::uint32_t b = 0; b < opacity::kMostBits; ++b) rank ^= (position >> b & 1) * columns_[b];
    return static_cast<float>(rank) + offset_;
  }

  bool takes(std::uint32_t position, float opacity) const { return rank(position) < opacity * 256.0f; }

 private:
  // Sheets in a row have orders in a row. Which sheets share an order after that is random, so that no regular mesh has
  // the same order in all of its layers.
  static const opacity::Columns& columns_of(std::uint32_t sheet, const opacity::Orders& orders) {
    const std::uint32_t rounds = sheet / orders.count;
    return orders.columns[(sheet % orders.count + mix_bits(rounds) % orders.count) % orders.count];
  }

  const opacity::Columns& columns_;
  std::uint8_t flip_;  // both differ from pixel to pixel
  float offset_;
};

}  // namespace beampipe
