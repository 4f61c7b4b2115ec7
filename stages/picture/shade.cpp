#include "stages/picture/shade.h"

#include <algorithm>

#include "stages/cost/counting.h"
#include "stages/data/half_bits.h"
#include "stages/raster/raster_cost.h"

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

// A component of Kd (0..1) or of the normal (-1..1) as an integer of the G-buffer: 255 or 1023 steps.
template <class Real>
auto quantize(Real value, Real scale, Real offset) {
  return to_integer(value * scale + offset);
}

OperationCounts material_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> value(1.0f, counts), constant(1.0f);
    for (int component = 0; component < 6; ++component) quantize(value, constant, constant);
  });
}

// `lit`: invocations that the cost is of.
void count_invocations(std::uint64_t items, std::uint64_t invocations, std::uint64_t lit, const OperationCounts& cost,
                       std::uint64_t bytes_read, std::uint64_t bytes_written, StageCounters& counters) {
  counters.items_in += items;
  counters.items_out += items;
  counters.ops += cost * lit;
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

template <class Items>
std::uint64_t lit_invocations(const Items& fragments, const std::vector<FlatAttributes>* attributes) {
  if (!attributes) return quad_invocations(fragments);
  std::uint64_t quads = 0;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const bool is_first = i == 0 || fragments[i].quad != fragments[i - 1].quad;
    quads += is_first && (*attributes)[fragments[i].triangle].lit;
  }
  return 4 * quads;
}

template <class Items>
void count_one_by_one(const Items& items, const std::vector<FlatAttributes>* attributes, StageCounters& counters) {
  std::uint64_t lit = items.size();
  if (attributes)
    lit = static_cast<std::uint64_t>(
        std::count_if(items.begin(), items.end(), [&](const auto& item) { return (*attributes)[item.triangle].lit; }));
  count_invocations(items.size(), items.size(), lit, invocation_cost(), sizeof(FlatAttributes) + kPixelTriangleBytes, 6,
                    counters);
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
    for (int c = 0; c < 3; ++c) color[c] = HalfBits(color[c]);
  return colors;
}

void shade(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters,
           const std::vector<FlatAttributes>* attributes) {
  for (Fragment& fragment : fragments) fragment.color = fragment.alpha * colors[fragment.triangle];
  count_invocations(fragments.size(), quad_invocations(fragments), lit_invocations(fragments, attributes),
                    invocation_cost(), sizeof(FlatAttributes) + kPixelTriangleBytes, 6, counters);
}

void shade_visible(const std::vector<glm::vec3>& colors, std::vector<Fragment>& fragments, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes) {
  for (Fragment& fragment : fragments) fragment.color = fragment.alpha * colors[fragment.triangle];
  count_one_by_one(fragments, attributes, counters);
}

void shade_visible(const std::vector<PixelTriangle>& whole, StageCounters& counters,
                   const std::vector<FlatAttributes>* attributes) {
  count_one_by_one(whole, attributes, counters);
}

void shade(const std::vector<SampleFragment>& fragments, StageCounters& counters,
           const std::vector<FlatAttributes>* attributes) {
  count_invocations(fragments.size(), quad_invocations(fragments), lit_invocations(fragments, attributes),
                    invocation_cost(), sizeof(FlatAttributes) + kSampleFragmentBytes, 6, counters);
}

void write_gbuffer(const std::vector<SampleFragment>& fragments, StageCounters& counters) {
  const std::uint64_t invocations = quad_invocations(fragments);
  count_invocations(fragments.size(), invocations, invocations, material_cost(),
                    sizeof(FlatAttributes) + kSampleFragmentBytes, kGBufferBytes, counters);
}

void write_gbuffer(std::uint64_t samples, StageCounters& counters) {
  count_invocations(samples, samples, samples, material_cost(), sizeof(FlatAttributes) + kVisibilityBytes,
                    kGBufferBytes, counters);
}

void light(std::uint64_t samples, StageCounters& counters) {
  count_invocations(samples, samples, samples, invocation_cost(), kGBufferBytes, 6, counters);
}

}  // namespace beampipe
