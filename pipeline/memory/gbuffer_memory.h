// What shading behind visibility moves for one bin, for the pixels that show a triangle.
#pragma once

#include <vector>

#include "pipeline/memory/tile_surface.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

// The pixels that show a triangle.
std::vector<std::uint32_t> shown_pixels(const SampleTile& surface, const Tile& tile);

// Writes each of the pixels once, and ends the pass.
void write_pixels(const std::vector<std::uint32_t>& pixels, TileSurface& to, StageCounters& counters);

// Light: from the G-buffer to colour. Resolve: from colour to the picture. Adds to `bytes` what each pixel was written.
void move_light_and_resolve(const MemoryParameters& memory, const Tile& tile, const ZOrder& order,
                            const std::vector<std::uint32_t>& pixels, TileSurface& gbuffer, StageCounters& lighting,
                            StageCounters& resolving, std::vector<float>& bytes);

}  // namespace beampipe
