#include "stages/data/sample_tile.h"

#include "simd/depth_compare.h"

namespace beampipe {

SampleTile::SampleTile(const Tile& tile, const Sampling& sampling, std::uint32_t color_bytes_per_sample)
    : samples_per_pixel(static_cast<std::size_t>(sampling.grid.cells_per_pixel() * sampling.pattern.count)),
      color_bytes(color_bytes_per_sample) {
  const std::size_t samples = tile.pixels() * samples_per_pixel + kSampleSlack;
  depth.assign(samples, kFarDepth);
  triangle.assign(samples, kNoTriangle);
}

}  // namespace beampipe
