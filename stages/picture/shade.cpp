#include "stages/picture/shade.h"

#include "stages/data/half_bits.h"
#include "stages/picture/picture_formulas.h"
#include "stages/picture/shade_cost.h"

namespace beampipe {

std::vector<glm::vec3> shade_triangles(const SetupTriangles& triangles, const Lighting& lighting) {
  std::vector<glm::vec3> colors;
  colors.reserve(triangles.attributes.size());
  for (const FlatAttributes& flat : triangles.attributes) {
    glm::vec3 color = flat.kd;
    if (flat.lit) {
      color = glm::vec3(0.0f);
      for (const Light& light : lighting.lights) {
        glm::vec3 reflected;
        lambert(&flat.kd.x, &flat.normal.x, &light.direction.x, &reflected.x);
        color += light.color * reflected;
      }
      if (lighting.ambient) {
        const Ambient& ambient = *lighting.ambient;
        color += flat.kd * glm::mix(ambient.ground, ambient.sky, 0.5f + 0.5f * glm::dot(flat.normal, ambient.up));
      }
    }
    colors.push_back(color);
  }
  return colors;
}

std::vector<glm::vec3> round_to_half(std::vector<glm::vec3> colors) {
  for (glm::vec3& color : colors)
    for (int c = 0; c < 3; ++c) color[c] = HalfBits(color[c]);
  return colors;
}

void shade(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters,
           const std::vector<FlatAttributes>* attributes) {
  for (Fragment& fragment : fragments) fragment.color = fragment.alpha * colors[fragment.triangle];
  charge(in_quads(fragments, attributes), lambert_cost(), sizeof(FlatAttributes) + kPairBytes, kColorBytes, counters);
}

void shade_visible(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes) {
  for (Fragment& fragment : fragments) fragment.color = fragment.alpha * colors[fragment.triangle];
  charge(one_by_one(fragments, attributes), lambert_cost(), sizeof(FlatAttributes) + kPairBytes, kColorBytes, counters);
}

void shade_visible(const std::vector<Pair>& whole, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes) {
  charge(one_by_one(whole, attributes), lambert_cost(), sizeof(FlatAttributes) + kPairBytes, kColorBytes, counters);
}

void shade_visible(const std::vector<ShadedTriangle>& shaded, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes) {
  charge(one_by_one(shaded, attributes), lambert_cost(), sizeof(FlatAttributes) + kPairBytes, kColorBytes, counters);
}

void shade(const std::vector<SampleFragment>& fragments, StageCounters& counters,
           const std::vector<FlatAttributes>* attributes) {
  charge(in_quads(fragments, attributes), lambert_cost(), sizeof(FlatAttributes) + kSampleFragmentBytes, kColorBytes,
         counters);
}

void write_gbuffer(const std::vector<SampleFragment>& fragments, StageCounters& counters) {
  charge(in_quads(fragments, nullptr), material_cost(), sizeof(FlatAttributes) + kSampleFragmentBytes, kGBufferBytes,
         counters);
}

void write_gbuffer(std::uint64_t samples, StageCounters& counters) {
  charge({samples, samples, samples}, material_cost(), sizeof(FlatAttributes) + kVisibilityBytes, kGBufferBytes,
         counters);
}

void light(std::uint64_t samples, StageCounters& counters) {
  charge({samples, samples, samples}, lambert_cost(), kGBufferBytes, kColorBytes, counters);
}

}  // namespace beampipe
