// The multisampled surface of a tile that draws change in the API's order.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stages/data/accumulator.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/tile.h"

namespace beampipe {

// Samples are ordered as in SampleTile. In the modelled machine, a sample has a word of 4 bytes with depth and stencil,
// and `color_bytes` of colour.
struct OrderedTile {
  std::vector<float> depth;           // of the frame, -1..0
  std::vector<std::uint8_t> stencil;  // empty if no draw tests or writes it
  std::vector<glm::vec4> color;       // RGBA, as the frame's target stores it
  std::vector<bool> is_drawn;         // has a draw written its colour?
  std::size_t samples_per_pixel = 0;
  AccumulatorFormat format = AccumulatorFormat::fp32;  // of colours
  std::uint32_t color_bytes = 0;
  std::size_t next_clear = 0;                 // index into RopRules::clears
  const PixelObservers* observers = nullptr;  // who look at the pixels, whose positions are the samples; null: nobody

  OrderedTile(const Tile& tile, std::size_t of_pixel, float clear_depth, bool has_stencil, const glm::vec4& clear_color)
      : depth(tile.pixels() * of_pixel, clear_depth),
        stencil(has_stencil ? depth.size() : 0, 0),
        color(depth.size(), clear_color),
        is_drawn(depth.size(), false),
        samples_per_pixel(of_pixel) {}
};

// What a fragment did to the samples of its cell; the memory model replays it. Bit s of a mask is sample s.
struct OrderedAccess {
  std::uint32_t cell;           // as in SampleAccess
  std::uint32_t triangle;       // index into SetupTriangles
  std::uint32_t read, written;  // samples whose word, or colour, was read or written
};

}  // namespace beampipe
