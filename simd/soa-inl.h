// Between arrays of structs in memory and structs of vectors. Included once per SIMD target.
//
// A row is a struct of 32-bit members, such as Coverage<float>. Its columns are the same struct with a vector for each
// member, such as Coverage<Floats>: lane i of every vector comes from row i.
#if defined(BEAMPIPE_SIMD_SOA_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_SIMD_SOA_INL_H_
#undef BEAMPIPE_SIMD_SOA_INL_H_
#else
#define BEAMPIPE_SIMD_SOA_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// Lane i has *row_of(i).
template <class Columns, class RowOf>
HWY_INLINE Columns gather_rows(const RowOf& row_of) {
  using Row = std::remove_cvref_t<decltype(*row_of(std::size_t{}))>;
  constexpr std::size_t kMembers = sizeof(Row) / sizeof(std::uint32_t), kLanes = sizeof(Columns) / sizeof(Row);
  Columns columns;
  auto* const bytes = reinterpret_cast<unsigned char*>(&columns);
  const unsigned char* row[kLanes];
  for (std::size_t lane = 0; lane < kLanes; ++lane) row[lane] = reinterpret_cast<const unsigned char*>(row_of(lane));
  for (std::size_t i = 0; i < kMembers; ++i) {
    std::uint32_t member[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) std::memcpy(member + lane, row[lane] + 4 * i, 4);
    std::memcpy(bytes + i * sizeof member, member, sizeof member);
  }
  return columns;
}

// Lanes past `count` repeat the last row, so that no lane holds garbage.
template <class Columns, class Row>
HWY_INLINE Columns load_rows(const Row* HWY_RESTRICT rows, std::size_t count) {
  return gather_rows<Columns>([=](std::size_t lane) { return rows + HWY_MIN(lane, count - 1); });
}

// The same row in every lane.
template <class Columns, class Row>
HWY_INLINE Columns repeat_row(const Row& row) {
  constexpr std::size_t kMembers = sizeof(Row) / sizeof(std::uint32_t), kLanes = sizeof(Columns) / sizeof(Row);
  Columns columns;
  auto* const bytes = reinterpret_cast<unsigned char*>(&columns);
  for (std::size_t i = 0; i < kMembers; ++i) {
    std::uint32_t member;
    std::memcpy(&member, reinterpret_cast<const unsigned char*>(&row) + 4 * i, 4);
    const Words everywhere(member);
    static_assert(sizeof everywhere == kLanes * sizeof member);
    std::memcpy(bytes + i * sizeof everywhere, &everywhere, sizeof everywhere);
  }
  return columns;
}

template <class Columns, class Row>
HWY_INLINE void store_rows(const Columns& columns, std::size_t count, Row* HWY_RESTRICT rows) {
  constexpr std::size_t kMembers = sizeof(Row) / sizeof(std::uint32_t), kLanes = sizeof(Columns) / sizeof(Row);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(&columns);
  if (kMembers == 1 && count == kLanes) {  // nothing to transpose
    std::memcpy(rows, bytes, sizeof columns);
    return;
  }
  for (std::size_t lane = 0; lane < count; ++lane) {
    auto* const row = reinterpret_cast<unsigned char*>(rows + lane);
    for (std::size_t i = 0; i < kMembers; ++i) std::memcpy(row + 4 * i, bytes + 4 * (i * kLanes + lane), 4);
  }
}

// out[i] = formula(in[i]), a vector of rows at a time.
template <class Columns, class In, class Out, class Formula>
HWY_INLINE void map_rows(const In* HWY_RESTRICT in, std::size_t count, Out* HWY_RESTRICT out, const Formula& formula) {
  constexpr std::size_t kLanes = sizeof(Columns) / sizeof(In);
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t n = HWY_MIN(kLanes, count - first);
    store_rows(formula(load_rows<Columns>(in + first, n)), n, out + first);
  }
}

// A block is the same struct again, with an array for each member: the rows that lie in it, a whole number of vectors.
// `first`: of the rows that are loaded or stored.
template <class Columns, class Block>
HWY_INLINE Columns load_columns(const Block& block, std::size_t first) {
  constexpr std::size_t kVectors = sizeof(Block) / sizeof(Columns);
  constexpr std::size_t kMembers = sizeof(Columns) / sizeof(Words);
  Columns columns;
  const auto* const from = reinterpret_cast<const unsigned char*>(&block) + first * sizeof(std::uint32_t);
  auto* const to = reinterpret_cast<unsigned char*>(&columns);
  for (std::size_t i = 0; i < kMembers; ++i)
    std::memcpy(to + i * sizeof(Words), from + i * kVectors * sizeof(Words), sizeof(Words));
  return columns;
}

template <class Columns, class Block>
HWY_INLINE void store_columns(const Columns& columns, std::size_t first, Block& block) {
  constexpr std::size_t kVectors = sizeof(Block) / sizeof(Columns);
  constexpr std::size_t kMembers = sizeof(Columns) / sizeof(Words);
  const auto* const from = reinterpret_cast<const unsigned char*>(&columns);
  auto* const to = reinterpret_cast<unsigned char*>(&block) + first * sizeof(std::uint32_t);
  for (std::size_t i = 0; i < kMembers; ++i)
    std::memcpy(to + i * kVectors * sizeof(Words), from + i * sizeof(Words), sizeof(Words));
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
