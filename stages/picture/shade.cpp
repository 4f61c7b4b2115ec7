#include "stages/picture/shade.h"

#include "stages/data/pixel_formats.h"
#include "stages/picture/shade_cost.h"

namespace beampipe {
namespace {

void shade_at_centroid(const TileShader& shader, TexelRequests* texels, Fragment& fragment) {
  fragment.color = fragment.alpha * shader.color(fragment.triangle, fragment.pixel, fragment.centroid_u,
                                                 fragment.centroid_v, 1.0f, texels);
}

}  // namespace

void shade(const TileShader& shader, std::vector<Fragment>& fragments, StageCounters& counters, TexelRequests* texels) {
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    if (starts_quad(fragments, i)) end_request(texels);
    shade_at_centroid(shader, texels, fragments[i]);
  }
  end_request(texels);
  charge(in_quads(shader, fragments, whole_shader), kPairBytes, kColorBytes, counters);
}

void shade_visible(const TileShader& shader, std::vector<Fragment>& fragments, StageCounters& counters,
                   TexelRequests* texels) {
  for (Fragment& fragment : fragments) {
    shade_at_centroid(shader, texels, fragment);
    end_request(texels);
  }
  charge(one_by_one(shader, fragments, whole_shader), kPairBytes, kColorBytes, counters);
}

void shade_visible(const TileShader& shader, const std::vector<Pair>& whole, StageCounters& counters) {
  charge(one_by_one(shader, whole, whole_shader), kPairBytes, kColorBytes, counters);
}

void shade_visible(const TileShader& shader, const std::vector<ShadedTriangle>& shaded, StageCounters& counters) {
  charge(one_by_one(shader, shaded, whole_shader), kPairBytes, kColorBytes, counters);
}

void shade(const TileShader& shader, const std::vector<SampleFragment>& fragments, std::uint32_t color_bytes,
           StageCounters& counters) {
  charge(in_quads(shader, fragments, whole_shader), kSampleFragmentBytes, color_bytes, counters);
}

void color_samples(const TileShader& shader, const Tile& tile, const SamplePattern& pattern,
                   const std::vector<std::uint32_t>& order, std::vector<SampleQuad>& quads, TexelRequests* texels) {
  const std::size_t columns = (static_cast<std::size_t>(tile.width()) + 1) / 2;
  const auto color_at = [&](std::size_t q, std::uint32_t triangle, std::uint8_t location) {
    const std::size_t pixel = location / 8u, sample = location % 8u;
    const std::size_t x = q % columns * 2 + pixel % 2, y = q / columns * 2 + pixel / 2;
    const auto index = static_cast<std::uint32_t>(y * static_cast<std::size_t>(tile.width()) + x);
    const glm::vec3 color = shader.color(triangle, index, static_cast<float>(pattern.x[sample]) / kSubpixelUnits,
                                         static_cast<float>(pattern.y[sample]) / kSubpixelUnits, 1.0f, texels);
    end_request(texels);
    return color;
  };
  const auto extras = extras_of(quads);
  for (const std::size_t item : order) {
    const std::size_t q = item / 4, p = item % 4;
    if (q < quads.size()) {
      quads[q].color[p] = color_at(q, quads[q].triangle[p], quads[q].location[p]);
    } else {
      const auto& [quad, extra] = extras[item - 4 * quads.size()];
      extra->color = color_at(quad, extra->triangle, extra->location);
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
