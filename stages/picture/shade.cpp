#include "stages/picture/shade.h"

#include "stages/data/pixel_formats.h"
#include "stages/picture/shade_cost.h"

namespace beampipe {
namespace {

Invocation at_centroid(const TileShader& shader, const Fragment& fragment) {
  return {fragment.triangle, shader.place(fragment.pixel, fragment.centroid_u, fragment.centroid_v), 1.0f};
}

// Of fragments that are requests of their own, or whose requests are not kept.
void color(const TileShader& shader, std::vector<Fragment>& fragments, TexelRequests* texels) {
  if (shader.is_flat()) {
    for (Fragment& fragment : fragments) fragment.color = fragment.alpha * shader.color(fragment.triangle, 0, 0, 0);
    return;
  }
  std::vector<Invocation> invocations;
  invocations.reserve(fragments.size());
  for (const Fragment& fragment : fragments) invocations.push_back(at_centroid(shader, fragment));
  const std::vector<glm::vec4> colors = shader.colors_alone(invocations, texels);
  for (std::size_t i = 0; i < fragments.size(); ++i) fragments[i].color = fragments[i].alpha * glm::vec3(colors[i]);
}

// Of quads, each of which is a request.
void color_quads(const TileShader& shader, std::vector<Fragment>& fragments, TexelRequests& texels) {
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    if (starts_quad(fragments, i)) texels.end_request();
    Fragment& fragment = fragments[i];
    fragment.color = fragment.alpha * shader.color(fragment.triangle, fragment.pixel, fragment.centroid_u,
                                                   fragment.centroid_v, 1.0f, &texels);
  }
  texels.end_request();
}

}  // namespace

void shade(const TileShader& shader, std::vector<Fragment>& fragments, StageCounters& counters, TexelRequests* texels) {
  if (texels && texels->are_kept()) {
    color_quads(shader, fragments, *texels);
  } else {
    color(shader, fragments, texels);
  }
  charge(in_quads(shader, fragments, whole_shader), kPairBytes, kColorBytes, counters);
}

void shade_visible(const TileShader& shader, std::vector<Fragment>& fragments, StageCounters& counters,
                   TexelRequests* texels) {
  color(shader, fragments, texels);
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
  const auto invocation = [&](std::size_t q, std::uint32_t triangle, std::uint8_t location) -> Invocation {
    const std::size_t pixel = location / 8u, sample = location % 8u;
    const std::size_t x = q % columns * 2 + pixel % 2, y = q / columns * 2 + pixel / 2;
    const auto index = static_cast<std::uint32_t>(y * static_cast<std::size_t>(tile.width()) + x);
    return {triangle,
            shader.place(index, static_cast<float>(pattern.x[sample]) / kSubpixelUnits,
                         static_cast<float>(pattern.y[sample]) / kSubpixelUnits),
            1.0f};
  };
  const auto extras = extras_of(quads);
  std::vector<Invocation> invocations;
  std::vector<glm::vec3*> results;
  for (const std::size_t item : order) {
    const std::size_t q = item / 4, p = item % 4;
    if (q < quads.size()) {
      invocations.push_back(invocation(q, quads[q].triangle[p], quads[q].location[p]));
      results.push_back(&quads[q].color[p]);
    } else {
      const auto& [quad, extra] = extras[item - 4 * quads.size()];
      invocations.push_back(invocation(quad, extra->triangle, extra->location));
      results.push_back(&extra->color);
    }
  }
  const std::vector<glm::vec4> colors = shader.colors_alone(invocations, texels);
  for (std::size_t i = 0; i < colors.size(); ++i) *results[i] = glm::vec3(colors[i]);
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
