#include "stages/shade.h"

#include <half.h>

#include "stages/counting.h"
#include "stages/raster_cost.h"

namespace beampipe {
namespace {

template <class Real>
void lambert(const Real kd[3], const Real normal[3], const Real light[3], Real color[3]) {
  const Real zero(0.0f);
  const Real cosine = greater(zero - (normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]), zero);
  for (int c = 0; c < 3; ++c) color[c] = kd[c] * cosine;
}

OperationCounts invocation_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), in[3] = {one, one, one};
    Counted<float> color[3];
    lambert(in, in, in, color);
  });
}

constexpr OperationCounts kMaterialCost{0, 0, 0, 0, 0, 6};  // Kd and normal to their formats

void count_invocations(std::uint64_t items, std::uint64_t invocations, const OperationCounts& cost,
                       std::uint64_t bytes_read, std::uint64_t bytes_written, StageCounters& counters) {
  counters.items_in += items;
  counters.items_out += items;
  counters.ops += cost * invocations;
  counters.bytes_read += items * bytes_read;
  counters.bytes_written += items * bytes_written;
  counters.lanes_used += items;
  counters.lanes_issued += invocations;
}

template <class Items>
std::uint64_t quad_invocations(const Items& fragments) {
  std::uint64_t quads = 0;
  for (std::size_t i = 0; i < fragments.size(); ++i) quads += i == 0 || fragments[i].quad != fragments[i - 1].quad;
  return 4 * quads;
}

}  // namespace

std::vector<glm::vec3> shade_triangles(const SetupTriangles& triangles, const std::optional<glm::vec3>& light) {
  std::vector<glm::vec3> colors;
  colors.reserve(triangles.attributes.size());
  const glm::vec3 direction = light.value_or(glm::vec3(0.0f));
  for (const FlatAttributes& flat : triangles.attributes) {
    glm::vec3 color = flat.kd;
    if (flat.lit) lambert(&flat.kd.x, &flat.normal.x, &direction.x, &color.x);
    colors.push_back(color);
  }
  return colors;
}

std::vector<glm::vec3> round_to_half(std::vector<glm::vec3> colors) {
  for (glm::vec3& color : colors)
    for (int c = 0; c < 3; ++c) color[c] = half(std::min(color[c], static_cast<float>(HALF_MAX)));
  return colors;
}

void shade(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters) {
  for (Fragment& fragment : fragments) fragment.color = fragment.alpha * colors[fragment.triangle];
  count_invocations(fragments.size(), quad_invocations(fragments), invocation_cost(), sizeof(FlatAttributes), 6,
                    counters);
}

void shade_visible(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters) {
  for (Fragment& fragment : fragments) fragment.color = fragment.alpha * colors[fragment.triangle];
  count_invocations(fragments.size(), fragments.size(), invocation_cost(), sizeof(FlatAttributes), 6, counters);
}

void shade(const std::vector<SampleFragment>& fragments, StageCounters& counters) {
  count_invocations(fragments.size(), quad_invocations(fragments), invocation_cost(),
                    sizeof(FlatAttributes) + kSampleFragmentBytes, 6, counters);
}

void write_gbuffer(const std::vector<SampleFragment>& fragments, StageCounters& counters) {
  count_invocations(fragments.size(), quad_invocations(fragments), kMaterialCost,
                    sizeof(FlatAttributes) + kSampleFragmentBytes, kGBufferBytes, counters);
}

void write_gbuffer(std::uint64_t samples, StageCounters& counters) {
  count_invocations(samples, samples, kMaterialCost, sizeof(FlatAttributes) + kVisibilityBytes, kGBufferBytes,
                    counters);
}

void light(std::uint64_t samples, StageCounters& counters) {
  count_invocations(samples, samples, invocation_cost(), kGBufferBytes, 6, counters);
}

}  // namespace beampipe
