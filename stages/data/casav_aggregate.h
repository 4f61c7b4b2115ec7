// The aggregate of the published rules as it is stored, in exactly these bytes. It is loaded at the start of each merge
// and stored at the end.
//
// The talk (slide 23) states 36 bytes, and 6 bytes for the colour. The paper's text (section 3) states 32 bytes and
// gives no layout, so there are two readings. If the 32 bytes are without colour, they are the talk's 36 bytes with
// three plane coefficients instead of four; three are all that a depth over a pixel needs. If they include the colour,
// slopes and thickness must take 16 bits each.
#pragma once

#include <cstdint>

#include "simd/merge.h"
#include "stages/data/half_bits.h"

namespace beampipe {

enum class CasavStorage {
  slides,  // 42 bytes: slide 23 of the talk
  text,    // 32 bytes with colour: the size that section 3 states, in a layout of our own
};

#pragma pack(push, 2)
struct SlidesAggregate {
  float alpha;
  std::uint32_t mask;
  float plane[4];  // z, dz/du, dz/dv; the fourth is not used
  float thickness, z_min, z_max;
  HalfBits color[3];

  explicit SlidesAggregate(const Aggregate& a)
      : alpha(a.alpha),
        mask(a.mask),
        plane{a.plane.z, a.plane.dzdu, a.plane.dzdv, 0},
        thickness(a.thickness),
        z_min(a.z_min),
        z_max(a.z_max),
        color{HalfBits(a.color[0]), HalfBits(a.color[1]), HalfBits(a.color[2])} {}
  operator Aggregate() const {
    return {.alpha = alpha,
            .mask = mask,
            .plane = {plane[0], plane[1], plane[2]},
            .thickness = thickness,
            .z_min = z_min,
            .z_max = z_max,
            .color = {color[0], color[1], color[2]}};
  }
};
static_assert(sizeof(SlidesAggregate) == 42);

inline constexpr std::uint32_t kAggregateColorBytes = sizeof(SlidesAggregate::color);

// The reading of the text's size that leaves out the colour.
inline constexpr std::uint32_t kTextBytesWithoutColor = sizeof(SlidesAggregate) - kAggregateColorBytes - sizeof(float);

struct TextAggregate {
  float alpha;
  std::uint32_t mask;
  float z;
  UpperHalf dzdu, dzdv;
  UpperHalf thickness;
  float z_min, z_max;
  HalfBits color[3];

  explicit TextAggregate(const Aggregate& a)
      : alpha(a.alpha),
        mask(a.mask),
        z(a.plane.z),
        dzdu(a.plane.dzdu),
        dzdv(a.plane.dzdv),
        thickness(a.thickness),
        z_min(a.z_min),
        z_max(a.z_max),
        color{HalfBits(a.color[0]), HalfBits(a.color[1]), HalfBits(a.color[2])} {}
  operator Aggregate() const {
    return {.alpha = alpha,
            .mask = mask,
            .plane = {z, dzdu, dzdv},
            .thickness = thickness,
            .z_min = z_min,
            .z_max = z_max,
            .color = {color[0], color[1], color[2]}};
  }
};
static_assert(sizeof(TextAggregate) == 32);
#pragma pack(pop)

constexpr std::uint32_t casav_aggregate_bytes(CasavStorage storage) {
  return storage == CasavStorage::slides ? sizeof(SlidesAggregate) : sizeof(TextAggregate);
}

// How `compose` and compose_layers merge: by which rules, where the bits of masks lie, and how aggregates are stored.
struct CasavMerging {
  const MergePositions& positions;
  MergeRules rules = {};
  CasavStorage storage = CasavStorage::slides;
};

}  // namespace beampipe
