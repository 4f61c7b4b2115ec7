// The published aggregate as it is stored: loaded before each merge and stored behind it, in exactly these bytes.
//
// The talk (slide 23) has 36 bytes and 6 of colour. The paper's text (section 3) has 32 and gives no layout; there are
// two readings. Without colour, 32 are the talk's 36 with a plane of three coefficients, all that a depth over a pixel
// needs, in place of four. With colour, they are what is left when slopes and thickness take 16 bits each.
#pragma once

#include <cstdint>

#include "simd/merge.h"
#include "stages/data/half_bits.h"

namespace beampipe {

enum class PaperStorage {
  slides,   // 42 bytes: slide 23 of the talk
  text,     // 32 bytes with colour: section 3's size, in a layout of ours
  float32,  // every number a float32: what packing costs
};

#pragma pack(push, 2)
struct SlidesAggregate {
  float alpha;
  std::uint32_t mask;
  float plane[4];  // z, dz/du, dz/dv; a plane over the pixel has no use for the fourth
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
    return {alpha, mask, {plane[0], plane[1], plane[2]}, thickness, z_min, z_max, {color[0], color[1], color[2]}};
  }
};
static_assert(sizeof(SlidesAggregate) == 42);

inline constexpr std::uint32_t kAggregateColorBytes = sizeof(SlidesAggregate::color);

// The text's size read as without colour.
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
    return {alpha, mask, {z, dzdu, dzdv}, thickness, z_min, z_max, {color[0], color[1], color[2]}};
  }
};
static_assert(sizeof(TextAggregate) == 32);
#pragma pack(pop)

constexpr std::uint32_t paper_aggregate_bytes(PaperStorage storage) {
  switch (storage) {
    case PaperStorage::slides:
      return sizeof(SlidesAggregate);
    case PaperStorage::text:
      return sizeof(TextAggregate);
    case PaperStorage::float32:
      break;
  }
  return sizeof(Aggregate);
}

}  // namespace beampipe
