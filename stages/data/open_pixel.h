// All that a pixel keeps while its bin is open: which surface owns which mask position, and the sums of what is final.
// It is loaded and stored for every fragment, as an aggregate is.
//
// Owners are surfaces that later fragments may still hide. Their number is fixed; if there is one more, two of them
// become one (stages/beam/compose_owners.h).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "simd/depth_plane.h"
#include "stages/data/owner_slot.h"
#include "stages/data/pixel_sums.h"
#include "stages/data/position_states.h"

namespace beampipe {

template <std::size_t Words, std::size_t Slots>  // 32 positions a word
struct OpenPixel {
  // States of a position.
  static constexpr std::uint32_t kEmpty = 0;          // nothing covers it yet
  static constexpr std::uint32_t kFirstSlot = 1;      // the first slot owns it; the next states are the other slots
  static constexpr std::uint32_t kFinal = Slots + 1;  // nothing that comes later can be nearer
  static constexpr std::size_t kBits = std::bit_width(kFinal);

  PositionStates<Words, kBits> states{};
  OwnerSlot slots[Slots];
  ColorSums colors;    // of what is final
  FixedSum area;       // of what is final, by analytic area; the number of its positions is the counted area
  FixedSum specks[2];  // the areas of visible specks that face away from the viewer, and towards the viewer

  // Size in the modelled machine. Here a pixel has two bytes more, so that the words of the next pixel are aligned.
  static constexpr std::uint32_t kBytes =
      sizeof(states) + sizeof(slots) + sizeof(colors) + sizeof(area) + sizeof(specks);

  static constexpr std::uint32_t owned_by(std::size_t slot) { return kFirstSlot + static_cast<std::uint32_t>(slot); }
};

static_assert(OpenPixel<8, 5>::kBytes == 154);
static_assert(OpenPixel<4, 7>::kBytes == 138);
static_assert(OpenPixel<2, 4>::kBytes == 74);
static_assert(OpenPixel<1, 2>::kBytes == 42);

// Depths of a pixel's owners, which the modelled machine computes again whenever it needs them. This program keeps
// them.
template <std::size_t Slots>
class OwnerDepths {
 public:
  DepthPlane<float> plane(std::size_t k) const { return {rows_[0][k], rows_[1][k], rows_[2][k]}; }
  float farthest(std::size_t k) const { return rows_[3][k]; }
  void set(std::size_t k, const DepthPlane<float>& plane, float farthest) {
    rows_[0][k] = plane.z, rows_[1][k] = plane.dzdu, rows_[2][k] = plane.dzdv, rows_[3][k] = farthest;
  }

  // Rows of all slots, from each of which a vector of std::bit_ceil(Slots) may be read.
  DepthPlane<const float*> planes() const { return {rows_[0], rows_[1], rows_[2]}; }

 private:
  float rows_[4][Slots];  // z, dzdu, dzdv, and the upper bound of the depth in the pixel
};

// The open pixels of a tile, row by row.
template <std::size_t Words, std::size_t Slots>
struct OpenPixels {
  // All are copies of one: g++ clears a pixel with `rep stos`, which takes longer to start than to clear so few bytes.
  explicit OpenPixels(std::size_t count)
      : pixels(count, OpenPixel<Words, Slots>()), depths(std::make_unique_for_overwrite<OwnerDepths<Slots>[]>(count)) {}

  std::vector<OpenPixel<Words, Slots>> pixels;
  std::unique_ptr<OwnerDepths<Slots>[]> depths;  // not set before a slot has an owner
};

// The instances that exist: X(words, slots). 4 words with 7 slots are for streaming order, the others for near-first
// order: its default, and those that specs can name.
#define BEAMPIPE_SLOT_COUNTS(X, words) X(words, 2) X(words, 4) X(words, 8) X(words, 16) X(words, 32)
#define BEAMPIPE_OPEN_PIXELS(X) \
  BEAMPIPE_SLOT_COUNTS(X, 1)    \
  BEAMPIPE_SLOT_COUNTS(X, 2) BEAMPIPE_SLOT_COUNTS(X, 4) BEAMPIPE_SLOT_COUNTS(X, 8) X(8, 5) X(4, 7)

// Calls shape.operator()<Words, Slots>() with the numbers of the instance. Throws std::invalid_argument if there is no
// such instance.
template <class Shape>
auto with_shape(int positions, int slots, Shape&& shape) {
#define BEAMPIPE_SHAPE(words, pixel_slots) \
  if (positions == 32 * words && slots == pixel_slots) return shape.template operator()<words, pixel_slots>();
  BEAMPIPE_OPEN_PIXELS(BEAMPIPE_SHAPE)
#undef BEAMPIPE_SHAPE
  throw std::invalid_argument("no pixel has " + std::to_string(positions) + " positions and " + std::to_string(slots) +
                              " slots");
}

}  // namespace beampipe
