// What the pixels of a tile keep while draws change them in the API's order. A pixel is cut into regions. Each has mask
// positions, an area, a colour, a depth plane and a stencil value, which are the same in all of it. A pixel that
// nothing has touched needs no more than its word; any other has a record in the pool of stages/data/pooled_pixels.h:
// bit planes that say which region has which position, with as many planes as there are regions, and 16 bytes for each
// region.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "simd/depth_plane.h"
#include "simd/wide_mask.h"
#include "stages/data/pooled_pixels.h"

namespace beampipe {

// ---- The modelled machine's layout ----

// Four bits count them and name them.
inline constexpr std::size_t kMostRegions = 16;

// A region: RGBA as fp16, and the triangle that gave it its depth, area, stencil value, the part of it that was drawn,
// and whether the draw at hand has changed it.
inline constexpr std::uint32_t kDrawnBits = 8, kStencilBits = 8;
inline constexpr std::uint32_t kRegionBytes = 16;
static_assert(4 * 16 + kTriangleBits + kAreaBits + kStencilBits + kDrawnBits + 1 <= 8 * kRegionBytes);
static_assert(kRegionBytes == kChunkBytes);

// A pixel's word: the record's first chunk, its regions (0: nothing has touched it), and the draw that touched it last.
inline constexpr std::uint32_t kRegionCountBits = 5, kDrawBits = 16;
static_assert(kChunkNumberBits + kRegionCountBits + kDrawBits <= 8 * kPixelWordBytes);

// Specks: the sum of their areas, and RGBA as fp16, which has a chunk of its own.
constexpr std::uint32_t region_chunks(std::size_t regions, bool has_specks, std::size_t words) {
  return static_cast<std::uint32_t>((planes_for(regions) * words * 4 + kChunkBytes - 1) / kChunkBytes + regions) +
         (has_specks ? 1u : 0u);
}
inline constexpr std::uint32_t kMostRegionChunks = region_chunks(kMostRegions, true, kMaxMaskWords);
static_assert(32 * 32 * kMostRegionChunks <= 1u << kChunkNumberBits);

// ---- This program's ----

inline constexpr std::uint32_t kWholeArea = (1u << kAreaBits) - 1;  // of a pixel
inline constexpr std::uint32_t kNobodysDepth = ~0u;                 // that of the last clear
inline constexpr std::uint32_t kNoDraw = ~0u;
inline constexpr std::uint8_t kWhollyDrawn = (1u << kDrawnBits) - 1;

struct Region {
  WideMask positions;       // one at least
  glm::vec4 color;          // RGBA as the frame's target stores it, rounded to fp16
  DepthPlane<float> plane;  // the modelled machine makes it again from its triangle
  std::uint32_t triangle = kNobodysDepth;
  std::uint16_t area = kWholeArea;  // the areas of a pixel's regions add up to kWholeArea
  std::uint8_t stencil = 0;
  std::uint8_t drawn = 0;   // the part whose colour a draw has written
  bool is_touched = false;  // by the draw that touched the pixel last: it has changed the colour
};

// Of the draw that touched the pixel last, those that passed its tests.
struct PendingSpecks {
  float area = 0;              // the sum, in units of kWholeArea; 0: there are none
  glm::vec4 color{0.0f};       // their mean
  std::uint32_t triangle = 0;  // of the last one, whose draw's rule they follow
};

struct RegionPixel {
  std::vector<Region> regions;  // up to kMostRegions
  PendingSpecks specks;
  std::uint32_t draw = kNoDraw;
  ChunkPool::Chunks chunks;
};

struct RegionPixels {
  // `mask_words`: of 32 positions.
  RegionPixels(std::size_t count, const ChunkPool& of_records, std::size_t mask_words, float clear_depth,
               const glm::vec4& clear_color)
      : words(mask_words), pool(of_records) {
    Region all;
    all.positions = first_words(words);
    all.color = clear_color;
    all.plane = {clear_depth, 0.0f, 0.0f};
    pixels.assign(count, {{all}, {}, kNoDraw, {}});
  }

  std::size_t words;
  std::vector<RegionPixel> pixels;  // row by row
  ChunkPool pool;
  std::size_t next_clear = 0;  // index into RopRules::clears
};

}  // namespace beampipe
