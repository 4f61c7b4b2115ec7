#include "simd/run_ends.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/run_ends.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

void mark_run_ends_kernel(const std::uint32_t* values, std::size_t count, std::uint64_t* words) {
  using Tag = hn::CappedTag<std::uint32_t, 16>;
  const Tag d;
  for (std::size_t first = 0; first < count; first += kRunWord) {
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < kRunWord; i += hn::Lanes(d)) {
      const Lanes<Tag> value(hn::LoadU(d, values + first + i)), next(hn::LoadU(d, values + first + i + 1));
      word |= std::uint64_t{mask_bits(value != next)} << i;
    }
    words[first / kRunWord] = word;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(mark_run_ends_kernel);
void mark_run_ends(const std::uint32_t* values, std::size_t count, std::uint64_t* words) {
  HWY_DYNAMIC_DISPATCH(mark_run_ends_kernel)(values, count, words);
}
}  // namespace beampipe
#endif
