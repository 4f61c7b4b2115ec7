// Rows of floats (structs in memory) to and from columns (one vector per member). Included once per SIMD target.
#if defined(BEAMPIPE_SIMD_SOA_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_SIMD_SOA_INL_H_
#undef BEAMPIPE_SIMD_SOA_INL_H_
#else
#define BEAMPIPE_SIMD_SOA_INL_H_
#endif

#include <cstddef>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// Column i starts at columns[i * lanes]; lanes past `rows` repeat the last row, so that no lane holds garbage.
HWY_INLINE void rows_to_columns(const float* HWY_RESTRICT row_data, std::size_t rows, std::size_t width,
                                std::size_t lanes, float* HWY_RESTRICT columns) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const float* row = row_data + (lane < rows ? lane : rows - 1) * width;
    for (std::size_t i = 0; i < width; ++i) columns[i * lanes + lane] = row[i];
  }
}

HWY_INLINE void columns_to_rows(const float* HWY_RESTRICT columns, std::size_t rows, std::size_t width,
                                std::size_t lanes, float* HWY_RESTRICT row_data) {
  for (std::size_t lane = 0; lane < rows; ++lane)
    for (std::size_t i = 0; i < width; ++i) row_data[lane * width + i] = columns[i * lanes + lane];
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
