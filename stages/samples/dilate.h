// dilate: shading samples with their masks -> pixels. Each pixel's colour is the mean of its quad's four colours,
// weighted by how many of the pixel's visibility samples each of them was given; so is the box for the history's clamp.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/samples/sample_select.h"
#include "stages/temporal/temporal.h"

namespace beampipe {

// All of a frame's quads, row by row.
struct QuadFrame {
  std::int32_t columns = 0, rows = 0;
  std::vector<SampleQuad> quads;

  QuadFrame(std::uint32_t width, std::uint32_t height);
  void insert(const Tile& tile, const std::vector<SampleQuad>& of_tile);
};

// Sets color, low, high and known of the tile's pixels. `colors` and `draws`: one per triangle. A shading sample's box
// is that of the 3x3 samples around it that are of the same draw. A pixel none of whose visibility samples was given
// takes the colour of its own shading sample, and is known by 0.
void dilate(const QuadFrame& quads, const std::vector<glm::vec3>& colors, const std::vector<std::uint32_t>& draws,
            const glm::vec3& background, const Tile& tile, StageCounters& counters, CurrentFrame& frame);

// Per pixel, the part whose material has no shading sample in the quad.
std::vector<float> unknown_part(const CurrentFrame& frame);

}  // namespace beampipe
