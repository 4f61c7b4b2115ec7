#include "bench/vector_peak.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/vector_peak.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::uint64_t vector_operations_kernel(float& result) {
  constexpr hn::ScalableTag<float> tag;
  constexpr std::uint64_t kRounds = 1 << 12, kChains = 6;  // of each kind: results come after three or four clocks
  const auto start = [&](float offset) HWY_ATTR { return hn::Set(tag, result + offset); };
  auto a0 = start(1), a1 = start(2), a2 = start(3), a3 = start(4), a4 = start(5), a5 = start(6);
  auto m0 = start(7), m1 = start(8), m2 = start(9), m3 = start(10), m4 = start(11), m5 = start(12);
  const auto addend = hn::Set(tag, 1e-3f), factor = hn::Set(tag, 1.0f - 1e-6f);
  for (std::uint64_t i = 0; i < kRounds; ++i) {
    a0 = hn::Add(a0, addend), m0 = hn::Mul(m0, factor);
    a1 = hn::Add(a1, addend), m1 = hn::Mul(m1, factor);
    a2 = hn::Add(a2, addend), m2 = hn::Mul(m2, factor);
    a3 = hn::Add(a3, addend), m3 = hn::Mul(m3, factor);
    a4 = hn::Add(a4, addend), m4 = hn::Mul(m4, factor);
    a5 = hn::Add(a5, addend), m5 = hn::Mul(m5, factor);
  }
  const auto sums = hn::Add(hn::Add(hn::Add(a0, a1), hn::Add(a2, a3)), hn::Add(a4, a5));
  const auto products = hn::Add(hn::Add(hn::Add(m0, m1), hn::Add(m2, m3)), hn::Add(m4, m5));
  result = hn::GetLane(hn::Mul(hn::Add(sums, products), hn::Set(tag, 1e-6f)));
  return kRounds * 2 * kChains * hn::Lanes(tag);
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(vector_operations_kernel);

std::uint64_t run_vector_operations(float& result) { return HWY_DYNAMIC_DISPATCH(vector_operations_kernel)(result); }
}  // namespace beampipe
#endif
