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

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kNobody = ~0u;
constexpr std::size_t kPositions = kMaxMaskWords * kMaxMaskSamples;

// 64 positions at a time.
struct Mask64 {
  std::uint64_t words[kMaxMaskWords / 2];
};
HWY_INLINE Mask64 load(const WideMask& mask) {
  Mask64 wide;
  std::memcpy(&wide, mask.words.data(), sizeof wide);
  return wide;
}
HWY_INLINE std::uint32_t count_bits(const Mask64& mask) {
  int bits = 0;
  for (const std::uint64_t word : mask.words) bits += std::popcount(word);
  return static_cast<std::uint32_t>(bits);
}

// The depth tests at contested positions, in the words that have any.
class Contest {
 public:
  Contest(const Mask64& contested, const SamplePattern* patterns) : patterns_(patterns) {
    std::memcpy(contested_, contested.words, sizeof contested_);
    for (std::size_t w = 0; w < kMaxMaskWords; ++w) {
      if (contested_[w] == 0) continue;
      words_[count_++] = w;
      std::fill_n(nearest_ + w * kMaxMaskSamples, kMaxMaskSamples, kFar);
      std::fill_n(owner_ + w * kMaxMaskSamples, kMaxMaskSamples, kNobody);
    }
  }

  std::uint64_t add(std::uint32_t index, const WideMask& mask, const DepthPlane<float>& plane) {
    const hn::RebindToUnsigned<D> du;
    const hn::RebindToSigned<D> di;
    const D d;
    const auto corner = hn::Set(d, corner_depth(plane)), dzdx = hn::Set(d, plane.dzdu / kSubpixelUnits),
               dzdy = hn::Set(d, plane.dzdv / kSubpixelUnits);
    const auto self = hn::Set(du, index);
    std::uint64_t tests = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t w = words_[i];
      const std::uint64_t bits = mask.words[w] & contested_[w];
      tests += static_cast<std::uint64_t>(std::popcount(bits));
      for (std::size_t s = 0; s < kMaxMaskSamples; s += hn::Lanes(d)) {
        const std::uint64_t part = bits >> s;
        std::uint8_t bytes[8];
        std::memcpy(bytes, &part, sizeof bytes);
        const auto x = hn::ConvertTo(d, hn::Load(di, patterns_[w].x.data() + s));
        const auto y = hn::ConvertTo(d, hn::Load(di, patterns_[w].y.data() + s));
        const auto depth = hn::Add(hn::Add(corner, hn::Mul(dzdx, x)), hn::Mul(dzdy, y));
        float* const nearest = nearest_ + w * kMaxMaskSamples + s;
        const auto nearer = hn::And(hn::LoadMaskBits(d, bytes), hn::Lt(depth, hn::Load(d, nearest)));
        hn::BlendedStore(depth, nearer, d, nearest);
        hn::BlendedStore(self, hn::RebindMask(du, nearer), du, owner_ + w * kMaxMaskSamples + s);
      }
    }
    return tests;
  }

  // Of the contested positions leaves fragment `index` those that it has won.
  void give(std::uint32_t index, WideMask& mask) const {
    const hn::RebindToUnsigned<D> du;
    const auto self = hn::Set(du, index);
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t w = words_[i];
      std::uint64_t won = 0;
      for (std::size_t s = 0; s < kMaxMaskSamples; s += hn::Lanes(du)) {
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(du, hn::Eq(hn::Load(du, owner_ + w * kMaxMaskSamples + s), self), bytes);
        std::uint64_t part = 0;
        std::memcpy(&part, bytes, sizeof part);
        won |= part << s;
      }
      mask.words[w] &= ~contested_[w] | static_cast<std::uint32_t>(won);
    }
  }

 private:
  using D = hn::CappedTag<float, 16>;

  const SamplePattern* patterns_;
  std::uint32_t contested_[kMaxMaskWords];
  std::size_t words_[kMaxMaskWords], count_ = 0;
  HWY_ALIGN float nearest_[kPositions];
  HWY_ALIGN std::uint32_t owner_[kPositions];
};

WindowCounts window_owners_kernel(const MaskedPlane* in, std::size_t count, const WideMask& taken,
                                  const SamplePattern* patterns, Ownership* out) {
  const Mask64 closed = load(taken);
  Mask64 seen{}, twice{};
  std::uint64_t any_twice = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Mask64 mask = load(in[i].mask);
    Mask64 open;
    for (std::size_t w = 0; w < kMaxMaskWords / 2; ++w) {
      open.words[w] = mask.words[w] & ~closed.words[w];
      twice.words[w] |= seen.words[w] & open.words[w];
      seen.words[w] |= open.words[w];
      any_twice |= twice.words[w];
    }
    std::memcpy(out[i].owned.words.data(), &open, sizeof open);
    out[i].covered = count_bits(mask);
    out[i].visible = count_bits(open);
  }
  std::uint64_t tests = 0;
  if (any_twice != 0) {
    Contest contest(twice, patterns);
    for (std::uint32_t i = 0; i < count; ++i) tests += contest.add(i, out[i].owned, in[i].plane);
    for (std::uint32_t i = 0; i < count; ++i) {
      contest.give(i, out[i].owned);
      out[i].visible = count_bits(load(out[i].owned));
    }
  }
  return {count_bits(closed), tests};
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
    std::size_t owner = here.front();
    if (here.size() > 1) {
      const SamplePattern& pattern = patterns[bit / kMaxMaskSamples];
      const auto x = static_cast<float>(pattern.x[bit % kMaxMaskSamples]);
      const auto y = static_cast<float>(pattern.y[bit % kMaxMaskSamples]);
      float nearest = std::numeric_limits<float>::infinity();
      for (const std::size_t i : here) {
        const DepthPlane<float>& plane = in[i].plane;
        float depth = 0;
        if (nearer_at(corner_depth(plane), plane.dzdu / kSubpixelUnits, plane.dzdv / kSubpixelUnits, x, y, nearest,
                      depth)) {
          nearest = depth;
          owner = i;
        }
      }
      tests += here.size();
    }
    out[owner].owned.set(bit);
    ++out[owner].visible;
  }
  return {static_cast<std::uint32_t>(taken.count()), tests};
}
}  // namespace beampipe
#endif
