// resolve: framebuffer -> picture: linear RGB over the background, and A, the part of the pixel that geometry covers.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "simd/merge.h"
#include "stages/cost/counters.h"
#include "stages/data/ordered_tile.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/sample_tile.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

std::vector<PixelColor> pixel_colors(const std::vector<Aggregate>& aggregates);

// Blends the aggregates over the background. `stored_bytes`: size of a stored aggregate. Returns RGBA per pixel of the
// tile.
std::vector<glm::vec4> resolve(const std::vector<PixelColor>& aggregates, const glm::vec3& background,
                               std::uint32_t stored_bytes, StageCounters& counters,
                               const PixelObservers* observers = nullptr);

// Where the samples of a triangle in a cell were shaded. `cell`: as in SampleAccess.
struct CellPlace {
  float u, v;   // in the pixel, from its upper left corner, 0..1
  float width;  // of the cell, in pixels
};
using CellPlaces = std::function<CellPlace(std::uint32_t triangle, std::size_t cell)>;

// What the mean of a pixel's samples is taken of: linear colours, or colours that Reinhard's operator has compressed.
// In the second case the mean is expanded again. A sample much brighter than white then counts for little more than
// white, which smooths the edges of highlights.
enum class ResolveSpace { linear, reinhard };

struct ResolveOptions {
  std::size_t cells = 1;     // per pixel
  CellPlaces place_of = {};  // asked for triangles that are not flat
  ResolveSpace space = ResolveSpace::linear;
};

// Returns the mean of each pixel's samples (a box filter of one pixel).
std::vector<glm::vec4> resolve(const SampleTile& surface, std::size_t pixels, const TileShader& shader,
                               const glm::vec3& background, StageCounters& counters,
                               const ResolveOptions& options = {});

// The same of samples that have their colours. `background`: what observers hear of it.
std::vector<glm::vec4> resolve(const OrderedTile& surface, std::size_t pixels, const glm::vec3& background,
                               ResolveSpace space, StageCounters& counters);

}  // namespace beampipe
