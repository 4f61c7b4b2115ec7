// Masks of positions in registers. Inlined into kernels, once per SIMD target.
#if defined(BEAMPIPE_STAGES_BEAM_REGISTER_MASK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_STAGES_BEAM_REGISTER_MASK_INL_H_
#undef BEAMPIPE_STAGES_BEAM_REGISTER_MASK_INL_H_
#else
#define BEAMPIPE_STAGES_BEAM_REGISTER_MASK_INL_H_
#endif

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hwy/highway.h"
#include "simd/wide_mask.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A mask in registers. It is loaded and stored in whole vectors, because a load waits for the parts of a vector that
// were stored one by one just before. Compilers copy a WideMask in smaller parts.
template <std::size_t Words>
class Mask {
 public:
  Mask() = default;
  HWY_INLINE explicit Mask(const std::uint32_t* words) {
    for (std::size_t i = 0; i < kParts; ++i) part_[i] = hn::LoadU(D(), words + i * kLanes);
  }
  HWY_INLINE explicit Mask(const WideMask& mask) : Mask(mask.words.data()) {}
  // All positions, or none.
  HWY_INLINE static Mask filled(bool all) { return repeated(all ? ~0u : 0); }
  HWY_INLINE static Mask repeated(std::uint32_t word) {
    Mask mask;
    for (auto& part : mask.part_) part = hn::Set(D(), word);
    return mask;
  }

  HWY_INLINE void store(std::uint32_t* words) const {
    for (std::size_t i = 0; i < kParts; ++i) hn::StoreU(part_[i], D(), words + i * kLanes);
  }
  HWY_INLINE WideMask wide() const {
    WideMask mask;
    store(mask.words.data());
    return mask;
  }

  HWY_INLINE bool none() const { return *this == filled(false); }
  HWY_INLINE int count() const {
    std::uint32_t words[Words];
    store(words);
    int count = 0;
    if constexpr (Words == 1) return std::popcount(words[0]);
    for (std::size_t i = 0; i < Words / 2; ++i) {
      std::uint64_t pair;
      std::memcpy(&pair, words + 2 * i, sizeof pair);
      count += std::popcount(pair);
    }
    return count;
  }

  HWY_INLINE friend Mask operator&(const Mask& a, const Mask& b) {
    return combine(a, b, [](V x, V y) { return hn::And(x, y); });
  }
  HWY_INLINE friend Mask operator|(const Mask& a, const Mask& b) {
    return combine(a, b, [](V x, V y) { return hn::Or(x, y); });
  }
  HWY_INLINE friend Mask operator^(const Mask& a, const Mask& b) {
    return combine(a, b, [](V x, V y) { return hn::Xor(x, y); });
  }
  HWY_INLINE friend Mask without(const Mask& a, const Mask& b) {  // a & ~b
    return combine(a, b, [](V x, V y) { return hn::AndNot(y, x); });
  }
  HWY_INLINE friend bool operator==(const Mask& a, const Mask& b) {
    bool equal = true;
    for (std::size_t i = 0; i < kParts; ++i) equal &= hn::AllTrue(D(), hn::Eq(a.part_[i], b.part_[i]));
    return equal;
  }

 private:
  using D = hn::CappedTag<std::uint32_t, Words>;
  using V = hn::Vec<D>;
  static constexpr std::size_t kLanes = hn::MaxLanes(D()), kParts = Words / kLanes;

  template <class Combine>
  HWY_INLINE static Mask combine(const Mask& a, const Mask& b, const Combine& parts) {
    Mask result;
    for (std::size_t i = 0; i < kParts; ++i) result.part_[i] = parts(a.part_[i], b.part_[i]);
    return result;
  }

  V part_[kParts];
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
