// Fragments and aggregates for the merge tests.
#pragma once

#include "simd/merge.h"
#include "tests/simd/random.h"

namespace beampipe {

inline constexpr std::uint32_t kAllBits = ~0u;

// A surface of constant depth and colour. `red` and `green` are given before they are multiplied by alpha.
inline Aggregate flat_surface(float alpha, std::uint32_t mask, float z, float red, float green = 0.0f) {
  return {.alpha = alpha,
          .mask = mask,
          .plane = {z, 0.0f, 0.0f},
          .thickness = 0.0f,
          .z_min = z,
          .z_max = z,
          .color = {red * alpha, green * alpha, 0.0f}};
}

// All numbers of an aggregate but its mask.
inline std::array<float, 10> numbers_of(const Aggregate& a) {
  return {a.alpha, a.plane.z, a.plane.dzdu, a.plane.dzdv, a.thickness,
          a.z_min, a.z_max,   a.color[0],   a.color[1],   a.color[2]};
}

// What the raster stages can send, with hard cases often: specks, full pixels, single bits, planes equal to earlier
// ones or as steep as those of slivers, depths of +0 and -0.
inline MergeFragment random_fragment(Random& random) {
  constexpr float kAlphas[] = {1.0f, 0.99999994f, 5.1e-7f, 0.5f, 1.0f / 32};
  constexpr std::uint32_t kMasks[] = {kAllBits, 1u, 0x80000000u, 0x0000ffffu, 0xffff0000u, 0x55555555u};
  constexpr float kDepths[] = {-1.0f, -0.5f, -0.5f, -0.0f, 0.0f};
  MergeFragment fragment;
  Aggregate& s = fragment.surface;
  s.alpha = random.one_in(3) ? random.pick(kAlphas) : random.real32(1e-6, 1);
  s.mask = random.one_in(3) ? random.pick(kMasks) : random.word() & (random.one_in(2) ? random.word() : kAllBits);
  fragment.tiny = s.mask == 0 ? kAllBits : 0u;
  if (s.mask == 0 || random.one_in(5)) {
    s.mask = 1u << random.integer(0, 31);
    fragment.tiny = kAllBits;
  }
  const double steep = random.one_in(6) ? 1e5 : random.one_in(4) ? 0.0 : 0.05;
  s.plane = {random.one_in(3) ? random.pick(kDepths) : random.real32(-1, 0), random.real32(-steep, steep),
             random.real32(-steep, steep)};
  const float spread = random.one_in(3) ? 0.0f : random.real32(0, 0.1);
  s.z_min = std::max(s.plane.z - spread, -1.0f);
  s.z_max = std::min(s.plane.z + spread, 0.0f);
  s.thickness = 0.0f;
  fragment.front = random.word();
  for (float& c : s.color) c = s.alpha * (random.one_in(4) ? 0.0f : random.real32(0, 3));
  return fragment;
}

// The default rules; the rules that differ from them in one value; and the last value of every policy together.
inline std::vector<MergeRules> every_merge_rule() {
  using R = MergeRules;
  return {{},
          {.overlap = R::Overlap::over},
          {.overlap = R::Overlap::unbounded},
          {.overlap = R::Overlap::transition},
          {.fuzzy = R::Fuzzy::delta},
          {.fuzzy = R::Fuzzy::mix},
          {.extents = R::Extents::slab},
          {.slab = R::Slab::full},
          {.plane = R::Plane::area},
          {.thickness = R::Thickness::containing},
          {.thickness = R::Thickness::none},
          {.regional = R::Regional::area},
          {R::Overlap::transition, R::Regional::area, R::Fuzzy::mix, R::Extents::slab, R::Slab::full, R::Plane::area,
           R::Thickness::containing},
          {.partition = R::Partition::positions},
          {.partition = R::Partition::given},
          {.overlap = R::Overlap::transition, .partition = R::Partition::positions}};
}

}  // namespace beampipe
