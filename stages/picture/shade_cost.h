// What shading is charged.
#pragma once

#include <vector>

#include "stages/cost/counting.h"
#include "stages/data/pair.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/sample_fragment.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

// Components become integers of the G-buffer: six of a flat triangle's Kd and normal; of a material, roughness and
// metallic as well.
inline OperationCounts pack_cost(int components) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> value(1.0f, counts), scale(1.0f), offset(1.0f);
    for (int component = 0; component < components; ++component) to_integer(value * scale + offset);
  });
}

// What an invocation does: operations, and bytes that it reads of the triangle.
struct InvocationWork {
  OperationCounts ops;
  std::uint64_t input_bytes;
  std::uint64_t helpers = 0;  // as SurfaceShader::Work
};

inline InvocationWork whole_shader(const TileShader& shader, std::uint32_t triangle) {
  const SurfaceShader::Work& work = shader.work(triangle);
  OperationCounts ops = work.material;
  return {ops += work.light, work.input_bytes, work.helpers};
}
inline InvocationWork material_half(const TileShader& shader, std::uint32_t triangle) {
  static const UnitCost flat = pack_cost(6), varying = pack_cost(8);
  const SurfaceShader::Work& work = shader.work(triangle);
  OperationCounts ops = work.material;
  return {ops += shader.is_flat(triangle) ? flat : varying, work.input_bytes, work.helpers};
}
// Lighting reads the G-buffer. It computes for all flat triangles, lit or not.
inline InvocationWork light_half(const TileShader& shader, std::uint32_t triangle) {
  return {(shader.is_flat(triangle) ? shader.lit_flat() : shader.work(triangle)).light, 0};
}

// What the shader runs on.
struct Invocations {
  std::uint64_t items = 0;        // fragments or samples
  std::uint64_t invocations = 0;  // with the helper invocations of 2x2 quads
  OperationCounts ops{};
  std::uint64_t input_bytes = 0;
};

inline std::uint32_t triangle_of(std::uint32_t triangle) { return triangle; }
template <class Item>
std::uint32_t triangle_of(const Item& item) {
  return item.triangle;
}

// Consecutive items whose triangles cost the same are charged at once.
template <class Items, class WorkOf>
Invocations one_by_one(const TileShader& shader, const Items& items, WorkOf&& work_of) {
  Invocations result{items.size(), items.size()};
  for (std::size_t first = 0, end = 0; first < items.size(); first = end) {
    const std::uint32_t triangle = triangle_of(items[first]);
    const SurfaceShader::Work* const of_first = &shader.work(triangle);
    while (end < items.size() && &shader.work(triangle_of(items[end])) == of_first) ++end;
    const InvocationWork work = work_of(shader, triangle);
    result.invocations += work.helpers * (end - first);
    result.ops += work.ops * ((1 + work.helpers) * (end - first));
    result.input_bytes += work.input_bytes * (end - first);
  }
  return result;
}

// The same in 2x2 quads: all four invocations compute.
template <class Items, class WorkOf>
Invocations in_quads(const TileShader& shader, const Items& fragments, WorkOf&& work_of) {
  Invocations result{fragments.size()};
  for (std::size_t first = 0, end = 0; first < fragments.size(); first = end) {
    std::uint64_t quads = 0;
    for (; end < fragments.size() && fragments[end].triangle == fragments[first].triangle; ++end)
      quads += starts_quad(fragments, end);
    const InvocationWork work = work_of(shader, fragments[first].triangle);
    result.invocations += 4 * quads;
    result.ops += work.ops * (4 * quads);
    result.input_bytes += work.input_bytes * (end - first);
  }
  return result;
}

// Bytes are per item.
inline void charge(const Invocations& shaded, std::uint64_t bytes_read, std::uint64_t bytes_written,
                   StageCounters& counters) {
  counters.items_in += shaded.items;
  counters.items_out += shaded.items;
  counters.ops += shaded.ops;
  counters.bytes_read += shaded.items * bytes_read + shaded.input_bytes;
  counters.bytes_written += shaded.items * bytes_written;
  counters.lanes_used += shaded.items;
  counters.lanes_issued += shaded.invocations;
}

}  // namespace beampipe
