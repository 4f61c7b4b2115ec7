// What each triangle is worth in the pixels of a bin, recorded while compose_owners composes them, for those who ask
// why a picture is wrong. It observes: what is composed and charged stays the same, and the modelled machine has no
// such memory. Triangles have their numbers in the bin's list.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "stages/data/open_pixel.h"
#include "stages/data/pixel_formats.h"

namespace beampipe {

// An owner, the index of its slot, the positions that it owns and, linear RGB, its colour.
struct RecordedOwner {
  const OwnerSlot& slot;
  std::size_t index;
  const WideMask& owned;
  const glm::vec3& color;
};

class OwnerWeights {
 public:
  struct Weight {
    std::uint32_t number;
    float weight;        // part of the pixel, 0..1
    bool speck, merged;  // merged: it shared an owner with other triangles
    glm::vec3 color;     // linear RGB
  };

  // A triangle of an owner.
  struct Part {
    std::uint32_t number;
    float part;       // of the owner's colour; they add up to 1
    glm::vec3 color;  // of the triangle
  };

  // An owner that became final, or a speck, and what it adds to the pixel's analytic and counted areas, 0..1.
  struct Final {
    std::vector<Part> parts;
    WideMask owned;
    float area, counted;
    bool speck, merged;
    glm::vec3 color;
  };

  // Two owners that became one, and what became of them.
  struct Merge {
    std::vector<Part> one, other;
    WideMask owned_by_one, owned_by_other;
    glm::vec3 color_of_one, color_of_other;
    float part;  // of their mean colour that is that of `one`
  };

  // The two estimates of a pixel, and what became of them.
  struct Estimates {
    PixelColor analytic, counted, result;
  };

  explicit OwnerWeights(std::size_t pixels) : pixels_(pixels) {}

  // Two owners become one in the slot of `one`; `part` of their mean colour is that of `one`.
  void merge(std::size_t pixel, const RecordedOwner& one, const RecordedOwner& other, float part);

  // An owner is final and adds this to the pixel's analytic and counted areas, 0..1.
  void settle(std::size_t pixel, const RecordedOwner& owner, float area, float counted);

  // A speck adds this to the pixel's analytic area.
  void add_speck(std::size_t pixel, std::uint32_t number, float area, const glm::vec3& color);

  // All owners of the pixel are final. `analytic`, `counted`: the two estimates of it; `result`: what became of them.
  // The weights add up to the result's area. They are a mixture of both estimates: the one whose colour is closest to
  // that of the result. It is the same if the channels are limited by the same factor.
  void finish(std::size_t pixel, const PixelColor& analytic, const PixelColor& counted, const PixelColor& result);

  // The same for a pixel that one triangle has for itself.
  void finish_whole(std::size_t pixel, std::uint32_t number, const glm::vec3& color);

  const std::vector<Weight>& of_pixel(std::size_t pixel) const { return pixels_[pixel].weights; }

  // What happened in the pixel so far, in order.
  const std::vector<Merge>& merges(std::size_t pixel) const { return pixels_[pixel].merges; }
  const std::vector<Final>& finals(std::size_t pixel) const { return pixels_[pixel].finals; }
  // Null before the end, and where one triangle has the pixel for itself or nothing is in it.
  const Estimates* estimates(std::size_t pixel) const {
    return pixels_[pixel].estimates ? &*pixels_[pixel].estimates : nullptr;
  }

 private:
  struct Pixel {
    std::vector<std::vector<Part>> owners;  // by slot; of those that are merged
    std::vector<Merge> merges;
    std::vector<Final> finals;
    std::vector<Weight> weights;
    std::optional<Estimates> estimates;
  };

  static std::vector<Part> parts_of(const Pixel& pixel, const RecordedOwner& owner);

  std::vector<Pixel> pixels_;
};

}  // namespace beampipe
