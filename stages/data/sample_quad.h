// The shading samples of decoupled visibility multisampling: four per 2x2 quad of pixels, and extra ones.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "simd/match.h"
#include "stages/data/sample_tile.h"

namespace beampipe {

// A shading sample beside the four of its quad, with the same members. It has all visibility samples of its material.
struct ExtraSample {
  std::uint32_t triangle, mask;
  std::uint8_t location;
  glm::vec3 color;
};

// Pixel p = 0..3 of a quad is its pixel (p % 2, p / 2), and shading sample p is stored there. Bit 8 p + s of a mask is
// sample s of pixel p. If the frame's size is odd, a quad's pixels outside the frame have no bits in any mask.
struct SampleQuad {
  std::uint32_t triangle[4];   // the triangle that is shaded; kNoTriangle: the background
  std::uint32_t mask[4];       // the visibility samples that take this colour
  std::uint8_t location[4];    // the sample where it is shaded: a bit number
  glm::vec3 color[4];          // linear RGB, once it is shaded; not of the background
  std::uint8_t materials = 0;  // that the quad shows, the background included
  std::uint8_t pixels = 0;     // inside the frame: fewer than 4 at the right and lower sides of a frame of odd size
  std::vector<ExtraSample> extras = {};
};

// The extra samples of all quads, in order, with the indices of their quads.
template <class Quads>
auto extras_of(Quads& quads) {
  std::vector<std::pair<std::size_t, decltype(quads[0].extras.data())>> extras;
  for (std::size_t q = 0; q < quads.size(); ++q)
    for (auto& extra : quads[q].extras) extras.push_back({q, &extra});
  return extras;
}

// Size of a shading sample in the modelled machine: visibility id, mask and location.
inline constexpr std::uint64_t kShadingSampleBytes = 4 + 4 + 1;

// Where quads have room for extra samples, a mask of 0 follows those that are there.
inline constexpr std::uint64_t kEndOfExtrasBytes = 4;

// All quads of a frame, row by row.
struct QuadFrame {
  std::int32_t columns = 0, rows = 0;
  std::vector<SampleQuad> quads;

  QuadFrame(std::uint32_t width, std::uint32_t height);  // pixels
  // `of_tile`: the tile's quads, row by row.
  void insert(const Tile& tile, const std::vector<SampleQuad>& of_tile);
  std::vector<SampleQuad> of(const Tile& tile) const;  // likewise
};

}  // namespace beampipe
