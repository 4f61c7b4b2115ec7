#include "stages/picture/shade.h"

#include "stages/data/pixel_formats.h"
#include "stages/picture/shade_cost.h"

namespace beampipe {
namespace {

void shade_at_centroids(const TileShader& shader, std::vector<Fragment>& fragments) {
  for (Fragment& fragment : fragments)
    fragment.color =
        fragment.alpha * shader.color(fragment.triangle, fragment.pixel, fragment.centroid_u, fragment.centroid_v);
}

}  // namespace

void shade(const TileShader& shader, std::vector<Fragment>& fragments, StageCounters& counters) {
  shade_at_centroids(shader, fragments);
  charge(in_quads(shader, fragments, whole_shader), kPairBytes, kColorBytes, counters);
}

void shade_visible(const TileShader& shader, std::vector<Fragment>& fragments, StageCounters& counters) {
  shade_at_centroids(shader, fragments);
  charge(one_by_one(shader, fragments, whole_shader), kPairBytes, kColorBytes, counters);
}

void shade_visible(const TileShader& shader, const std::vector<Pair>& whole, StageCounters& counters) {
  charge(one_by_one(shader, whole, whole_shader), kPairBytes, kColorBytes, counters);
}

void shade_visible(const TileShader& shader, const std::vector<ShadedTriangle>& shaded, StageCounters& counters) {
  charge(one_by_one(shader, shaded, whole_shader), kPairBytes, kColorBytes, counters);
}

void shade(const TileShader& shader, const std::vector<SampleFragment>& fragments, StageCounters& counters) {
  charge(in_quads(shader, fragments, whole_shader), kSampleFragmentBytes, kColorBytes, counters);
}

void color_samples(const TileShader& shader, const Tile& tile, const SamplePattern& pattern,
                   std::vector<SampleQuad>& quads) {
  const std::size_t columns = (static_cast<std::size_t>(tile.width()) + 1) / 2;
  for (std::size_t q = 0; q < quads.size(); ++q) {
    for (std::size_t p = 0; p < 4; ++p) {
      SampleQuad& quad = quads[q];
      if (quad.triangle[p] == kNoTriangle) continue;
      const std::size_t pixel = quad.location[p] / 8u, sample = quad.location[p] % 8u;
      const std::size_t x = q % columns * 2 + pixel % 2, y = q / columns * 2 + pixel / 2;
      const auto index = static_cast<std::uint32_t>(y * static_cast<std::size_t>(tile.width()) + x);
      quad.color[p] = shader.color(quad.triangle[p], index, static_cast<float>(pattern.x[sample]) / kSubpixelUnits,
                                   static_cast<float>(pattern.y[sample]) / kSubpixelUnits);
    }
  }
}

void write_gbuffer(const TileShader& shader, const std::vector<SampleFragment>& fragments, StageCounters& counters) {
  charge(in_quads(shader, fragments, material_half), kSampleFragmentBytes, kGBufferBytes, counters);
}

void write_gbuffer(const TileShader& shader, const std::vector<std::uint32_t>& triangles, StageCounters& counters) {
  charge(one_by_one(shader, triangles, material_half), kVisibilityBytes, kGBufferBytes, counters);
}

void light(const TileShader& shader, const std::vector<std::uint32_t>& triangles, StageCounters& counters) {
  charge(one_by_one(shader, triangles, light_half), kGBufferBytes, kColorBytes, counters);
}

}  // namespace beampipe
