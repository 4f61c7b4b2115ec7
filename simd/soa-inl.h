// Rows of 32-bit members (structs in memory) to and from columns (one vector per member). Included once per SIMD
// target.
#if defined(BEAMPIPE_SIMD_SOA_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_SIMD_SOA_INL_H_
#undef BEAMPIPE_SIMD_SOA_INL_H_
#else
#define BEAMPIPE_SIMD_SOA_INL_H_
#endif

#include <cstddef>
#include <cstring>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// Column i starts at columns[i * lanes]; lanes past `rows` repeat the last row, so that no lane holds garbage.
template <class Row, class Member>
HWY_INLINE void rows_to_columns(const Row* HWY_RESTRICT row_data, std::size_t rows, std::size_t lanes,
                                Member* HWY_RESTRICT columns) {
  constexpr std::size_t kWidth = sizeof(Row) / sizeof(Member);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    Member row[kWidth];
    std::memcpy(row, row_data + (lane < rows ? lane : rows - 1), sizeof row);
    for (std::size_t i = 0; i < kWidth; ++i) columns[i * lanes + lane] = row[i];
  }
}

template <class Row>
HWY_INLINE void columns_to_rows(const float* HWY_RESTRICT columns, std::size_t rows, std::size_t lanes,
                                Row* HWY_RESTRICT row_data) {
  constexpr std::size_t kWidth = sizeof(Row) / sizeof(float);
  for (std::size_t lane = 0; lane < rows; ++lane) {
    float row[kWidth];
    for (std::size_t i = 0; i < kWidth; ++i) row[i] = columns[i * lanes + lane];
    std::memcpy(row_data + lane, row, sizeof row);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
