#include "simd/window_owners.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/window_owners.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/depth_compare.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr float kFar = std::numeric_limits<float>::infinity();

// 256 positions in one vector or more.
using DMask = hn::CappedTag<std::uint32_t, kMaxMaskWords>;
constexpr std::size_t kMaskVectors = kMaxMaskWords / hn::MaxLanes(DMask());

HWY_INLINE hn::Vec<DMask> load(const WideMask& mask, std::size_t vector) {
  return hn::LoadU(DMask(), mask.words.data() + vector * hn::MaxLanes(DMask()));
}
HWY_INLINE void store(hn::Vec<DMask> part, std::size_t vector, WideMask& mask) {
  hn::StoreU(part, DMask(), mask.words.data() + vector * hn::MaxLanes(DMask()));
}
HWY_INLINE std::uint32_t count_bits(const WideMask& mask) {
  int bits = 0;
  for (std::size_t w = 0; w < kMaxMaskWords; w += 2) {
    std::uint64_t word;
    std::memcpy(&word, mask.words.data() + w, sizeof word);
    bits += std::popcount(word);
  }
  return static_cast<std::uint32_t>(bits);
}

using D = hn::CappedTag<float, 16>;

// Leaves every fragment those contested positions of word `w` where it is nearest. The nearest depths stay in registers
// while the fragments pass one by one. Returns how many depths were computed.
HWY_INLINE std::uint64_t contest(const MaskedPlane* in, std::size_t count, std::size_t w, std::uint32_t contested,
                                 const SamplePattern& pattern, Ownership* out) {
  const D d;
  const hn::RebindToSigned<D> di;
  constexpr std::size_t kLanes = hn::MaxLanes(d), kVectors = kMaxMaskSamples / kLanes;
  hn::Vec<D> x[kVectors], y[kVectors], nearest[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v) {
    x[v] = hn::ConvertTo(d, hn::Load(di, pattern.x.data() + v * kLanes));
    y[v] = hn::ConvertTo(d, hn::Load(di, pattern.y.data() + v * kLanes));
    nearest[v] = hn::Set(d, kFar);
  }
  std::uint64_t tests = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t tested = out[i].owned.words[w] & contested;
    tests += static_cast<std::uint64_t>(std::popcount(tested));
    const CellPlane<float>& plane = in[i].plane;
    const auto corner = hn::Set(d, plane.z), dzdx = hn::Set(d, plane.dzdx), dzdy = hn::Set(d, plane.dzdy);
    std::uint32_t won = 0;  // positions where it is nearer than all earlier fragments
    for (std::size_t v = 0; v < kVectors; ++v) {
      const std::uint64_t part = tested >> (v * kLanes);
      std::uint8_t bytes[8];
      std::memcpy(bytes, &part, sizeof bytes);
      const auto depth = hn::Add(hn::Add(corner, hn::Mul(dzdx, x[v])), hn::Mul(dzdy, y[v]));
      const auto nearer = hn::And(hn::LoadMaskBits(d, bytes), hn::Lt(depth, nearest[v]));
      nearest[v] = hn::IfThenElse(nearer, depth, nearest[v]);
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, nearer, bits);
      std::uint32_t low = 0;
      std::memcpy(&low, bits, sizeof low);
      won |= low << (v * kLanes);
    }
    out[i].owned.words[w] = (out[i].owned.words[w] & ~contested) | won;
    out[i].visible -= static_cast<std::uint32_t>(std::popcount(tested & ~won));
  }
  std::uint32_t later = 0;  // positions that later fragments won: the last one to be nearer is the nearest
  for (std::size_t i = count; i-- > 0;) {
    const std::uint32_t won = out[i].owned.words[w] & contested;
    out[i].owned.words[w] &= ~later;
    out[i].visible -= static_cast<std::uint32_t>(std::popcount(won & later));
    later |= won;
  }
  return tests;
}

WindowCounts window_owners_kernel(const MaskedPlane* in, std::size_t count, const WideMask& taken,
                                  const SamplePattern* patterns, Ownership* out) {
  using V = hn::Vec<DMask>;
  V closed[kMaskVectors], seen[kMaskVectors], twice[kMaskVectors];
  for (std::size_t v = 0; v < kMaskVectors; ++v) {
    closed[v] = load(taken, v);
    seen[v] = twice[v] = hn::Zero(DMask());
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t v = 0; v < kMaskVectors; ++v) {
      const V open = hn::AndNot(closed[v], load(in[i].mask, v));
      twice[v] = hn::Or(twice[v], hn::And(seen[v], open));
      seen[v] = hn::Or(seen[v], open);
      store(open, v, out[i].owned);
    }
    out[i].covered = count_bits(in[i].mask);
    out[i].visible = count_bits(out[i].owned);
  }
  WideMask contested;
  for (std::size_t v = 0; v < kMaskVectors; ++v) store(twice[v], v, contested);
  std::uint64_t tests = 0;
  for (std::size_t w = 0; w < kMaxMaskWords; ++w)
    if (contested.words[w] != 0) tests += contest(in, count, w, contested.words[w], patterns[w], out);
  return {count_bits(taken), tests};
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(window_owners_kernel);
WindowCounts window_owners(const MaskedPlane* in, std::size_t count, const WideMask& taken,
                           const SamplePattern* patterns, Ownership* out) {
  return HWY_DYNAMIC_DISPATCH(window_owners_kernel)(in, count, taken, patterns, out);
}

WindowCounts window_owners_scalar(const MaskedPlane* in, std::size_t count, const WideMask& taken,
                                  const SamplePattern* patterns, Ownership* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = {{}, static_cast<std::uint32_t>(in[i].mask.count()), 0};
  std::uint64_t tests = 0;
  for (std::size_t bit = 0; bit < kMaxMaskWords * kMaxMaskSamples; ++bit) {
    if (taken.test(bit)) continue;
    std::vector<std::size_t> here;
    for (std::size_t i = 0; i < count; ++i)
      if (in[i].mask.test(bit)) here.push_back(i);
    if (here.empty()) continue;
    std::size_t owner = here.size() == 1 ? here.front() : count;
    if (here.size() > 1) {
      const SamplePattern& pattern = patterns[bit / kMaxMaskSamples];
      const auto x = static_cast<float>(pattern.x[bit % kMaxMaskSamples]);
      const auto y = static_cast<float>(pattern.y[bit % kMaxMaskSamples]);
      float nearest = std::numeric_limits<float>::infinity();
      for (const std::size_t i : here) {
        const CellPlane<float>& plane = in[i].plane;
        float depth = 0;
        if (depth_test_scalar(plane, x, y, nearest, depth)) {
          nearest = depth;
          owner = i;
        }
      }
      tests += here.size();
    }
    if (owner == count) continue;
    out[owner].owned.set(bit);
    ++out[owner].visible;
  }
  return {static_cast<std::uint32_t>(taken.count()), tests};
}
}  // namespace beampipe
#endif
